// The kernels for Fortran: of the tables of builds one is chosen when the program starts, by the level of the processor.

#include "kernels.h"

int spintop_processor_level(void);

#ifdef HAS_LEVELS
static const struct kernels *const built[] = {0, 0, &spintop_kernels_v2, &spintop_kernels_v3, &spintop_kernels_v4};
#else
#define KERNELS spintop_kernels_as_built
#include "kernels_of_level.h"
static const struct kernels *const built[] = {&spintop_kernels_as_built};
#endif

static struct kernels chosen;

__attribute__((constructor)) static void choose(void) { chosen = *built[spintop_processor_level()]; }

#define PROCEDURE(name, arguments, ...) \
    void spintop_##name(__VA_ARGS__) { chosen.name arguments; }
#define FUNCTION(name, arguments, ...) \
    double spintop_##name(__VA_ARGS__) { return chosen.name arguments; }
#include "kernel_list.h"

// The same at a level, for tests; returns whether there is a build for it.

static const struct kernels *builds_at(int level) {
    return level >= 0 && level < (int)(sizeof built / sizeof *built) ? built[level] : 0;
}

#define PROCEDURE(name, arguments, ...)                     \
    int spintop_##name##_at_level(int level, __VA_ARGS__) { \
        const struct kernels *const at = builds_at(level);  \
        if (at) at->name arguments;                         \
        return at != 0;                                     \
    }
#define FUNCTION(...)
#include "kernel_list.h"
