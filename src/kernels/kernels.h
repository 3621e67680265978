// What C and Fortran share: the kernels, and the types of their arguments, which kernel_types.f90 has in Fortran.
//
// A kernel has a build for each level of the processor (processor.c): kernels_v2.c, kernels_v3.c and kernels_v4.c are tables of
// them, of which kernels.c chooses one when the program starts.

// Numbers in a state and in a term of a series, what a stage sets aside, and the highest order, as in capabilities.f90;
// instants, as in motions.f90.
enum { numbers = 8, half = numbers / 2, set_aside = 3 * half, highest_order = 30, most_terms = highest_order + 1 };
enum { instants = 8 };

#include "lane_rows.h"

// Constants of the equations of one body: factors of the products of vectors in body_vectors.h.
struct body_products {
    double first[numbers], second[numbers], third[numbers], decay[numbers], pull[numbers], swing[numbers];
};

// The same for stages: those of the angular velocity.
struct stage_factors {
    double inertia[half], mobility[half], coupling[half], decay[half], pull[half], swing[half];
};

// Drag y z of the air, with y = (x.x)^b.
struct drag {
    double speed[3][half], moment[3][half]; // columns of the matrices that make x and z of the angular velocity
    double power;                           // b
};

// Constants of the equations of one body with effects.
struct series_effects {
    double first[numbers], second[numbers], third[numbers], turn_first[numbers], turn_second[numbers];
    double frame[3][half];         // factors of the quaternion in its rate
    double side_frame[2][numbers]; // factors of (Y, X) and of (G, G) in the rates of (X, Y)
    double coupling[half], inverse_inertia[half], damping[half], arm[half], frame_rate[half];
    double torque_body[half], torque_space[half], rotor_torque[half];
    struct drag drag[most_drags];
    double gravity, circle; // of (X, Y), which turn by this rate beside the body where they are the motion of the pivot
    int drags, has_sides, turns, is_driven, vibrates;
};

// The same for stages. The pivot's acceleration in space axes is `swing[0] cos(rate t) + swing[1] sin(rate t)`.
struct stage_effects {
    double mobility[half], coupling[half], damping[half], weight[half], arm[half], drag[half], torque_body[half];
    double rotor[half], drive[half], torque_space[half], frame[half], swing[2][half];
    double gravity, drag_power, drag_force, rate;
    int has_sides, has_rotor, has_drag, vibrates, turns;
};

// Bodies in lanes, or changes of them: the numbers by which their motions are expanded.
struct lane_body {
    double coupling[3][lanes], decay[3][lanes], pull[3][lanes], swing[3][lanes];
};

// Which effects there are, the same in all lanes.
struct lane_kinds {
    int turns, twists, vibrates, drags;
};

// Drag of the air in lanes: the moment -moment v.
struct lane_drag {
    double speed[6][lanes], moment[3][lanes], power[lanes];
};

// Constants of the equations of bodies with effects, a row of lanes for each number.
struct lane_constants {
    double coupling[3][lanes], decay[3][lanes], pull[3][lanes], swing[3][lanes], gravity[lanes];
    double inverse_inertia[3][lanes], torque[3][lanes];
    double rotor[2][3][lanes], drive[2][3][lanes];
    double frame_rate[3][lanes], torque_space[3][lanes];
    double amplitude[3][lanes], phase[3][lanes], rate[lanes];
    struct lane_drag drag[most_drags];
};

// What the slope of the force takes of a body: unit vectors, two beside its centre of mass and one along it, by components,
// and the length of the arm, m; gravity, m/s^2.
struct lane_arm {
    double axes[3][3][lanes], length[lanes], gravity[lanes];
};

// What the work of effects takes of them, all over the scale of the energy.
struct lane_work {
    double damping[3][lanes], linear_drag[3][lanes], drag[most_drags][3][lanes], arm[3][lanes], torque[3][lanes];
    double drive[3][lanes], per_scale[lanes];
};

// body_series.h, top_series.h: terms of the series of a motion.
void spintop_expand_body(int order, const struct body_products *body, const double *state, const double *share, double *c);
void spintop_expand_top(int order, const double *linear, const double *weight, const double *share, const double *state,
                        const double *rate, double fall, double *c);

// effects_series.h: the same with effects. `state` has q, U, G, X, Y and the momentum of the rotor.
void spintop_expand_effects(int order, const struct series_effects *e, const double *state, const double *pivot,
                            const double *share, double *c, int *exists);

// series_terms.h: the time at which the larger of the last two terms reaches the admissible error, not finite if they are not;
// the change after a time h, the sum of all terms but the first; the changes after several times, of one variable after the
// other.
double spintop_length_of_step(int order, const double *c, const double *absolute, const double *relative, const double *scale,
                              double least, double h);
void spintop_add_terms(int order, const double *c, double h, double *change);
void spintop_add_terms_at(int order, const double *c, const double *h, double *change);

// body_stages.h: the stages `from` to `to`, counted from zero, of a step of size h from y. Column i of `a`, `stages` apart, has
// the weights of those before stage i, of which the first and those from number since[i] - 1 on are not zero. Row i of k is the
// slope of quaternion and momentum. Row i of `aside` is the change of quaternion, angular velocity and vertical at this slope,
// over the step; the rows before `from` are known, but row 0 is found here.
void spintop_find_stages(int from, int to, const struct stage_factors *body, const double *y, double h, int stages,
                         const double *a, const int *since, double *k, double *aside);

// effects_stages.h: the same with effects, of a step from the time t; c[i] is the time of a stage in the step. The quaternion
// keeps the norm that it has in y.
void spintop_find_effects_stages(int from, int to, const struct stage_effects *e, double t, const double *y, double h,
                                 const double *a, int stride, const double *c, double *k);

// stage_sums.h: the change of the state over a step of size h, the state after it, with the rounding error `rest` of that
// before, and the logarithm to base 2 of its error in units of the tolerance: the root mean square over the states of the
// errors of the embedded methods, combined to an estimate of order h^8. It is not finite if they are not. `growth` is the
// factor from this step to the next: `most` and `share` are powers of two, the first if the error is the tolerance, and less by
// the second times the logarithm of the error. The stages that enter are the first and those from `since` on, counted from one.
double spintop_sum_stages(int since, int stages, const double *weight, const double *k, const double *y, const double *rest,
                          double h, const double *absolute, const double *relative, int states, double most, double share,
                          double *change, double *y_new, double *growth);

// lane_series.h: terms of the series of motions in lanes, and of their perturbations.
void spintop_expand_lanes(int order, const struct lane_body *b, const double *side, const double *state, const double *share,
                          const double *share_rest, double *c);
void spintop_carry_tangents(int order, const struct lane_body *b, const double *c, const double *duration, const double *pace,
                            int number, const int *which, int free, const struct lane_body *change, const double *before,
                            double *after, double *whole, double *last);

// lane_effects.h, lane_work.h: the same with effects, and their work.
void spintop_expand_affected_lanes(int order, const struct lane_kinds *has, const struct lane_constants *e, const double *t,
                                   const double *side, const double *state, const double *share, const double *share_rest,
                                   double *c, double *x);
void spintop_add_lane_work(int order, const struct lane_kinds *has, const int *acts, const struct lane_work *of,
                           const double *duration, const double *c, const double *x, double *done);

// lane_products.h: products of series in lanes.
void spintop_multiply_lanes(int degree, const double *x, const double *y, double *product);
void spintop_multiply_slopes(int degree, const double *x, const double *y, double *product);
void spintop_square_lanes(int degree, const double *x, double *product);
void spintop_find_force_slopes(int degree, const struct lane_arm *arm, const double *power, const double *c, double *slope,
                               double *first);

// lane_roots.h: where polynomials in lanes pass zero.
void spintop_find_changes(int n, const double *share, double rounding, const double *a, double *noise, double *sign,
                          double *changes, double *near);
void spintop_refine_root(int n, int iterations, double still, const double *a, double *u, double *doubt);

// The builds of all kernels for a level.
struct kernels {
    __typeof__(spintop_expand_body) *expand_body;
    __typeof__(spintop_expand_top) *expand_top;
    __typeof__(spintop_expand_effects) *expand_effects;
    __typeof__(spintop_length_of_step) *length_of_step;
    __typeof__(spintop_add_terms) *add_terms;
    __typeof__(spintop_add_terms_at) *add_terms_at;
    __typeof__(spintop_find_stages) *find_stages;
    __typeof__(spintop_find_effects_stages) *find_effects_stages;
    __typeof__(spintop_sum_stages) *sum_stages;
    __typeof__(spintop_expand_lanes) *expand_lanes;
    __typeof__(spintop_carry_tangents) *carry_tangents;
    __typeof__(spintop_expand_affected_lanes) *expand_affected_lanes;
    __typeof__(spintop_add_lane_work) *add_lane_work;
    __typeof__(spintop_multiply_lanes) *multiply_lanes;
    __typeof__(spintop_multiply_slopes) *multiply_slopes;
    __typeof__(spintop_square_lanes) *square_lanes;
    __typeof__(spintop_find_force_slopes) *find_force_slopes;
    __typeof__(spintop_find_changes) *find_changes;
    __typeof__(spintop_refine_root) *refine_root;
};

// gcc for x86-64 builds all levels; other compilers and processors have one build, with the flags of the file.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define HAS_LEVELS
#endif
extern const struct kernels spintop_kernels_v2, spintop_kernels_v3, spintop_kernels_v4, spintop_kernels_as_built;
