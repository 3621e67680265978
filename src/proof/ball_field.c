// The equations of motion of any body, and its start.
#include "ball_tube.h"
#ifdef SPINTOP_FLINT
#include <math.h>
#include <string.h>

const int ball_pair[PAIRS][2] = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

// R_sb = (q0^2 - |q|^2) [s = b] + 2 q_s q_b - 2 q0 e_sbc q_c, with s, b, c = 1, 2, 3.
int ball_rotation(int space, int body, int pair) {
    const int a = ball_pair[pair][0], b = ball_pair[pair][1], third = 3 - space - body;
    if (space == body) return a != b ? 0 : a == 0 || a == space + 1 ? 1 : -1;
    if (a == 0 && b == third + 1) return (body - space + 3) % 3 == 1 ? -2 : 2;
    return a > 0 && a != b && a != third + 1 && b != third + 1 ? 2 : 0;
}

void ball_into_body(arb_ptr sum, arb_srcptr q, arb_srcptr v, int sign, slong bits) {
    arb_t product;
    int i, s, p;
    arb_init(product);
    for (p = 0; p < PAIRS; p++)
        for (s = 0; s < 3; s++) {
            arb_mul(product, q + ball_pair[p][0], q + ball_pair[p][1], bits), arb_mul(product, product, v + s, bits);
            for (i = 0; i < 3; i++) arb_addmul_si(sum + i, product, sign * ball_rotation(s, i, p), bits);
        }
    arb_clear(product);
}

// A cross product, one component.
static void cross(arb_t c, arb_srcptr a, arb_srcptr b, int i, slong bits) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    arb_mul(c, a + j, b + k, bits), arb_submul(c, a + k, b + j, bits);
}

// J and its inverse, without products that of each moment: a thin rod has none about itself.
static void find_inertia(arb_ptr inertia, arb_ptr inverse, const top_data *data, slong bits) {
    int i, s, is_diagonal = 1;
    arb_t determinant;
    arb_init(determinant);
    for (i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        ball_datum(inertia + 4 * i, data, INERTIA + i), ball_datum(inertia + 3 * j + k, data, PRODUCTS + i);
        arb_set(inertia + 3 * k + j, inertia + 3 * j + k);
        is_diagonal = is_diagonal && arb_is_zero(inertia + 3 * j + k);
    }
    for (i = 0; i < 3; i++)
        for (s = 0; s < 3; s++) cross(inverse + 3 * i + s, inertia + (i + 1) % 3 * 3, inertia + (i + 2) % 3 * 3, s, bits);
    arb_dot(determinant, NULL, 0, inertia, 1, inverse, 1, 3, bits);
    if (!is_diagonal) _arb_vec_scalar_div(inverse, inverse, 9, determinant, bits);
    for (i = 0; i < 3 && is_diagonal; i++) arb_inv(inverse + 4 * i, inertia + 4 * i, bits);
    arb_clear(determinant);
}

// The derivatives of J and of its inverse, -1/J dJ 1/J, by an element of J.
static void differentiate_inertia(arb_ptr d, arb_ptr d_inverse, arb_srcptr inverse, int element, slong bits) {
    const int a = element < INERTIA + 3 ? element - INERTIA : (element - PRODUCTS + 1) % 3;
    const int b = element < INERTIA + 3 ? a : (a + 1) % 3;
    int i, s;
    arb_one(d + 3 * a + b), arb_one(d + 3 * b + a);
    for (i = 0; i < 3; i++)
        for (s = 0; s < 3; s++) {
            arb_submul(d_inverse + 3 * i + s, inverse + 3 * i + a, inverse + 3 * b + s, bits);
            if (a != b) arb_submul(d_inverse + 3 * i + s, inverse + 3 * i + b, inverse + 3 * a + s, bits);
        }
}

// Adds 1/J of a moment or momentum to a column; of none it is none, for a thin rod, too.
static void divide(arb_ptr quotient, int stride, arb_srcptr x, arb_srcptr inverse, slong bits) {
    int i, j;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++)
            if (!arb_is_zero(x + j)) arb_addmul(quotient + i * stride, inverse + 3 * i + j, x + j, bits);
}

static void read_vector(arb_ptr v, const top_data *data, int first) {
    int i;
    for (i = 0; i < 3; i++) ball_datum(v + i, data, first + i);
}

// The frame; its axes point east, north and up.
static void read_frame(arb_ptr frame, const top_data *data, slong bits) {
    arb_ptr w = _arb_vec_init(4), rate = w, latitude = w + 1, sine = w + 2, cosine = w + 3;
    read_vector(frame, data, FRAME), ball_datum(rate, data, EARTH_RATE), ball_datum(latitude, data, LATITUDE);
    arb_sin_cos(sine, cosine, latitude, bits);
    arb_addmul(frame + 1, rate, cosine, bits), arb_addmul(frame + 2, rate, sine, bits);
    _arb_vec_clear(w, 4);
}

// A swing a cos(W t + f) as a cos f, which is the factor of cos W t, and -a sin f.
static void read_swing(arb_ptr z, arb_t rate, const top_data *data, int first, slong bits) {
    arb_t number;
    int i;
    arb_init(number), ball_datum(rate, data, first + 6);
    for (i = 0; i < 3; i++) {
        ball_datum(number, data, first + 3 + i), arb_sin_cos(z + 3 + i, z + i, number, bits);
        ball_datum(number, data, first + i), arb_mul(z + i, z + i, number, bits);
        arb_neg(number, number), arb_mul(z + 3 + i, z + 3 + i, number, bits);
    }
    arb_clear(number);
}

// The body, and what acts on it: in space axes the force m (g z + z'') on the centre of mass, and a torque; a torque in body
// axes.
typedef struct {
    arb_ptr inertia, inverse, mass, centre, damping, frame, force, couple, torque;
} load;

// T_n: the forms of 1/J (R^T force x r + R^T couple + torque |q|^2 + d R^T O), the last one for n = 0, as the frame turns
// with what damps the body. |q| = 1, so that the solution does not feel the factor.
static void add_forms(ball_field *f, int n, const load *l) {
    const slong bits = f->bits;
    arb_ptr w = _arb_vec_init(7), force = w, moment = w + 3, part = w + 6;
    int i, p, s;
    for (p = 0; p < PAIRS; p++) {
        for (i = 0, _arb_vec_zero(force, 3); i < 3; i++)
            for (s = 0; s < 3; s++) arb_addmul_si(force + i, l->force + s, ball_rotation(s, i, p), bits);
        for (i = 0; i < 3; i++) {
            cross(moment + i, force, l->centre, i, bits);
            for (s = 0; s < 3; s++) {
                arb_set(part, l->couple + s);
                if (n == 0) arb_addmul(part, l->damping + i, l->frame + s, bits);
                arb_addmul_si(moment + i, part, ball_rotation(s, i, p), bits);
            }
            if (p < 4) arb_add(moment + i, moment + i, l->torque + i, bits);
        }
        divide(f->form + n * 3 * PAIRS + p, PAIRS, moment, l->inverse, bits);
    }
    _arb_vec_clear(w, 7);
}

// C: the form of 1/J (J w x w). The product w_a w_b has the place of q_a q_b.
static void add_spin(ball_field *f, const load *l) {
    arb_ptr moment = _arb_vec_init(3);
    int i, p, side;
    for (p = 1; p < PAIRS; p++) {
        for (_arb_vec_zero(moment, 3), side = 0; side < (p < 4 ? 1 : 2) && ball_pair[p][0] > 0; side++) {
            const int a = ball_pair[p][side] - 1, b = ball_pair[p][1 - side] - 1; // J_a of the first, the second as it is
            for (i = 0; i < 3; i++) {
                const int j = (i + 1) % 3, k = (i + 2) % 3;
                if (b == k) arb_add(moment + i, moment + i, l->inertia + 3 * j + a, f->bits);
                if (b == j) arb_sub(moment + i, moment + i, l->inertia + 3 * k + a, f->bits);
            }
        }
        divide(f->form + WAVES * 3 * PAIRS + p, PAIRS, moment, l->inverse, f->bits);
    }
    _arb_vec_clear(moment, 3);
}

// H_n: the matrix 1/J ([rotor]x - diag damping), the damping for n = 0.
static void add_gyro(ball_field *f, int n, arb_srcptr rotor, const load *l) {
    arb_ptr moment = _arb_vec_init(3);
    int j;
    for (j = 0; j < 3; j++) {
        const int k = (j + 1) % 3, i = (j + 2) % 3;
        arb_zero(moment + j), arb_set(moment + k, rotor + i), arb_neg(moment + i, rotor + k);
        if (n == 0) arb_neg(moment + j, l->damping + j);
        divide(f->gyro + n * 9 + j, 3, moment, l->inverse, f->bits);
    }
    _arb_vec_clear(moment, 3);
}

// The force m (-W^2 z + 2 side W O x z_other + O x (O x z)) of a vibrating pivot, of which z and z_other are cos and sin.
static void find_shake(const load *l, arb_srcptr z, arb_srcptr other, int side, arb_srcptr rate, slong bits) {
    arb_ptr w = _arb_vec_init(5), turned = w, term = w + 3, square = w + 4;
    int i;
    for (i = 0; i < 3; i++) cross(turned + i, l->frame, z, i, bits);
    arb_sqr(square, rate, bits);
    for (i = 0; i < 3; i++) {
        cross(l->force + i, l->frame, turned, i, bits), arb_submul(l->force + i, square, z + i, bits);
        cross(term, l->frame, other, i, bits), arb_mul(term, term, rate, bits), arb_mul_si(term, term, 2 * side, bits);
        arb_add(l->force + i, l->force + i, term, bits), arb_mul(l->force + i, l->force + i, l->mass, bits);
    }
    _arb_vec_clear(w, 5);
}

enum { NONE = -1 };

// The coefficients, in seconds; or their derivatives by an element of J: they are 1/J of what is linear in it.
static void find_coefficients(ball_field *f, const top_data *data, int element) {
    const slong bits = f->bits;
    arb_ptr w = _arb_vec_init(67), rotor = w + 37, drive = w + 40, z = w + 43, d = w + 49;
    load l = {w, w + 9, w + 18, w + 19, w + 22, w + 25, w + 28, w + 31, w + 34};
    int i, n;
    find_inertia(l.inertia, l.inverse, data, bits + 64), ball_datum(l.mass, data, MASS);
    read_vector(l.centre, data, CENTRE), read_vector(l.damping, data, DAMPING);
    read_frame(l.frame, data, bits), read_vector(rotor, data, ROTORS), read_vector(drive, data, ROTOR_DRIVE);
    _arb_vec_set(f->turn, l.frame, 3);
    if (element != NONE) {
        differentiate_inertia(d, d + 9, l.inverse, element, bits + 64);
        l.inertia = d, add_spin(f, &l), l.inertia = w, l.inverse = d + 9;
    }
    add_spin(f, &l);
    // Gravity, constant torques, damping, and the rotor: of momentum h + h' t.
    ball_datum(l.force + 2, data, GRAVITY), arb_mul(l.force + 2, l.force + 2, l.mass, bits);
    read_vector(l.couple, data, TORQUE_SPACE), read_vector(l.torque, data, TORQUE_BODY);
    for (i = 0; i < 3; i++) arb_sub(l.torque + i, l.torque + i, drive + i, bits);
    add_forms(f, 0, &l), add_gyro(f, 0, rotor, &l), add_gyro(f, 1, drive, &l);
    // The pivot.
    _arb_vec_zero(l.couple, 3), _arb_vec_zero(l.torque, 3), read_swing(z, f->rate, data, SWING, bits);
    for (n = 0; n < 2; n++) find_shake(&l, z + 3 * n, z + 3 - 3 * n, n ? -1 : 1, f->rate, bits), add_forms(f, 2 + n, &l);
    // Harmonic torques.
    _arb_vec_zero(l.force, 3), read_swing(z, f->rate + 1, data, HARMONIC_BODY, bits);
    for (n = 0; n < 2; n++) _arb_vec_set(l.torque, z + 3 * n, 3), add_forms(f, 4 + n, &l);
    _arb_vec_zero(l.torque, 3), read_swing(z, f->rate + 2, data, HARMONIC_SPACE, bits);
    for (n = 0; n < 2; n++) _arb_vec_set(l.couple, z + 3 * n, 3), add_forms(f, 6 + n, &l);
    _arb_vec_clear(w, 67);
    if (element != NONE) _arb_vec_zero(f->turn, 3), _arb_vec_zero(f->rate, SWINGS);
}

// Everything in units of time, 2^-unit s.
static void change_unit(ball_field *f, int unit) {
    f->unit = unit;
    _arb_vec_scalar_mul_2exp_si(f->start + 4, f->start + 4, 3, -unit);
    _arb_vec_scalar_mul_2exp_si(f->turn, f->turn, 3, -unit);
    _arb_vec_scalar_mul_2exp_si(f->rate, f->rate, SWINGS, -unit);
    _arb_vec_scalar_mul_2exp_si(f->form, f->form, WAVES * 3 * PAIRS, -2 * unit);
    _arb_vec_scalar_mul_2exp_si(f->gyro, f->gyro, WAVES * 9, -unit);
    _arb_vec_scalar_mul_2exp_si(f->gyro + 9, f->gyro + 9, 9, -unit); // of t
}

// The unit of time: 2^unit is at least 2 sqrt(|w|^2 + max_i sum|T_i|), in seconds.
static int choose_unit(const ball_field *f) {
    double most = 0, speed = 0, sum;
    int i, n, p;
    for (i = 0; i < 3; i++) {
        for (sum = 0, n = 0; n < WAVES; n++)
            for (p = 0; p < PAIRS; p++) sum += ball_most(f->form + (n * 3 + i) * PAIRS + p);
        most = fmax(most, sum), speed += pow(ball_most(f->start + 4 + i), 2);
    }
    return speed + most > 0 ? (int)ceil(log2(2 * sqrt(speed + most))) : 0;
}

// The Euclidean norm of balls.
static double size_of(arb_srcptr x, int count) {
    double sum = 0;
    int i;
    for (i = 0; i < count; i++) sum += pow(ball_most(x + i), 2);
    return sqrt(sum) * SAFE;
}

// Middles as doubles; norms, which are added. Forms are symmetric: products of different components have each half. Of those of
// w the products w_j w_k in row i, which principal axes have, bound less than their Frobenius norm does.
static void find_doubles(ball_field *f) {
    int i, j, n, p;
    for (i = 0; i < 3; i++) f->o[i] = arf_get_d(arb_midref(f->turn + i), ARF_RND_NEAR);
    f->frame = size_of(f->turn, 3);
    for (n = 0; n < FORMS; n++) {
        double square = 0, most = 0;
        for (i = 0; i < 3; i++) {
            for (p = 0; p < PAIRS; p++) {
                arb_srcptr x = f->form + (n * 3 + i) * PAIRS + p;
                const int a = ball_pair[p][0], b = ball_pair[p][1];
                f->t[n][i][a][b] = f->t[n][i][b][a] = arf_get_d(arb_midref(x), ARF_RND_NEAR) / (a == b ? 1 : 2);
                if (n == WAVES && a != b && a != i + 1 && b != i + 1) most = fmax(most, ball_most(x));
                else square += pow(ball_most(x), 2) / (a == b ? 1 : 2);
                if (!arb_is_zero(x)) f->has_pair[n == WAVES][p] = f->has_wave[n] = 1;
            }
            for (j = 0; j < 3 && n < WAVES; j++) {
                arb_srcptr x = f->gyro + (n * 3 + i) * 3 + j;
                f->h[n][i][j] = arf_get_d(arb_midref(x), ARF_RND_NEAR);
                if (!arb_is_zero(x)) f->has_wave[n] = 1;
            }
        }
        if (n == WAVES) f->kappa += most + 1.4143 * sqrt(square) * SAFE;
        else f->tau[n] += sqrt(square) * SAFE, f->eta[n] += size_of(f->gyro + n * 9, 9);
    }
}

// The start: w = omega + R^T O.
static int find_start(ball_field *f, const top_data *data) {
    const int is_known = ball_given(f->start, f->start + 4, data, f->bits);
    ball_into_body(f->start + 4, f->start, f->turn, 1, f->bits);
    return is_known;
}

enum { NUMBERS = 3 + FORMS * 3 * PAIRS + WAVES * 9 + SWINGS + STATES };

static void open_field(ball_field *f, slong bits) {
    memset(f, 0, sizeof *f), f->bits = bits, f->order = (int)(0.36 * (double)bits);
    f->ball = f->turn = _arb_vec_init(NUMBERS), f->form = f->turn + 3;
    f->gyro = f->form + FORMS * 3 * PAIRS, f->rate = f->gyro + WAVES * 9, f->start = f->rate + SWINGS;
}

// All numbers, or their derivatives by an element of J; whether they are known.
static int find_numbers(ball_field *f, const top_data *data, int element) {
    int i, is_known = 1;
    _arb_vec_zero(f->ball, NUMBERS), find_coefficients(f, data, element);
    if (element == NONE) is_known = find_start(f, data);
    for (i = 0; i < NUMBERS; i++) is_known = is_known && arb_is_finite(f->ball + i);
    return is_known;
}

// Adds the difference of the numbers at two values of a datum, times a factor; whether they are known.
static int add_difference(ball_field *f, const top_data *data, int which, double from, double to, double radius, int factor) {
    top_data there = *data;
    ball_field other;
    int i, side, is_known = 1;
    open_field(&other, f->bits), there.radius[which] = radius;
    for (side = -1; side < 2; side += 2) {
        there.value[which] = side < 0 ? from : to, is_known = find_numbers(&other, &there, NONE) && is_known;
        for (i = 0; i < NUMBERS; i++) arb_addmul_si(f->ball + i, other.ball + i, side * factor, f->bits);
    }
    ball_field_clear(&other);
    return is_known;
}

// The derivatives of the numbers by a datum, in balls that hold for all data. By an angle they are sums of its sine and cosine
// and of those of its half; by others but the inertia of first degree.
static int differentiate(ball_field *f, const top_data *data, int which) {
    const double here = data->value[which], radius = data->radius[which], right = 1.5707963267948966;
    const double rounded = radius + (fabs(here) + 8) * 0x1p-50;
    int is_known, divisor = 1;
    arb_t scale;
    arb_init(scale), arb_one(scale);
    if (which >= PHI && which <= PSI) {
        is_known = add_difference(f, data, which, here - 2 * right, here + 2 * right, rounded, 1)
                   && add_difference(f, data, which, here - right, here + right, rounded, 1)
                   && add_difference(f, data, which, here - 3 * right, here + 3 * right, rounded, -1);
        divisor = 4;
    } else if (which < INERTIA + 3 || (which >= PRODUCTS && which < PRODUCTS + 3)) {
        is_known = find_numbers(f, data, which);
    } else {
        is_known = add_difference(f, data, which, 0, 1, 0, 1);
    }
    arb_mul_si(scale, scale, divisor, f->bits), _arb_vec_scalar_div(f->ball, f->ball, NUMBERS, scale, f->bits);
    arb_clear(scale);
    return is_known;
}

// The field of a datum: its middle, by the mean value theorem, and the rest, which the balls of the whole field contain.
static int find_moved(ball_field *f, ball_field *moved, const top_data *data, int which) {
    int i, n, is_known;
    arb_t rest, radius;
    arb_init(rest), arb_init(radius), arb_set_d(radius, data->radius[which]), open_field(moved, f->bits);
    is_known = differentiate(moved, data, which), change_unit(moved, f->unit);
    _arb_vec_scalar_mul(moved->ball, moved->ball, NUMBERS, radius, f->bits);
    for (i = 0; i < NUMBERS; i++) {
        arb_set_d(rest, arf_get_d(arb_midref(moved->ball + i), ARF_RND_NEAR)), arb_sub(rest, moved->ball + i, rest, f->bits);
        arb_add_error(f->ball + i, rest);
    }
    find_doubles(moved), f->kappa += moved->kappa * SAFE;
    for (n = 0; n < WAVES; n++) f->tau[n] += moved->tau[n] * SAFE, f->eta[n] += moved->eta[n] * SAFE;
    for (n = 0; n < FORMS; n++) f->has_wave[n] = f->has_wave[n] || moved->has_wave[n];
    arb_clear(rest), arb_clear(radius);
    return is_known;
}

int ball_field_init(ball_field *f, const top_data *data, slong bits) {
    top_data middle = *data;
    int i, is_known, count = 0;
    open_field(f, bits), memset(middle.radius, 0, sizeof middle.radius);
    is_known = find_numbers(f, &middle, NONE), change_unit(f, choose_unit(f));
    for (i = 0; i < DATA; i++) count += data->radius[i] > 0;
    if (count > 0) f->moved = flint_calloc((size_t)count, sizeof *f->moved);
    for (i = 0; i < DATA && is_known; i++)
        if (data->radius[i] > 0) is_known = f->radii < RADII && find_moved(f, f->moved + f->radii++, data, i);
    if (is_known) find_doubles(f);
    return is_known ? PROVED : NO_START;
}

void ball_field_clear(ball_field *f) {
    while (f->radii > 0) ball_field_clear(f->moved + --f->radii);
    _arb_vec_clear(f->ball, NUMBERS), flint_free(f->moved);
}
#endif
