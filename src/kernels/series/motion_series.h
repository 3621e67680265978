// Taylor coefficients of the motion of a heavy body and of all that acts on it, in the numbers of an algebra: included for
// bodies in lanes (algebra_lanes.h), for one body (algebra_one.h), and for one body in quadruple precision
// (algebra_quadruple.h).
//
//     I w_a' = (I w_a) x w_a + h x w_a + m (g G + B) x r + M + T - d w - h' - friction - sum of D v,   w = w_a - O
//     G' = G x w,   v = y w with s = w.w, or v = r x (y u) with u = w x r and s = u.u,   y = s^b
//
// This is the only place where the equations of an effect stand as series. O, M, B (the rotation of the frame, torques, and the
// acceleration of the pivot) are sums of rows that turn with the body as the vertical does. Products of series
// are Cauchy products; those of a term k with unknown parts, powers and quotients, are found with zero in their place, and then
// completed. Bodies in lanes have all constants over the moments of inertia; others have them as they are, so that the momentum
// takes the moments without a factor that would be rounded in the same way in every step.

#ifndef for_single_effects

// How a vector in space is directed: along the vertical, whose row then does, or anyhow; axes of a harmonic torque; friction.
enum { along = 1, anyhow = 2, in_space = 1, in_body = 2, with_load = 2, table_terms = 4 };

// The drags, of which the kinds are the sum of their numbers from 1 on.
enum { of_moment, of_force };

// The rows, each in its place, and what they are. A row S of a vector that is given in space obeys S' = S x w + rate S_partner;
// one in body axes S' = rate S_partner.
enum { of_frame, of_torque, of_push, of_partner, few_rows, of_harmonics = few_rows, of_table = of_harmonics + 4 };
enum { many_rows = of_table + table_terms };
enum { is_partner, is_frame, is_torque, is_push, is_moment };
enum { of_pivot, of_harmonic_in_space, of_harmonic_in_body, rates, by_time = rates, at_rest };

struct turned_row {
    int place, role, turns, rate, partner; // the partner is so many places ahead
};

// The rows that effects need.
inlined int list_rows(const struct motion_kinds *has, struct turned_row *row) {
    int n = 0;
    if (has->frame == anyhow) row[n++] = (struct turned_row){of_frame, is_frame, 1, at_rest, 0};
    if (has->torque == anyhow) row[n++] = (struct turned_row){of_torque, is_torque, 1, at_rest, 0};
    if (has->push == anyhow) {
        row[n++] = (struct turned_row){of_push, is_push, 1, of_pivot, 1};
        row[n++] = (struct turned_row){of_partner, is_partner, 1, of_pivot, -1};
    }
    for (int i = 0; i < 2; ++i) {
        const int turns = i == 0, role = turns ? is_torque : is_moment, place = of_harmonics + 2 * i;
        if (!(has->harmonic & (i + 1))) continue;
        row[n++] = (struct turned_row){place, role, turns, of_harmonic_in_space + i, 1};
        row[n++] = (struct turned_row){place + 1, is_partner, turns, of_harmonic_in_space + i, -1};
    }
    for (int term = 0; has->table && term < table_terms; ++term) {
        const int rate = term + 1 < table_terms ? by_time : at_rest;
        row[n++] = (struct turned_row){of_table + term, term == 0 ? is_torque : is_partner, 1, rate, 1};
    }
    return n;
}

// The kinds that have a build of their own, in which nothing is asked in loops: a single effect, with and without a rotor.
// There is none without optimization, where each would take stack of its own.
#ifdef __OPTIMIZE__
#define for_single_effects(build)                                                                                 \
    build(.drags = 0) build(.frame = along) build(.frame = anyhow) build(.torque = along) build(.torque = anyhow) \
        build(.push = along) build(.push = anyhow) build(.drags = of_moment + 1) build(.drags = of_force + 1)
#else
#define for_single_effects(build)
#endif

// In a function: expands by the build of one of these kinds, if `which` is one, and returns.
#define build_kind(...)                                \
    {                                                  \
        const struct motion_kinds has = {__VA_ARGS__}; \
        if (memcmp(&has, which, sizeof has) == 0) {    \
            expand_as(&has, 1);                        \
            return;                                    \
        }                                              \
    }
#define build_kinds(...) build_kind(__VA_ARGS__) build_kind(.rotor = 1, __VA_ARGS__)

#endif

// Rows of a term: angular velocity, vertical, attitude.
enum { NAME(w) = 0, NAME(g) = room, NAME(attitude) = 2 * room, NAME(rows) = 2 * room + attitude_room };
// Further rows: those that turn, in body axes first the rotation of the frame, the torque in space and the acceleration of the
// pivot; the angular velocity with that of the frame; drags: u, s, k s, y, v; what vibrates along the vertical, and its
// partner.
enum { NAME(total) = most_turned * room, NAME(drags) = NAME(total) + room };
enum { NAME(u) = 0, NAME(s) = room, NAME(t), NAME(y), NAME(v) = room + components, NAME(of_drag) = 2 * room + components };
enum { NAME(swing) = NAME(drags) + most_drags * NAME(of_drag), NAME(friction) = NAME(swing) + components };
// Friction by a table: the change of the angular velocity about its axis, its square, and the law; dry friction: the square
// of the smoothed speed, and the inverse speed; the height, what N is made of, N; direction, force without load, lever.
enum { NAME(change) = NAME(friction), NAME(change_square), NAME(law), NAME(smooth) = NAME(law) + 4 };
enum { NAME(radicand) = NAME(smooth) + 2, NAME(height) = NAME(radicand) + 2 };
enum { NAME(along) = NAME(height) + 1, NAME(forces), NAME(rest), NAME(load) };
enum { NAME(direction) = NAME(friction) + 16, NAME(force) = NAME(direction) + room, NAME(lever) = NAME(force) + room };
enum { NAME(more) = is_many ? NAME(friction) : NAME(lever) + room };

// Constants of a body, or of one in each lane.
#define constant_vec(name) name[components * stride]
struct NAME(constants) {
    element constant_vec(per_inertia), constant_vec(coupling), constant_vec(decay), constant_vec(pull), constant_vec(swing);
    element constant_vec(torque), constant_vec(rotor[2]), constant_vec(drive[2]), constant_vec(arm);
    element gravity[stride], rate[rates][stride];
    element frame[3][stride], torque_space[3][stride], amplitude[3][3][stride], phase[3][3][stride];
    struct {
        element constant_vec(moment), power[stride];
    } drag[most_drags];
#if !is_many
    element constant_vec(inertia), constant_vec(momentum), constant_vec(axis);
    element mass, force, friction_torque, friction_arm, smoothing;
#endif
};
#undef constant_vec

// What the terms of a step have in common: s/(1 + s G3) of the attitude by an angle; the momentum of the rotor; 1/s and y of
// powers in term 0: of drags, of the smoothed speed, and of the squared load.
enum { NAME(powers) = most_drags + 2 };
struct NAME(start) {
    element inverse[stride], rotor[2][components * stride], per_square[NAME(powers)][stride], power[NAME(powers)][stride];
    // Of drags: v in term 0; the slopes of s by the angular velocity, and of y by s.
    element v[most_drags][components * stride], slope[most_drags][components * stride], steep[most_drags][stride];
    element law[2][5], spin;
    const element *given; // terms of torques over time in body axes
    int exists;
};

// S x w of the vertical and of the rows that turn is one sum, or two where there are registers for both.
struct NAME(turn) {
    vec plus, minus;
};
struct NAME(sums) {
    vec gyro, push;
    attitude_sums attitude;
    struct NAME(turn) up, row[most_turned];
};

#define at(row, j) (c + stride * (NAME(rows) * (j) + (row)))
#define more_at(row, j) (x + stride * (NAME(more) * (j) + (row)))
#define constant(name) load_constant(e->name + lane)
#define number(name) load_num(e->name + lane)

#if !is_many

// What the algebras of one body have in common.

// A power that is a polynomial has a series everywhere; another one, where s is zero, only if s is zero throughout: then its
// terms are zero.
inlined num inverse_of(num s) { return s > 0 ? 1 / s : 0; }
inlined num power_term(num b, num s, num y) { return b < 1 || b > 1 ? y : s; }

// Most of the amplitudes of a body are zero.
inlined void find_swing(num size, num x, num *even, num *odd) {
    *even = *odd = 0;
    if (!(size < 0 || size > 0)) return;
    find_circle(x, even, odd);
    *even *= size, *odd *= size;
}

// Space x, y and z in body axes, of a quaternion of any length: quadratic forms, divided by the squared norm 1 + s. Where s is
// small its share s/(1 + s) is subtracted: a factor that is rounded beside 1 errs to one side on average, since numbers below 1
// are denser than those above, and energy drifts.
inlined void find_axes(const element *q, num side, vec axes[3]) {
    const num q0 = q[0], q1 = q[1], q2 = q[2], q3 = q[3], s = ((q0 * q0 - 1) + q3 * q3) + q1 * q1 + q2 * q2;
    (void)side;
    axes[0] = vec_of((q0 * q0 + q1 * q1) - (q2 * q2 + q3 * q3), 2 * (q1 * q2 - q0 * q3), 2 * (q1 * q3 + q0 * q2));
    axes[1] = vec_of(2 * (q1 * q2 + q0 * q3), (q0 * q0 + q2 * q2) - (q1 * q1 + q3 * q3), 2 * (q2 * q3 - q0 * q1));
    axes[2] = vec_of(2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1), (q0 * q0 + q3 * q3) - (q1 * q1 + q2 * q2));
    for_all(i, 3) {
        if (s > -0.5 && s < 0.5) {
            axes[i] = sub(axes[i], by(s / (1 + s), axes[i]));
        } else {
            axes[i] = by(1 / (q0 * q0 + q3 * q3 + q1 * q1 + q2 * q2), axes[i]);
        }
    }
}

#endif

inlined vec NAME(scaled)(vec rate, struct share s) {
    const vec value = by(s.first + (num){0}, rate);
    return s.is_sum ? add(value, by(s.rest + (num){0}, rate)) : value;
}

inlined void NAME(add_turn)(const element *row, const element *w, struct NAME(turn) * sum) {
    const vec left = mul(load_ahead(row), load_behind(w)), right = mul(load_behind(row), load_ahead(w));
    sum->plus = add(sum->plus, left);
    if (has_registers) {
        sum->minus = add(sum->minus, right);
    } else {
        sum->plus = sub(sum->plus, right);
    }
}

inlined vec NAME(whole)(const struct NAME(turn) * sum) { return has_registers ? sub(sum->plus, sum->minus) : sum->plus; }

// Adds the products of the first factors in term i and the second in term j.
inlined void NAME(add_products)(const struct motion_kinds *has, int joined, const struct turned_row *row, int i, int j,
                                const element *c, const element *x, struct NAME(sums) * sum) {
    const element *first = has->frame ? more_at(NAME(total), i) : at(NAME(w), i);
    const element *second = has->frame ? more_at(NAME(total), j) : at(NAME(w), j);
    sum->gyro = add(sum->gyro, mul(load_ahead(first), load_behind(second)));
    add_attitude(&sum->attitude, at(0, i), at(0, j));
    NAME(add_turn)(at(NAME(g), i), at(NAME(w), j), &sum->up);
    if (has->push == along) sum->push = add(sum->push, by(load_num(more_at(NAME(swing), i)), load_vec(at(NAME(g), j))));
    for_all(r, joined) NAME(add_turn)(more_at(room * row[r].place, i), at(NAME(w), j), &sum->row[r]);
}

inlined void NAME(find_sums)(const struct motion_kinds *has, int joined, const struct turned_row *row, int k, const element *c,
                             const element *x, struct NAME(sums) * sum) {
    int i = (k + 1) / 2 - 1, j = k - i;
    *sum = (struct NAME(sums)){0};
    if (k % 2 == 0) NAME(add_products)(has, joined, row, k / 2, k / 2, c, x, sum);
    pairs_for(; i >= 0; --i, ++j) {
        NAME(add_products)(has, joined, row, i, j, c, x, sum);
        NAME(add_products)(has, joined, row, j, i, c, x, sum);
    }
}

// Term k of S x w for a row S.
inlined vec NAME(turned)(int k, int at_row, const element *c, const element *x) {
    struct NAME(turn) sum = {0};
    int i = (k + 1) / 2 - 1, j = k - i;
    if (k % 2 == 0) NAME(add_turn)(more_at(at_row, k / 2), at(NAME(w), k / 2), &sum);
    unrolled_for(; i >= 0; --i, ++j) {
        NAME(add_turn)(more_at(at_row, i), at(NAME(w), j), &sum);
        NAME(add_turn)(more_at(at_row, j), at(NAME(w), i), &sum);
    }
    return NAME(whole)(&sum);
}

// Term k of a power y = s^b from that of s, with the products of the other terms: from s y' = b s' y.
inlined num NAME(power)(int k, int number_of, int lane, num b, num s, num products, const struct NAME(start) * of) {
    const num y0 = load_num(of->power[number_of] + lane);
    if (k == 0) return y0;
    return power_term(b, s, load_num(of->per_square[number_of] + lane) * (products + b * s * y0));
}

inlined vec NAME(cross)(vec a, vec b) { return sub(mul(ahead(a), behind(b)), mul(behind(a), ahead(b))); }

// What a drag takes of the angular velocity, and gives of a vector: the vector itself, or that of the centre of mass its vector
// products with r.
inlined vec NAME(taken)(int d, int lane, const struct NAME(constants) * e, vec w) {
    return d == of_moment ? w : NAME(cross)(w, constant(arm));
}
inlined vec NAME(given)(int d, int lane, const struct NAME(constants) * e, vec v) {
    return d == of_moment ? v : NAME(cross)(constant(arm), v);
}

// Adds the moment of a drag in term k to the rate. What the newest angular velocity adds to s, y and the moment is linear in
// it: so little is done after it is known.
inlined vec NAME(add_drag)(int d, int k, int lane, const struct NAME(constants) * e, const struct NAME(start) * of,
                           const element *c, element *x, vec rate) {
#define drag_at(row, j) more_at(NAME(drags) + d * NAME(of_drag) + NAME(row), j)
    const vec w = load_vec(at(NAME(w), k)), u = NAME(taken)(d, lane, e, w), v_0 = load_constant(of->v[d] + lane);
    const num b = number(drag[d].power), y_0 = load_num(of->power[d] + lane);
    vec inner = {0}, square = {0};
    num first = {0}, second = {0}, s, y = y_0;
    pairs_for(int i = (k - 1) / 2, j = k - i; i > 0; --i, ++j) {
        const num y_i = load_num(drag_at(y, i)), y_j = load_num(drag_at(y, j));
        const vec u_i = load_vec(drag_at(u, i)), u_j = load_vec(drag_at(u, j));
        square = add(square, mul(u_i, u_j));
        inner = add(inner, add(by(y_i, u_j), by(y_j, u_i)));
        first += y_i * load_num(drag_at(t, j)) + y_j * load_num(drag_at(t, i));
        second += y_i * load_num(drag_at(s, j)) + y_j * load_num(drag_at(s, i));
    }
    square = add(square, square);
    if (k > 0 && k % 2 == 0) {
        const vec u_m = load_vec(drag_at(u, k / 2));
        const num y_m = load_num(drag_at(y, k / 2));
        square = add(square, mul(u_m, u_m)), inner = add(inner, by(y_m, u_m));
        first += y_m * load_num(drag_at(t, k / 2)), second += y_m * load_num(drag_at(s, k / 2));
    }
    if (k == 0) {
        s = sum_of(mul(u, u));
    } else {
        const num rest = load_num(of->per_square[d] + lane) * ((1 + b) * ((element)1 / k) * first - second);
        s = sum_of(mul(load_constant(of->slope[d] + lane), w)) + sum_of(square);
        y = load_num(of->steep[d] + lane) * s + rest;
        inner = add(inner, by(y_0, u));
    }
    store_vec(drag_at(u, k), u);
    store_num(drag_at(s, k), s), store_num(drag_at(t, k), k * s), store_num(drag_at(y, k), y);
    const vec v = add(NAME(given)(d, lane, e, inner), by(y, v_0));
    store_vec(drag_at(v, k), v);
    return sub(rate, mul(constant(drag[d].moment), v));
#undef drag_at
}

#if !is_many

// Friction: by a table, a polynomial of the angular velocity about its axis, and dry friction.

// Term k of the products of two rows of numbers, of a number and a vector, and of the components of two vectors.
inlined num NAME(product)(int k, const element *a, const element *b) {
    num sum = 0;
    for (int i = 0; i <= k; ++i) sum += a[NAME(more) * i] * b[NAME(more) * (k - i)];
    return sum;
}

inlined vec NAME(times)(int k, const element *a, const element *b, int terms_apart) {
    vec sum = {0};
    for (int i = 0; i <= k; ++i) sum = add(sum, by(a[NAME(more) * i], load_vec(b + terms_apart * (k - i))));
    return sum;
}

inlined num NAME(inner)(int k, const element *a, const element *b, int terms_apart) {
    vec sum = {0};
    for (int i = 0; i <= k; ++i) sum = add(sum, mul(load_vec(a + terms_apart * i), load_vec(b + terms_apart * (k - i))));
    return sum_of(sum);
}

// Keeps term k of s and of the power y = s^b in the rows s, y from `row` on.
inlined num NAME(keep_power)(int k, int number_of, int row, num b, num s, struct NAME(start) * of, element *x) {
    num products = 0;
    if (k == 0) of->per_square[number_of][0] = inverse_of(s), of->power[number_of][0] = s > 0 ? power_of(s, b) : 0;
    for (int i = 1; i < k; ++i) products += ((1 + b) * i - k) * (*more_at(row, i) * *more_at(row + 1, k - i));
    const num y = NAME(power)(k, number_of, 0, b, s, k > 0 ? products / k : 0, of);
    *more_at(row, k) = s, *more_at(row + 1, k) = y;
    return y;
}

// The moment of a table in term k: at a row the law of the side to which the angular velocity moves.
inlined num NAME(law_of_table)(int k, num spin, const struct NAME(start) * of, element *x) {
    *more_at(NAME(change), k) = k == 0 ? 0 : spin;
    if (k <= 1) {
        const element *table = of->law[spin < 0 ? 0 : 1];
        const num h = of->spin - table[0], l1 = table[2], l2 = table[3], l3 = table[4];
        *more_at(NAME(law), 0) = table[1] + h * (l1 + h * (l2 + h * l3)),
                            *more_at(NAME(law) + 1, 0) = l1 + h * (2 * l2 + h * 3 * l3);
        *more_at(NAME(law) + 2, 0) = l2 + h * 3 * l3, *more_at(NAME(law) + 3, 0) = l3;
    }
    const num square = NAME(product)(k, more_at(NAME(change), 0), more_at(NAME(change), 0));
    *more_at(NAME(change_square), k) = square;
    if (k == 0) return *more_at(NAME(law), 0);
    return *more_at(NAME(law) + 1, 0) * spin + *more_at(NAME(law) + 2, 0) * square
           + *more_at(NAME(law) + 3, 0) * NAME(product)(k, more_at(NAME(change), 0), more_at(NAME(change_square), 0));
}

// Adds friction in term k to the rate. Dry friction is -(Mc + a N) u, where the support force N is the root of a quadratic
// equation (loads.f90).
static vec NAME(add_friction)(const struct motion_kinds *has, int k, const struct NAME(constants) * e, struct NAME(start) * of,
                              const element *c, element *x, vec lift, vec rate) {
    enum { lane = 0 };
    const vec arm = constant(arm), per_inertia = constant(per_inertia);
    const element *const total = has->frame ? more_at(NAME(total), 0) : at(NAME(w), 0);
    const int apart = has->frame ? NAME(more) : NAME(rows);

    if (has->law) {
        const num spin = sum_of(mul(constant(axis), load_vec(at(NAME(w), k))));
        if (k == 0) of->spin = spin;
        rate = add(rate, by(NAME(law_of_table)(k, spin, of, x), constant(axis)));
    }
    if (!has->friction) return rate;
    num square = NAME(inner)(k, at(NAME(w), 0), at(NAME(w), 0), NAME(rows));
    if (k == 0) square += e->smoothing * e->smoothing, of->exists = of->exists && square > 0;
    NAME(keep_power)(k, most_drags, NAME(smooth), -0.5, square, of, x);
    const vec u = NAME(times)(k, more_at(NAME(smooth) + 1, 0), at(NAME(w), 0), NAME(rows));
    store_vec(more_at(NAME(direction), k), u);
    rate = sub(rate, by(e->friction_torque, u));
    if (has->friction < with_load) return rate;

    // w_a x (w_a x r) = w_a (w_a . r) - r w_a^2
    *more_at(NAME(height), k) = sum_of(mul(arm, load_vec(total + apart * k)));
    vec force = sub(NAME(times)(k, more_at(NAME(height), 0), total, apart), by(NAME(inner)(k, total, total, apart), arm));
    force = by(e->mass, add(add(lift, force), NAME(cross)(mul(rate, per_inertia), arm)));
    if (has->drags & (of_force + 1)) {
        const vec moment = load_vec(more_at(NAME(drags) + of_force * NAME(of_drag) + NAME(v), k));
        force = add(force, by(e->force, NAME(cross)(moment, arm)));
    }
    store_vec(more_at(NAME(force), k), force);
    store_vec(more_at(NAME(lever), k), by(e->mass * e->friction_arm, NAME(cross)(mul(u, per_inertia), arm)));
    const element *const forces = more_at(NAME(force), 0), *const levers = more_at(NAME(lever), 0);
    const num along_lever = NAME(inner)(k, forces, levers, NAME(more)), rest = NAME(inner)(k, levers, levers, NAME(more));
    *more_at(NAME(along), k) = along_lever, *more_at(NAME(rest), k) = (k == 0) - rest;
    *more_at(NAME(forces), k) = NAME(inner)(k, forces, forces, NAME(more));
    const num radicand = NAME(product)(k, more_at(NAME(along), 0), more_at(NAME(along), 0))
                         + NAME(product)(k, more_at(NAME(rest), 0), more_at(NAME(forces), 0));
    num load_of = NAME(keep_power)(k, most_drags + 1, NAME(radicand), 0.5, radicand, of, x) - along_lever;
    for (int j = 1; j <= k; ++j) load_of -= *more_at(NAME(rest), j) * *more_at(NAME(load), k - j);
    *more_at(NAME(load), k) = load_of / *more_at(NAME(rest), 0);
    return sub(rate, by(e->friction_arm, NAME(times)(k, more_at(NAME(load), 0), more_at(NAME(direction), 0), NAME(more))));
}

#endif

// The term behind the k-th of everything, and what is known of the k-th only with the products.
inlined void NAME(append)(const struct motion_kinds *has, int joins, int k, int lane, const struct NAME(constants) * e,
                          struct NAME(start) * of, struct share s, element *c, element *x, element *state) {
    struct turned_row row[most_turned];
    struct NAME(sums) sum;
    const int n = list_rows(has, row), joined = joins ? n : 0;
    const vec w = load_vec(at(NAME(w), k)), g = load_vec(at(NAME(g), k));
    const vec all = has->frame ? load_vec(more_at(NAME(total), k)) : w;
    vec torque = {0}, push = {0}, moment = {0}, frame = {0};

    begin_attitude(at(0, k));
    NAME(find_sums)(has, joined, row, k, c, x, &sum);
    for_all(r, n) {
        const vec value = load_vec(more_at(room * row[r].place, k));
        if (row[r].role == is_torque) torque = add(torque, value);
        if (row[r].role == is_push) push = add(push, value);
        if (row[r].role == is_moment) moment = add(moment, value);
    }
    if (has->torque == along) torque = add(torque, by(number(torque_space[2]), g));
    if (has->push == along) push = add(push, sum.push);
    // Sums with what a body has not would be computed: a zero is no number that a compiler may leave out.
    vec lift = by(number(gravity), g), lift_ahead = by(number(gravity), load_ahead(at(NAME(g), k)));
    vec lift_behind = by(number(gravity), load_behind(at(NAME(g), k)));
    if (has->push) lift = add(lift, push), lift_ahead = ahead(lift), lift_behind = behind(lift);
    vec rate = sub(sub(mul(lift_ahead, constant(pull)), mul(lift_behind, constant(swing))), mul(w, constant(decay)));
    if (has->rotor) {
        const vec ahead_of = mul(load_constant(of->rotor[0] + lane), behind(all));
        rate = add(rate, sub(ahead_of, mul(load_constant(of->rotor[1] + lane), ahead(all))));
    }
    if (has->rotor && k == 0) rate = add(rate, constant(torque));
    if (has->rotor && k > 0) {
        const vec last = load_vec(has->frame ? more_at(NAME(total), k - 1) : at(NAME(w), k - 1));
        rate = add(rate, sub(mul(constant(drive[0]), behind(last)), mul(constant(drive[1]), ahead(last))));
    }
#if !is_many
    if (has->given) moment = add(moment, vec_of(of->given[3 * k], of->given[3 * k + 1], of->given[3 * k + 2]));
#endif
    if (has->harmonic & in_body || has->given) rate = add(rate, moment);
    if (has->torque || has->table || has->harmonic & in_space) {
        rate = add(rate, is_many ? mul(constant(per_inertia), torque) : torque);
    }
    if (is_many && has->torque == along) store_vec(more_at(room * of_torque, k), torque);
    if (is_many && has->push == along) store_vec(more_at(room * of_push, k), push);
    for_all(d, most_drags) {
        if (has->drags & (d + 1)) rate = NAME(add_drag)(d, k, lane, e, of, c, x, rate);
    }
    rate = add(rate, mul(constant(coupling), sum.gyro));
#if !is_many
    if (has->friction || has->law) rate = NAME(add_friction)(has, k, e, of, c, x, lift, rate);
#endif
    const vec momentum = rate;
    const vec up = NAME(scaled)(NAME(whole)(&sum.up), s);
    store_vec(at(NAME(g), k + 1), up);
    for_all(r, n) {
        const int own = room * row[r].place;
        vec change = {0};
        if (row[r].turns) change = joined ? NAME(whole)(&sum.row[r]) : NAME(turned)(k, own, c, x);
        if (row[r].rate != at_rest) {
            vec other = load_vec(more_at(own + room * row[r].partner, k));
            if (row[r].rate != by_time) other = by(row[r].partner * load_num(e->rate[row[r].rate] + lane), other);
            change = add(change, other);
        }
        change = NAME(scaled)(change, s);
        if (row[r].role == is_frame) frame = change;
        store_vec(more_at(own, k + 1), change);
    }
    if (has->push == along) {
        const num rate_of = load_num(e->rate[of_pivot] + lane);
        for_all(r, 2) {
            const num other = load_num(more_at(NAME(swing) + 1 - r, k)), value = (1 - 2 * r) * rate_of * other;
            store_num(more_at(NAME(swing) + r, k + 1), s.first * value + s.rest * value);
        }
    }
    if (!is_many) rate = mul(constant(per_inertia), rate);
    rate = NAME(scaled)(rate, s);
    if (has->frame) {
        if (has->frame == along) frame = by(number(frame[2]), up);
        if (is_many && has->frame == along) store_vec(more_at(room * of_frame, k + 1), frame);
        store_vec(more_at(NAME(total), k + 1), rate);
        rate = sub(rate, frame);
    }
    store_vec(at(NAME(w), k + 1), rate);
    append_attitude(&sum.attitude, load_num(of->inverse + lane), s, at(0, k), at(0, k + 1));
#if !is_many
    put_state(state + numbers * (k + 1), at(0, k + 1), add(NAME(scaled)(momentum, s), k == 0 ? constant(momentum) : (vec){0}));
#else
    (void)momentum, (void)state;
#endif
}

// Sets the constants of a body, or of the one in a lane.
static void NAME(set)(const struct body_numbers *b, int lane, element *constants) {
    struct NAME(constants) *const e = (struct NAME(constants) *)constants;
    const int is_linear = !(b->drag_exponent < 1 || b->drag_exponent > 1);
    const element r[3] = {b->centre[0], b->centre[1], b->centre[2]};
    for (int m = 0; m < 3; ++m) {
        const int next = (m + 1) % 3, last = (m + 2) % 3, i = m * stride + lane;
        const element scale = is_many ? 1 / (element)b->inertia[m] : 1;
        e->per_inertia[i] = 1 / (element)b->inertia[m];
        e->coupling[i] = ((element)b->inertia[next] - b->inertia[last]) * scale;
        e->decay[i] = (b->damping[m] + (element)(is_linear ? b->drag_moment[m] : 0)) * scale;
        e->pull[i] = b->mass * r[last] * scale, e->swing[i] = b->mass * r[next] * scale;
        e->torque[i] = ((element)b->torque_body[m] - b->drive[m]) * scale;
        e->rotor[0][i] = b->rotor[next] * scale, e->rotor[1][i] = b->rotor[last] * scale;
        e->drive[0][i] = b->drive[next] * scale, e->drive[1][i] = b->drive[last] * scale;
        e->frame[m][lane] = b->frame[m], e->torque_space[m][lane] = b->torque_space[m];
        for (int n = 0; n < rates; ++n) e->amplitude[n][m][lane] = b->amplitude[n][m], e->phase[n][m][lane] = b->phase[n][m];
        e->drag[of_moment].moment[i] = b->drag_moment[m] * scale, e->drag[of_force].moment[i] = b->drag_force * scale;
        e->arm[i] = r[m];
#if !is_many
        e->inertia[m] = b->inertia[m], e->momentum[m] = b->drive[m], e->axis[m] = b->axis[m];
#endif
    }
    for (int n = 0; n < rates; ++n) e->rate[n][lane] = b->rate[n];
    e->gravity[lane] = b->gravity;
    e->drag[of_moment].power[lane] = ((element)b->drag_exponent - 1) / 2, e->drag[of_force].power[lane] = 0.5;
#if !is_many
    const element arm_square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    num cosine, sine;
    e->force = arm_square > 0 ? b->drag_force / arm_square : 0;
    e->mass = b->mass, e->friction_torque = b->friction_torque, e->friction_arm = b->friction_arm, e->smoothing = b->smoothing;
    if (b->earth_rate < 0 || b->earth_rate > 0) {
        // The rate of the frame itself was rounded from these.
        find_circle(b->latitude, &cosine, &sine);
        e->frame[1][0] = b->earth_rate * cosine, e->frame[2][0] = b->earth_rate * sine;
    }
#endif
}

#define cross_of(a, b, i) ((a)[((i) + 1) % 3] * (b)[((i) + 2) % 3] - (a)[((i) + 2) % 3] * (b)[((i) + 1) % 3])

// A vector in space that swings, and its rate over W, at a time: A cos(W t + f), or for the pivot, where this is the place z,
// its acceleration z'' + 2 O x z' + O x (O x z).
inlined void NAME(find_swings)(int n, int lane, const struct NAME(constants) * e, num t, const num o[3], num now[3],
                               num later[3]) {
    const num rate = load_num(e->rate[n] + lane);
    num even[3], odd[3], turned[3];
    for_all(i, 3) {
        const num phase = rate * t + load_num(e->phase[n][i] + lane);
        find_swing(load_num(e->amplitude[n][i] + lane), phase, &even[i], &odd[i]);
        now[i] = even[i], later[i] = -odd[i];
    }
    if (n != of_pivot) return;
    for_all(i, 3) turned[i] = cross_of(o, even, i) - 2 * rate * odd[i];
    for_all(i, 3) now[i] = cross_of(o, turned, i) - rate * rate * even[i];
    for_all(i, 3) turned[i] = cross_of(o, odd, i) + 2 * rate * even[i];
    for_all(i, 3) later[i] = rate * rate * odd[i] - cross_of(o, turned, i);
}

#undef cross_of

// Term 0 of everything. The rows of the angular velocity, or the momentum, and of the attitude are in the state; `table` has
// the terms of the torque over time.
inlined void NAME(begin)(const struct motion_kinds *has, int lane, const struct NAME(constants) * e, num t, num side,
                         const element *state, const double *table, struct NAME(start) * of, element *c, element *x) {
    const num none = {0}, o[3] = {number(frame[0]), number(frame[1]), number(frame[2])};
    num swings[rates][2][3];
    struct turned_row row[most_turned];
    const int n = list_rows(has, row);
    vec axes[3], frame = {0};

    if (!is_many || has->rotor) {
        for_all(i, 2) store_constant(of->rotor[i] + lane, add(constant(rotor[i]), by(t, constant(drive[i]))));
    }
    if (!is_many || n > 0) find_axes(state, side, axes);
    if (is_many) axes[2] = load_vec(at(NAME(g), 0));
    for_all(i, rates) {
        if (i == of_pivot ? has->push : has->harmonic & i) NAME(find_swings)(i, lane, e, t, o, swings[i][0], swings[i][1]);
    }
    if (has->push == along) {
        for_all(i, 2) store_num(more_at(NAME(swing) + i, 0), swings[of_pivot][i][2]);
    }
    int term = 0, factor = 1;
    for_all(r, n) {
        num v[3] = {none, none, none};
        if (row[r].place == of_frame || row[r].place == of_torque) {
            for_all(i, 3) v[i] = row[r].place == of_frame ? o[i] : number(torque_space[i]);
        } else if (row[r].rate < rates) {
            for_all(i, 3) v[i] = swings[row[r].rate][row[r].partner < 0][i];
        } else {
            // Term j of a polynomial is the j-th derivative over j!.
            for_all(i, 3) v[i] = none + factor * table[3 * term + i];
            term = (term + 1) % table_terms, factor = term == 0 ? 1 : factor * term;
        }
        vec value = vec_of(v[0], v[1], v[2]);
        if (row[r].turns) value = add(add(by(v[0], axes[0]), by(v[1], axes[1])), by(v[2], axes[2]));
        if (row[r].role == is_frame) frame = value;
        store_vec(more_at(room * row[r].place, 0), value);
    }
    if (has->frame == along) frame = by(o[2], axes[2]);
#if is_many
    vec w = load_vec(at(NAME(w), 0));
    if (has->frame) store_vec(more_at(room * of_frame, 0), frame), store_vec(more_at(NAME(total), 0), add(w, frame));
    store_num(of->inverse + lane, side / (1 + side * axes[2].z));
#else
    const element *const rotor = of->rotor[0];
    const vec momentum = vec_of(state[4] - rotor[2], state[5] - rotor[0], state[6] - rotor[1]);
    const vec total = mul(constant(per_inertia), momentum), w = sub(total, frame);
    store_vec(more_at(NAME(total), 0), total), store_vec(at(NAME(w), 0), w), store_vec(at(NAME(g), 0), axes[2]);
    store_attitude(at(NAME(attitude), 0), state[0], vec_of(state[1], state[2], state[3]));
    of->exists = 1;
#endif
    for_all(d, most_drags) {
        if (!(has->drags & (d + 1))) continue;
        const vec u = NAME(taken)(d, lane, e, w);
        const num s = sum_of(mul(u, u));
        const num b = number(drag[d].power), inverse = inverse_of(s), y = power_of(s, b);
        const vec v = NAME(given)(d, lane, e, u);
        store_num(of->per_square[d] + lane, power_term(b, (num){0}, inverse)), store_num(of->power[d] + lane, y);
        store_constant(of->v[d] + lane, v), store_constant(of->slope[d] + lane, by(2 + (num){0}, v));
        store_num(of->steep[d] + lane, power_term(b, 1 + (num){0}, b * y * inverse));
    }
}

// All terms up to the order; those from `behind` on are found in turn, so that one is computed while another waits for its
// last.
inlined void NAME(expand)(const struct motion_kinds *has, int joins, int order, const struct NAME(constants) * e,
                          struct NAME(start) * of, element *c, element *x, element *state) {
    const int ends[] = {order < exact_shares ? order : exact_shares, order};
    int k = 0;
    for_all(part, 2) {
        for (; k < ends[part]; ++k) {
            const struct share s = share_of_term(part == 0, k);
            for (int lane = 0; lane < stride; lane += at_once)
                NAME(append)(has, joins, k, lane, e, of, s, c + lane, x + lane, state);
        }
    }
}

#if !is_many

// The series of one body with effects, of quaternion and momentum: `c`, of which term 0 is the state. Returns whether there is
// one.

inlined int NAME(expand_with)(const struct motion_kinds *has, int joins, int order, const struct NAME(constants) * e, num t,
                              const element *state, const double *table, const double *law, const element *given, element *c) {
    element terms[NAME(rows) * most_terms] __attribute__((aligned(64))),
        more[NAME(more) * most_terms] __attribute__((aligned(64)));
    struct NAME(start) of;
    element *const x = more;
    for_all(i, numbers) c[i] = state[i];
    of.given = given;
    for_all(i, 10) of.law[i / 5][i % 5] = has->law ? law[i] : 0;
    NAME(begin)(has, 0, e, t, 0, state, table, &of, terms, more);
    NAME(expand)(has, joins, order, e, &of, terms, more, c);
    for (int d = 0; d < most_drags; ++d) {
        const element b = e->drag[d].power[0];
        if (!(has->drags & (d + 1)) || of.per_square[d][0] > 0 || !(b < 1 || b > 1)) continue;
        for (int k = 0; k < order; ++k) {
            const element s = *more_at(NAME(drags) + d * NAME(of_drag) + NAME(s), k);
            if (s < 0 || s > 0) of.exists = 0;
        }
    }
    return of.exists;
}

#endif
