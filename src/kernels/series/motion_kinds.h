// What acts on a body, for motion_series.h: which of its parts are compiled, and which rows turn with the body.

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
#define for_single_effects(build)                                                                                 \
    build(.drags = 0) build(.frame = along) build(.frame = anyhow) build(.torque = along) build(.torque = anyhow) \
        build(.push = along) build(.push = anyhow) build(.drags = of_moment + 1) build(.drags = of_force + 1)
