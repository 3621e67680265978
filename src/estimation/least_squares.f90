!> Nonlinear least squares: the method of Levenberg and Marquardt in the form of More (1978), as in MINPACK's `lmder`, on its
!> routines `qrfac` and `lmpar`. Some of the parameters may be held. Parameters have ranges: steps are cut at their ends, and
!> a parameter that the sum of squares presses against an end stays there while the others move.
module spintop_least_squares
    use spintop_kinds, only: dp, is_finite
    use spintop_jacobian, only: find_jacobian
    use spintop_minpack, only: lmpar, qrfac
    use spintop_residuals, only: residuals_t
    implicit none
    private
    public :: residuals_t, minimum_t, minimize, find_jacobian

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

contains

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
        real(dp) :: x(size(minimum%x)), residuals(size(minimum%residuals)), norm, new_norm, length, actual, predicted, &
            slope, ratio, factor, least
        logical :: exists, is_cut

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
                predicted = (norm2(times_r(search, step)) / norm)**2
                if (is_cut) then
                    slope = dot_product(search%qtf, times_r(search, step)) / norm**2
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

    !> R times the permuted step.
    pure function times_r(search, step) result(product)
        type(search_t), intent(in) :: search
        real(dp), intent(in) :: step(:)
        real(dp) :: product(size(step))
        integer :: j
        product = 0
        do j = 1, size(step)
            product(:j) = product(:j) + search%jacobian(:j, j) * step(search%pivot(j))
        end do
    end function times_r

end module spintop_least_squares
