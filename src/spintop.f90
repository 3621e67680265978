!> The public interface of the library: what a program that uses spintop needs.
!>
!>     type(body_t) :: body
!>     type(exact_motion_t) :: exact
!>     body%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
!>     body%centre_of_mass(3) = sqrt(0.75_dp)
!>     call prepare_exact_motion(body, motion_from_angles(0.0_dp, angle, rate), exact, status)
!>     motion = exact%at(2.0_dp)
module spintop
    use spintop_kinds, only: dp
    use spintop_errors, only: error_t
    use spintop_status, only: status_ok, is_good_end, status_name, status_meaning, status_names, status_pole, &
        status_non_finite, status_step_limit, status_not_converged, status_step_too_small, &
        status_turning_point, status_outside, status_unsuitable, status_integrator, status_bad_input, &
        status_bad_body, status_bad_start, status_bad_tolerance, status_bad_span, status_bad_samples, &
        status_bad_events, status_bad_projection, status_no_steps, status_no_structure, &
        status_stuck_at_turn, status_unknown_name, status_too_many_events, status_at_rest, &
        status_bad_steps, status_no_fixed_steps, status_bad_table
    use spintop_validity, only: body_status, start_status
    use spintop_body, only: body_t
    use spintop_effects, only: effects_t
    use spintop_motion, only: motion_t, motion_from_angles, motion_from_quaternion
    use spintop_checked_functions, only: kinetic_energy, potential_energy, vertical_momentum, &
        axial_momentum, euler_residuals, support_force, axis_tip, axis_height_rate, &
        euler_poisson_state, critical_omega3, fast_top
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_conditioning, only: conditioning_t, prepare_conditioning, inherent_error
    use spintop_force_extremes, only: force_extremes_t, find_force_extremes
    use spintop_exact_block, only: exact_block_t, block_size, compute_block
    use spintop_nutation, only: nutation_t, find_nutation, class_name
    use spintop_steady_motion, only: steady_rates, steady_rates_at_spin, fast_top_t, find_permanent_rotation, permanent_rate
    use spintop_relative_equilibrium, only: find_equilibrium_eigenvalues
    use spintop_floquet, only: find_multipliers, find_monodromy
    use spintop_lyapunov, only: find_largest_singular_value, find_lyapunov
    use spintop_tangent_flow, only: propagate_tangents
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states
    use spintop_formulations, only: formulation_infos, create_formulation
    use spintop_stepper, only: stepper_t, method_info_t, controls_t, counts_t
    use spintop_fixed_step, only: fixed_step_t
    use spintop_runge_kutta, only: runge_kutta_t, explicit_table
    use spintop_arkode, only: tableau_t, parse_tableau, create_tableau_stepper
    use spintop_methods, only: can_run, create_stepper, method_infos, register_method
    use spintop_events, only: event_t, event_search_t, path_t
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_taylor_lanes, only: integrate_many
    use spintop_execution, only: run_study
    use spintop_loaded_table, only: read_table, table_t
    use spintop_text, only: string_t
    implicit none
    public
end module spintop
