// The git revision this program was built from. scripts/setup writes it into revision.h, beside this
// file; a bare `fpm build` without that header gives "unknown". Fortran sees it as
// function spintop_revision() bind(C), a type(c_ptr) to a text that ends with a null character.
#ifdef __has_include
#if __has_include("revision.h")
#include "revision.h"
#endif
#endif
#ifndef SPINTOP_REVISION
#define SPINTOP_REVISION "unknown"
#endif

const char *spintop_revision(void);

const char *spintop_revision(void) { return SPINTOP_REVISION; }
