!> Derivatives of computed quantities by central differences of many step sizes, extrapolated to none (Richardson,
!> Ridders 1982), with an estimate of their error. A quantity need not be known as a formula: it is computed at the
!> nodes of a number, and may fail at some of them.
!>
!>     nodes = nodes_around(x, keeps_sign)                   ! once per number
!>     values(i) = f(nodes%x(i))                             ! for each node that is valid
!>     call nodes%differentiate(values, derivative, error, row)   ! both NaN where there is no derivative
!>
!> A smooth error of the quantity, such as that of a numerical method, does not show in the differences. It shows in the
!> change of one difference if the quantity is computed anew, in other ways, at two nodes:
!>
!>     ends = nodes%ends(row)                                     ! the two nodes
!>     others(i, k) = g_k(nodes%x(i))                             ! for these
!>     call nodes%add_change(row, values, others, derivative, error)
module spintop_differences
    use spintop_kinds, only: dp, nan => no_number, is_finite
    implicit none
    private
    public :: nodes_t, node_count, nodes_around

    !> Number of step sizes, each a quarter of the one before, and the first, in units of the scale of the number.
    integer, parameter :: rows = 12
    real(dp), parameter :: ratio = 4, first_step = 0.02_dp
    !> Nodes of a number: itself, those above, those below.
    integer, parameter :: node_count = 1 + 2 * rows
    integer, parameter :: centre = 1, first_above = 2, first_below = 2 + rows
    !> Largest relative error of a derivative, and the largest in units of the rounding error of its difference: what
    !> has not converged to either is no derivative.
    real(dp), parameter :: largest_error = 1.0e-3_dp, largest_noise = 1.0e6_dp
    !> What the derivative must explain of the smallest difference: all but this part of the range of the values, or they
    !> only seem to converge.
    real(dp), parameter :: largest_rest = 1.0e-2_dp
    !> Factor of the estimates, which see the rounding errors of few values.
    real(dp), parameter :: safety = 4

    !> The nodes of a number.
    type :: nodes_t
        !> The number, and the values around it. Those that are not valid are the number itself.
        real(dp) :: x(node_count) = 0
        logical :: is_valid(node_count) = .false.
    contains
        procedure :: limit_to
        procedure :: differentiate
        procedure :: differentiate_together
        procedure :: ends
        procedure :: add_change
    end type nodes_t

contains

    !> The nodes around a number. The steps are in proportion to a number whose sign cannot change; to others, if they
    !> are small, in proportion to 1; or to a given scale.
    pure type(nodes_t) function nodes_around(x, keeps_sign, scale) result(nodes)
        real(dp), intent(in) :: x !! the number
        logical, intent(in) :: keeps_sign !! whether its sign cannot change
        real(dp), intent(in), optional :: scale !! a change of the number that matters
        real(dp) :: step
        integer :: i

        nodes%x(centre) = x
        step = abs(x)
        if (.not. (step > 0 .and. keeps_sign)) step = max(step, 1.0_dp)
        if (present(scale)) step = scale
        step = first_step * step
        do i = 0, rows - 1
            nodes%x(first_above + i) = x + step
            nodes%x(first_below + i) = x - step
            step = step / ratio
        end do
        nodes%is_valid = abs(nodes%x - x) > 0
        nodes%is_valid(centre) = .true.
    end function nodes_around

    !> Leaves out the nodes outside the domain of the number.
    pure subroutine limit_to(self, in_domain)
        class(nodes_t), intent(inout) :: self
        logical, intent(in) :: in_domain(node_count) !! whether each node is in the domain
        self%is_valid = self%is_valid .and. in_domain
        self%x = merge(self%x, self%x(centre), self%is_valid)
    end subroutine limit_to

    !> The derivative at the number, and the estimate of its error. Both are NaN where the differences do not converge, as
    !> at a jump, a kink or an end of what the quantity is defined for. At an end of the domain it is that of the one side.
    pure subroutine differentiate(self, values, derivative, error, row)
        class(nodes_t), intent(in) :: self
        real(dp), intent(in) :: values(node_count) !! of the quantity at the nodes; NaN where it has none
        real(dp), intent(out) :: derivative !! per unit of the number
        real(dp), intent(out) :: error !! the estimate of its error
        integer, intent(out), optional :: row !! the last difference from which it is extrapolated; 0 where there is none
        real(dp) :: derivatives(1), errors(1), noise(rows), bend(rows)
        integer :: best

        call extrapolate(self, reshape(values, [1, node_count]), derivatives, errors, best, noise, bend)
        derivative = derivatives(1)
        error = errors(1)
        if (best > 0) then
            if (.not. error <= largest_error * abs(derivative) + largest_noise * noise(best) .or. &
                has_kink(bend(best - 1:), noise(best - 1:))) best = 0
        end if
        if (present(row)) row = best
        if (best > 0) return
        derivative = nan
        error = nan
    end subroutine differentiate

    !> The derivatives of quantities that belong together, as those at the times of a motion, with estimates of their errors.
    !> The same step sizes are best for all of them: what agrees by chance in one of them does not count. Where a quantity has
    !> no value next to the number, all are NaN.
    pure subroutine differentiate_together(self, values, derivatives, errors)
        class(nodes_t), intent(in) :: self
        real(dp), intent(in) :: values(:, :) !! of the quantities (rows) at the nodes (columns); NaN where they have none
        real(dp), intent(out) :: derivatives(:) !! per unit of the number
        real(dp), intent(out) :: errors(:) !! the estimates of their errors
        real(dp) :: noise(rows), bend(rows)
        integer :: best
        call extrapolate(self, values, derivatives, errors, best, noise, bend)
    end subroutine differentiate_together

    !> Extrapolates the differences of quantities to no step. Without a difference to end at, all is NaN.
    pure subroutine extrapolate(self, values, derivatives, errors, best, noise, bend)
        class(nodes_t), intent(in) :: self
        real(dp), intent(in) :: values(:, :)
        real(dp), intent(out) :: derivatives(:), errors(:)
        integer, intent(out) :: best !! the last difference from which they are extrapolated; 0 where there is none
        real(dp), intent(out) :: noise(rows) !! rounding errors of the differences
        real(dp), intent(out) :: bend(rows) !! second differences over the step; zero at an end of the domain
        real(dp), dimension(size(derivatives), 0:rows - 1) :: now, last
        real(dp), dimension(size(derivatives)) :: rounding, change
        real(dp) :: factor, least, range, width
        integer :: above, below, first, i, k, one, other

        best = 0
        derivatives = nan
        errors = nan
        noise = 0
        bend = 0
        least = huge(least)
        range = 0
        width = 0
        call find_sides(self%is_valid, above, below)
        factor = ratio**2
        if (above == centre .or. below == centre) factor = ratio
        first = rows + 1
        do i = rows, 1, -1
            if (.not. (is_there(node(above, i)) .and. is_there(node(below, i)) .and. is_there(centre))) exit
            first = i
        end do
        do i = first, rows
            ! Not the functions themselves: gfortran 14 does not know them in an associate.
            one = node(above, i)
            other = node(below, i)
            associate (up => values(:, one), down => values(:, other), middle => values(:, centre))
                width = self%x(one) - self%x(other)
                now(:, 0) = (up - down) / width
                rounding = 2 * epsilon(1.0_dp) * max(abs(up), abs(down), abs(middle)) / width
                noise(i) = norm2(rounding)
                if (factor > ratio) bend(i) = norm2(up - middle + (down - middle)) / width
                range = max(range, norm2(up - middle), norm2(down - middle))
            end associate
            do k = 1, i - first
                now(:, k) = now(:, k - 1) + (now(:, k - 1) - last(:, k - 1)) / (factor**k - 1)
                change = max(abs(now(:, k) - now(:, k - 1)), abs(now(:, k) - last(:, k - 1))) + rounding
                if (.not. norm2(change) < least) cycle
                least = norm2(change)
                derivatives = now(:, k)
                errors = safety * change
                best = i
            end do
            last(:, :i - first) = now(:, :i - first)
        end do
        if (best > 0) then
            if (norm2(last(:, 0) - derivatives) <= largest_noise * noise(rows) + largest_rest * range / width) return
        end if
        best = 0
        derivatives = nan
        errors = nan

    contains

        !> Whether all quantities have values at a node.
        pure logical function is_there(i)
            integer, intent(in) :: i
            is_there = self%is_valid(i) .and. all(is_finite(values(:, i)))
        end function is_there

    end subroutine extrapolate

    !> The two nodes of a difference.
    pure function ends(self, row)
        class(nodes_t), intent(in) :: self
        integer, intent(in) :: row !! of a derivative (`differentiate`), above 0
        integer :: ends(2)
        integer :: above, below
        call find_sides(self%is_valid, above, below)
        ends = [node(above, row), node(below, row)]
    end function ends

    !> Adds to the error of a derivative the most that its last difference changes by if the quantity is computed in other ways.
    !> Both become NaN if it is not found in one of them.
    pure subroutine add_change(self, row, values, others, derivative, error)
        class(nodes_t), intent(in) :: self
        integer, intent(in) :: row !! of the derivative (`differentiate`); nothing changes with 0
        real(dp), intent(in) :: values(node_count) !! of the quantity at the nodes
        real(dp), intent(in) :: others(:, :) !! the same in each other way; only those at the ends of the difference matter
        real(dp), intent(inout) :: derivative, error !! as found by `differentiate`
        real(dp) :: change(size(others, 2))
        integer :: ends(2)

        if (row == 0) return
        ends = self%ends(row)
        change = (others(ends(1), :) - values(ends(1))) - (others(ends(2), :) - values(ends(2)))
        error = error + safety * maxval(abs(change / (self%x(ends(1)) - self%x(ends(2)))))
        if (all(is_finite(change))) return
        derivative = nan
        error = nan
    end subroutine add_change

    !> The first nodes of the differences: those above and below, or the number itself where one side is outside the
    !> domain down to the smallest step.
    pure subroutine find_sides(is_valid, above, below)
        logical, intent(in) :: is_valid(node_count)
        integer, intent(out) :: above, below
        above = first_above
        below = first_below
        if (.not. is_valid(first_above + rows - 1)) above = centre
        if (.not. is_valid(first_below + rows - 1)) below = centre
    end subroutine find_sides

    !> The node of a step size on one side.
    pure integer function node(side, i)
        integer, intent(in) :: side, i
        node = side
        if (side /= centre) node = side + i - 1
    end function node

    !> Whether the slopes of both sides differ, from second differences over the step: those of a smooth quantity are
    !> quartered with the step, and those of a kink are not.
    pure logical function has_kink(bend, noise)
        real(dp), intent(in) :: bend(:), noise(:) !! from the step before that of the derivative
        integer :: i
        has_kink = .true.
        do i = 2, min(3, size(bend))
            has_kink = has_kink .and. abs(bend(i)) > max(abs(bend(i - 1)) / 2, largest_noise * noise(i))
        end do
    end function has_kink

end module spintop_differences
