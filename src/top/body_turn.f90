!> Rotations of the body axes to axes that the methods need: to the principal axes of a body that is given by an
!> inertia tensor; and those that make a Lagrange top of a body whose symmetry axis is body x or y, or whose centre of
!> mass lies below the pivot on body z.
!>
!> The rotated axes of a Lagrange top have the symmetry axis along z and the centre of mass at or above the pivot.
!> Results that are computed in rotated axes are rotated back to the axes in which the body was given.
!>
!> The same for effects that only add constants to the rates of phi and psi: a rotor with constant momentum h on the
!> axis, and a frame that turns with s about the vertical. With the rates phi' + s and psi' + h/I3 the body moves as
!> a top without effects.
module spintop_body_turn
    use spintop_kinds, only: dp, pi, is_zero
    use spintop_attitude, only: quaternion_product, conjugate_quaternion, &
        angles_from_quaternion, rates_from_omega, to_space
    use spintop_body, only: body_t
    use spintop_effects, only: effect_axial_rotor, effect_upright_frame
    use spintop_given_axes, only: given_axes_t, unshifted
    use spintop_motion, only: motion_t, motion_from_angles, motion_from_quaternion
    use spintop_principal_axes, only: clear_rounding, find_principal_axes
    implicit none
    private
    public :: body_turn_t, find_body_turn, turn_to_principal_axes, shift_effects

    !> The effects on a symmetric top about body z that only add constants to the rates of phi and psi.
    integer, parameter :: shift_effects = effect_upright_frame + effect_axial_rotor

    !> A rotation of the body axes by a quaternion p: the vector v becomes p v conj(p).
    type :: body_turn_t
        !> Whether the body is rotated to its principal axes first.
        logical :: to_principal_axes = .false.
        !> The symmetry axis was (principal) axis x, y or z (1, 2, 3); 0 if there is no rotation of it.
        integer :: axis = 0
        !> The direction of the axis is reversed by the rotation.
        logical :: flipped = .false.
        !> What effects add to the rates of phi and psi, rad/s.
        real(dp) :: phi_shift = 0, psi_shift = 0
        !> The whole rotation, and that to principal axes.
        real(dp), private :: p(4) = [1, 0, 0, 0], principal(4) = [1, 0, 0, 0]
    contains
        procedure :: is_turned
        procedure :: is_shifted
        procedure :: exchanges_axes
        procedure :: turned_body
        procedure :: turned_motion
        procedure :: back
        procedure :: vector
    end type body_turn_t

    !> Half a turn about x, which reverses y and z.
    real(dp), parameter :: flip(4) = [0, 1, 0, 0]
    !> Cyclic permutations that bring body x, y, z to z.
    real(dp), parameter :: exchange(4, 3) = reshape([ &
        0.5_dp, -0.5_dp, -0.5_dp, -0.5_dp, 0.5_dp, 0.5_dp, 0.5_dp, 0.5_dp, &
        1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], [4, 3])

contains

    !> The rotation that gives a body principal axes and makes a Lagrange top of it; none if it needs none.
    pure type(body_turn_t) function find_body_turn(body) result(turn)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(body_turn_t) :: trial
        type(body_t) :: turned
        real(dp) :: moments(3)
        integer :: axis, sense

        if (body%is_lagrange()) return
        if (body%has_products()) then
            call find_principal_axes(body%inertia, body%products, moments, turn%principal)
            turn%to_principal_axes = .true.
            turn%p = turn%principal
            turned = turn%turned_body(body)
            if (turned%is_lagrange()) return
        else if (allocated(body%effects)) then
            trial = with_shifts(trial, body)
            turned = trial%turned_body(body)
            if (turned%is_lagrange()) then
                turn = trial
                return
            end if
        end if
        do axis = 3, 1, -1
            do sense = 1, 2
                trial = turn
                trial%axis = axis
                trial%flipped = sense == 2
                trial%p = exchange(:, axis)
                if (trial%flipped) trial%p = quaternion_product(flip, trial%p)
                if (turn%to_principal_axes) trial%p = quaternion_product(trial%p, turn%principal)
                if (allocated(body%effects)) trial = with_shifts(trial, body)
                turned = trial%turned_body(body)
                if (.not. turned%is_lagrange()) cycle
                turn = trial
                return
            end do
        end do
    end function find_body_turn

    !> A rotation with what the effects on a body add to the rates of the angles, if they do no more.
    pure type(body_turn_t) function with_shifts(rotation, body) result(turn)
        type(body_turn_t), intent(in) :: rotation
        type(body_t), intent(in) :: body
        type(body_t) :: turned
        turn = rotation
        turned = rotation%turned_body(body)
        if (.not. turned%effects%only(shift_effects)) return
        turn%phi_shift = turned%effects%frame_rate(3)
        turn%psi_shift = turned%effects%rotor_momentum(3) / turned%inertia(3)
    end function with_shifts

    !> Whether the computation has a rotation, or other rates of the angles.
    elemental logical function is_turned(self)
        class(body_turn_t), intent(in) :: self
        is_turned = self%axis > 0 .or. self%to_principal_axes .or. self%is_shifted()
    end function is_turned

    !> Whether effects add to the rates of the angles.
    elemental logical function is_shifted(self)
        class(body_turn_t), intent(in) :: self
        is_shifted = .not. (is_zero(self%phi_shift) .and. is_zero(self%psi_shift))
    end function is_shifted

    !> Whether body z is not along the z axis of the rotated axes.
    elemental logical function exchanges_axes(self)
        class(body_turn_t), intent(in) :: self
        exchanges_axes = self%axis == 1 .or. self%axis == 2 .or. self%to_principal_axes
    end function exchanges_axes

    !> The body in rotated axes; without effects, where they are in the rates of the angles.
    pure type(body_t) function turned_body(self, body) result(turned)
        class(body_turn_t), intent(in) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        turned = body
        if (self%to_principal_axes) call turn_to_principal_axes(body, turned)
        if (self%is_shifted()) deallocate (turned%effects)
        if (self%exchanges_axes() .or. self%is_shifted()) then
            turned%given = given_axes_t(self%exchanges_axes(), self%p, self%phi_shift, self%psi_shift)
        end if
        if (self%axis == 0) return
        turned%inertia = cshift(turned%inertia, self%axis)
        turned%damping = cshift(turned%damping, self%axis)
        turned%centre_of_mass = reordered(self, turned%centre_of_mass)
        if (.not. allocated(turned%effects)) return
        turned%effects%rotor_momentum = reordered(self, turned%effects%rotor_momentum)
    end function turned_body

    !> A body in its principal axes, and the rotation to them: the vector v becomes p v conj(p). Its damping, and the moment
    !> of the air, are the same about axes that the rotation mixes.
    pure subroutine turn_to_principal_axes(body, turned, rotation)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(body_t), intent(out) :: turned !! the same in its principal axes
        real(dp), intent(out), optional :: rotation(4) !! unit quaternion p
        real(dp) :: p(4), even(3), odd(3)
        integer :: i, k
        turned = body
        call find_principal_axes(body%inertia, body%products, turned%inertia, p)
        if (present(rotation)) rotation = p
        turned%products = 0
        turned%centre_of_mass = to_space(p, body%centre_of_mass)
        call clear_rounding(turned%inertia, turned%products, turned%centre_of_mass)
        if (.not. allocated(turned%effects)) return
        associate (effects => turned%effects)
            effects%rotor_momentum = in_principal_axes(p, effects%rotor_momentum)
            effects%rotor_torque = in_principal_axes(p, effects%rotor_torque)
            effects%torque_body = in_principal_axes(p, effects%torque_body)
            effects%friction_axis = in_principal_axes(p, effects%friction_axis)
            if (allocated(effects%harmonic_body)) then
                associate (of => effects%harmonic_body)
                    even = in_principal_axes(p, of%amplitude * cos(of%phase))
                    odd = in_principal_axes(p, of%amplitude * sin(of%phase))
                    of%amplitude = hypot(even, odd)
                    of%phase = atan2(odd, even)
                end associate
            end if
            if (.not. allocated(effects%table) .or. effects%table_in_space) return
            do i = 1, size(effects%table%coefficient, 3)
                do k = lbound(effects%table%coefficient, 1), ubound(effects%table%coefficient, 1)
                    effects%table%coefficient(k, :, i) = in_principal_axes(p, effects%table%coefficient(k, :, i))
                end do
            end do
        end associate
    end subroutine turn_to_principal_axes

    !> A vector in principal axes. Components that are only rounding errors are zero, so that a vector along an axis of
    !> symmetry is so exactly.
    pure function in_principal_axes(p, v) result(w)
        real(dp), intent(in) :: p(4), v(3)
        real(dp) :: w(3)
        w = to_space(p, v)
        where (abs(w) <= 16 * epsilon(1.0_dp) * norm2(w)) w = 0
    end function in_principal_axes

    !> A vector in principal axes, expressed in rotated axes, without rounding errors: in the order that brings `axis` to z.
    pure function reordered(self, v) result(w)
        class(body_turn_t), intent(in) :: self
        real(dp), intent(in) :: v(3)
        real(dp) :: w(3)
        w = cshift(v, self%axis)
        if (self%flipped) w(2:3) = -w(2:3)
    end function reordered

    !> A vector in rotated axes; without rounding errors if it was in principal axes.
    pure function vector(self, v) result(w)
        class(body_turn_t), intent(in) :: self
        real(dp), intent(in) :: v(3) !! in the axes in which the body was given
        real(dp) :: w(3)
        w = v
        if (self%to_principal_axes) w = to_space(self%principal, v)
        w = reordered(self, w)
    end function vector

    !> A motion in rotated axes.
    pure type(motion_t) function turned_motion(self, motion) result(turned)
        class(body_turn_t), intent(in) :: self
        type(motion_t), intent(in) :: motion !! in the axes in which the body was given
        turned = motion
        if (self%exchanges_axes()) then
            turned = motion_from_quaternion(motion%t, &
                quaternion_product(motion%quaternion, conjugate_quaternion(self%p)), &
                self%vector(motion%omega), motion%angle)
            turned%given_angle = motion%angle
            turned%gives_quaternion = .true.
            turned%gives_omega = .true.
        else if (self%axis == 3) then
            turned = motion_from_angles(motion%t, [motion%angle(1) + pi, pi - motion%angle(2), &
                -motion%angle(3) - pi], [motion%rate(1), -motion%rate(2), -motion%rate(3)])
            ! Of both quaternions of an attitude, the one that is given.
            if (dot_product(turned%quaternion, quaternion_product(motion%quaternion, conjugate_quaternion(self%p))) < 0) then
                turned%quaternion = -turned%quaternion
            end if
            turned%omega = self%vector(motion%omega)
            turned%gives_omega3 = motion%gives_omega3 .or. motion%gives_omega
            turned%gives_omega = motion%gives_omega
        end if
        if (.not. self%is_shifted()) return
        turned = unshifted(-self%phi_shift, -self%psi_shift, turned)
        turned%omega_rate = 0 ! is not known
    end function turned_motion

    !> A motion in rotated axes, expressed in the axes in which the body was given. phi and psi are the values
    !> nearest to those of `near`.
    pure type(motion_t) function back(self, motion, near) result(seen)
        class(body_turn_t), intent(in) :: self
        type(motion_t), intent(in) :: motion !! in rotated axes
        real(dp), intent(in) :: near(3) !! angles near the result, rad
        seen = motion
        if (self%is_shifted()) seen = unshifted(self%phi_shift, self%psi_shift, motion)
        if (.not. (self%axis > 0 .or. self%to_principal_axes)) return
        seen%quaternion = quaternion_product(seen%quaternion, self%p)
        seen%omega = given_vector(seen%omega)
        seen%omega_rate = given_vector(seen%omega_rate)
        if (self%exchanges_axes()) then
            seen%angle = angles_from_quaternion(seen%quaternion, near)
            seen%rate = rates_from_omega(seen%angle, seen%omega)
        else
            seen%angle = [seen%angle(1) - pi, pi - seen%angle(2), -(seen%angle(3) + pi)]
            seen%rate = [seen%rate(1), -seen%rate(2), -seen%rate(3)]
        end if

    contains

        !> A vector in rotated axes, expressed in the given axes.
        pure function given_vector(w) result(v)
            real(dp), intent(in) :: w(3)
            real(dp) :: v(3)
            v = w
            if (self%flipped) v(2:3) = -v(2:3)
            v = cshift(v, -self%axis)
            if (self%to_principal_axes) v = to_space(conjugate_quaternion(self%principal), v)
        end function given_vector

    end function back

end module spintop_body_turn
