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
    use spintop_sample_design, only: place_in_saltelli, saltelli_place_t
    use spintop_state_stream, only: state_stream_t
    implicit none
    private
    public :: sobol_indices_t, sobol_index_t, case_groups_t

    !> Parts of the base points, for the error; the quantile of Student's distribution with one degree of freedom less,
    !> for an interval of 95 %.
    integer, parameter :: parts = 16
    real(dp), parameter :: student = 2.131449545559323_dp
    !> Places of the sums of a part; after the last of these come those of the factors.
    integer, parameter :: of_values = 1, of_squares = 2, of_factors = 2
    !> The largest value whose difference from another is finite.
    real(dp), parameter :: largest_value = huge(1.0_dp) / 2

    !> The sums from which the indices follow.
    type :: sobol_indices_t
        integer :: factors = 0
        !> Groups of the design; those added to each part; those of which a value is missing.
        integer(int64) :: groups = 0, added(parts) = 0, left_out = 0
        !> Sums of each part: of the values A and B, and of their squares; of (B - C)^2 of each factor, and of (A - C)^2.
        type(exact_sum_t), allocatable :: sums(:, :)
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

    !> A group: its base point, which of its cases are there, and the values of these by case and column. A case without a
    !> value has a NaN.
    type :: group_t
        integer(int64) :: base = 0
        logical, allocatable :: is_there(:)
        real(dp), allocatable :: values(:, :)
    end type group_t

    !> The cases of the design, gathered group by group for the indices of columns. Groups are consecutive cases, which blocks
    !> and parts of a sweep may cut anywhere: the values of an unfinished group are kept until the others are added, or merged.
    !> Without factors nothing is gathered.
    !>
    !>     call groups%start(factors=3, groups=4096_int64, columns=2)
    !>     call groups%add(numbers, is_ok, values)
    !>     call groups%indices(column)%estimate(factor, index)
    type :: case_groups_t
        integer :: factors = 0
        !> Of each column.
        type(sobol_indices_t), allocatable :: indices(:)
        !> Number of unfinished groups: rarely more than two in a part, and none in a whole sweep.
        integer :: unfinished = 0
        type(group_t), allocatable, private :: group(:)
    contains
        procedure :: start => start_groups
        procedure :: add => add_cases
        procedure :: merge_with => merge_groups
        procedure :: store_or_restore => carry_groups
    end type case_groups_t

    !> Room for unfinished groups at the beginning.
    integer, parameter :: usual_room = 2

contains

    !> Starts without groups.
    impure elemental subroutine start(self, factors, groups)
        class(sobol_indices_t), intent(out) :: self
        integer, intent(in) :: factors !! number of factors
        integer(int64), intent(in) :: groups !! number of base points of the design
        self%factors = factors
        self%groups = groups
        allocate (self%sums(of_factors + 2 * factors, parts))
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
        associate (sums => self%sums(:, part))
            do i = 1, 2
                call sums(of_values)%add(values(i))
                call sums(of_squares)%add_square(values(i))
            end do
            do i = 1, self%factors
                call sums(of_factors + i)%add_square(values(2) - values(2 + i))
                call sums(of_factors + self%factors + i)%add_square(values(1) - values(2 + i))
            end do
        end associate
    end subroutine add

    !> Adds the groups of another object that was started alike.
    impure elemental subroutine merge_with(self, other)
        class(sobol_indices_t), intent(inout) :: self
        type(sobol_indices_t), intent(in) :: other !! sums over other groups of the same design
        self%added = self%added + other%added
        self%left_out = self%left_out + other%left_out
        call self%sums%merge_with(other%sums)
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
        packed_size = parts + 1 + (of_factors + 2 * self%factors) * parts * (storage_size(self%sums) / storage_size(0_int64))
    end function packed_size

    !> Carries all sums.
    subroutine store_or_restore(self, stream)
        class(sobol_indices_t), target, intent(inout) :: self !! started alike if they are read
        type(state_stream_t), intent(inout) :: stream !! a file
        call stream%carry_numbers(parts, self%added)
        call stream%carry_memory(c_loc(self%left_out), storage_size(self%left_out) / 8_int64)
        call stream%carry_memory(c_loc(self%sums(1, 1)), size(self%sums) * (storage_size(self%sums) / 8_int64))
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
            associate (sums => self%sums(:, part), first => of_factors + factor)
                mean = mean + sums(of_values)%total()
                variance = variance + sums(of_squares)%total()
                squares = squares + [sums(first)%total(), sums(first + self%factors)%total()]
            end associate
        end do
        mean = mean / (2 * groups)
        variance = variance / (2 * groups) - mean**2
        ! What is left of equal values is rounding.
        if (.not. variance > epsilon(1.0_dp)**2 * mean**2) return
        squares = squares / (2 * groups * variance)
        indices = real([1 - squares(1), squares(2)], dp)
    end function indices_of

    !> Starts with no cases.
    subroutine start_groups(self, factors, groups, columns)
        class(case_groups_t), intent(out) :: self
        integer, intent(in) :: factors !! number of factors of the design
        integer(int64), intent(in) :: groups !! number of groups of the whole design
        integer, intent(in) :: columns !! number of columns
        self%factors = factors
        allocate (self%indices(columns))
        call self%indices%start(factors, groups)
        allocate (self%group(usual_room))
    end subroutine start_groups

    !> Adds cases, in any order, each once.
    subroutine add_cases(self, numbers, is_ok, values)
        class(case_groups_t), intent(inout) :: self
        integer(int64), intent(in) :: numbers(:) !! numbers of the cases, from 1
        logical, intent(in) :: is_ok(:) !! a case that failed has no values
        real(dp), intent(in) :: values(:, :) !! of the columns of each case; one that is not finite is none
        type(saltelli_place_t) :: place
        integer :: k, i

        do k = 1, size(numbers)
            place = place_in_saltelli(numbers(k), self%factors)
            call find_group(self, place%base, i)
            associate (group => self%group(i))
                group%is_there(place%role) = .true.
                group%values(place%role, :) = no_number
                if (is_ok(k)) group%values(place%role, :) = values(:, k)
            end associate
            call end_group(self, i)
        end do
    end subroutine add_cases

    !> Adds the cases of another object that was started alike.
    subroutine merge_groups(self, other)
        class(case_groups_t), intent(inout) :: self
        type(case_groups_t), intent(in) :: other !! groups of other cases of the same design
        integer :: i, k, role

        call self%indices%merge_with(other%indices)
        do k = 1, other%unfinished
            call find_group(self, other%group(k)%base, i)
            associate (group => self%group(i), more => other%group(k))
                do role = 1, self%factors + 2
                    if (more%is_there(role)) group%values(role, :) = more%values(role, :)
                end do
                group%is_there = group%is_there .or. more%is_there
            end associate
            call end_group(self, i)
        end do
    end subroutine merge_groups

    !> Finds the unfinished group of a base point, or begins it.
    subroutine find_group(self, base, i)
        class(case_groups_t), intent(inout) :: self
        integer(int64), intent(in) :: base
        integer, intent(out) :: i !! its place
        type(group_t), allocatable :: more(:)
        do i = self%unfinished, 1, -1
            if (self%group(i)%base == base) return
        end do
        i = self%unfinished + 1
        if (i > size(self%group)) then
            allocate (more(2 * size(self%group)))
            more(:size(self%group)) = self%group
            call move_alloc(more, self%group)
        end if
        self%unfinished = i
        self%group(i)%base = base
        self%group(i)%is_there = spread(.false., 1, self%factors + 2)
        self%group(i)%values = spread(spread(no_number, 1, self%factors + 2), 2, size(self%indices))
    end subroutine find_group

    !> Takes a group, if it is complete, into the sums of each column; the last unfinished one takes its place.
    subroutine end_group(self, place)
        class(case_groups_t), intent(inout) :: self
        integer, intent(in) :: place
        integer :: i

        if (.not. all(self%group(place)%is_there)) return
        do i = 1, size(self%indices)
            call self%indices(i)%add(self%group(place)%base, self%group(place)%values(:, i))
        end do
        if (place < self%unfinished) self%group(place) = self%group(self%unfinished)
        self%unfinished = self%unfinished - 1
    end subroutine end_group

    !> Carries all: the sums of each column, and the unfinished groups.
    subroutine carry_groups(self, stream)
        class(case_groups_t), target, intent(inout) :: self !! started alike if they are read; what is there is replaced
        type(state_stream_t), intent(inout) :: stream !! a file
        integer(int64) :: there(1 + self%factors + 2) !! the base point, and which of its cases are there
        integer :: i, k, n

        do i = 1, size(self%indices)
            call self%indices(i)%store_or_restore(stream)
        end do
        n = self%unfinished
        there = 0
        call stream%carry_count(n, size(there))
        if (stream%is_read) self%unfinished = 0
        do k = 1, n
            i = k
            if (.not. stream%is_read) there = [self%group(i)%base, merge(1_int64, 0_int64, self%group(i)%is_there)]
            call stream%carry_numbers(size(there), there)
            if (there(1) < 1 .or. all(there(2:) == 1)) call stream%refuse()
            if (allocated(stream%error)) return
            if (stream%is_read) then
                call find_group(self, there(1), i)
                self%group(i)%is_there = there(2:) == 1
            end if
            call stream%carry_memory(c_loc(self%group(i)%values(1, 1)), &
                                     size(self%group(i)%values) * (storage_size(self%group(i)%values) / 8_int64))
        end do
    end subroutine carry_groups

end module spintop_sobol_indices
