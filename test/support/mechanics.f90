!> The words of mechanics that most suites use: bodies, motions, formulations, methods and their runs, and what suites
!> have for them.
module mechanics
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
    use spintop_methods
    use spintop_motion
    use spintop_nutation
    use spintop_quantities
    use spintop_relative_equilibrium
    use spintop_status
    use spintop_steady_motion
    use spintop_stepper
    use spintop_tangent_flow
    use event_log
    use known_tops
    use random_stream
    use recorder
    use reference_rows
    use runs
    use symmetric_cases
    implicit none
    public
end module mechanics
