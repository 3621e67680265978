/* The least time of several runs, as in scripts/comparing/answer.py, and the line of JSON that is printed. */
#ifndef SPINTOP_ANSWER_H
#define SPINTOP_ANSWER_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* Elapsed time of a motion, whatever else the processor does can only lengthen it; processor time of many
 * bodies, as that of a sweep, because one run takes long. */
static double now(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The mean time of so many runs one after the other. */
static double time_of(int calls, void (*run)(void *), void *what, clockid_t clock)
{
    const double start = now(clock);
    for (int i = 0; i < calls; ++i)
        run(what);
    return (now(clock) - start) / calls;
}

/* Each run starts anew. Those that are short are measured several at a time, so that the clock does not
 * count. They are repeated five times and for a twentieth of a second at least, but not beyond two
 * seconds. */
static double least_time(void (*run)(void *), void *what, clockid_t clock)
{
    const double first = time_of(1, run, what, clock);
    const int calls = first < 2e-4 ? 1 + (int)(2e-4 / (first + 1e-7)) : 1;
    double spent = 0, least = first;
    for (int repeat = 0; first <= 2 && spent <= 2 && (repeat < 5 || spent < 0.05); ++repeat) {
        const double taken = time_of(calls, run, what, clock);
        spent += calls * taken;
        if (taken < least)
            least = taken;
    }
    return least;
}

/* Prints a state, the numbers of which are so far apart; ends the program where it is not finite. */
static void print_state(const double *y, int states, int stride, int is_first)
{
    for (int i = 0; i < states; ++i) {
        if (!isfinite(y[i * stride])) {
            fprintf(stderr, "the state is not finite\n");
            exit(1);
        }
        printf("%s%.17g", i ? ", " : is_first ? "{\"states\": [[" : ", [", y[i * stride]);
    }
    printf("]");
}

/* Prints the rest of the line; a count below zero is not known. */
static void print_costs(double time_s, long steps, long rejected, long evaluations)
{
    const char *const names[] = {"steps", "rejected", "evaluations"};
    const long counts[] = {steps, rejected, evaluations};
    printf("], \"time_s\": %.9g", time_s);
    for (int i = 0; i < 3; ++i)
        if (counts[i] >= 0)
            printf(", \"%s\": %ld", names[i], counts[i]);
    printf("}\n");
}

#endif
