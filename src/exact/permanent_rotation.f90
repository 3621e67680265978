!> Permanent rotations of a heavy rigid body about the vertical (O. Staude, Ueber permanente Rotationsaxen bei der
!> Bewegung eines schweren Koerpers um einen festen Punkt, J. reine angew. Math. 113, 1894).
!>
!> A body rotates for ever about an axis that is vertical, omega = s Gamma, if s^2 I Gamma - m g r is along Gamma. Then
!> (I - p) Gamma = (m g/s^2) r with a number p: to every p belong one axis and one rate,
!>
!>     u = (I - p)^-1 r,   Gamma = u/|u|,   s^2 = m g |u|.
!>
!> For p from -infinity to infinity the axes are the directed half of Staude's cone Gamma . (I Gamma x r) = 0 about which
!> the body can rotate: from rest upright, over the principal axes p = I_k, where the rate is infinite, to rest hanging.
module spintop_permanent_rotation
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite, is_zero
    use spintop_kinds, only: dp, no_number
    use spintop_status, only: is_ok, status_bad_input, status_ok, status_unsuitable
    use spintop_validity, only: plain_body_status
    use spintop_vectors, only: cross
    implicit none
    private
    public :: find_permanent_rotation, permanent_rate

    !> Tolerance of the cone, relative to the terms that balance each other: ten digits suffice.
    real(dp), parameter :: slack = 1.0e-10_dp

contains

    !> The permanent rotation of an undamped body with a parameter p of the cone: the vertical in body axes, and the rate.
    !> `status_unsuitable`: there is no weight torque, or the body is damped or not in principal axes;
    !> `status_bad_input`: p is not finite, or is the moment of inertia of a principal axis.
    pure subroutine find_permanent_rotation(body, parameter, vertical, rate, status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: parameter !! p, kg m^2
        real(dp), intent(out) :: vertical(3), rate !! unit vector in body axes; s > 0, rad/s; -s is another rotation
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: solution(3), moment(3)

        vertical = no_number
        rate = no_number
        call check_body(body, status)
        if (is_ok(status) .and. .not. is_finite(parameter)) status = status_bad_input
        if (.not. is_ok(status)) return
        moment = body%weight_moment()
        solution = 0
        where (abs(moment) > 0) solution = moment / (body%inertia - parameter)
        if (.not. all(is_finite(solution)) .or. .not. norm2(solution) > 0) then
            status = status_bad_input
            return
        end if
        vertical = solution / norm2(solution)
        rate = sqrt(norm2(solution))
    end subroutine find_permanent_rotation

    !> The rate of the permanent rotation about an axis that is vertical, rad/s; 0 where the body rests upright or hanging.
    !> `status_unsuitable`: the axis is not on the cone, or its other direction has to be up, or any rate will do (a
    !> principal axis through the centre of mass), or as in `find_permanent_rotation`; `status_bad_input`: the axis is no
    !> vector of finite length.
    pure subroutine permanent_rate(body, axis, rate, status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: axis(3) !! of any length, in body axes; its direction is up
        real(dp), intent(out) :: rate !! s >= 0, rad/s
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: vertical(3), inertial(3), weight(3), square

        rate = no_number
        call check_body(body, status)
        if (.not. is_ok(status)) return
        status = status_bad_input
        if (.not. all(is_finite(axis)) .or. .not. norm2(axis) > 0) return
        vertical = axis / norm2(axis)
        ! s^2 (I Gamma x Gamma) = m g (r x Gamma)
        inertial = cross(body%inertia * vertical, vertical)
        weight = cross(body%weight_moment(), vertical)
        status = status_unsuitable
        if (norm2(weight) <= slack * norm2(body%weight_moment())) then
            if (norm2(inertial) <= slack * maxval(body%inertia)) return
            rate = 0
            status = status_ok
            return
        end if
        if (norm2(inertial) <= slack * maxval(body%inertia)) return
        square = dot_product(inertial, weight) / sum(inertial**2)
        if (norm2(square * inertial - weight) > slack * norm2(weight) .or. .not. square > 0) return
        rate = sqrt(square)
        status = status_ok
    end subroutine permanent_rate

    !> Whether there are such rotations.
    pure subroutine check_body(body, status)
        type(body_t), intent(in) :: body
        integer, intent(out) :: status
        status = plain_body_status(body)
        if (.not. is_ok(status)) return
        if (.not. (norm2(body%weight_moment()) > 0 .and. all(is_zero(body%damping)))) status = status_unsuitable
    end subroutine check_body

end module spintop_permanent_rotation
