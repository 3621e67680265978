// The process itself: its standard streams, its signals, its limits, and how it ends.

#define _DEFAULT_SOURCE
#define _POSIX_C_SOURCE 200809L

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

void spintop_remove_lock_file(const char *path);

enum { standard_input, standard_output, standard_error };

// Exit codes of an unexpected end, as in errors.f90.
enum { exit_output = 4, exit_internal = 5 };

static atomic_int is_planned;

// Whether a library cannot be ended, so that it is left as it is.
static int leaves_libraries;

// What an invalid access to memory means as long as a library is expected to have one.
static char meaning_of_crash[8192];

// The message of a signal that ends the process: `before`, a number of rows, `after`. It is prepared
// in advance, as few functions are safe in a handler.
static char before[8192], after[16384];
static atomic_int is_watching;
static atomic_llong rows_kept;

// Whether a thread ends the process after a signal, when it has kept what is to be kept; the signal; and the time after
// which the process ends in any case.
static atomic_int has_journal_thread;
static atomic_int wanted;
static const struct itimerval longest_wait = {.it_value = {.tv_usec = 900000}};

// Signals that end a process from outside and leave it time for a message.
static const int ending_signals[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};

static void complain(const char *text, size_t length) {
    while (length > 0) {
        const ssize_t written = write(standard_error, text, length);
        if (written <= 0) return;
        text += written;
        length -= (size_t)written;
    }
}

// Says what is kept of the run, and lets go of its files.
static void report_rows_kept(void) {
    char digits[24];
    char *first = digits + sizeof digits;
    long long rows = rows_kept;
    spintop_remove_lock_file(NULL);
    if (!atomic_exchange(&is_watching, 0)) return;
    if (rows >= 0) {
        do {
            *--first = (char)('0' + rows % 10);
            rows /= 10;
        } while (rows > 0);
    }
    complain(before, strlen(before));
    complain(first, (size_t)(digits + sizeof digits - first));
    complain(after, strlen(after));
}

// The run-time libraries end the process when memory runs out or a check fails. They have printed
// the reason; their exit codes are replaced.
static void end_unplanned(void) {
    static const char text[] = "spintop: stopped by the error above: there is no more memory, or the program has a fault\n";
    if (is_planned) return;
    complain(text, sizeof text - 1);
    report_rows_kept();
    _exit(exit_internal);
}

// Ends the process by a signal, after its message.
static void report_and_end(int number) {
    report_rows_kept();
    // In the handler of this signal it ends the process when the handler returns.
    signal(number, SIG_DFL);
    raise(number);
}

// The first signal is left to the journal thread, if there is one; a second one ends the process at once.
static void answer(int number) {
    if (has_journal_thread && wanted == 0) {
        wanted = number;
        setitimer(ITIMER_REAL, &longest_wait, NULL);
        return;
    }
    report_and_end(number);
}

// The journal thread has taken too long.
static void end_of_wait(int number) {
    if (wanted != 0) report_and_end(wanted);
    (void)number;
}

// Without this a file opened later could take the number of a closed stream, and output to the
// stream would go into the file. Such a stream refuses output.
static void occupy(int stream) {
    int file;
    if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) return;
    file = open("/dev/null", O_RDONLY);
    if (file < 0 || file == stream) return;
    dup2(file, stream);
    close(file);
}

// An invalid access to memory. gfortran does not check memory for values such as `[list, more]`, and goes on with a null
// pointer.
static void answer_crash(int number) {
    static const char text[] = "spintop: there is no more memory, or the program has a fault\n";
    const int is_expected = meaning_of_crash[0] != '\0';
    (void)number;
    complain(is_expected ? meaning_of_crash : text, is_expected ? strlen(meaning_of_crash) : sizeof text - 1);
    report_rows_kept();
    _exit(is_expected ? exit_output : exit_internal);
}

// From now on an invalid access to memory ends the program with a text, as an error of an output; with '' no longer. netCDF
// has such accesses where HDF5 cannot close a file.
void spintop_expect_crash(const char *text) { snprintf(meaning_of_crash, sizeof meaning_of_crash, "%s", text); }

// At its end the process does nothing more in its libraries.
void spintop_leave_libraries(void) { leaves_libraries = 1; }

// To be called once, before anything else is opened.
void spintop_begin_process(void) {
    struct sigaction old;
    const struct sigaction ending = {.sa_handler = answer, .sa_flags = SA_RESTART};
    const struct sigaction ignored = {.sa_handler = SIG_IGN}, late = {.sa_handler = end_of_wait, .sa_flags = SA_RESTART};
#ifndef __SANITIZE_ADDRESS__
    // On a stack of its own: without memory HDF5 reports the error of its report, until the stack is full.
    static char stack_of_crash[65536];
    const stack_t other = {.ss_sp = stack_of_crash, .ss_size = sizeof stack_of_crash};
    const struct sigaction crash = {.sa_handler = answer_crash, .sa_flags = SA_RESTART | SA_ONSTACK};
    sigaltstack(&other, NULL);
    sigaction(SIGSEGV, &crash, NULL);
    sigaction(SIGABRT, &crash, NULL); // netCDF and the C library give up so where memory is not as they expect
#endif

    for (int stream = standard_input; stream <= standard_error; ++stream) occupy(stream);
    atexit(end_unplanned);

    // A file that may not grow is an error of write.
    sigaction(SIGXFSZ, &ignored, NULL);
    sigaction(SIGALRM, &late, NULL);
    for (size_t i = 0; i < sizeof ending_signals / sizeof *ending_signals; ++i) {
        // What the parent has had ignored (nohup) stays so. A library may have set a handler: UCX, which comes with
        // Open MPI, has one for SIGHUP that does not end the process.
        if (sigaction(ending_signals[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN) {
            sigaction(ending_signals[i], &ending, NULL);
        }
    }
}

// Whether from now on a journal thread ends the process after a signal, by `spintop_end_by_signal`.
void spintop_set_journal_thread(_Bool there_is_one) { has_journal_thread = there_is_one; }

// Whether a signal is to end the process.
_Bool spintop_end_is_wanted(void) { return wanted != 0; }

// Ends the process by that signal.
void spintop_end_by_signal(void) { report_and_end(wanted); }

void spintop_end_process(int code) {
    is_planned = 1;
    if (leaves_libraries) _exit(code);
    exit(code);
}

// From now on a signal prints `head`, the number of rows, `tail`; the tail only if `rows` < 0.
void spintop_watch(const char *head, const char *tail, long long rows) {
    is_watching = 0;
    snprintf(before, sizeof before, "%s%s", isatty(standard_error) ? "\n" : "", rows < 0 ? "" : head);
    snprintf(after, sizeof after, "%s", tail);
    rows_kept = rows;
    is_watching = 1;
}

// Sets the number of rows.
void spintop_keep(long long rows) { rows_kept = rows; }

void spintop_watch_no_more(void) { is_watching = 0; }

// Bytes that the stack of the first thread may take; -1 for no limit.
long long spintop_stack_limit(void) {
    struct rlimit limit;
    if (getrlimit(RLIMIT_STACK, &limit) < 0 || limit.rlim_cur == RLIM_INFINITY) return -1;
    return (long long)limit.rlim_cur;
}

// Reads a size as OpenMP does: a whole number, and B, K (the default), M or G. -1 if it is none.
static long long read_size(const char *text) {
    static const char units[] = "bkmg";
    long long size;
    char unit = 'k', rest;
    const int found = sscanf(text, "%lld %c %c", &size, &unit, &rest);
    const char *const place = strchr(units, tolower((unsigned char)unit));
    if (found < 1 || found > 2 || place == NULL || size < 0 || size > LLONG_MAX >> 10 * (place - units)) return -1;
    return size << 10 * (place - units);
}

// Bytes that the environment gives the stacks of the other threads; -1 if it leaves them as they are.
long long spintop_thread_stack(void) {
    static const char *const names[] = {"OMP_STACKSIZE", "GOMP_STACKSIZE"};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        const char *text = getenv(names[i]);
        const long long size = text == NULL ? -1 : read_size(text);
        if (size >= 0) return size;
    }
    return -1;
}
