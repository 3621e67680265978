/* The least time of several runs after a first, as in scripts/peers/answer.py. */
#ifndef SPINTOP_LEAST_TIME_H
#define SPINTOP_LEAST_TIME_H

#include <time.h>

/* Elapsed time: what else the processor does can only lengthen it. */
#ifndef LEAST_TIME_CLOCK
#define LEAST_TIME_CLOCK CLOCK_MONOTONIC
#endif

static double now(void)
{
    struct timespec t;
    clock_gettime(LEAST_TIME_CLOCK, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The mean time of so many runs one after the other. */
static double time_of(int calls, void (*run)(void *), void *what)
{
    const double start = now();
    for (int i = 0; i < calls; ++i)
        run(what);
    return (now() - start) / calls;
}

/* Each run starts anew. Those that are short are measured several at a time, so that the clock does not
 * count. They are repeated five times and for a twentieth of a second at least, but not beyond two
 * seconds. */
static double least_time(void (*run)(void *), void *what)
{
    const double first = time_of(1, run, what);
    const int calls = first < 2e-4 ? 1 + (int)(2e-4 / (first + 1e-7)) : 1;
    double spent = 0, least = first;
    if (first > 2)
        return first;
    for (int repeat = 0; repeat < 5 || spent < 0.05; ++repeat) {
        const double taken = time_of(calls, run, what);
        spent += calls * taken;
        if (taken < least)
            least = taken;
        if (spent > 2)
            break;
    }
    return least;
}

#endif
