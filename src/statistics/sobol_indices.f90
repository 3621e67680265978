!> First-order and total Sobol' indices of a quantity, from the design of Saltelli (`spintop_sample_design`): the shares
!> of its variance that are due to each factor alone, and to each factor with all its interactions.
!>
!> The estimators are those of M. J. W. Jansen, Computer Physics Communications 117, 1999, 35-43: with the values A, B
!> and C of the cases A, B, and A with the factor from B, of variance V, the first-order index is 1 - <(B - C)^2>/(2 V),
!> the total index <(A - C)^2>/(2 V). The errors come from a delete-a-group jackknife over consecutive parts of the
!> base points. Nothing depends on the order of the groups, nor on how they are divided among sums that are merged.
!>
!>     call indices%start(factors=3, groups=4096_int64)
!>     call indices%add(base, values)             ! A, B, and A with factor 1, 2, 3 from B
!>     call indices%estimate(factor=1, index)
module spintop_sobol_indices
    use, intrinsic :: iso_c_binding, only: c_loc
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_order_free_sum, only: exact_sum_t
    use spintop_kinds, only: dp, no_number, qp
    use spintop_state_stream, only: state_stream_t
    implicit none
    private
    public :: sobol_indices_t, sobol_index_t

    !> Parts of the base points, for the error; the quantile of Student's distribution with one degree of freedom less,
    !> for an interval of 95 %.
    integer, parameter :: parts = 16
    real(dp), parameter :: student = 2.131449545559323_dp
    !> The largest value whose difference from another is finite.
    real(dp), parameter :: largest_value = huge(1.0_dp) / 2

    !> The sums from which the indices follow.
    type :: sobol_indices_t
        integer :: factors = 0
        !> Groups of the design; those added to each part; those of which a value is missing.
        integer(int64) :: groups = 0, added(parts) = 0, left_out = 0
        !> Sums of the values A and B and of their squares; sums of (B - C)^2 and (A - C)^2 by factor and part.
        type(exact_sum_t) :: values(parts), squares(parts)
        type(exact_sum_t), allocatable :: first(:, :), total(:, :)
    contains
        procedure :: start
        procedure :: add
        procedure :: merge_with
        procedure :: estimate
        procedure :: packed_size
        procedure :: store_or_restore
    end type sobol_indices_t

    !> The indices of a factor, and half the width of their confidence intervals of 95 %; NaN where the quantity does not
    !> vary, or too few groups have values.
    type :: sobol_index_t
        real(dp) :: first = 0, total = 0, first_error = 0, total_error = 0
    end type sobol_index_t

contains

    !> Starts without groups.
    subroutine start(self, factors, groups)
        class(sobol_indices_t), intent(out) :: self
        integer, intent(in) :: factors !! number of factors
        integer(int64), intent(in) :: groups !! number of base points of the design
        self%factors = factors
        self%groups = groups
        allocate (self%first(factors, parts), self%total(factors, parts))
    end subroutine start

    !> Adds the values of a group. A group with a value that is not finite, or so large that differences overflow, is
    !> counted and left out.
    subroutine add(self, base, values)
        class(sobol_indices_t), intent(inout) :: self
        integer(int64), intent(in) :: base !! number of the base point, from 1
        real(dp), intent(in) :: values(:) !! of cases A and B, and of A with each factor from B
        integer :: part, i

        if (.not. all(abs(values) <= largest_value)) then
            self%left_out = self%left_out + 1
            return
        end if
        part = int((base - 1) / max(1_int64, (self%groups + parts - 1) / parts)) + 1
        self%added(part) = self%added(part) + 1
        do i = 1, 2
            call self%values(part)%add(values(i))
            call self%squares(part)%add_square(values(i))
        end do
        do i = 1, self%factors
            call self%first(i, part)%add_square(values(2) - values(2 + i))
            call self%total(i, part)%add_square(values(1) - values(2 + i))
        end do
    end subroutine add

    !> Adds the groups of another object that was started alike.
    subroutine merge_with(self, other)
        class(sobol_indices_t), intent(inout) :: self
        type(sobol_indices_t), intent(in) :: other !! sums over other groups of the same design
        integer :: i, part
        self%added = self%added + other%added
        self%left_out = self%left_out + other%left_out
        do part = 1, parts
            call self%values(part)%merge_with(other%values(part))
            call self%squares(part)%merge_with(other%squares(part))
            do i = 1, self%factors
                call self%first(i, part)%merge_with(other%first(i, part))
                call self%total(i, part)%merge_with(other%total(i, part))
            end do
        end do
    end subroutine merge_with

    !> The indices of a factor.
    subroutine estimate(self, factor, index)
        class(sobol_indices_t), intent(in) :: self
        integer, intent(in) :: factor !! number of the factor, from 1
        type(sobol_index_t), intent(out) :: index !! the indices, and their errors
        real(dp) :: without(2, parts), all_parts(2), errors(2)
        logical :: taken(parts)
        integer :: part, used

        taken = self%added > 0
        all_parts = indices_of(self, factor, taken)
        used = count(taken)
        errors = no_number
        if (used > 1) then
            without = 0
            do part = 1, parts
                if (.not. self%added(part) > 0) cycle
                taken(part) = .false.
                without(:, part) = indices_of(self, factor, taken)
                taken(part) = .true.
            end do
            errors = sum(without, dim=2) / used
            do part = 1, parts
                if (taken(part)) without(:, part) = (without(:, part) - errors)**2
            end do
            errors = student * sqrt(sum(without, dim=2) * (used - 1) / used)
        end if
        index = sobol_index_t(all_parts(1), all_parts(2), errors(1), errors(2))
    end subroutine estimate

    !> How many numbers of 64 bits the sums are.
    pure integer function packed_size(self)
        class(sobol_indices_t), intent(in) :: self
        packed_size = parts + 1 + (2 + 2 * self%factors) * parts * (storage_size(self%values) / storage_size(0_int64))
    end function packed_size

    !> Carries all sums.
    subroutine store_or_restore(self, stream)
        class(sobol_indices_t), target, intent(inout) :: self !! started alike if they are read
        type(state_stream_t), intent(inout) :: stream !! a file
        integer(int64) :: bytes
        bytes = storage_size(self%values) / 8
        call stream%carry_numbers(parts, self%added)
        call stream%carry_memory(c_loc(self%left_out), storage_size(self%left_out) / 8_int64)
        call stream%carry_memory(c_loc(self%values(1)), bytes * parts)
        call stream%carry_memory(c_loc(self%squares(1)), bytes * parts)
        call stream%carry_memory(c_loc(self%first(1, 1)), bytes * size(self%first))
        call stream%carry_memory(c_loc(self%total(1, 1)), bytes * size(self%total))
    end subroutine store_or_restore

    !> The first-order and the total index from some of the parts.
    pure function indices_of(self, factor, taken) result(indices)
        type(sobol_indices_t), intent(in) :: self
        integer, intent(in) :: factor
        logical, intent(in) :: taken(parts)
        real(dp) :: indices(2)
        real(qp) :: mean, variance, squares(2)
        integer(int64) :: groups
        integer :: part

        groups = sum(self%added, mask=taken)
        indices = no_number
        if (groups == 0) return
        mean = 0
        variance = 0
        squares = 0
        do part = 1, parts
            if (.not. taken(part)) cycle
            mean = mean + self%values(part)%total()
            variance = variance + self%squares(part)%total()
            squares = squares + [self%first(factor, part)%total(), self%total(factor, part)%total()]
        end do
        mean = mean / (2 * groups)
        variance = variance / (2 * groups) - mean**2
        ! What is left of equal values is rounding.
        if (.not. variance > epsilon(1.0_dp)**2 * mean**2) return
        squares = squares / (2 * groups * variance)
        indices = real([1 - squares(1), squares(2)], dp)
    end function indices_of

end module spintop_sobol_indices
