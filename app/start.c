// What a program inherits, read before its libraries can change it.

#define _POSIX_C_SOURCE 200809L

#include <signal.h>
#include <stddef.h>

// Of process.c.
extern int spintop_hangup_is_ignored;

static void look(void) {
    struct sigaction inherited;
    if (sigaction(SIGHUP, NULL, &inherited) == 0) spintop_hangup_is_ignored = inherited.sa_handler == SIG_IGN;
}

// These functions run before the constructors of libraries; only a program may have them. UCX, which comes with Open
// MPI, has a constructor that puts a handler in the place of an ignored SIGHUP, and nohup would be of no use.
__attribute__((section(".preinit_array"), used)) static void (*const before_libraries)(void) = look;
