!> The attitude of a symmetric top at an instant, as a product of theta functions, and its angles. They are compiled by
!> themselves: inlined into several procedures they would be rounded in several ways, as products and sums are contracted
!> there.
module spintop_symmetric_attitude
    use spintop_kinds, only: dp, xp, pi_xp, no_number
    use spintop_nutation, only: nutation_t
    use spintop_circular_functions, only: argument, unit
    use spintop_theta_functions, only: theta_values_t
    use spintop_theta_motion, only: theta_motion_t, regime_resting
    implicit none
    private
    public :: symmetric_motion_t, attitude_t, find_attitude, find_thetas, find_angles_of_attitude

    !> The exact solution for one top and one start. It does not change after its preparation, so threads may
    !> share it.
    type :: symmetric_motion_t
        !> Quantities that do not depend on time.
        type(nutation_t), public :: nutation
        !> Start, turning points and theta functions.
        type(theta_motion_t) :: theta
        !> Phases of the upper and the lower component at the start, rad; their rates, and the difference of these, rad/s.
        real(xp) :: upper_phase = 0, lower_phase = 0
        real(xp) :: upper_rate = 0, lower_rate = 0, difference_rate = 0
        !> The components at the start, which an axis at rest keeps. NaN before the preparation, so that any
        !> motion is NaN then.
        complex(dp) :: upper = (no_number, no_number), lower = (no_number, no_number)
        real(dp) :: omega3 = no_number
        !> Number of nutations, and of passages of theta = pi, before the start.
        real(xp) :: tops_before = 0, bottoms_before = 0
        !> Whether there are exact passages of a pole.
        logical :: passes_pole = .false.
    end type symmetric_motion_t

    !> The attitude at an instant, and intermediate results. Without initial values, because it is filled for
    !> every sample.
    type :: attitude_t
        !> The two Cayley-Klein components, and the rotating factors by which U and L are multiplied.
        complex(dp) :: upper, lower, upper_turn, lower_turn
        type(theta_values_t) :: theta
        !> Time since the start, s, and the number of nutations subtracted from the argument.
        real(xp) :: elapsed, nutations
        logical :: rising  !! moving from u1 to u2
    end type attitude_t

contains

    !> The Cayley-Klein components at time t.
    pure subroutine find_attitude(self, t, now)
        type(symmetric_motion_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        type(attitude_t), intent(out) :: now
        call find_thetas(self, t, now)
        if (self%theta%regime == regime_resting) then
            now%upper = self%upper * unit(self%upper_rate * now%elapsed)
            now%lower = self%lower * unit(self%lower_rate * now%elapsed)
            return
        end if

        associate (clock => self%theta%clock)
            now%upper_turn = unit(self%upper_phase + self%upper_rate * now%elapsed &
                                  + now%nutations * clock%upper_step) &
                             * (clock%upper_amplitude / now%theta%divisor)
            now%lower_turn = unit(self%lower_phase + self%lower_rate * now%elapsed &
                                  + now%nutations * clock%lower_step) &
                             * (clock%lower_amplitude / now%theta%divisor)
            now%upper = now%upper_turn * now%theta%upper
            now%lower = now%lower_turn * now%theta%lower
        end associate
    end subroutine find_attitude

    !> The theta functions at time t, of which the axis at rest has none, and what else does not depend on the phases.
    pure subroutine find_thetas(self, t, now)
        type(symmetric_motion_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        type(attitude_t), intent(inout) :: now !! its theta functions and its times
        real(dp) :: z, from_top

        now%elapsed = t - self%theta%time
        if (self%theta%regime == regime_resting) return
        call self%theta%locate(now%elapsed, z, from_top, now%nutations)
        call self%theta%evaluate(z, from_top, now%theta)
        now%rising = z >= 0
    end subroutine find_thetas

    !> Angles, with all turns of phi and psi, and their rates.
    pure subroutine find_angles_of_attitude(self, attitude, angle, rate)
        type(symmetric_motion_t), intent(in) :: self
        type(attitude_t), intent(in) :: attitude !! the theta functions at an instant
        real(dp), intent(out) :: angle(3), rate(3) !! phi, theta, psi, rad, and their rates, rad/s
        real(xp) :: total, difference
        real(dp) :: sn2, cn2, range, one_minus_u, one_plus_u, u, y, sine, dn, upper, lower

        total = self%upper_phase + self%lower_phase + self%theta%clock%sum_rate * attitude%elapsed
        difference = self%upper_phase - self%lower_phase + self%difference_rate * attitude%elapsed
        if (self%theta%regime == regime_resting) then
            angle = [real(total, dp), 2 * atan2(abs(self%lower), abs(self%upper)), real(difference, dp)]
            rate = [0.0_dp, 0.0_dp, self%omega3]
            return
        end if

        associate (points => self%theta, clock => self%theta%clock, theta => attitude%theta)
            sn2 = theta%sn**2
            cn2 = theta%cn**2
            range = real(points%roots%u2_minus_u1, dp)
            one_minus_u = real(points%roots%one_minus_u2, dp) + range * cn2
            one_plus_u = real(points%roots%one_plus_u1, dp) + range * sn2
            u = (one_plus_u - one_minus_u) / 2
            sine = sqrt(one_minus_u * one_plus_u)

            if (self%passes_pole) call add_jumps(self, attitude, total, difference)
            total = total + attitude%nutations * (clock%upper_step + clock%lower_step)
            difference = difference + attitude%nutations * (clock%upper_step - clock%lower_step)
            upper = argument(theta%upper)
            lower = argument(theta%lower)
            angle = [real(total + (upper + lower), dp), argument(cmplx(u, sine, dp)), &
                            real(difference + (upper - lower), dp)]

            if (sn2 < cn2) then
                y = real(points%roots%y1, dp) + range * sn2
            else
                y = real(points%roots%y2, dp) - range * cn2
            end if
            if (sine > 0) then
                dn = sqrt(real(points%roots%complement_squared, dp) + real(points%roots%k_squared, dp) * cn2)
                rate(1) = turn_at(points, y, one_minus_u, one_plus_u) / (one_minus_u * one_plus_u)
                rate(2) = -2 * range * real(points%roots%frequency, dp) * theta%sn * theta%cn * (dn / sine)
            else
                rate(1) = 0
                rate(2) = sqrt(real(points%swing_squared, dp) - real(points%beta, dp) * y)
            end if
            rate(3) = self%omega3 - rate(1) * u
        end associate
    end subroutine find_angles_of_attitude

    !> phi' sin(theta)^2 = b - a u, rad/s, in the form that cancels least.
    pure real(dp) function turn_at(points, y, one_minus_u, one_plus_u) result(turn)
        type(theta_motion_t), intent(in) :: points
        real(dp), intent(in) :: y, one_minus_u, one_plus_u
        real(dp) :: a, constant(3), slope(3)
        a = real(points%a, dp)
        ! From the start, from the top and from the bottom.
        constant = real([points%turn, points%b_minus_a, points%b_plus_a], dp)
        slope = [-a * y, a * one_minus_u, -a * one_plus_u]
        associate (form => minloc(abs(constant) + abs(slope), dim=1))
            turn = constant(form) + slope(form)
        end associate
    end function turn_at

    !> Half turns of phi and psi at exact passages of a pole. The theta functions turn in the same direction
    !> each time; counted here are half turns of alternating sign.
    pure subroutine add_jumps(self, attitude, phi, psi)
        type(symmetric_motion_t), intent(in) :: self
        type(attitude_t), intent(in) :: attitude
        real(xp), intent(inout) :: phi, psi  !! the angles, to which half turns are added, rad
        real(xp) :: tops, bottoms, top_jump, bottom_jump
        top_jump = 0
        bottom_jump = 0
        if (self%nutation%passes_top) then
            tops = attitude%nutations - self%tops_before
            top_jump = pi_xp * (modulo(tops, 2.0_xp) - sign(1.0_xp, self%theta%b_minus_a) * tops)
        end if
        if (self%nutation%passes_bottom) then
            bottoms = merge(attitude%nutations, attitude%nutations - 1, attitude%rising) &
                      - self%bottoms_before
            bottom_jump = pi_xp * (modulo(bottoms, 2.0_xp) - sign(1.0_xp, self%theta%b_plus_a) * bottoms)
        end if
        phi = phi + bottom_jump + top_jump
        psi = psi + bottom_jump - top_jump
    end subroutine add_jumps

end module spintop_symmetric_attitude
