!> Derivatives of residuals with respect to parameters, by differences, with an estimate of their errors.
module spintop_jacobian
    use spintop_kinds, only: dp, is_finite
    use spintop_differences, only: node_count, nodes_around, nodes_t
    use spintop_residuals, only: residuals_t
    implicit none
    private
    public :: find_jacobian, refine_jacobian

    !> Steps of differences in units of the scale of a parameter: of one side, for the search, and of both sides at two
    !> distances, extrapolated, of which the residuals may vary by 0.01 over a step with an error of 1e-10.
    real(dp), parameter :: one_sided_step = 1.5e-8_dp, central_step = 3.0e-5_dp
    !> Factor of the tolerance of an integration, by which the error of its derivatives is seen.
    real(dp), parameter :: coarser = 10

contains

    !> The derivatives of the residuals with respect to some parameters, by differences.
    subroutine find_jacobian(model, x, free, residuals, is_central, jacobian, is_valid, errors)
        class(residuals_t), intent(inout) :: model !! the residuals
        real(dp), intent(in) :: x(:) !! the parameters
        integer, intent(in) :: free(:) !! numbers of the parameters that vary
        real(dp), intent(in) :: residuals(:) !! the residuals at the parameters
        logical, intent(in) :: is_central !! whether differences are central and extrapolated where both sides exist
        real(dp), intent(out) :: jacobian(:, :) !! a column for each of these parameters
        logical, intent(out) :: is_valid !! whether the residuals exist on one side at least
        real(dp), intent(out), optional :: errors(:, :) !! upper estimates of the errors of the derivatives
        real(dp) :: half(size(residuals)), terms(size(residuals)), steps(size(free)), step
        logical :: has_both
        integer :: k

        is_valid = .true.
        do k = 1, size(free)
            has_both = .false.
            if (is_central) then
                call find_central_difference(model, x, free(k), central_step, jacobian(:, k), has_both)
                if (has_both) call find_central_difference(model, x, free(k), central_step / 2, half, has_both)
                if (has_both .and. present(errors)) errors(:, k) = 2 * abs(half - jacobian(:, k))
                if (has_both) jacobian(:, k) = half + (half - jacobian(:, k)) / 3
                step = central_step / 2
            end if
            if (.not. has_both) then
                call find_one_sided_difference(model, x, free(k), residuals, jacobian(:, k), is_valid)
                if (present(errors)) errors(:, k) = sqrt(one_sided_step) * abs(jacobian(:, k))
                step = one_sided_step
            end if
            is_valid = is_valid .and. all(is_finite(jacobian(:, k)))
            if (.not. is_valid) return
            steps(k) = (x(free(k)) + step * model%step_scale(free(k), x(free(k)))) - x(free(k))
        end do
        if (.not. present(errors)) return
        terms = terms_of(model, x(free), residuals, jacobian)
        do k = 1, size(free)
            errors(:, k) = errors(:, k) + 2 * epsilon(step) * terms / abs(steps(k))
        end do
    end subroutine find_jacobian

    !> The size of what the residuals are sums of, whose rounding is theirs: the measurements, and what each parameter adds to
    !> first order, which may be larger where parameters counteract each other.
    pure function terms_of(model, x, residuals, jacobian) result(terms)
        class(residuals_t), intent(in) :: model
        real(dp), intent(in) :: x(:), residuals(:), jacobian(:, :)
        real(dp) :: terms(size(residuals))
        integer :: k
        terms = abs(residuals)
        if (allocated(model%data)) terms = abs(residuals + model%data)
        do k = 1, size(x)
            terms = max(terms, abs(x(k) * jacobian(:, k)))
        end do
    end function terms_of

    !> The derivatives by all parameters again, and their errors: each from many step sizes, extrapolated to none. The error
    !> of an integration is the change with its tolerance. Derivatives that do not converge stay as they are.
    subroutine refine_jacobian(model, x, residuals, jacobian, errors)
        class(residuals_t), intent(inout) :: model !! the residuals
        real(dp), intent(in) :: x(:) !! the parameters
        real(dp), intent(in) :: residuals(:) !! the residuals at the parameters
        real(dp), intent(inout) :: jacobian(:, :), errors(:, :) !! derivatives, and estimates of their errors
        real(dp), allocatable :: coarse(:, :), error_of_coarse(:, :), at_coarse(:)
        logical :: is_valid

        allocate (coarse, source=jacobian)
        allocate (error_of_coarse, source=errors)
        call extrapolate(model, x, residuals, jacobian, errors)
        if (.not. model%precision > 0) return
        allocate (at_coarse, mold=residuals)
        call model%coarsen(coarser)
        call model%evaluate(x, at_coarse, is_valid)
        if (is_valid) then
            call extrapolate(model, x, at_coarse, coarse, error_of_coarse)
            errors = errors + abs(coarse - jacobian)
        end if
        call model%coarsen(1.0_dp)
    end subroutine refine_jacobian

    !> The derivatives from many step sizes.
    subroutine extrapolate(model, x, residuals, jacobian, errors)
        class(residuals_t), intent(inout) :: model
        real(dp), intent(in) :: x(:), residuals(:)
        real(dp), intent(inout) :: jacobian(:, :), errors(:, :)
        real(dp), allocatable :: values(:, :), slopes(:), changes(:)
        real(dp) :: moved(size(x)), terms(size(residuals))
        type(nodes_t) :: nodes
        logical :: exists(node_count)
        integer :: i, k

        allocate (values(size(residuals), node_count), slopes(size(residuals)), changes(size(residuals)))
        terms = terms_of(model, x, residuals, jacobian)
        do k = 1, size(x)
            nodes = nodes_around(x(k), .true., model%step_scale(k, x(k)))
            exists = nodes%is_valid
            values(:, 1) = residuals
            do i = 2, node_count
                exists(i) = exists(i) .and. abs(model%limited(k, nodes%x(i)) - nodes%x(i)) <= 0
                if (.not. exists(i)) cycle
                moved = x
                moved(k) = nodes%x(i)
                call model%evaluate(moved, values(:, i), exists(i))
            end do
            call nodes%limit_to(exists)
            ! Rounding is that of what the residuals are sums of.
            values = values + spread(terms, 2, node_count)
            call nodes%differentiate_together(values, slopes, changes)
            if (.not. all(is_finite(changes))) cycle
            jacobian(:, k) = slopes
            errors(:, k) = changes
        end do
    end subroutine extrapolate

    !> The central difference by a parameter.
    subroutine find_central_difference(model, x, i, relative_step, slopes, is_valid)
        class(residuals_t), intent(inout) :: model
        real(dp), intent(in) :: x(:), relative_step
        integer, intent(in) :: i
        real(dp), intent(out) :: slopes(:)
        logical, intent(out) :: is_valid
        real(dp) :: above(size(x)), below(size(x)), residuals(size(slopes))

        above = x
        below = x
        above(i) = x(i) + relative_step * model%step_scale(i, x(i))
        below(i) = x(i) - relative_step * model%step_scale(i, x(i))
        call model%evaluate(above, slopes, is_valid)
        if (is_valid) call model%evaluate(below, residuals, is_valid)
        if (is_valid) slopes = (slopes - residuals) / (above(i) - below(i))
    end subroutine find_central_difference

    !> The difference of one side by a parameter: of that above, or if there are no residuals, below.
    subroutine find_one_sided_difference(model, x, i, residuals, slopes, is_valid)
        class(residuals_t), intent(inout) :: model
        real(dp), intent(in) :: x(:)
        integer, intent(in) :: i
        real(dp), intent(in) :: residuals(:)
        real(dp), intent(out) :: slopes(:)
        logical, intent(out) :: is_valid
        real(dp), parameter :: steps(2) = [one_sided_step, -one_sided_step]
        real(dp) :: moved(size(x))
        integer :: side

        do side = 1, size(steps)
            moved = x
            moved(i) = x(i) + steps(side) * model%step_scale(i, x(i))
            call model%evaluate(moved, slopes, is_valid)
            if (is_valid) exit
        end do
        if (is_valid) slopes = (slopes - residuals) / (moved(i) - x(i))
    end subroutine find_one_sided_difference

end module spintop_jacobian
