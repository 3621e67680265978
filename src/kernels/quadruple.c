// The series of one body in quadruple precision, which no processor of today has vectors for: one build for all levels.

#include <float.h>
#include <math.h>

#include "kernels.h"

#if LDBL_MANT_DIG == 113
typedef long double quadruple;
#define of_element(name) name##l
#else
__extension__ typedef __float128 quadruple;
#define of_element(name) name##q
// Of libquadmath, a part of the library of gfortran, whose header not every compiler has.
quadruple cosq(quadruple), sinq(quadruple), sqrtq(quadruple), powq(quadruple, quadruple);
#endif

#define inlined static inline
#define for_all(i, n) for (int i = 0; i < (n); ++i)
#define unrolled_for for

// 1/k has no second number here.
enum { exact_shares = 0 };
struct share {
    quadruple first, rest;
    int is_sum;
};
inlined struct share share_of_term(int is_sum, int k) { return (void)is_sum, (struct share){1 / (quadruple)(k + 1), 0, 0}; }

#include "series/algebra_names.h"

#define NAME(name) quadruple_##name
#define element quadruple
#include "series/algebra_scalar.h"
#include "series/motion_series.h"

void spintop_expand_quadruple(int order, const struct motion_kinds *has, const struct body_numbers *body, double t,
                              const void *state, const double *table, const double *law, const void *given, void *c,
                              int *exists) {
    struct quadruple_constants e;
    quadruple_set(body, 0, (quadruple *)&e);
    *exists = quadruple_expand_with(has, 0, order, &e, t, state, table, law, given, c);
}
