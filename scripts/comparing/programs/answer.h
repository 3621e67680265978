/* The least time of several runs, as in scripts/comparing/answer.py, and the numbers that are written. */
#ifndef SPINTOP_ANSWER_H
#define SPINTOP_ANSWER_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* The mean time of so many runs one after the other: elapsed time of a motion, whatever else the processor does can
 * only lengthen it; processor time of many bodies, as that of a sweep, because one run takes long. */
static double time_of(int calls, void (*run)(void *), void *what, clockid_t clock)
{
    struct timespec start, end;
    clock_gettime(clock, &start);
    for (int i = 0; i < calls; ++i)
        run(what);
    clock_gettime(clock, &end);
    return ((double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec)) / calls;
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

/* Writes a state, the numbers of which are so far apart; ends the program where it is not finite. */
static void write_state(const double *y, int states, int stride)
{
    for (int i = 0; i < states; ++i) {
        if (!isfinite(y[i * stride])) {
            fprintf(stderr, "the state is not finite\n");
            exit(1);
        }
        fwrite(&y[i * stride], sizeof(double), 1, stdout);
    }
}

/* Writes the time and the counts behind the states; NAN for one that is not known. */
static void write_costs(double time_s, double steps, double rejected, double evaluations)
{
    const double costs[] = {time_s, steps, rejected, evaluations};
    fwrite(costs, sizeof(double), 4, stdout);
}

#endif
