!> Lyapunov exponents of a motion: the mean rates at which small deviations grow.
module spintop_lyapunov
    use spintop_kinds, only: dp, pi
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_euler_poisson, only: euler_poisson_state, state_units
    use spintop_motion, only: motion_t
    use spintop_status, only: status_ok, status_step_limit, status_bad_input, status_non_finite
    use spintop_tangent_flow, only: step_limit, take_tangent_step
    use spintop_validity, only: body_status, motion_status
    implicit none
    private
    public :: find_lyapunov

contains

    !> The `size(exponents)` largest exponents of the motion over `t_end` seconds, at most six, 1/s;
    !> largest first in the limit of long times, to which they tend like log(t)/t. Deviations are
    !> made orthonormal after every step (Benettin, Galgani, Giorgilli and Strelcyn, Meccanica 15,
    !> 1980); they are given by `directions`, a column each (Gamma, Pi; SI units), or of no
    !> special direction. A motion of more than `max_steps` steps is given up. `status_bad_input`: no
    !> positive span, no or more than six exponents, or directions that are not six finite numbers
    !> for each; `status_non_finite`, `status_bad_body`, `status_bad_start`: no body or no motion.
    pure subroutine find_lyapunov(body, start, t_end, exponents, status, directions, max_steps)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: t_end
        real(dp), intent(out) :: exponents(:)
        integer, intent(out) :: status
        real(dp), intent(in), optional :: directions(:, :)
        integer, intent(in), optional :: max_steps
        real(dp) :: columns(6, 1 + size(exponents)), unit(6), growth(size(exponents)), left, h
        integer :: step, most_steps, i, k

        exponents = 0
        growth = 0
        status = status_bad_input
        if (size(exponents) < 1 .or. size(exponents) > 6 .or. .not. (t_end > 0 .and. is_finite(t_end))) return
        if (present(directions)) then
            if (size(directions, 1) /= 6 .or. size(directions, 2) < size(exponents)) return
            if (.not. all(is_finite(directions))) return
        end if
        status = body_status(body)
        if (status == status_ok) status = motion_status(start)
        if (status /= status_ok) return
        columns(:, 1) = euler_poisson_state(body, start)
        unit = state_units(body, columns(:, 1))
        if (present(directions)) then
            columns(:, 2:) = directions(:, :size(exponents))
        else
            do k = 1, size(exponents)
                columns(:, 1 + k) = unit * [(cos(pi * (i - 0.5_dp) * (k - 1) / 6), i=1, 6)]
            end do
        end if
        call separate(columns(:, 2:), unit, growth)
        growth = 0

        most_steps = step_limit
        if (present(max_steps)) most_steps = max_steps
        status = status_ok
        left = t_end
        do step = 1, most_steps
            if (.not. left > 0) exit
            call take_tangent_step(body, left, columns, h, status)
            if (status /= status_ok) return
            left = left - h
            call separate(columns(:, 2:), unit, growth)
        end do
        if (left > 0) status = status_step_limit
        if (.not. all(is_finite(growth))) status = status_non_finite
        if (status == status_ok) exponents = growth / t_end
    end subroutine find_lyapunov

    !> Makes vectors orthonormal, each by those before it, and adds the logarithms of the lengths
    !> that they had grown to.
    pure subroutine separate(vectors, unit, growth)
        real(dp), intent(inout) :: vectors(:, :)
        real(dp), intent(in) :: unit(6)
        real(dp), intent(inout) :: growth(:)
        real(dp) :: length
        integer :: i, k
        do k = 1, size(vectors, 2)
            vectors(:, k) = vectors(:, k) / unit
            do i = 1, k - 1
                vectors(:, k) = vectors(:, k) - dot_product(vectors(:, i), vectors(:, k)) * vectors(:, i)
            end do
            length = norm2(vectors(:, k))
            growth(k) = growth(k) + log(length)
            vectors(:, k) = vectors(:, k) / length
        end do
        do k = 1, size(vectors, 2)
            vectors(:, k) = vectors(:, k) * unit
        end do
    end subroutine separate

end module spintop_lyapunov
