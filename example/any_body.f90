!> An asymmetric, damped body, integrated by Taylor series; an observer prints its inclination.
module printer
    use spintop, only: dp, formulation_t, max_states, motion_t, observer_t
    implicit none

    type, extends(observer_t) :: printer_t
        integer :: rows = 0
    contains
        procedure :: observe
    end type printer_t

contains

    subroutine observe(self, formulation, t, y, near)
        class(printer_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        type(motion_t) :: motion
        self%rows = self%rows + 1
        motion = formulation%motion(t, y, near)
        print '(a, f4.1, a, f11.8)', 't =', t, ' s: theta =', motion%angle(2)
    end subroutine observe
end module printer

program any_body
    use printer, only: printer_t
    use spintop
    implicit none
    type(body_t) :: body
    class(formulation_t), allocatable :: formulation
    class(stepper_t), allocatable :: stepper
    type(printer_t) :: seen
    type(outcome_t) :: outcome

    body%inertia = [0.9_dp, 0.7_dp, 0.25_dp]
    body%centre_of_mass = [0.05_dp, 0.0_dp, 0.8_dp]
    body%damping = 0.01_dp ! N m s
    call create_formulation('rigid_body', formulation)
    call create_stepper('taylor', stepper)
    stepper%controls%relative_tolerance = 1.0e-12_dp
    call integrate(formulation, stepper, body, &
                   motion_from_angles(0.0_dp, [0.0_dp, 0.2_dp, 0.0_dp], [0.0_dp, 0.0_dp, 5.0_dp]), &
                   2.0_dp, [0.5_dp, 1.0_dp, 1.5_dp, 2.0_dp], seen, outcome)
    print '(i0, 2a)', seen%rows, ' rows, status: ', status_name(outcome%status)
end program any_body
