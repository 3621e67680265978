// The motion of a body in ball arithmetic: what the files of this folder share. It is enclosed step by step; theorem and proof
// are in doc/proof.md. In a build without FLINT this header has the numbers only, and balls_absent.c is all there is.
#ifndef SPINTOP_BALLS_H
#define SPINTOP_BALLS_H

// clang-format off: a line for each name would not help.

// The numbers of a motion, in the order in which certificate.f90 gives them. The frame turns with FRAME and as the Earth does
// at a latitude. A swing has three amplitudes, three phases and a rate.
enum { INERTIA, MASS = INERTIA + 3, GRAVITY, PHI, THETA, PSI, PHI_RATE, THETA_RATE, SPIN, OMEGA, QUATERNION = OMEGA + 3,
       CENTRE = QUATERNION + 4, DAMPING = CENTRE + 3, PRODUCTS = DAMPING + 3, FRAME = PRODUCTS + 3, EARTH_RATE = FRAME + 3, LATITUDE,
       ROTORS, ROTOR_DRIVE = ROTORS + 3, TORQUE_BODY = ROTOR_DRIVE + 3, TORQUE_SPACE = TORQUE_BODY + 3,
       SWING = TORQUE_SPACE + 3, HARMONIC_BODY = SWING + 7, HARMONIC_SPACE = HARMONIC_BODY + 7, DATA = HARMONIC_SPACE + 7 };
// Which of them say how it starts.
enum { BY_OMEGA3 = 1, BY_OMEGA = 2, BY_QUATERNION = 4 };
// The quantities that are enclosed.
enum { Q0, Q1, Q2, Q3, ANGLE_THETA, ANGLE_PHI, ANGLE_PSI, ORIENTATION, RATE1, RATE2, RATE3, QUANTITIES };
// Why something is not proved; certificate.f90 has the sentences.
enum { PROVED, TOO_WIDE, NO_ANGLES, NO_START, TOO_MANY_STEPS, NO_LIBRARY };

// clang-format on

#ifdef SPINTOP_FLINT
#if SPINTOP_FLINT >= 3
#include <flint/acb.h>
#else
#include <acb.h>
#endif

// The components q0 + i q3 and q1 + i q2.
enum { PLUS, MINUS };

// Data of a motion: value and radius of each number, and how the start is given. SPIN is psi', or omega3 with BY_OMEGA3.
typedef struct {
    double value[DATA], radius[DATA];
    int given;
} top_data;

// ball_given.c: a number of the data; quaternion and angular velocity at the start, 0 if they are not known; an upper bound of
// the size of a ball.
void ball_datum(arb_t x, const top_data *data, int which);
int ball_given(arb_ptr q, arb_ptr omega, const top_data *data, slong bits);
double ball_most(const arb_t x);
// ball_field.c: adds the vector v of space in body axes, or subtracts it.
void ball_into_body(arb_ptr sum, arb_srcptr q, arb_srcptr v, int sign, slong bits);
// ball_tube.c: a motion at a precision; its answer at a time, phi and psi but for their turns: `turned` is near them, or NaN.
typedef struct ball_tube ball_tube;
ball_tube *ball_tube_open(const top_data *data, slong bits, int *reason);
void ball_tube_close(ball_tube *tube);
int ball_tube_answer(arb_ptr answer, double turned[2], ball_tube *tube, double t);
#endif
#endif
