!> How fast a motion may become: the units of its own in which errors are measured, so that these do
!> not depend on the units of mass, length and time.
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

    !> Bounds from the energy, which does not rise: exact at the lowest place of an undamped symmetric
    !> top that reaches it, and the order of magnitude for other bodies. A body at rest has the scales
    !> of its small oscillation, and one without gravity torque, too, those of 1 rad/s.
    pure type(motion_scales_t) function motion_scales(body, start) result(scales)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! any instant of the motion: attitude and angular velocity
        real(dp) :: pull, fall, energy, spin, across, middle, largest

        pull = norm2(body%weight_moment())
        fall = pull + dot_product(body%weight_moment(), vertical_from_quaternion(start%quaternion))
        associate (inertia => body%inertia, omega => start%omega)
            if (body%is_lagrange()) then
                spin = omega(3)
                energy = sum(inertia(1:2) * omega(1:2)**2) / 2 + max(fall, 0.0_dp)
                across = sqrt(max(2 * energy, pull) / inertia(1))
                scales%rate = norm2([across, spin])
                scales%momentum = norm2([inertia(1) * across, inertia(3) * spin])
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
