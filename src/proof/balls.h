// The exact motion of a symmetric top, or of a free body, in ball arithmetic: what the files of this folder share.
//
// u = cos(theta), a = (I3 omega3 + h)/I1, h the momentum of a rotor on the axis, b = Lz/I1, beta = 2 m g l/I1,
// y = u - u at the start, y1 <= y2 <= y3 the roots of the cubic u'^2. "Plus" is q0 + i q3 and its pole, theta = pi;
// "minus" is q1 + i q2 and theta = 0. What both have are two balls or numbers in this order: BALL(m, nu_plus) + side.
// In a build without FLINT this header is empty, and balls_absent.c is all there is.
#ifndef SPINTOP_BALLS_H
#define SPINTOP_BALLS_H

// clang-format off: a line for each name would not help.

// The numbers of a motion, in the order in which certificate.f90 gives them. The frame turns with FRAME and as the Earth does
// at a latitude. A swing has three amplitudes, three phases and a rate.
enum { INERTIA1, INERTIA3, MASS, GRAVITY, LENGTH, PHI, THETA, PSI, PHI_RATE, THETA_RATE, SPIN, INERTIA2,
       OMEGA1, OMEGA2, OMEGA3, QUATERNION, ROTOR = QUATERNION + 4,
       CENTRE, DAMPING = CENTRE + 3, FRAME = DAMPING + 3, EARTH_RATE = FRAME + 3, LATITUDE,
       ROTORS, ROTOR_DRIVE = ROTORS + 3,
       TORQUE_BODY = ROTOR_DRIVE + 3, TORQUE_SPACE = TORQUE_BODY + 3,
       SWING = TORQUE_SPACE + 3, HARMONIC_BODY = SWING + 7, HARMONIC_SPACE = HARMONIC_BODY + 7, DATA = HARMONIC_SPACE + 7 };
// Which of them say how it starts, that it is free, that it is a top about body x or y, and that it is any body.
enum { BY_OMEGA3 = 1, BY_OMEGA = 2, BY_QUATERNION = 4, FREE_BODY = 8, AXIS_X = 16, AXIS_Y = 32, ANY_BODY = 64,
       GIVEN_OTHERWISE = BY_OMEGA | BY_QUATERNION | AXIS_X | AXIS_Y };
// The quantities that are enclosed.
enum { Q0, Q1, Q2, Q3, ANGLE_THETA, ANGLE_PHI, ANGLE_PSI, PERIOD, PRECESSION, ORIENTATION, MOMENTUM_PERIOD, MOMENTUM_TURN,
       RATE1, RATE2, RATE3, QUANTITIES };
// Why something is not proved; certificate.f90 has the sentences.
enum { PROVED, TOO_WIDE, NO_ANGLES, NO_PERIOD, NOT_PERIODIC, UNDECIDED_SIGN, UNDECIDED_ROOTS, UNDECIDED_BRANCH, TOO_MANY_TURNS,
       NO_CIRCULATION, TOO_MANY_STEPS, NO_CLOSED_FORM, NO_LIBRARY };

// clang-format on

#ifdef SPINTOP_FLINT
#if SPINTOP_FLINT >= 3
#include <flint/acb.h>
#include <flint/acb_elliptic.h>
#else
#include <acb.h>
#include <acb_elliptic.h>
#endif

// Data of a motion: value and radius of each number, and how the start and the body are given. SPIN is psi', or
// omega3 with BY_OMEGA3.
typedef struct {
    double value[DATA], radius[DATA];
    int given;
} top_data;

// Balls of a motion, each by its name: BALL(m, beta) is one of them.
// clang-format off
#define BALL_NAMES(X) \
    X(i1) X(i2) X(i3) X(q0) X(q1) X(q2) X(q3) X(omega1) X(omega2) X(omega3) X(rate1) X(rate2) X(rate3) \
    X(r0) X(r1) X(r2) X(r3) X(weight) X(rotor) X(phi) X(psi) X(phi_rate) X(theta_rate) X(spin) \
    X(u0) X(sh) X(ch) X(s2) X(cosine) X(sine) X(a) X(beta) X(half) X(swing) X(b_plus_a) X(b_minus_a) \
    X(sum) X(difference) X(g0) X(g1) X(g2) X(y1) X(y2) X(y3) X(nu_plus) X(nu_minus) X(zeta) X(z0) X(height) \
    X(jump_plus) X(jump_minus) X(slope_plus) X(slope_minus) X(kappa_plus) X(kappa_minus) X(period) X(omega) X(start_rate) \
    X(tau) X(nome) X(momentum_period) X(momentum_turn)
// clang-format on
#define AS_INDEX(name) ball_##name,
enum { BALL_NAMES(AS_INDEX) BALLS };
#define BALL(m, name) ((m)->ball + ball_##name)

// The regimes of a motion: those of a top, and of a free body about fixed axes, with two equal moments of inertia, and
// with three different ones; and that of any body, which has no closed form.
enum regime { NUTATING, FREE, STEADY, SLEEPING, ROTATING, CONING, TUMBLING, STEPPING };

enum { PLUS, MINUS, SIDES };

// M+ and M- at a reduced phase, with their continuous arguments.
typedef struct {
    acb_struct value[SIDES];
    arb_struct turn[SIDES];
    int is_known[SIDES], is_odd; // whether the arguments are known; (-1)^n of the half periods left out
} top_components;

// A motion at a precision.
typedef struct {
    slong bits;
    enum regime regime;
    int is_flipped;              // the centre of mass is below the pivot: computed turned over
    int pole;                    // exact start at theta = 0: 1, at theta = pi: -1, elsewhere: 0
    int is_turning;              // theta' = 0 at the start, or it is on a pole
    int starts_high;             // then: at the upper turning point
    int meets_top, meets_bottom; // b = a exactly and the axis passes theta = 0; b = -a exactly
    int is_plane;                // a = b = 0 exactly
    int is_dual;                 // form b, by the dual nome
    int meets_pole;              // exactly, or is on it: phi and psi jump there, or do not exist
    int sense[SIDES];            // signs of b + a and b - a
    int body_axis, is_negated;   // a top about body x, y, z: 0, 1, 2; computed with the opposite quaternion
    int axis[3], sign[3];        // of a free body: the axes x, y, z of its momentum, and their signs
    arb_struct ball[BALLS];
    acb_struct w[SIDES];    // the factors e^(i phase) of the poles
    top_components first;   // at the start
    struct ball_tube *tube; // the steps of any body
} top_motion;

// Whole turns along a motion: where they are counted up to, phi and psi there, and q0 + i q3 and q1 + i q2 by their
// arguments, without turns, and their distances from zero.
typedef struct {
    int is_begun, steps;
    double time, phi, psi, angle[2], distance[2];
} ball_turns;

// A number of the data.
void ball_datum(arb_t x, const top_data *data, int which);
// ball_given.c: q0 .. q3 and omega1 .. omega3 at the start, these in rate1 .. rate3, too. 0 if they are not known.
int ball_given(top_motion *m, const top_data *data);
// The same of a top, in axes of which z is its axis: its angles and rates.
int ball_given_top(top_motion *m, const top_data *data);
// The product of two quaternions.
void ball_quaternion_product(arb_ptr r, arb_srcptr p, arb_srcptr q, slong bits);
// A quaternion of those axes (side = 1) in the given axes, or of these in those (-1).
void ball_about_axis(arb_ptr q, int axis, int side);
// ball_free_body.c: the motion of a free body, and its q0 .. q3 at a time.
int ball_free_body(top_motion *m, const top_data *data);
void ball_free_attitude(acb_t upper, acb_t lower, const top_motion *m, const arb_t time);
// ball_start.c: a motion from its data, up to the roots; returns a reason or PROVED.
int ball_start(top_motion *m, const top_data *data);
// ball_roots.c: the three roots.
int ball_roots(top_motion *m);
// ball_phases.c: periods and phases; Carlson's R_F of numbers that are not negative, and the complete integral K of a
// complementary modulus squared.
int ball_phases(top_motion *m);
void ball_carlson(arb_t value, const arb_t x, const arb_t y, const arb_t z, slong bits);
void ball_complete(arb_t k, const arb_t complement, slong bits);
// ball_theta.c: what theta functions give: their logarithmic slopes, both components at a phase, and the rate at which
// the component that vanishes at a start on a pole leaves it.
void ball_components_init(top_components *c);
void ball_components_clear(top_components *c);
void ball_theta_start(top_motion *m);
int ball_components(top_components *c, const top_motion *m, const arb_t z);
void ball_pole_rate(arb_t rate, const top_motion *m);
// Whether cos(theta) grows: 1, or falls: -1; 0 next to its turning points.
int ball_rises(const top_motion *m, const arb_t time);
// The same of a free body: the slope of its phase, and its two functions, of one argument.
void ball_tumbling_start(top_motion *m, const arb_t nu, int side);
void ball_tumbling(acb_t plus, acb_t minus, fmpz_t turns, const top_motion *m, const arb_t z);
// ball_attitude.c: q0 .. q3, theta, phi, psi at a time; phi and psi are NaN on a pole.
int ball_attitude(arb_ptr answer, const top_motion *m, double t);
// Whether the closed form gives phi and psi with all their turns; else, whether these can be counted along the motion.
int ball_knows_turns(const top_motion *m);
int ball_has_turns(const top_motion *m);
// ball_rates.c: omega1 .. omega3 at a time, at which ball_attitude gave the answer.
void ball_rates(arb_ptr answer, const top_motion *m, double t);
// ball_field.c: adds the vector v of space in body axes, or subtracts it.
void ball_into_body(arb_ptr sum, arb_srcptr q, arb_srcptr v, int sign, slong bits);
// ball_tube.c: the motion of any body; q0 .. q3 at a time; omega1 .. omega3, phi and psi there, these within half a turn.
int ball_tube_open(top_motion *m, const top_data *data);
void ball_tube_close(struct ball_tube *tube);
int ball_tube_attitude(acb_t upper, acb_t lower, const top_motion *m, double t);
void ball_tube_rates(arb_ptr omega, const top_motion *m);
int ball_tube_turns(double *phi, double *psi, const top_motion *m);
// ball_turns.c: bounds of the size of a ball; continues a count of turns to a time. NO_ANGLES if a pole is on the way.
double ball_most(const arb_t x);
double ball_least(const arb_t x);
int ball_count_turns(ball_turns *turns, const top_motion *m, const top_data *data, double t);
// The period of the momentum of a free symmetric body in its axes, and the turn about it, from the moments along and
// across its axis, omega along it and the size of the momentum.
void ball_circulation(top_motion *m, const arb_t along, const arb_t across, const arb_t spin, const arb_t momentum);
// The same of all times: periods, precession per nutation, turn about the momentum.
void ball_periods(arb_ptr answer, const top_motion *m);

// 1 or -1 as the sign of a ball, 1 for an exact zero; 0 if it is not decided.
int ball_sign(const arb_t x);
#endif
#endif
