// The motion of any body in ball arithmetic, step by step: what ball_field.c, ball_series.c, ball_matrix.c and ball_tube.c
// share. Theorem and proof are in doc/proof.md, with the same letters.
//
// State x = (q, w): quaternion, and w = omega + R^T O in body axes, O the rotation of the frame. The unit of time is a power
// of two of a second, such that |w| is about 1/2: then one norm fits all components. With u = 1, t, cos W1 t, sin W1 t, ...
//
//     q' = (q w - O q)/2,    w_i' = c_i w_j w_k + sum_n u_n (T_n,i : q q + H_n,i w)
//
// Constants are balls. A step is a polynomial X(s) with exact coefficients, t = t0 + h s, 0 <= s <= 1.
#ifndef SPINTOP_BALL_TUBE_H
#define SPINTOP_BALL_TUBE_H
#include "balls.h"
#ifdef SPINTOP_FLINT

// Components of x, products q_a q_b, the functions u_n, oscillations; the most coefficients of X and of V, and data with
// radii.
enum { STATES = 7, PAIRS = 10, SWINGS = 3, WAVES = 2 + 2 * SWINGS, TERMS = 320, MATRICES = 61, RADII = 32 };

// Relative rounding of what is computed in double precision, and the factor that it is allowed in sums of bounds.
#define ROUNDING 0x1p-42
#define SAFE (1 + 0x1p-20)

// The equations of motion. Balls lie in `ball`; the same numbers as doubles, and upper bounds of norms. With radii of data
// those are the numbers of the middle of the data, the norms hold for all data, and each datum has a field of its own: its
// radius times the derivatives of the numbers.
typedef struct ball_field {
    slong bits;      // of sums; an ulp is 2^-bits
    int order, unit; // order of X; the unit of time is 2^-unit s
    arb_ptr ball, coupling, turn, form, gyro, rate, start;
    int has_wave[WAVES], has_pair[PAIRS];
    double c[3], o[3], t[WAVES][3][4][4], h[WAVES][3][3];
    double kappa, frame, tau[WAVES], eta[WAVES]; // max |c_i|, |O|, |T_n|, |H_n|
    int radii;
    struct ball_field *moved;
} ball_field;

typedef double matrix[STATES * STATES];
#define AT(m, i, j) ((m)[(i) * STATES + (j)])

// The polynomial of a step: coefficients of X and of u_n, each with order + 1 places, and the same as doubles. By orders,
// norms of q and w, of h J, of the growth of errors, of the defect beyond the order; `bend` is that of the quadratic term.
typedef struct {
    const ball_field *field;
    slong halvings; // |h| = 2^-halvings, in units of time
    int sense;      // 1, or -1 back in time
    arb_ptr x, wave;
    double real[STATES * TERMS], u[WAVES * TERMS], a[TERMS], b[TERMS], jacobian[2 * TERMS], growth[2 * TERMS], tail[3 * TERMS];
    double bend, lost, beyond; // int |d| of lower orders, and what the u_n lack, in ulps
    // The fundamental matrix V, norms of its coefficients, and of D = V' - h J V.
    int degree;
    matrix v[MATRICES];
    double v_norm[MATRICES], defect[2 * TERMS + MATRICES];
    // With radii of data: coefficients of Y, sums of norms of its columns, of Y' - h J Y - h F, of h F, of h dF/dx.
    double y[MATRICES][STATES * RADII], y_norm[MATRICES], left[3 * TERMS + MATRICES], forced[3 * TERMS], bent[2 * TERMS];
} ball_step;
// The polynomial of order n of a component, or of a function u_n.
#define SERIES(step, c) ((step)->x + (c) * ((step)->field->order + 1))
#define WAVE(step, n) ((step)->wave + (n) * ((step)->field->order + 1))

// ball_field.c: the equations and the start, at the precision of a motion; returns a reason or PROVED.
int ball_field_init(ball_field *f, top_motion *m, const top_data *data);
void ball_field_clear(ball_field *f);
// The quadratic forms of the rotation R: coefficient of a product of components in R[space][body].
int ball_rotation(int space, int body, int pair);
extern const int ball_pair[PAIRS][2];
// A term of component c of q (0, w), or from the left of (0, w) q: components of q and w, and its sign.
int ball_product(int c, int term, int *a, int *i, int from_left);
// ball_series.c: the polynomial from a state at a time; the longest s in 64ths up to which it fits, 128 if 2 would; the sum
// of a series of bounds, from the power `first` of s.
void ball_expand(ball_step *step, arb_srcptr state, const arb_t time);
int ball_longest(const ball_step *step);
double ball_series(const double *c, int count, double s, int first);
// ball_matrix.c: the fundamental matrix of a step that goes as far as s, and its value and norm, or those of
// Y; the length of its columns, one for each datum; products, inverses and orthogonal axes.
void ball_find_matrix(ball_step *step, double s);
double ball_matrix_at(double *v, const ball_step *step, double s, int of_data);
double ball_norm(const double *m, int count);
double ball_length(const double *columns, int radii);
void ball_multiply(double *product, const matrix a, const double *b, int columns);
int ball_invert(matrix inverse, const matrix m);
void ball_orthogonal(matrix q, const matrix a, const double radius[STATES]);
#endif
#endif
