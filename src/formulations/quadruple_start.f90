!> Attitude and angular velocity of a start in quadruple precision.
module spintop_quadruple_start
    use spintop_kinds, only: qp
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: quadruple_attitude, quadruple_omega, vector

contains

    !> The quaternion of a start.
    pure function quadruple_attitude(start) result(q)
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(qp) :: q(4), theta, plus, minus
        q = start%quaternion
        if (start%gives_quaternion .or. .not. start%is_given) return
        theta = real(start%angle(2), qp) / 2
        plus = (real(start%angle(1), qp) + start%angle(3)) / 2
        minus = (real(start%angle(1), qp) - start%angle(3)) / 2
        q = [cos(theta) * cos(plus), sin(theta) * cos(minus), sin(theta) * sin(minus), cos(theta) * sin(plus)]
        if (dot_product(q, start%quaternion) < 0) q = -q
    end function quadruple_attitude

    !> Its angular velocity in body axes, rad/s: the rate of phi about the vertical, that of theta about the line of nodes,
    !> that of psi about body z.
    pure function quadruple_omega(start) result(omega)
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(qp) :: omega(3), q(4), vertical(3), node(2), psi
        omega = start%omega
        if (start%gives_omega .or. .not. start%is_given) return
        q = quadruple_attitude(start)
        vertical = [2 * (q(2) * q(4) - q(1) * q(3)), 2 * (q(3) * q(4) + q(1) * q(2)), &
                    (q(1)**2 + q(4)**2) - (q(2)**2 + q(3)**2)] / sum(q**2)
        psi = start%angle(3)
        node = [cos(psi), -sin(psi)]
        if (start%gives_quaternion .and. any(abs(vertical(1:2)) > 0)) then
            node = [vertical(2), -vertical(1)] / norm2(vertical(1:2))
        end if
        omega(1:2) = start%rate(1) * vertical(1:2) + start%rate(2) * node
        if (.not. start%gives_omega3) omega(3) = start%rate(1) * vertical(3) + start%rate(3)
    end function quadruple_omega

    !> Vector product.
    pure function vector(a, b) result(c)
        real(qp), intent(in) :: a(3), b(3) !! the factors
        real(qp) :: c(3)
        c = [a(2) * b(3) - a(3) * b(2), a(3) * b(1) - a(1) * b(3), a(1) * b(2) - a(2) * b(1)]
    end function vector

end module spintop_quadruple_start
