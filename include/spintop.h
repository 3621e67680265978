/* spintop: the motion of a heavy spinning top. The interface for C, C++ and whatever calls C.
 *
 * Inputs are namelist texts, as the program reads them (doc/input.md); results are columns of doubles, in SI units
 * and radians. The library has no global state:
 *
 *  - What a function returns as a pointer belongs to the caller, who deletes it with the function named there. The
 *    structures are for reading. Texts end with a null character, are in UTF-8, and live as long as their structure.
 *  - `spintop_error **error` may be NULL. Otherwise the function sets *error where it fails, and leaves it unchanged
 *    where it succeeds; set *error to NULL before the call.
 *  - NULL where nothing is said of it is an error, SPINTOP_BAD_INPUT. As a top it has no columns and no warnings. So are
 *    empty names, negative counts, and sizes beyond those of arrays.
 *  - Any thread may call any function. spintop_top_at and spintop_tops run side by side, also with the same
 *    spintop_top; those that read a text or make a result (spintop_top_new, spintop_top_events, spintop_run,
 *    spintop_sweep, spintop_list) wait for each other.
 *  - A thread that calls needs a stack of at least 1 MB. That of a thread is 8 MB by default on Linux; some languages and
 *    programs make smaller ones.
 *  - Rounding, traps and other settings of the caller's floating-point arithmetic do not change results, and are as before
 *    when a function returns. Threads that OpenMP made before the first call keep their own.
 *  - The library writes nothing to standard output or standard error, installs no handlers of signals, and does not
 *    end the process, except where the memory is exhausted.
 *
 * ABI: functions, structures and constants of interface 1 do not change. A later version may add functions. A change
 * that breaks programs changes SPINTOP_INTERFACE and the number at the end of the library's name (libspintop.so.1). */
#ifndef SPINTOP_H
#define SPINTOP_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SPINTOP_INTERFACE 1

/* The interface of the library that is loaded: compare it with SPINTOP_INTERFACE. */
int spintop_interface(void);

/* Version of the library, as "0.1.0"; not to be deleted. */
const char *spintop_version(void);

/* Codes of errors and results: those with which the program ends. */
enum {
    SPINTOP_OK = 0,
    SPINTOP_BAD_INPUT = 2, /* wrong usage or input: nothing was computed */
    SPINTOP_FAILED = 3,    /* the motion, or some cases, failed; the rest is there */
    SPINTOP_NO_OUTPUT = 4, /* a result could not be written */
    SPINTOP_INTERNAL = 5
};

/* An error. */
typedef struct spintop_error {
    int code;         /* one of the codes above */
    int line, column; /* first wrong place of the input; 0 if there is none */
    int reserved;
    const char *status;  /* how a motion failed, as in the column status of tables; "" for other errors */
    const char *message; /* what is wrong, and what to do; may have several lines */
    const char *source;  /* name of the input or file with that place; "" if there is none */
    void *owner;         /* of the library */
} spintop_error;

void spintop_error_delete(spintop_error *error); /* NULL is allowed */

/* A column of a table: numbers, or words. */
typedef struct spintop_column {
    const char *name;
    const char *unit;         /* SI; "" where there is none */
    const char *what;         /* meaning */
    const double *values;     /* one for each row; NULL for a description without values, or without rows */
    const char *const *words; /* NULL for numbers. Otherwise row i has words[(size_t)values[i]] */
    long long word_count;
} spintop_column;

/* One top.
 *
 * `input` is the input of a trajectory (groups &top, &initial, &span, &integration, &output). Its method computes the
 * motion, in closed form or step by step, and its columns are the result; `name` stands in messages (NULL: "input").
 *
 * Columns may be derivatives, "theta__top.mass": of a column with respect to a real key of &top, &initial or &effects, at
 * the same time. They stand after the other columns, each with its error, "theta__top.mass_error". */
typedef struct spintop_top spintop_top;

spintop_top *spintop_top_new(const char *input, const char *name, spintop_error **error);
void spintop_top_delete(spintop_top *top); /* NULL is allowed */

/* Warnings of the input, such as that no body has its inertia; "" if there are none. They live as long as the top. */
const char *spintop_top_warnings(const spintop_top *top);

/* The columns: in the cells of spintop_top_at that of index c has its values in cells[c*n] to cells[c*n + n - 1]. */
int spintop_top_column_count(const spintop_top *top);
const spintop_column *spintop_top_columns(const spintop_top *top);

/* The motion at n times t (s, from the start), into memory of the caller for n values of each column. Returns a code.
 *
 * A closed form takes any times. Other methods take increasing times from 0, and integrate up to the last one; those
 * with steps of fixed size take them over the span of the input, and have the times of steps only. After a failure the
 * rows that were not reached are NaN, and so is a derivative that does not exist. phi and psi have all their turns since
 * the start. */
int spintop_top_at(const spintop_top *top, size_t n, const double *t, double *cells, spintop_error **error);

/* A table. */
typedef struct spintop_table {
    const char *name; /* "rows", "events", "statistics", "histogram", "indices" or "residuals" */
    const spintop_column *columns;
    long long column_count, row_count;
    const char *frame; /* its lines as a CSV file but for the rows: header, names, end; "" of spintop_top_events */
} spintop_table;

/* What a run gives. */
typedef struct spintop_result {
    int code; /* SPINTOP_OK, or SPINTOP_FAILED: the motion ended early, or some cases failed */
    int table_count;
    const spintop_table *tables; /* the first is "rows", unless the input wants none */
    const char *summary;         /* plan, cost and end of the run for a reader, or its end only; "" for a sweep in memory */
    const char *warnings;        /* of the input and of the run; "" if there are none */
    void *owner;                 /* of the library */
} spintop_result;

void spintop_result_delete(spintop_result *result); /* NULL is allowed */

/* Looks for the events of a top (output.events) in the span of its input, or up to its end by span.stop_at; spintop_top_at
 * does not end there. The table "events" has a row for each event: its name, its number, and the columns of the top at that
 * instant, but for derivatives. NULL after an error; a motion that ends early is a result with a code, whose summary says
 * why. */
spintop_result *spintop_top_events(const spintop_top *top, spintop_error **error);

/* Sets a function that spintop_run and spintop_sweep ask about ten times a second, when the calling thread calls them:
 * `share` of the work is done, from 0 to 1 (of a fit, which does not know, 0), and `data` is as given. If it returns another
 * number than 0, the call ends soon, with the error "stopped, as the caller wants" of the code SPINTOP_FAILED; no file is then
 * complete that is not. It may be called in another thread, by one at a time, and must not call this library. Each thread has
 * its own; NULL is none. */
typedef int (*spintop_progress)(double share, void *data);
void spintop_on_progress(spintop_progress function, void *data);

/* Runs an input of any kind of study. The tables are in memory; with a `folder` (else NULL) they are also written
 * there, as by the program. Paths in the input are relative to the folder of `name`. `threads` 0: all cores; at most 4096
 * are taken. NULL after an error; a motion that ends early is not an error but a result with a code. */
spintop_result *spintop_run(const char *input, const char *name, const char *folder, int threads, spintop_error **error);

/* Runs a sweep (study.kind = 'sweep', without a group &sweep) over `parameter_count` arrays of `cases` values each:
 * names[i], as "initial.spin_ratio", has values[i]. Without parameters there is one case. The table has a row for each
 * case, with its status; those of failed cases say why in the column notes. */
spintop_result *spintop_sweep(const char *input, int parameter_count, const char *const *names, const double *const *values,
                              size_t cases, int threads, spintop_error **error);

/* Many undamped symmetric tops in closed form, from arrays to arrays: the fastest way, at 0.1 to 0.2 us each.
 *
 * Data: inertia1, inertia3 (kg m^2, about the pivot), mgl (N m, not negative), theta (rad); and with default 0
 * phi_rate, theta_rate, omega3 (rad/s), phi, psi (rad), t_end (s). Value k of given[i] is given[i][k*strides[i]]: a
 * stride of 0 is one value for all tops. Strides are not negative.
 * Quantities, n each: theta_min, theta_max, delta_u, nutation_period, precession_per_nutation, precession_rate,
 * phi_rate_max; theta_end, phi_end, psi_end, theta_rate_end, energy_error (motion at t_end). They are those of the
 * columns of a sweep, with the same bits. A name is given once.
 * `status` (may be NULL) is 0 for a top that was computed; the quantities of others are NaN. Returns a code. */
int spintop_tops(long long n, int given_count, const char *const *given_names, const double *const *given,
                 const long long *strides, int wanted_count, const char *const *wanted_names, double *const *wanted,
                 int *status, int threads, spintop_error **error);

/* What `spintop list` shows: methods, formulations, columns, events, shapes, parameters, cases, studies, statuses,
 * exit_codes. NULL lists the topics, or, as JSON, all of them. Free the text with free(). */
char *spintop_list(const char *topic, int as_json, spintop_error **error);

#ifdef __cplusplus
}
#endif
#endif
