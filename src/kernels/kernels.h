// What C and Fortran share: the kernels, and the types of their arguments, which kernel_types.f90 has in Fortran.
//
// A kernel has a build for each level of the processor (processor.c): kernels_v2.c, kernels_v3.c and kernels_v4.c are tables of
// them, of which kernels.c chooses one when the program starts.

#include <stdint.h>

// Numbers in a state and in a term of a series, what a stage sets aside, and the highest order, as in kernel_types.f90;
// instants, as in motions.f90.
enum { numbers = 8, half = numbers / 2, set_aside = 3 * half, highest_order = 30, most_terms = highest_order + 1 };
enum { instants = 8 };

// The rows of the terms of motions in lanes, one number of each lane in a row, as lane_series.f90 has them.
enum { lanes = 8, rows = 9, term = lanes * rows, more_rows = 36, more = lanes * more_rows };

// The rows of a term of the series.
enum { w1, w2, w3, g1, g2, g3, angle, quotient, numerator };

enum { most_drags = 2 };

// Constants of a symmetric top in space axes: I1, m g l/I1 and w3 = L_z/I1.
struct symmetric_top {
    double inertia, pull, turn_rate;
};

// A body and what acts on it, for the constants of its series (top/effects.f90). Of what vibrates, in this order: the pivot,
// and a torque in space axes and one in body axes.
struct body_numbers {
    double inertia[3], centre[3], damping[3], axis[3], drag_moment[3], rotor[3], drive[3], torque_body[3], torque_space[3];
    double frame[3], amplitude[3][3], phase[3][3], rate[3];
    double mass, gravity, friction_torque, friction_arm, smoothing, drag_exponent, drag_force, earth_rate, latitude;
};

// Which parts of the equations there are, the same in all lanes: see kernel_types.f90 and series/motion_series.h.
struct motion_kinds {
    int rotor, frame, torque, push, drags, harmonic, table, friction, law, given;
};

// Bodies in lanes, or changes of them: the numbers by which their motions are expanded.
struct lane_body {
    double coupling[3][lanes], decay[3][lanes], pull[3][lanes], swing[3][lanes];
};

// Symmetric tops to be computed together, and what is found: see kernel_types.f90.
enum { block_size = 512, block_data = 11 };
struct exact_block {
    double inertia1[block_size], inertia3[block_size], mgl[block_size], theta[block_size], phi_rate[block_size],
        theta_rate[block_size], omega3[block_size], phi[block_size], psi[block_size], t_end[block_size], t_period[block_size];
    double theta_min[block_size], theta_max[block_size], u_min[block_size], delta_u[block_size], period[block_size],
        precession[block_size], precession_rate[block_size], phi_rate_max[block_size];
    double theta_end[block_size], phi_end[block_size], psi_end[block_size], theta_rate_end[block_size],
        energy_error[block_size];
    double phi_at_period[block_size];
    long long doubt[block_size];
    int status[block_size], n, fallbacks;
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
