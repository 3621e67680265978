// What a program inherits: read, and in part removed, before its libraries look at it.

#define _POSIX_C_SOURCE 200809L

#include <signal.h>
#include <stddef.h>
#include <string.h>

// Of process.c.
extern int spintop_hangup_is_ignored;

static void note_ignored_hangup(void) {
    struct sigaction inherited;
    if (sigaction(SIGHUP, NULL, &inherited) == 0) spintop_hangup_is_ignored = inherited.sa_handler == SIG_IGN;
}

// Removes the variables of gfortran's run-time library, which change formats, units, buffers and lengths of records.
static void forget_settings(char **environment) {
    static const char prefix[] = "GFORTRAN_";
    char **kept = environment;
    for (char **each = environment; *each != NULL; ++each) {
        if (strncmp(*each, prefix, sizeof prefix - 1) != 0) *kept++ = *each;
    }
    *kept = NULL;
}

static void begin(int count, char **arguments, char **environment) {
    (void)count;
    (void)arguments;
    note_ignored_hangup();
    forget_settings(environment);
}

// These functions run before the constructors of libraries; only a program may have them. UCX, which comes with Open
// MPI, has a constructor that puts a handler in the place of an ignored SIGHUP, and nohup would be of no use. The
// constructor of libgfortran reads the environment.
__attribute__((section(".preinit_array"), used)) static void (*const before_libraries)(int, char **, char **) = begin;
