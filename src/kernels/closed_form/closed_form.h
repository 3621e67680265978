// The exact solution of a symmetric top in circular functions, for every arithmetic: of vectors, one top in each lane
// (top_lanes.h), and in extended precision (../extended.c). There are no branches by values; where one would lead another way,
// one of two results is chosen.
//
// Jacobi's theta functions have the nome q = exp(-pi K'/K). Textbooks compute the positions of the poles with incomplete
// elliptic integrals. Here X = 2 q cosh(2 v) of a position i v is the solution of an equation, similar to a quadratic one, in
// the data; this is accurate also where the axis passes a pole. Terms up to the fifth multiple of the argument suffice for
// nomes up to 0.27 in double precision, and up to 0.06 in extended precision (the next term is q^30).
//
// Whittaker and Watson, A Course of Modern Analysis, chapter XXI; Klein and Sommerfeld, chapter VI.
//
// Defined before: `real`, and `truth` of its comparisons; any_of(condition); choose(condition, a, b); less_of(a, b) and
// greater_of(a, b); square_root, magnitude, and with_sign(a, b): a >= 0 with the sign of b; divided(a, b) and inverse(b), with
// the limit 0/0 = 0 where it is wanted; argument_of(x, y): that of x + i y, x >= 0; laguerre_steps, newton_steps, and
// `unrolled` of a loop of few steps; has_settled(step, x, onward, &returns): whether an iteration has ended, for which `onward`
// is positive where the step goes on as all before.
//
// Where several quotients are needed, the product of all divisors is inverted once; it vanishes with the numerators.

// The start of a motion, with u = cos(theta): a = I3 omega3/I1, beta = 2 m g l/I1, 1 - u0, 1 + u0, phi0' sin(theta0)^2, K0 =
// omega1^2 + omega2^2, b - a, b + a, u0', and the coefficients of u'^2 = beta y^3 + g2 y^2 + g1 y + g0, where u = u0 + y.
struct start {
    real a, beta, below, above, turn, swing, b_minus_a, b_plus_a, u_rate, g0, g1, g2;
};

// Differences of the roots u1 <= u0 <= u2 <= 1 <= u3; those with beta stay finite without gravity: u1 - u0, u2 - u0, beta (u3 -
// u0), u2 - u1, 1 - u1, 1 - u2, 1 + u1, 1 + u2, beta (u3 - 1), beta (u3 - u1), beta (1 + u3); k^2, k'^2, k', and the rate of
// the argument of the elliptic functions, rad/s; inverses; and the square roots of beta (u3 - 1), of (1 - u1) (1 - u2), and of
// the last inverse.
struct roots {
    real y1, y2, beta_y3, d, m1, d2, p1, p2, beta_d3, beta_u, beta_p3, k2, kc2, kc, frequency;
    real per_m1, per_p2, per_beta_u, per_beta_p3, root_d3, root_md, per_root_p3;
};

// One pole of the sphere, seen by the motion: its theta function
//
//     Theta(z) = nearest + 2 h even(c) +- i side odd(c) sin 2z
//
// with polynomials `even` and `odd` in c, where c = cos 2z, h = sin(z)^2 and + for theta = pi (z = 0 at the lower turning
// point), c = -cos 2z, h = cos(z)^2 and - for theta = 0. Written from its least value, for digits close to the pole. Where the
// axis is farthest it is `farthest`; `slope` is the derivative of its argument there times its value. `weight` is the factor of
// |Theta|^2 in 1 + u (1 - u), but for a common one; `excess`, `position` and `scale` are data of place_pole and of
// find_positions before it.
struct pole {
    real excess, position, scale, farthest, nearest, slope, even[5], odd[5], side, weight;
};

// The theta functions: sqrt(k'), the nome, the constant theta_3, the rate of the argument z, and the rates of the phases of the
// upper and the lower component, without +-(omega3 - a)/2, and their sum, that of phi.
struct thetas {
    real root_kc, q, theta3, z_rate, upper_rate, lower_rate, sum_rate;
    struct pole bottom, top;
};

static const double nome_series[] = {1,      2,       15,       150,       1707,         20910,
                                     268616, 3567400, 48555069, 673458874, 9481557398.0, 135119529972.0};
enum { nome_terms = sizeof nome_series / sizeof *nome_series };

// The square root, of a square that rounding may have made negative.
inlined real safe_root(real square) { return square_root(greater_of(square, (real){0})); }

// The roots of the cubic that bounds the nutation, without cancellation. The trigonometric formula of textbooks loses all
// digits of u2 - u1 for fast tops; here every difference of roots that is needed is computed separately. From a start at a
// turning point the cubic is y times a quadratic.
inlined void find_roots_at_turning_point(const struct start *s, struct roots *r) {
    const real g1 = s->g1, g2 = s->g2, beta = s->beta, zero = {0};
    // The larger root of Y^2 + g2 Y + beta g1.
    const real half = (safe_root(g2 * g2 - 4 * beta * g1) + magnitude(g2)) / 2;
    const truth falls = g2 <= 0;
    const real per_half = inverse(choose(falls, half, half * beta)), other = choose(falls, g1, -half * half) * per_half;
    r->beta_y3 = choose(falls, half, -beta * beta * g1 * per_half);
    r->y1 = less_of(other, zero), r->y2 = greater_of(other, zero), r->d = magnitude(other);
    r->d2 = s->below - r->y2, r->beta_d3 = r->beta_y3 - beta * s->below;
}

// The roots from other starts (g0 > 0). Laguerre's method finds an outermost root from outside: the highest as beta (u3 - u0),
// which is regular without gravity; the lowest where the upper two may be close together, so that an iteration for the highest
// one would be slow.
inlined void find_roots_of_moving(const struct start *s, struct roots *r, truth *doubt) {
    const real g0 = s->g0, g1 = s->g1, g2 = s->g2, beta = s->beta, zero = {0};
    const truth moves = g0 > 0, low = moves & (g2 * (2 * g2 * g2 - 9 * beta * g1) + 27 * beta * beta * g0 > 0);
    const real c0 = choose(low, g0, beta * beta * g0), c1 = choose(low, g1, beta * g1), c3 = choose(low, beta, zero + 1);
    real y = choose(low, -s->above, r->beta_y3), step = zero;
    int returns = 0;
    unrolled for (int n = 0; n < laguerre_steps; ++n) {
        const real g = c0 + y * (c1 + y * (g2 + y * c3)), bend = 3 * c3 * y, slope = c1 + y * (2 * g2 + bend);
        step = divided(3 * g, slope + 2 * safe_root(slope * slope - 3 * g * (g2 + bend)));
        y -= step;
        if (has_settled(step, y, choose(low, -step, step), &returns)) break;
    }
    *doubt |= moves & (magnitude(step) > 1e-6 * magnitude(y));

    // Below the highest root: the other two from their sum and product.
    const real per_y = 1 / y, product = -g0 * per_y, total = (g1 - beta * product) * per_y;
    const real apart = safe_root(total * total - 4 * product), larger = (total + with_sign(apart, total)) / 2;
    const real smaller = product / larger;

    // Above the lowest root: u2 + u3 - 2 in two ways, of which the one with the smaller terms has less cancellation, and the
    // distances of u2 and u3 from 1.
    const real energy = s->swing + s->a * s->a, low_g0 = g0 * per_y, per_by = 1 / (beta * y), sum = energy * y * per_by;
    const real excess = choose(2 * s->below - (magnitude(g1) - low_g0) * per_by < sum + 2 - y,
                               (g1 + low_g0) * per_by - 2 * s->below, sum - 2 - y);
    const real distances = s->b_minus_a * s->b_minus_a / (beta * (s->below - y));
    const real far = (magnitude(excess) + square_root(excess * excess + 4 * distances)) / 2, near = divided(distances, far);
    const real d3 = choose(excess >= 0, far, near), beta_y3 = choose(low, beta * (s->below + d3), y);

    const real y1 = choose(low, y, less_of(smaller, larger));
    const real y2 = choose(low, -low_g0 / (beta * (s->below + d3)), greater_of(smaller, larger));
    r->y1 = choose(moves, y1, r->y1);
    r->y2 = choose(moves, y2, r->y2);
    r->d = choose(moves, choose(low, y2 - y1, apart), r->d);
    r->d2 = choose(moves, choose(low, choose(excess >= 0, near, far), s->below - y2), r->d2);
    r->beta_y3 = choose(moves, beta_y3, r->beta_y3);
    r->beta_d3 = choose(moves, choose(low, beta * d3, beta_y3 - beta * s->below), r->beta_d3);
}

// From the roots, their distances and the moduli.
inlined void find_moduli(const struct start *s, struct roots *r) {
    const real beta = s->beta, zero = {0};
    r->m1 = s->below - r->y1, r->p2 = s->above + r->y2;
    r->beta_u = r->beta_y3 - beta * r->y1, r->beta_p3 = r->beta_y3 + beta * s->above;
    // f(1) = -(b-a)^2 relates the distances from u = 1: the larger one of u2 and u3 is accurate. Both vanish where b = a.
    const truth farther = r->beta_d3 > beta * r->d2;
    const real mp = r->m1 * r->p2, both = r->beta_u * r->beta_p3, larger = choose(farther, r->beta_d3, r->m1 * r->d2);
    const real divisor = choose(larger > 0, larger, zero + 1), per_all = inverse(mp * both * divisor);
    const real per_four = per_all * divisor, per_larger = per_all * mp * both;
    r->per_m1 = per_four * both * r->p2, r->per_p2 = per_four * both * r->m1;
    r->per_beta_u = per_four * mp * r->beta_p3, r->per_beta_p3 = per_four * mp * r->beta_u;
    const real root = safe_root(larger), other_root = magnitude(s->b_minus_a) * root * per_larger,
               other = other_root * other_root;
    r->root_d3 = choose(farther, root, other_root), r->root_md = choose(farther, other_root, root);
    r->beta_d3 = choose(farther, r->beta_d3, other);
    r->d2 = choose(farther, other * r->per_m1, r->d2);
    r->per_root_p3 = square_root(r->beta_p3) * r->per_beta_p3;
    r->p1 = s->b_plus_a * s->b_plus_a * r->per_p2 * r->per_beta_p3;
    r->k2 = beta * r->d * r->per_beta_u;
    r->kc2 = choose(r->d > 0, (beta * r->d2 + r->beta_d3) * r->per_beta_u, zero + 1);
    r->kc = square_root(r->kc2);
    r->frequency = square_root(r->beta_u) / 2;
}

// Nome q = exp(-pi K'/K), k^2 <= 0.99: a series in the fourth power of its leading term, k^2/(2 (1 + k') (1 + sqrt(k'))^2).
inlined real nome_of(real leading) {
    const real t = leading * leading * leading * leading;
    real series = (real){0} + nome_series[nome_terms - 1];
    unrolled for (int n = nome_terms - 2; n >= 0; --n) series = nome_series[n] + t * series;
    return leading * series;
}

// Solves sum_{n odd} q^(n^2-n) h_n = excess (1 + sum_{n even} q^(n^2-n) h_n) for X = h_1, with h_n = 2 q^n cosh(2 n v), by
// Newton's method from a quadratic equation. Each step corrects the inverse slope of the one before instead of another
// division.
inlined real position_of(real q, real excess, truth *doubt) {
    const real q2 = q * q, q4 = q2 * q2, q6 = q2 * q4, q12 = q6 * q6, scale = 1 - 2 * q4, ratio = excess * excess * q2 * scale;
    // X - excess (1 - 2 q^4 + q^2 X^2) = 0 by its series.
    const real r = less_of(ratio, (real){0} + 0.2);
    real x = excess * scale * (1 + r * (1 + r * (2 + r * (5 + r * (14 + r * 42))))), per_slope = r, step = r;
    int returns = 0;
    unrolled for (int n = 0; n < newton_steps; ++n) {
        const real y = x * x;
        real odd = x + x * q6 * (y - 3 * q2), even = 1 + q2 * (y - 2 * q2), slope = 1 + 3 * q6 * (y - q2) - 2 * excess * x * q2;
        if (n == 0) {
            per_slope = 1 / slope; // and the small terms can wait
        } else {
            odd += x * q12 * q4 * q4 * (y * (y - 5 * q2) + 5 * q4);
            even += q12 * (y * (y - 4 * q2) + 2 * q4);
            slope -= 4 * excess * x * q12 * (y - 2 * q2);
            per_slope *= 2 - slope * per_slope;
        }
        step = (odd - excess * even) * per_slope;
        x -= step;
        if (has_settled(step, x, magnitude(step), &returns)) break;
    }
    *doubt |= magnitude(step) > 1e-6;
    return x;
}

// A/B of a position X: A = 1 + sum q^(n^2) a_n with a_1 = X - q, B = 1 + sum (-1)^n q^(n^2) b_n with b_1 = X + q, both by
// x_(n+1) = X x_n - q^2 x_(n-1), x_0 = 1: the theta functions that carry sn/cn.
inlined real ratio_of(real q, real x) {
    const real q2 = q * q, q4 = q2 * q2, q9 = q4 * q4 * q, q16 = q4 * q4 * q4 * q4;
    const real a1 = x - q, a2 = x * a1 - q2, a3 = x * a2 - q2 * a1, a4 = x * a3 - q2 * a2;
    const real b1 = x + q, b2 = x * b1 - q2, b3 = x * b2 - q2 * b1, b4 = x * b3 - q2 * b2;
    return (1 + q * a1 + q4 * a2 + q9 * a3 + q16 * a4) / (1 - q * b1 + q4 * b2 - q9 * b3 + q16 * b4);
}

// The positions of the poles, from the right-hand sides for them, `excess`.
static void find_positions(struct thetas *f, truth *doubt) {
    f->bottom.position = position_of(f->q, f->bottom.excess, doubt);
    f->top.position = position_of(f->q, f->top.excess, doubt);
}

// A pole from its position, sqrt(k') times its sc(i v) without the i, `scale`, and its nearest value over the farthest.
static void place_pole(real q, struct pole *p) {
    const real q2 = q * q, q6 = q2 * q2 * q2, q12 = q6 * q6, q20 = q12 * q6 * q2, x = p->position;
    // W^n + V^n and W^n - V^n, of W + V = X and W V = q^2. Not W - V = sqrt(X^2 - 4 q^2): that loses half the digits.
    const real s2 = x * x - 2 * q2, s3 = x * s2 - q2 * x, s4 = x * s3 - q2 * s2, s5 = x * s4 - q2 * s3;
    const real o1 = (x + 2 * q) * p->scale * ratio_of(q, x), t2 = x * o1, t3 = x * t2 - q2 * o1, t4 = x * t3 - q2 * t2;
    const real t5 = x * t4 - q2 * t3;
    // Times q^(n^2 - n).
    const real e1 = x, e2 = q2 * s2, e3 = q6 * s3, e4 = q12 * s4, e5 = q20 * s5;
    const real o2 = q2 * t2, o3 = q6 * t3, o4 = q12 * t4, o5 = q20 * t5;
    p->farthest = 1 + e1 + e2 + e3 + e4 + e5;
    p->nearest *= p->farthest;
    p->slope = 2 * (o1 + 2 * o2 + 3 * o3 + 4 * o4 + 5 * o5);
    // -sum (-1)^n e_n sin(nz)^2/sin(z)^2 and -sum (-1)^n o_n sin(2nz)/sin(2z) in powers of cos 2z.
    p->even[0] = e1 - 2 * e2 + e3 + e5, p->even[1] = 4 * (e3 - e5) - 2 * e2, p->even[2] = 4 * (e3 - e5) - 8 * e4;
    p->even[3] = 16 * e5 - 8 * e4, p->even[4] = 16 * e5;
    p->odd[0] = o1 - o3 + o5, p->odd[1] = 4 * o4 - 2 * o2, p->odd[2] = 4 * o3 - 12 * o5;
    p->odd[3] = -8 * o4, p->odd[4] = 16 * o5;
}

// The nome, and the data for the poles: theta = pi, below the motion, and theta = 0, above it.
static void find_nome(const struct start *s, const struct roots *r, struct thetas *f) {
    const real kc = r->kc, root_kc = square_root(kc), square = (1 + root_kc) * (1 + root_kc), factor = (1 + kc) * square;
    struct pole *const bottom = &f->bottom, *const top = &f->top;
    // sqrt(k'/(beta (1 + u3))), sqrt(p1 p2 k') and sqrt(m1 d2 k').
    const real scale = root_kc * r->per_root_p3;
    const real root_bottom = magnitude(s->b_plus_a) * scale, root_top = root_kc * r->root_md;
    const real bottom_sum = r->p2 + r->p1 * kc + 2 * root_bottom, top_sum = r->m1 * kc + r->d2 + 2 * root_top;
    const real sums = bottom_sum * top_sum, per_all = 1 / (factor * kc * sums), per_factor = per_all * kc * sums;
    const real per_kc = per_all * factor * sums, per_sums = per_all * factor * kc;
    f->root_kc = root_kc, f->q = nome_of(r->k2 / 2 * per_factor);
    bottom->excess = (r->d + r->p1 * r->k2 * square * per_factor) * top_sum * per_sums;
    top->excess = r->d * (r->beta_d3 * r->per_beta_u + kc) * square * per_factor * bottom_sum * per_sums;
    bottom->scale = 2 * r->frequency * scale;
    top->scale = 2 * r->frequency * r->per_beta_u * root_kc * r->root_d3 * per_kc;
    bottom->nearest = root_bottom * r->per_p2, top->nearest = root_top * r->per_m1 * per_kc;
    bottom->side = with_sign((real){0} + 1, s->b_plus_a), top->side = with_sign((real){0} + 1, s->b_minus_a);
}

// Rates of the argument and of the phases.
static void find_rates(const struct start *s, const struct roots *r, struct thetas *f) {
    const real q = f->q, q4 = q * q * q * q, q16 = q4 * q4 * q4 * q4;
    struct pole *const bottom = &f->bottom, *const top = &f->top;
    const truth is_fast = r->d2 > r->m1 / 4;
    const real theta3 = 1 + 2 * (q + q4 + q4 * q4 * q + q16 + q16 * q4 * q4 * q), both = bottom->farthest * top->farthest;
    const real last = choose(is_fast, r->d2 * top->nearest, (real){0} + 1), square = theta3 * theta3;
    const real per_all = 1 / (both * square * last), per_last = per_all * both * square, per_both = per_all * square * last;
    const real per_bottom = per_both * top->farthest, per_top = per_both * bottom->farthest;
    f->theta3 = theta3;
    f->z_rate = r->frequency * per_all * both * last;
    const real upper_turn = f->z_rate * bottom->side * bottom->slope * per_bottom;
    f->upper_rate = s->b_plus_a / 2 * r->per_p2 + upper_turn;
    f->lower_rate = s->b_minus_a / 2 * r->per_m1 + f->z_rate * top->side * top->slope * per_top;
    const real slope_nearest = 2 * (top->odd[0] + top->odd[1] + top->odd[2] + top->odd[3] + top->odd[4]);
    // A fast top precesses slowly: the two rates nearly cancel.
    f->sum_rate = choose(is_fast,
                         (s->turn - s->a * r->y2) * r->per_p2 * top->nearest * per_last + upper_turn
                             - f->z_rate * top->side * slope_nearest * r->d2 * per_last,
                         f->upper_rate + f->lower_rate);
    bottom->weight = r->p2 * per_bottom * per_bottom;
    top->weight = r->m1 * r->kc * per_top * per_top;
}

// z at the start: 0 at the lower turning point u1, pi/2 at the upper one, negative on the way down. The equation is that of the
// position of a pole, with X = 2 q cos 2z.
inlined real position_at_start(const struct roots *r, const struct thetas *f, truth *doubt) {
    const real per_both = inverse(r->d * (1 + r->kc)), sn2 = -r->y1 * (1 + r->kc) * per_both;
    const real sum = safe_root(1 - r->k2 * sn2) + f->root_kc;
    return position_of(f->q, r->k2 * (r->d * per_both - sn2) / (sum * sum), doubt);
}
inlined real argument_at_start(const struct start *s, const struct roots *r, const struct thetas *f, real position) {
    const real zero = {0}, cosine = square_root(r->y2), sine = f->root_kc * square_root(-r->y1) * ratio_of(f->q, position);
    const real z = choose(r->y1 < 0, choose(r->y2 > 0, argument_of(cosine, sine), zero + pi / 2), zero);
    return choose(s->u_rate < 0, -z, z);
}
