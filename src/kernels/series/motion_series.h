// Taylor coefficients of the motion of a heavy body and of all that acts on it, in the numbers of an algebra: included for
// bodies in lanes (algebra_lanes.h), for one body (algebra_one.h), and for one body in quadruple precision
// (algebra_quadruple.h).
//
//     I w_a' = (I w_a) x w_a + h x w_a + m (g G + B) x r + M + T - d w - h' - friction - sum of D v,   w = w_a - O
//     G' = G x w,   v = y w with s = w.w, or v = r x (y u) with u = w x r and s = u.u,   y = s^b
//
// This is the only place where the equations of an effect stand as series. O, M, B (the rotation of the frame, torques, and the
// acceleration of the pivot) are sums of rows that turn with the body as the vertical does (motion_kinds.h). Products of series
// are Cauchy products; those of a term k with unknown parts, powers and quotients, are found with zero in their place, and then
// completed. Bodies in lanes have all constants over the moments of inertia; others have them as they are, so that the momentum
// takes the moments without a factor that would be rounded in the same way in every step.

// Rows of a term: angular velocity, vertical, attitude.
enum { NAME(w) = 0, NAME(g) = room, NAME(attitude) = 2 * room, NAME(rows) = 2 * room + attitude_room };
// Further rows: those that turn, in body axes first the rotation of the frame, the torque in space and the acceleration of the
// pivot; the angular velocity with that of the frame; drags: u, s, k s, y, v; what vibrates along the vertical, and its
// partner.
enum {
    NAME(total) = most_turned * room,
    NAME(drags) = NAME(total) + room,
    NAME(u) = 0,
    NAME(s) = room,
    NAME(t),
    NAME(y),
    NAME(v) = room + components,
    NAME(of_drag) = 2 * room + components,
    NAME(swing) = NAME(drags) + most_drags * NAME(of_drag),
    NAME(friction) = NAME(swing) + components
};
// Friction by a table: the change of the angular velocity about its axis, its square, and the law; dry friction: the square
// of the smoothed speed, and the inverse speed; the height, what N is made of, N; direction, force without load, lever.
enum {
    NAME(change) = NAME(friction),
    NAME(change_square),
    NAME(law),
    NAME(smooth) = NAME(law) + 4,
    NAME(radicand) = NAME(smooth) + 2,
    NAME(height) = NAME(radicand) + 2,
    NAME(along),
    NAME(forces),
    NAME(rest),
    NAME(load),
    NAME(direction) = NAME(friction) + 16,
    NAME(force) = NAME(direction) + room,
    NAME(lever) = NAME(force) + room,
    NAME(more) = is_many ? NAME(friction) : NAME(lever) + room
};

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

// What a drag takes of the angular velocity, and gives of a vector: the vector itself, or that of the centre of mass its vector
// products with r.
inlined vec NAME(taken)(int d, int lane, const struct NAME(constants) * e, vec w) {
    const vec r = constant(arm);
    return d == of_moment ? w : sub(mul(ahead(w), behind(r)), mul(behind(w), ahead(r)));
}
inlined vec NAME(given)(int d, int lane, const struct NAME(constants) * e, vec v) {
    const vec r = constant(arm);
    return d == of_moment ? v : sub(mul(ahead(r), behind(v)), mul(behind(r), ahead(v)));
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
#include "friction_series.h"
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
    vec lift = by(number(gravity), g);
    if (has->push) lift = add(lift, push);
    vec rate = sub(sub(mul(ahead(lift), constant(pull)), mul(behind(lift), constant(swing))), mul(w, constant(decay)));
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

#include "motion_start.h"
