// Certified digits in a build without FLINT: there are none.
#include "balls.h"
#ifndef SPINTOP_FLINT
#include <math.h>
#include <stddef.h>

void *spintop_proof_open(const double value[DATA], const double radius[DATA], int given) {
    (void)value, (void)radius, (void)given;
    return NULL;
}

void spintop_proof_close(void *proof) { (void)proof; }

int spintop_proof_bounds(void *proof, double t, const int wanted[QUANTITIES], int certified, double printed[QUANTITIES],
                         double bound[QUANTITIES], int reason[QUANTITIES]) {
    int i;
    (void)proof, (void)t, (void)certified, (void)printed;
    for (i = 0; i < QUANTITIES; i++) bound[i] = INFINITY, reason[i] = wanted[i] ? NO_LIBRARY : PROVED;
    return 0;
}

int spintop_proof_library(void) { return 0; }
#endif
