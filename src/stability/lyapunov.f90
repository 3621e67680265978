!> Lyapunov exponents of a motion, the mean rates at which perturbations grow, and the largest singular
!> value of its tangent map, the largest factor by which one of them grows.
!>
!> Perturbations are measured in the scales of the motion (`state_units`): no result depends on the units
!> of mass, length and time.
module spintop_lyapunov
    use spintop_kinds, only: dp, pi
    use spintop_lapack, only: dgesvd
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_euler_poisson, only: euler_poisson_state, state_units
    use spintop_motion, only: motion_t
    use spintop_status, only: is_ok, status_bad_input, status_non_finite, status_ok, status_step_limit
    use spintop_tangent_flow, only: step_limit, take_tangent_step
    use spintop_validity, only: plain_body_status, motion_status
    use spintop_vectors, only: cross
    implicit none
    private
    public :: find_lyapunov, find_largest_singular_value
    public :: scales_of, span_perturbations, even_perturbation, scale_up

    !> Perturbations that are smaller than the largest one by this factor are zero.
    real(dp), parameter :: negligible = 1.0e-150_dp

    abstract interface
        !> Brings tangent vectors, given in the scales `unit`, back to length 1 or less, and adds the
        !> logarithms of their growth.
        pure subroutine normalization(vectors, unit, growth)
            import :: dp
            real(dp), intent(inout) :: vectors(:, :)
            real(dp), intent(in) :: unit(6)
            real(dp), intent(inout) :: growth(:)
        end subroutine normalization
    end interface

contains

    !> The `size(exponents)` largest exponents of the motion over `t_end` seconds, at most six, 1/s, in
    !> decreasing order for long times. They tend to their limits like log(t)/t. The perturbations are made
    !> orthonormal after every step (Benettin, Galgani, Giorgilli and Strelcyn, Meccanica 15, 1980). Their
    !> initial values are the columns of `directions` (Gamma, Pi; SI units), or else have no special
    !> direction. A single one then has equal components, except for its part along Gamma, which is removed so
    !> that the norm of the vertical is kept; with several, that part is included. `max_steps` limits the
    !> number of steps; `steps` is the number of steps taken. `status_bad_input`: the span is not positive,
    !> the number of exponents is not between 1 and 6, or a direction is not six finite numbers;
    !> `status_non_finite`, `status_bad_body`, `status_bad_start`: body or start is not valid.
    pure subroutine find_lyapunov(body, start, t_end, exponents, status, directions, max_steps, steps)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: t_end !! length of the span, s
        real(dp), intent(out) :: exponents(:) !! exponents, 1/s
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), intent(in), optional :: directions(:, :)
            !! initial perturbations, one per column (Gamma, Pi; SI units)
        integer, intent(in), optional :: max_steps !! maximum number of steps
        integer, intent(out), optional :: steps !! number of steps
        real(dp) :: columns(6, 1 + size(exponents)), unit(6), growth(size(exponents))
        integer :: i, k

        exponents = 0
        growth = 0
        if (present(steps)) steps = 0
        status = status_bad_input
        if (size(exponents) < 1 .or. size(exponents) > 6 .or. .not. (t_end > 0 .and. is_finite(t_end))) return
        if (present(directions)) then
            if (size(directions, 1) /= 6 .or. size(directions, 2) < size(exponents)) return
            if (.not. all(is_finite(directions))) return
        end if
        status = plain_body_status(body)
        if (is_ok(status)) status = motion_status(start, body)
        if (.not. is_ok(status)) return
        columns(:, 1) = euler_poisson_state(body, start)
        unit = scales_of(body, columns(:, 1), t_end)
        if (present(directions)) then
            columns(:, 2:) = directions(:, :size(exponents))
        else
            do k = 1, size(exponents)
                columns(:, 1 + k) = unit * [(cos(pi * (i - 0.5_dp) * (k - 1) / 6), i=1, 6)]
            end do
            if (size(exponents) == 1) columns(:, 2) = even_perturbation(columns(1:3, 1), unit)
        end if
        call separate(columns(:, 2:), unit, growth)
        growth = 0

        call walk(body, t_end, columns, unit, separate, size(exponents) == 1 .and. .not. present(directions), growth, &
                  status, max_steps, steps)
        if (is_ok(status) .and. .not. all(is_finite(growth))) status = status_non_finite
        if (is_ok(status)) exponents = growth / t_end
    end subroutine find_lyapunov

    !> The largest singular value of the tangent map of the motion over `t_end` seconds, in the scales of
    !> its start: the largest factor by which a perturbation grows that keeps the length of the vertical.
    !> A motion of more than `max_steps` steps is abandoned; `steps` are those taken. `status_bad_input`: no
    !> positive span; `status_non_finite`, `status_bad_body`, `status_bad_start`: no body or no motion.
    subroutine find_largest_singular_value(body, start, t_end, factor, status, max_steps, steps)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: t_end !! length of the span, s
        real(dp), intent(out) :: factor !! 0 unless `status_ok`
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        integer, intent(in), optional :: max_steps !! maximum number of steps
        integer, intent(out), optional :: steps !! number of steps
        real(dp) :: columns(6, 6), unit(6), growth(1)

        factor = 0
        if (present(steps)) steps = 0
        status = status_bad_input
        if (.not. (t_end > 0 .and. is_finite(t_end))) return
        status = plain_body_status(body)
        if (is_ok(status)) status = motion_status(start, body)
        if (.not. is_ok(status)) return
        columns(:, 1) = euler_poisson_state(body, start)
        unit = scales_of(body, columns(:, 1), t_end)
        call span_perturbations(columns(1:3, 1), unit, columns(:, 2:))
        growth = 0
        call walk(body, t_end, columns, unit, shrink, .true., growth, status, max_steps, steps)
        if (is_ok(status)) call scale_up(columns(:, 2:) / spread(unit, 2, 5), growth(1), factor, status)
    end subroutine find_largest_singular_value

    !> Propagates the state `columns(:, 1)` and the tangent vectors in the other columns over `t_end` seconds. After every step
    !> `keep_small` brings the vectors back to their scales and adds the logarithms of what they had grown by. With
    !> `keep_across` the vectors stay across the vertical: what rounding adds along it never decays. `status_step_limit` after
    !> more than `max_steps` steps; `steps` are those taken.
    pure subroutine walk(body, t_end, columns, unit, keep_small, keep_across, growth, status, max_steps, steps)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: t_end, unit(6)
        real(dp), intent(inout) :: columns(:, :), growth(:)
        procedure(normalization) :: keep_small
        logical, intent(in) :: keep_across
        integer, intent(out) :: status
        integer, intent(in), optional :: max_steps
        integer, intent(inout), optional :: steps
        real(dp) :: left, h
        integer :: step, most_steps, k

        most_steps = step_limit
        if (present(max_steps)) most_steps = max_steps
        status = status_ok
        left = t_end
        do step = 1, most_steps
            if (.not. left > 0) exit
            call take_tangent_step(body, left, columns, h, status)
            if (.not. is_ok(status)) return
            left = left - h
            if (present(steps)) steps = step
            if (keep_across) then
                associate (vertical => columns(1:3, 1))
                    do k = 2, size(columns, 2)
                        columns(1:3, k) = columns(1:3, k) &
                            - dot_product(vertical, columns(1:3, k)) / sum(vertical**2) * vertical
                    end do
                end associate
            end if
            call keep_small(columns(:, 2:), unit, growth)
        end do
        if (left > 0) status = status_step_limit
    end subroutine walk

    !> The largest singular value of a matrix times e^growth. `status_non_finite`: it is not a number, or overflows.
    subroutine scale_up(matrix, growth, factor, status)
        real(dp), intent(in) :: matrix(6, 5), growth !! perturbations, one per column; logarithm of their factor
        real(dp), intent(out) :: factor !! 0 unless `status_ok`
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: a(6, 5), values(5), u(1, 1), v(1, 1), work(64)
        integer :: failure
        factor = 0
        status = status_non_finite
        if (.not. all(is_finite(matrix))) return
        a = matrix
        call dgesvd('N', 'N', 6, 5, a, 6, values, u, 1, v, 1, work, size(work), failure)
        if (failure /= 0 .or. .not. growth + log(values(1)) < log(huge(1.0_dp))) return
        factor = exp(growth + log(values(1)))
        status = status_ok
    end subroutine scale_up

    !> The perturbation with equal components in the scales `unit`, without its part along the vertical.
    pure function even_perturbation(vertical, unit) result(vector)
        real(dp), intent(in) :: vertical(3), unit(6) !! unit vector; scales of (Gamma, Pi)
        real(dp) :: vector(6)
        vector = unit
        vector(1:3) = vector(1:3) - dot_product(vertical, vector(1:3)) * vertical
    end function even_perturbation

    !> Perturbations, orthonormal in the scales `unit`, that keep the norm of the vertical: two of the
    !> vertical, across it, and three of the momentum.
    pure subroutine span_perturbations(vertical, unit, vectors)
        real(dp), intent(in) :: vertical(3), unit(6) !! unit vector; scales of (Gamma, Pi)
        real(dp), intent(out) :: vectors(6, 5) !! perturbations, one per column
        real(dp) :: across(3)
        integer :: i
        across = 0
        across(minloc(abs(vertical), dim=1)) = 1
        across = cross(vertical, across)
        across = across / norm2(across)
        vectors = 0
        vectors(1:3, 1) = across
        vectors(1:3, 2) = cross(vertical, across)
        do i = 4, 6
            vectors(i, i - 1) = unit(i)
        end do
    end subroutine span_perturbations

    !> The scales of a state; for a body at rest without weight, those of a rotation by one radian in the
    !> span.
    pure function scales_of(body, x, t_end) result(unit)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: x(6), t_end !! state (Gamma, Pi); length of the span, s
        real(dp) :: unit(6)
        unit = state_units(body, x)
        if (all(abs([x(4:6), body%weight_moment()]) <= 0)) unit(4:6) = maxval(body%inertia) / t_end
    end function scales_of

    !> Divides vectors by the largest of their components, and adds its logarithm to the only `growth`.
    pure subroutine shrink(vectors, unit, growth)
        real(dp), intent(inout) :: vectors(:, :)
        real(dp), intent(in) :: unit(6)
        real(dp), intent(inout) :: growth(:)
        real(dp) :: scale
        integer :: i
        scale = maxval(abs(vectors) / spread(unit, 2, size(vectors, 2)))
        growth = growth + log(scale)
        vectors = vectors / scale
        do i = 1, size(vectors, 2)
            if (all(abs(vectors(:, i)) < negligible * unit)) vectors(:, i) = 0
        end do
    end subroutine shrink

    !> Makes vectors orthonormal, each with respect to those before it, and adds the logarithms of their
    !> previous norms to `growth`.
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
