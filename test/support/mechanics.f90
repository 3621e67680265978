!> The words of mechanics that most suites use: bodies, motions, formulations, methods and their runs.
module mechanics
    use spintop_attitude
    use spintop_body
    use spintop_conditioning
    use spintop_errors
    use spintop_exact_motion
    use spintop_formulation
    use spintop_formulations
    use spintop_integration
    use spintop_kinds
    use spintop_methods
    use spintop_motion
    use spintop_status
    use spintop_stepper
    use spintop_suitability
    implicit none
    public
end module mechanics
