// What C and Fortran share: the kernels, and the types of their arguments, which kernel_types.f90 has in Fortran.
//
// A kernel has a build for each level of the processor (processor.c): kernels_v2.c, kernels_v3.c and kernels_v4.c are tables of
// them, of which kernels.c chooses one when the program starts.

// Numbers in a state and in a term of a series, what a stage sets aside, and the highest order, as in kernel_types.f90;
// instants, as in motions.f90.
enum { numbers = 8, half = numbers / 2, set_aside = 3 * half, highest_order = 30, most_terms = highest_order + 1 };
enum { instants = 8 };

#include "many_bodies/lane_rows.h"

// Constants of the equations of one body: factors of the products of vectors in body_vectors.h.
struct body_products {
    double first[numbers], second[numbers], third[numbers], decay[numbers], pull[numbers], swing[numbers];
    double is_steady[numbers]; // 1 where the factor a0 of a product is steadier than b0
};

// The same for stages: those of the angular velocity.
struct stage_factors {
    double inertia[half], mobility[half], coupling[half], decay[half], pull[half], swing[half];
};

// Constants of a symmetric top in space axes: I1, m g l/I1 and w3 = L_z/I1.
struct symmetric_top {
    double inertia, pull, turn_rate;
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
    double coupling[half], is_steady[half], inverse_inertia[half], damping[half], arm[half], frame_rate[half];
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

// As Fortran calls them.
#define PROCEDURE(name, arguments, ...) void spintop_##name(__VA_ARGS__);
#define FUNCTION(name, arguments, ...) double spintop_##name(__VA_ARGS__);
#include "kernel_list.h"

// The builds of all kernels for a level.
#define PROCEDURE(name, arguments, ...) __typeof__(spintop_##name) *name;
#define FUNCTION PROCEDURE
struct kernels {
#include "kernel_list.h"
};

// gcc for x86-64 builds all levels; other compilers and processors have one build, with the flags of the file.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define HAS_LEVELS
#endif
extern const struct kernels spintop_kernels_v2, spintop_kernels_v3, spintop_kernels_v4, spintop_kernels_as_built;
