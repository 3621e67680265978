!> The words of mechanics that most suites use: bodies, motions, formulations, methods and their runs.
module tested
    use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_attitude
    use spintop_body
    use spintop_body_turn
    use spintop_kinds
    use spintop_conditioning
    use spintop_effects
    use spintop_errors
    use spintop_euler_poisson
    use spintop_events
    use spintop_exact_motion
    use spintop_floquet
    use spintop_force_extremes
    use spintop_formulation
    use spintop_formulations
    use spintop_integration
    use spintop_lyapunov, only: find_largest_singular_value, find_lyapunov, growth_lanes_t
    use spintop_methods
    use spintop_motion
    use spintop_nutation
    use spintop_quantities
    use spintop_relative_equilibrium
    use spintop_status
    use spintop_steady_motion
    use spintop_stepper
    use spintop_tangent_flow
    use spintop_taylor_lanes, only: integrate_many, monitor_slot_t, taylor_lanes_t
    implicit none
    public
end module tested
