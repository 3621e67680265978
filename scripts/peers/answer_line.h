/* What the programs of peers print: one line of JSON. */
#ifndef SPINTOP_ANSWER_LINE_H
#define SPINTOP_ANSWER_LINE_H

#include <math.h>
#include <stdio.h>

/* A count below zero is not known. */
static void print_count(const char *name, long count)
{
    if (count < 0)
        printf(", \"%s\": NaN", name);
    else
        printf(", \"%s\": %ld", name, count);
}

/* Returns the exit code: not zero where the state is not finite. */
static int print_answer(const double *y, int states, long steps, long rejected, long evaluations,
                        double time_s)
{
    for (int i = 0; i < states; ++i)
        if (!isfinite(y[i])) {
            fprintf(stderr, "the state is not finite\n");
            return 1;
        }
    printf("{\"state\": [");
    for (int i = 0; i < states; ++i)
        printf("%s%.17g", i ? ", " : "", y[i]);
    printf("], \"time_s\": %.9g", time_s);
    print_count("steps", steps);
    print_count("rejected", rejected);
    print_count("evaluations", evaluations);
    printf("}\n");
    return 0;
}

#endif
