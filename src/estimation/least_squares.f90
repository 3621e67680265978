!> Nonlinear least squares: the method of Levenberg and Marquardt in the form of More (1978), as in MINPACK's `lmder`, on its
!> routines `qrfac` and `lmpar`. Some of the parameters may be held. Parameters have ranges: steps are cut at their ends, and
!> a parameter that the sum of squares presses against an end stays there while the others move. Derivatives are differences,
!> with an estimate of their errors. The standard deviation that a robust loss needs is found with the parameters where it is
!> not known.
module spintop_least_squares
    use spintop_differences, only: node_count, nodes_around, nodes_t
    use spintop_kinds, only: dp, is_finite
    use spintop_residuals, only: loss_huber, loss_squares, loss_t, loss_tukey, residuals_t
    implicit none
    private
    public :: residuals_t, minimum_t, minimize, minimize_loss, robust_deviation, find_jacobian, refine_jacobian

    !> Relative reduction of the sum of squares, and of the parameters, below which the search ends; its largest number of
    !> evaluations per parameter; and the first bound of its steps.
    real(dp), parameter :: tolerance = 1.0e-10_dp, first_bound = 100
    integer, parameter :: most_evaluations = 400

    !> Where the search ended.
    type :: minimum_t
        !> The parameters, the residuals there, and the sum of their squares (of a robust loss: those of bent residuals).
        real(dp), allocatable :: x(:), residuals(:)
        real(dp) :: sum_of_squares = huge(1.0_dp)
        !> Number of evaluations of the residuals, and of steps of the search.
        integer :: evaluations = 0, steps = 0
        logical :: has_converged = .false.
    end type minimum_t

    !> The state of a search: the numbers of the n parameters that move, what belongs to each of them, and the scales of all.
    type :: search_t
        integer :: n = 0
        integer, allocatable :: free(:), pivot(:)
        real(dp), allocatable :: jacobian(:, :), scales(:), norms(:), qtf(:), step(:), work(:, :), scale_of(:)
        !> The residuals as their squares are summed: bent by the loss.
        real(dp), allocatable :: bent(:)
        real(dp) :: bound = 0, parameter = 0
    end type search_t

    !> Steps of differences in units of the scale of a parameter: of one side, for the search, and of both sides at two
    !> distances, extrapolated, of which the residuals may vary by 0.01 over a step with an error of 1e-10.
    real(dp), parameter :: one_sided_step = 1.5e-8_dp, central_step = 3.0e-5_dp
    !> Factor of the tolerance of an integration, by which the error of its derivatives is seen.
    real(dp), parameter :: coarser = 10

    !> The median of the magnitude of a Gaussian number in standard deviations.
    real(dp), parameter :: median_of_gaussian = 0.6744897501960817_dp
    !> The standard deviation is found in so many searches at most, to this part of it, and not below this part of the data.
    integer, parameter :: most_searches = 30
    real(dp), parameter :: same_deviation = 1.0e-4_dp, least_part = 1.0e-13_dp

    ! Those below `lmder`, which calls a procedure that has no data of its own, so that threads could not use it. Arguments have
    ! the names of the MINPACK guide (ANL-80-74).
    interface
        !> QR factorisation with column pivoting.
        subroutine qrfac(m, n, a, lda, pivot, ipvt, lipvt, rdiag, acnorm, wa)
            import :: dp
            integer, intent(in) :: m, n, lda, lipvt !! numbers of rows and columns; leading dimension; size of `ipvt`
            real(dp), intent(inout) :: a(lda, *) !! matrix on entry; the factors but the diagonal of R on return
            logical, intent(in) :: pivot !! whether columns are exchanged
            integer, intent(out) :: ipvt(*) !! the permutation
            real(dp), intent(out) :: rdiag(*), acnorm(*), wa(*) !! diagonal of R; norms of the columns; work space
        end subroutine qrfac

        !> The Levenberg-Marquardt parameter, and the step that belongs to it.
        subroutine lmpar(n, r, ldr, ipvt, diag, qtb, delta, par, x, sdiag, wa1, wa2)
            import :: dp
            integer, intent(in) :: n, ldr, ipvt(*) !! order of R; leading dimension; permutation
            real(dp), intent(inout) :: r(ldr, *) !! R; its lower triangle is overwritten
            real(dp), intent(in) :: diag(*), qtb(*), delta !! scales; (Q transpose) b; bound of the scaled step
            real(dp), intent(inout) :: par !! the parameter: an estimate on entry
            real(dp), intent(out) :: x(*), sdiag(*), wa1(*), wa2(*) !! the step, negative; work space
        end subroutine lmpar

        !> LAPACK's sort of numbers.
        subroutine dlasrt(id, n, d, info)
            import :: dp
            character, intent(in) :: id !! I: increasing
            integer, intent(in) :: n !! number of them
            real(dp), intent(inout) :: d(*) !! the numbers
            integer, intent(out) :: info !! 0
        end subroutine dlasrt
    end interface

contains

    !> Finds the least sum of the losses near `x`. Tukey's loss, which has more than one minimum, begins where Huber's ends.
    subroutine minimize_loss(model, x, m, kind, knows_deviation, minimum, goal)
        class(residuals_t), intent(inout) :: model !! the residuals; their loss is set
        real(dp), intent(in) :: x(:) !! the parameters at the beginning
        integer, intent(in) :: m !! number of residuals, more than parameters
        integer, intent(in) :: kind !! of the loss, one of `loss_squares` to `loss_tukey`
        logical, intent(in) :: knows_deviation !! whether the standard deviation of the residuals is 1
        type(minimum_t), intent(out) :: minimum !! where the search ended
        real(dp), intent(in), optional :: goal !! a search ends if no more than this part of the sum of squares can be gained
        integer :: evaluations, steps

        call settle(model, x, m, min(kind, loss_huber), knows_deviation, minimum, goal)
        if (kind /= loss_tukey .or. .not. minimum%has_converged) return
        evaluations = minimum%evaluations
        steps = minimum%steps
        call settle(model, [minimum%x], m, loss_tukey, knows_deviation, minimum, goal)
        minimum%evaluations = minimum%evaluations + evaluations
        minimum%steps = minimum%steps + steps
    end subroutine minimize_loss

    !> Finds the least sum of the losses of one kind, search by search until the standard deviation is that of the residuals.
    subroutine settle(model, x, m, kind, knows_deviation, minimum, goal)
        class(residuals_t), intent(inout) :: model
        real(dp), intent(in) :: x(:)
        integer, intent(in) :: m, kind
        logical, intent(in) :: knows_deviation
        type(minimum_t), intent(out) :: minimum
        real(dp), intent(in), optional :: goal
        real(dp), allocatable :: from(:), residuals(:)
        real(dp) :: deviation, last, least
        logical :: is_valid
        integer :: i, evaluations

        model%loss = loss_t(kind, 1.0_dp)
        is_valid = kind /= loss_squares .and. .not. knows_deviation
        allocate (residuals(m))
        if (is_valid) call model%evaluate(x, residuals, is_valid)
        if (.not. is_valid) then
            call minimize(model, x, m, spread(.true., 1, size(x)), minimum, goal)
            return
        end if
        allocate (from, source=x)
        evaluations = 1
        least = tiny(least)
        if (allocated(model%data)) least = max(least_part * norm2(model%data) / sqrt(real(m, dp)), least)
        deviation = robust_deviation(residuals, size(x))
        do i = 1, most_searches
            last = max(deviation, least)
            model%loss = loss_t(kind, last)
            call minimize(model, from, m, spread(.true., 1, size(x)), minimum, goal)
            evaluations = evaluations + minimum%evaluations
            if (.not. minimum%has_converged) exit
            deviation = robust_deviation(minimum%residuals, size(x))
            if (abs(max(deviation, least) - last) <= same_deviation * last) exit
            from(:) = minimum%x
        end do
        minimum%evaluations = evaluations
    end subroutine settle

    !> The standard deviation of residuals by the median of their magnitudes, without the smallest, as many as parameters,
    !> which these can make vanish.
    real(dp) function robust_deviation(residuals, parameters) result(deviation)
        real(dp), intent(in) :: residuals(:) !! the residuals, more than parameters
        integer, intent(in) :: parameters !! number of parameters that were fitted
        real(dp) :: sizes(size(residuals))
        integer :: info
        sizes = abs(residuals)
        associate (m => size(residuals))
            call dlasrt('I', m, sizes, info)
            deviation = sizes(min(parameters + (m - parameters + 1) / 2, m)) / median_of_gaussian
        end associate
    end function robust_deviation

    !> Finds the least sum of squares near `x`. Parameters that are not free keep their values.
    subroutine minimize(model, x, m, free, minimum, goal, jacobian, most)
        class(residuals_t), intent(inout) :: model !! the residuals
        real(dp), intent(in) :: x(:) !! the parameters at the beginning
        integer, intent(in) :: m !! number of residuals, at least that of the free parameters
        logical, intent(in) :: free(:) !! the parameters that are sought
        type(minimum_t), intent(out) :: minimum !! where the search ended
        real(dp), intent(in), optional :: goal !! the search ends if no more than this part of the sum of squares can be gained
        real(dp), intent(in), optional :: jacobian(:, :) !! derivatives near x by all parameters: whether x will do
        integer, intent(in), optional :: most !! evaluations, after which it ends, too
        type(search_t) :: search
        integer, allocatable :: sought(:)
        real(dp), allocatable :: slopes(:, :)
        logical :: is_valid, knows_jacobian
        integer :: i, limit

        minimum%x = x
        allocate (minimum%residuals(m))
        call model%evaluate(x, minimum%residuals, is_valid)
        minimum%evaluations = 1
        if (is_valid) minimum%sum_of_squares = sum(model%loss%bend(minimum%residuals)**2)
        if (.not. (is_valid .and. is_finite(minimum%sum_of_squares))) return
        sought = pack([(i, i=1, size(x))], free)
        minimum%has_converged = size(sought) == 0
        knows_jacobian = present(jacobian)
        limit = most_evaluations * size(sought)
        if (present(most)) limit = most
        allocate (slopes(m, size(sought)), search%scale_of(size(x)), source=0.0_dp)
        do while (.not. minimum%has_converged .and. minimum%evaluations < limit)
            if (knows_jacobian) then
                slopes = jacobian(:, sought)
            else
                call find_jacobian(model, minimum%x, sought, minimum%residuals, .false., slopes, is_valid)
                minimum%evaluations = minimum%evaluations + size(sought)
            end if
            if (.not. is_valid) return
            search%bent = model%loss%bend(minimum%residuals)
            if (model%loss%is_robust()) then
                slopes = slopes * spread(model%loss%bend_slope(minimum%residuals), 2, size(sought))
            end if
            call choose_moving(model, sought, slopes, minimum, search)
            minimum%has_converged = search%n == 0
            if (minimum%has_converged) return
            call factorize(search, minimum)
            ! This is what the step to the minimum of the linear model would gain.
            if (present(goal)) minimum%has_converged = sum(search%qtf**2) <= goal * minimum%sum_of_squares
            if (minimum%has_converged) return
            if (.not. knows_jacobian) call take_step(model, search, minimum, is_valid, goal)
            if (.not. is_valid) return
            knows_jacobian = .false. ! steps are made with the derivatives at their place
        end do
    end subroutine minimize

    !> The parameters that move: all that are sought, but for those that are at an end of their range and would leave it where
    !> the sum of squares falls.
    subroutine choose_moving(model, sought, slopes, minimum, search)
        class(residuals_t), intent(in) :: model
        integer, intent(in) :: sought(:)
        real(dp), intent(in) :: slopes(:, :)
        type(minimum_t), intent(in) :: minimum
        type(search_t), intent(inout) :: search
        logical :: moves(size(sought))
        real(dp) :: slope, beyond
        integer :: i

        do i = 1, size(sought)
            slope = dot_product(slopes(:, i), search%bent)
            beyond = nearest(minimum%x(sought(i)), -slope)
            moves(i) = .not. abs(slope) > 0 .or. .not. abs(model%limited(sought(i), beyond) - beyond) > 0
        end do
        search%free = pack(sought, moves)
        search%n = size(search%free)
        search%jacobian = slopes(:, pack([(i, i=1, size(sought))], moves))
        search%scales = search%scale_of(search%free)
        if (allocated(search%norms)) deallocate (search%norms, search%qtf, search%step, search%pivot, search%work)
        associate (n => search%n)
            allocate (search%norms(n), search%qtf(n), search%step(n), search%pivot(n), search%work(max(size(slopes, 1), n), 4))
        end associate
    end subroutine choose_moving

    !> Factorizes the Jacobian, applies Q to the residuals, and sets the scales and, at first, the bound.
    subroutine factorize(search, minimum)
        type(search_t), intent(inout) :: search
        type(minimum_t), intent(inout) :: minimum
        real(dp) :: f(size(search%bent)), size_of_x
        integer :: j, m

        m = size(f)
        associate (jacobian => search%jacobian, diagonal => search%work(:, 1), n => search%n)
            call qrfac(m, n, jacobian, m, .true., search%pivot, n, search%work(:, 1), search%norms, search%work(:, 2))
            f = search%bent
            do j = 1, n
                if (abs(jacobian(j, j)) > 0) then
                    f(j:) = f(j:) - jacobian(j:, j) * (dot_product(jacobian(j:, j), f(j:)) / jacobian(j, j))
                end if
                jacobian(j, j) = diagonal(j)
                search%qtf(j) = f(j)
            end do
            search%scales = max(search%scales, search%norms)
            where (.not. search%scales > 0) search%scales = 1
            search%scale_of(search%free) = search%scales
            if (minimum%steps == 0) then
                size_of_x = norm2(search%scales * minimum%x(search%free))
                search%bound = merge(first_bound * size_of_x, first_bound, size_of_x > 0)
            end if
        end associate
    end subroutine factorize

    !> Takes one step: steps that do not reduce the sum of squares are shortened until one does.
    subroutine take_step(model, search, minimum, is_valid, goal)
        class(residuals_t), intent(inout) :: model
        type(search_t), intent(inout) :: search
        type(minimum_t), intent(inout) :: minimum
        logical, intent(out) :: is_valid
        real(dp), intent(in), optional :: goal
        real(dp) :: x(size(minimum%x)), residuals(size(minimum%residuals)), change(search%n), norm, new_norm, length, actual, &
            predicted, slope, ratio, factor, least
        logical :: exists, is_cut
        integer :: j

        least = tolerance
        if (present(goal)) least = goal
        norm = sqrt(minimum%sum_of_squares)
        is_valid = norm > 0
        minimum%has_converged = .not. is_valid
        do while (is_valid)
            associate (n => search%n, work => search%work, step => search%step)
                call lmpar(n, search%jacobian, size(residuals), search%pivot, search%scales, search%qtf, search%bound, &
                           search%parameter, step, work(:, 1), work(:, 2), work(:, 3))
                step = -step
                length = norm2(search%scales * step)
                if (minimum%steps == 0) search%bound = min(search%bound, length)
                x = minimum%x
                call add_step(model, search%free, x, step, is_cut)
                call model%evaluate(x, residuals, exists)
                minimum%evaluations = minimum%evaluations + 1
                new_norm = huge(norm)
                if (exists) new_norm = norm2(model%loss%bend(residuals))
                actual = -1
                if (0.1_dp * new_norm < norm) actual = 1 - (new_norm / norm)**2
                change = 0 ! R times the permuted step
                do j = 1, n
                    change(:j) = change(:j) + search%jacobian(:j, j) * step(search%pivot(j))
                end do
                predicted = (norm2(change) / norm)**2
                if (is_cut) then
                    slope = dot_product(search%qtf, change) / norm**2
                    predicted = -2 * slope - predicted
                else
                    slope = -(predicted + search%parameter * (length / norm)**2)
                    predicted = predicted + 2 * search%parameter * (length / norm)**2
                end if
            end associate
            ratio = 0
            if (predicted > 0) ratio = actual / predicted
            if (ratio <= 0.25_dp) then
                factor = 0.5_dp
                if (actual < 0) factor = 0.5_dp * slope / (slope + 0.5_dp * actual)
                if (0.1_dp * new_norm >= norm .or. factor < 0.1_dp) factor = 0.1_dp
                search%bound = factor * min(search%bound, 10 * length)
                search%parameter = search%parameter / factor
            else if (ratio >= 0.75_dp .or. .not. search%parameter > 0) then
                search%bound = 2 * length
                search%parameter = search%parameter / 2
            end if
            if (ratio >= 1.0e-4_dp) then
                minimum%x = x
                minimum%residuals = residuals
                minimum%sum_of_squares = new_norm**2
                minimum%steps = minimum%steps + 1
            end if
            minimum%has_converged = (abs(actual) <= least .and. predicted <= least .and. (predicted > 0 .or. .not. is_cut)) .or. &
                                    search%bound <= tolerance * norm2(search%scales * minimum%x(search%free))
            if (.not. exists .and. minimum%has_converged) then
                ! The steps came to nothing because there are no residuals near by, not because this is a minimum.
                minimum%has_converged = .false.
                is_valid = .false.
                return
            end if
            if (minimum%has_converged .or. ratio >= 1.0e-4_dp) return
            is_valid = minimum%evaluations < most_evaluations * search%n
        end do
    end subroutine take_step

    !> Adds a step to the parameters that move, as far as their ranges allow.
    subroutine add_step(model, free, x, step, is_cut)
        class(residuals_t), intent(in) :: model
        integer, intent(in) :: free(:)
        real(dp), intent(inout) :: x(:), step(:) !! the step is that which was made
        logical, intent(out) :: is_cut !! whether a range did not allow it
        real(dp) :: wanted
        integer :: i
        is_cut = .false.
        do i = 1, size(free)
            wanted = x(free(i)) + step(i)
            if (abs(model%limited(free(i), wanted) - wanted) > 0) then
                is_cut = .true.
                wanted = model%limited(free(i), wanted)
                step(i) = wanted - x(free(i))
            end if
            x(free(i)) = wanted
        end do
    end subroutine add_step

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
                call find_difference(model, x, free(k), central_step, jacobian(:, k), has_both)
                if (has_both) call find_difference(model, x, free(k), central_step / 2, half, has_both)
                if (has_both .and. present(errors)) errors(:, k) = 2 * abs(half - jacobian(:, k))
                if (has_both) jacobian(:, k) = half + (half - jacobian(:, k)) / 3
                step = central_step / 2
            end if
            if (.not. has_both) then
                call find_difference(model, x, free(k), one_sided_step, jacobian(:, k), is_valid, residuals)
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

    !> The difference by a parameter over both sides; where the residuals at the parameters are given, over the side above, or if
    !> there are no residuals, below.
    subroutine find_difference(model, x, i, relative_step, slopes, is_valid, residuals)
        class(residuals_t), intent(inout) :: model
        real(dp), intent(in) :: x(:), relative_step
        integer, intent(in) :: i
        real(dp), intent(out) :: slopes(:)
        logical, intent(out) :: is_valid
        real(dp), intent(in), optional :: residuals(:)
        real(dp) :: moved(size(x)), others(size(slopes)), place, step

        step = relative_step * model%step_scale(i, x(i))
        moved = x
        moved(i) = x(i) + step
        call model%evaluate(moved, slopes, is_valid)
        if (present(residuals) .and. .not. is_valid) then
            moved(i) = x(i) - step
            call model%evaluate(moved, slopes, is_valid)
        end if
        if (.not. is_valid) return
        place = moved(i)
        if (present(residuals)) then
            moved(i) = x(i)
            others = residuals
        else
            moved(i) = x(i) - step
            call model%evaluate(moved, others, is_valid)
        end if
        if (is_valid) slopes = (slopes - others) / (place - moved(i))
    end subroutine find_difference

end module spintop_least_squares
