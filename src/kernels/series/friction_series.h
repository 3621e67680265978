// Friction in motion_series.h: by a table, a polynomial of the angular velocity about its axis, and dry friction.

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

inlined vec NAME(cross)(vec a, vec b) { return sub(mul(ahead(a), behind(b)), mul(behind(a), ahead(b))); }

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
