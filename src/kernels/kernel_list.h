// All kernels: PROCEDURE(name, (arguments), parameters), or FUNCTION, whose result is a double. Included where they are
// declared (kernels.h), where a table has the builds for a level (kernels_of_level.h), and where Fortran calls them, by their
// names with spintop_ before (kernels.c).

// top_series.h: terms of the series of the motion of a symmetric top, and of their denominator.
PROCEDURE(expand_top, (order, top, state, share, share_rest, c), int order, const struct symmetric_top *top,
          const double *state, const double *share, const double *share_rest, double *c)

// series/motion_series.h: the same of any body, whose constants are set first. `table` has the terms of a torque over time in
// space axes, `law` those of friction by a table towards smaller and larger angular velocities, after the one they are about,
// `given` all terms of torques over time in body axes.
PROCEDURE(one_set, (body, lane, constants), const struct body_numbers *body, int lane, double *constants)
PROCEDURE(expand_body, (order, has, constants, t, state, table, law, given, c, exists), int order,
          const struct motion_kinds *has, const double *constants, double t, const double *state, const double *table,
          const double *law, const double *given, double *c, int *exists)

// series_terms.h: a step, whose size is returned, not finite if terms are not: the time at which the larger of the last two
// terms reaches the admissible error, times `safety`, and `growth` times the last size at most; it is stretched to the end
// where that suffices. `rest` is the rounding error of the state. And the change of the state after a time h, the sum of all
// terms but the first; the changes after several times, of one variable after the other.
FUNCTION(take_step,
         (order, of_denominator, turn_rate, c, absolute, relative, scale, least, last_h, safety, growth, stretch, t, t_end, y,
          rest, t_new, y_new, rest_new),
         int order, int of_denominator, double turn_rate, const double *c, const double *absolute, const double *relative,
         const double *scale, double least, double last_h, double safety, double growth, double stretch, double t, double t_end,
         const double *y, const double *rest, double *t_new, double *y_new, double *rest_new)
PROCEDURE(add_terms, (order, of_denominator, turn_rate, c, y, h, change), int order, int of_denominator, double turn_rate,
          const double *c, const double *y, double h, double *change)
PROCEDURE(add_terms_at, (order, of_denominator, turn_rate, c, y, h, change), int order, int of_denominator, double turn_rate,
          const double *c, const double *y, const double *h, double *change)

// body_stages.h: the stages `from` to `to`, counted from zero, of a step of size h from y at the time t; c[i] is the time of a
// stage in the step. Column i of `a`, `stages` apart, has the weights of those before stage i, of which the first and those
// from number since[i] - 1 on are not zero. Row i of k is the slope of quaternion and momentum. With effects (is_affected) the
// quaternion keeps the norm that it has in y. Without, row i of `aside` is the change of quaternion, angular velocity and
// vertical at this slope, over the step; the rows before `from` are known, but row 0 is found here.
PROCEDURE(find_stages, (from, to, is_affected, has, constants, t, y, h, stages, a, since, c, k, aside), int from, int to,
          int is_affected, const struct motion_kinds *has, const double *constants, double t, const double *y, double h,
          int stages, const double *a, const int *since, const double *c, double *k, double *aside)

// dop853_error.h: the change of the state over a step of size h, the state after it, with the rounding error `rest` of that
// before, and the logarithm to base 2 of its error in units of the tolerance: the root mean square over the states of the
// errors of the embedded methods, combined to an estimate of order h^8. It is not finite if they are not. `growth` is the
// factor from this step to the next: `most` and `share` are powers of two, the first if the error is the tolerance, and less by
// the second times the logarithm of the error. The stages that enter are the first and those from `since` on, counted from one.
FUNCTION(sum_stages, (since, stages, weight, k, y, rest, h, absolute, relative, states, most, share, change, y_new, growth),
         int since, int stages, const double *weight, const double *k, const double *y, const double *rest, double h,
         const double *absolute, const double *relative, int states, double most, double share, double *change, double *y_new,
         double *growth)

// lane_series.h: terms of the series of motions in lanes, and of their perturbations.
PROCEDURE(expand_lanes, (order, b, side, state, c), int order, const struct lane_body *b, const double *side,
          const double *state, double *c)
PROCEDURE(carry_tangents, (order, b, c, duration, pace, number, before, after, whole, last), int order,
          const struct lane_body *b, const double *c, const double *duration, const double *pace, int number,
          const double *before, double *after, double *whole, double *last)

// series/motion_series.h: the same with effects, whose constants are set lane by lane.
PROCEDURE(lanes_set, (body, lane, constants), const struct body_numbers *body, int lane, double *constants)
PROCEDURE(expand_affected_lanes, (order, has, constants, t, side, state, c, x), int order, const struct motion_kinds *has,
          const double *constants, const double *t, const double *side, const double *state, double *c, double *x)

// lane_products.h: products of series in lanes.
PROCEDURE(multiply_lanes, (degree, x, y, product), int degree, const double *x, const double *y, double *product)
PROCEDURE(multiply_slopes, (degree, x, y, product), int degree, const double *x, const double *y, double *product)
PROCEDURE(square_lanes, (degree, x, product), int degree, const double *x, double *product)
PROCEDURE(find_force_slopes, (degree, axes, arm, gravity, power, c, slope, first), int degree, const double *axes,
          const double *arm, const double *gravity, const double *power, const double *c, double *slope, double *first)

// lane_steps.h: lengths of the steps of motions in lanes, what is in them, and where they end.
PROCEDURE(choose_durations,
          (order, absolute, relative, growth, safety, stretch, shortest, most, c, scale, t, t_end, steps, h, duration, trouble),
          int order, double absolute, double relative, double growth, double safety, double stretch, double shortest,
          int64_t most, const double *c, const double *scale, const double *t, const double *t_end, const int64_t *steps,
          double *h, double *duration, int64_t *trouble)
PROCEDURE(rows_at, (many, order, c, t, states), int many, int order, const double *c, const double *t, double *states)
PROCEDURE(add_steps, (order, c, duration, t_end, t_last, t, state, rest), int order, const double *c, const double *duration,
          const double *t_end, double *t_last, double *t, double *state, double *rest)

// lane_roots.h: where polynomials in lanes pass zero.
PROCEDURE(find_changes, (n, share, rounding, a, noise, sign, changes, near), int n, const double *share, double rounding,
          const double *a, double *noise, double *sign, double *changes, double *near)
PROCEDURE(refine_root, (n, iterations, still, a, u, doubt), int n, int iterations, double still, const double *a, double *u,
          double *doubt)

// closed_form/top_lanes.h: the exact solution of the tops of a block: the quantities of a whole nutation, the motion at the end
// of the span, and phi at another time.
PROCEDURE(find_tops, (wants_end, wants_period, block), int wants_end, int wants_period, struct exact_block *block)

#undef PROCEDURE
#undef FUNCTION
