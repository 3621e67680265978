!> A thousand asymmetric bodies, of which the vector lanes of Taylor's method integrate eight at a time.
program many_bodies
    use spintop
    implicit none
    integer, parameter :: n = 1000
    type(body_t) :: bodies(n)
    type(motion_t) :: starts(n), ends(n)
    type(outcome_t) :: outcomes(n)
    type(controls_t) :: controls
    real(dp) :: spans(n), largest
    integer :: i

    starts = motion_from_angles(0.0_dp, [0.0_dp, 0.2_dp, 0.0_dp], [0.0_dp, 0.0_dp, 5.0_dp])
    spans = 2
    bodies%mass = 1
    do i = 1, n
        bodies(i)%inertia = [0.9_dp, 0.6_dp + 0.4_dp * i / n, 0.25_dp]
        bodies(i)%centre_of_mass = [0.05_dp, 0.0_dp, 0.8_dp]
    end do
    controls%relative_tolerance = 1.0e-13_dp
    call integrate_many(controls, bodies, starts, spans, ends, outcomes)

    print '(i0, a)', count(is_good_end(outcomes%status)), ' bodies completed'
    do i = n / 4, n, n / 4
        print '(a, f5.2, a, f12.9)', 'I2 =', bodies(i)%inertia(2), ' kg m^2: theta after 2 s =', ends(i)%angle(2)
    end do
    largest = 0
    do i = 1, n
        largest = max(largest, abs(energy(bodies(i), ends(i)) - energy(bodies(i), starts(i))))
    end do
    print '(a, es8.1, a)', 'largest change of an energy:', largest, ' J'

contains

    real(dp) function energy(body, motion)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: motion
        energy = kinetic_energy(body, motion) + potential_energy(body, motion)
    end function energy
end program many_bodies
