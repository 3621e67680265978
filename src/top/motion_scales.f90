!> Scales of a motion, in which its errors are measured, so that errors do not depend on the units of mass,
!> length and time.
module spintop_motion_scales
    use spintop_kinds, only: dp
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: motion_scales_t, motion_scales

    !> Scales of a motion.
    type :: motion_scales_t
        !> Largest angular velocity, rad/s, and angular momentum, kg m^2/s; above zero.
        real(dp) :: rate = 1, momentum = 1
    end type motion_scales_t

contains

    !> Bounds from the energy, which does not increase. They are exact for an undamped symmetric top that
    !> reaches its lowest point, and an order of magnitude for other bodies. A body at rest has the scales of
    !> its small oscillation; without gravitational torque either, those of a rotation at 1 rad/s.
    pure type(motion_scales_t) function motion_scales(body, start) result(scales)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! any instant of the motion: attitude and angular velocity
        real(dp) :: pull, fall, energy, spin, across, middle, largest, moment(3)
        logical :: is_lagrange

        moment = body%weight_moment()
        is_lagrange = body%is_lagrange()
        if (is_lagrange) then
            pull = abs(moment(3))
        else
            pull = norm2(moment)
        end if
        fall = pull + dot_product(moment, vertical_from_quaternion(start%quaternion))
        associate (inertia => body%inertia, omega => start%omega)
            if (is_lagrange) then
                spin = omega(3)
                energy = sum(inertia(1:2) * omega(1:2)**2) / 2 + max(fall, 0.0_dp)
                across = sqrt(max(2 * energy, pull) / inertia(1))
                scales%rate = hypot(across, spin)
                scales%momentum = hypot(inertia(1) * across, inertia(3) * spin)
            else
                largest = maxval(inertia)
                middle = sum(inertia) - largest - minval(inertia)
                energy = sum(inertia * omega**2) / 2 + max(fall, 0.0_dp)
                scales%rate = max(norm2(omega), sqrt(max(2 * energy, pull) / middle))
                scales%momentum = sqrt(max(2 * energy, pull) * largest)
            end if
            if (.not. scales%rate > 0) then
                scales%rate = 1
                scales%momentum = maxval(inertia)
            end if
        end associate
    end function motion_scales

end module spintop_motion_scales
