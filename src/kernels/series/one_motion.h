// The series of one body with effects, of quaternion and momentum: `c`, of which term 0 is the state. Returns whether there is
// one.

inlined int NAME(expand_with)(const struct motion_kinds *has, int joins, int order, const struct NAME(constants) * e, num t,
                              const element *state, const double *table, const double *law, const element *given,
                              const element *share, const element *share_rest, element *c) {
    element terms[NAME(rows) * most_terms] __attribute__((aligned(64))),
        more[NAME(more) * most_terms] __attribute__((aligned(64)));
    struct NAME(start) of;
    element *const x = more;
    for_all(i, numbers) c[i] = state[i];
    of.given = given;
    for_all(i, 10) of.law[i / 5][i % 5] = has->law ? law[i] : 0;
    NAME(begin)(has, 0, e, t, 0, state, table, &of, terms, more);
    NAME(expand)(has, joins, order, e, &of, share, share_rest, terms, more, c);
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
