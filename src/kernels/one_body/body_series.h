// Taylor coefficients of the motion of one body; see rigid_body.f90, which has the equations. C with
// vectors, as no Fortran compiler makes vectors of the products of one body: each term of the series is kept in
// six arrangements, so that all products of two terms are three products of vectors.

static void expand_body(int order, const struct body_products *body, const double *state, const double *share,
                        const double *share_rest, double *c) {
    struct factors row[most_terms], start, next, f;
    struct inner_sums later;
    vector first[parts], second[parts], third[parts], decay[parts], pull[parts], swing[parts], is_steady[parts];
    vector now[parts], both[parts], rate[parts], ahead[parts], torque[2][parts], by_torque[2][parts];
    vector s1[parts], s2[parts];
    half_vector q, momentum, vertical;

    get_parts(first, body->first), get_parts(second, body->second), get_parts(third, body->third);
    get_parts(decay, body->decay), get_parts(pull, body->pull), get_parts(swing, body->swing);
    get_parts(is_steady, body->is_steady);
    find_first_term(state, &q, &momentum, &vertical);
    from_halves(&momentum, &vertical, now);
    memcpy(c, state, numbers * sizeof *c);
    arrange(now, &q, &f, torque);
    for_all(p, parts) {
        start.a0[p] = first[p] * f.b0[p], start.b0[p] = first[p] * f.a0[p];
        start.a1[p] = second[p] * f.b1[p], start.b1[p] = second[p] * f.a1[p];
        start.a2[p] = third[p] * f.b2[p], start.b2[p] = third[p] * f.a2[p];
        // As terms to come have it: the product of a constant and a momentum that does not change is rounded in the same way
        // in every step.
        rate[p] = is_steady[p] * (start.b0[p] * f.b0[p]) + (1 - is_steady[p]) * (start.a0[p] * f.a0[p])
                  + (pull[p] * torque[0][p] - swing[p] * torque[1][p] - decay[p] * now[p]);
        s1[p] = start.a1[p] * f.a1[p], s2[p] = start.a2[p] * f.a2[p];
        by_torque[0][p] = pull[p], by_torque[1][p] = -swing[p];
        ahead[p] = (vector){0};
    }
    add_last_half(by_torque[0], start.a1), add_last_half(by_torque[1], start.b1);
    add_last_half(rate, s1);
    for_all(p, parts) now[p] = rate[p];
    q = sum_of_halves(s1, s2);
    for_all(p, parts) s1[p] = s2[p] = (vector){0};

    for (int k = 1;; ++k) {
        // `now` and `q` are term k; `ahead`, `s1` and `s2` the products of the terms 1 to k - 1.
        arrange(now, &q, &f, torque);
        momentum = first_half(now);
        from_halves(&q, &momentum, both);
        for_all(p, parts) memcpy(c + numbers * k + width * p, &both[p], sizeof *both);
        if (k == order) return;
        const struct share s = share_of(share, share_rest, k);
        for_all(p, parts) {
            s1[p] += start.b1[p] * f.b1[p], s2[p] += start.b2[p] * f.b2[p];
            s1[p] += start.a1[p] * f.a1[p], s2[p] += start.a2[p] * f.a2[p];
            rate[p] = ((ahead[p] - decay[p] * now[p]) + start.a0[p] * f.a0[p] + by_torque[1][p] * torque[1][p])
                      + (start.b0[p] * f.b0[p] + by_torque[0][p] * torque[0][p]);
            now[p] = scaled(rate[p], s);
        }
        q = scaled_half(sum_of_halves(s1, s2), s);
        // What the next term needs of those before it does not wait for that.
        if (k + 1 == order) continue;
        if (k == 1) {
            for_all(p, parts) {
                next.a0[p] = first[p] * f.b0[p], next.b0[p] = first[p] * f.a0[p];
                next.a1[p] = second[p] * f.b1[p], next.b1[p] = second[p] * f.a1[p];
                next.a2[p] = third[p] * f.b2[p], next.b2[p] = third[p] * f.a2[p];
                ahead[p] = next.a0[p] * f.a0[p];
                s1[p] = next.a1[p] * f.a1[p], s2[p] = next.a2[p] * f.a2[p];
            }
            add_last_half(ahead, s1);
            continue;
        }
        for_all(p, parts) {
            ahead[p] = next.a0[p] * f.a0[p] + next.b0[p] * f.b0[p];
            s1[p] = next.a1[p] * f.a1[p] + next.b1[p] * f.b1[p];
            s2[p] = next.a2[p] * f.a2[p] + next.b2[p] * f.b2[p];
        }
        for_all(p, parts) f.a0[p] *= first[p], f.a1[p] *= second[p], f.a2[p] *= third[p];
        row[k] = f;
        add_inner_products(k, row, ahead, s1, s2, &later);
        add_last_half(ahead, s1);
    }
}
