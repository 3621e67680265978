!> The cases of the design of Saltelli, gathered group by group for the Sobol' indices of columns. Groups are
!> consecutive cases, which blocks and parts of a sweep may cut anywhere: the values of an unfinished group are kept
!> until the others are added, or merged.
!>
!>     call groups%start(factors=3, groups=4096_int64, columns=2)
!>     call groups%add(numbers, is_ok, values)
!>     call groups%indices(column)%estimate(factor, index)
module spintop_case_groups
    use, intrinsic :: iso_c_binding, only: c_loc
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, no_number
    use spintop_sample_design, only: place_in_saltelli, saltelli_place_t
    use spintop_sobol_indices, only: sobol_indices_t
    use spintop_state_stream, only: state_stream_t
    implicit none
    private
    public :: case_groups_t

    !> A group: its base point, which of its cases are there, and the values of these by case and column. A case without a
    !> value has a NaN.
    type :: group_t
        integer(int64) :: base = 0
        logical, allocatable :: is_there(:)
        real(dp), allocatable :: values(:, :)
    end type group_t

    !> What was gathered; without factors nothing is.
    type :: case_groups_t
        integer :: factors = 0
        !> Of each column.
        type(sobol_indices_t), allocatable :: indices(:)
        !> Number of unfinished groups: rarely more than two in a part, and none in a whole sweep.
        integer :: unfinished = 0
        type(group_t), allocatable, private :: group(:)
    contains
        procedure :: start
        procedure :: add
        procedure :: merge_with
        procedure :: store_or_restore
    end type case_groups_t

    !> Room for unfinished groups at the beginning.
    integer, parameter :: usual_room = 2

contains

    !> Starts with no cases.
    subroutine start(self, factors, groups, columns)
        class(case_groups_t), intent(out) :: self
        integer, intent(in) :: factors !! number of factors of the design
        integer(int64), intent(in) :: groups !! number of groups of the whole design
        integer, intent(in) :: columns !! number of columns
        integer :: i
        self%factors = factors
        allocate (self%indices(columns))
        do i = 1, columns
            call self%indices(i)%start(factors, groups)
        end do
        allocate (self%group(usual_room))
    end subroutine start

    !> Adds cases, in any order, each once.
    subroutine add(self, numbers, is_ok, values)
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
    end subroutine add

    !> Adds the cases of another object that was started alike.
    subroutine merge_with(self, other)
        class(case_groups_t), intent(inout) :: self
        type(case_groups_t), intent(in) :: other !! groups of other cases of the same design
        integer :: i, k, role

        do i = 1, size(self%indices)
            call self%indices(i)%merge_with(other%indices(i))
        end do
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
    end subroutine merge_with

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

    !> Carries all: how many numbers follow, the sums of each column, then the unfinished groups.
    subroutine store_or_restore(self, stream)
        class(case_groups_t), target, intent(inout) :: self !! started alike if they are read; what is there is replaced
        type(state_stream_t), intent(inout) :: stream !! a file
        integer(int64) :: numbers(1), of_sums, of_group, k
        integer(int64) :: there(1 + self%factors + 2) !! the base point, and which of its cases are there
        integer :: i

        of_sums = size(self%indices) * int(self%indices(1)%packed_size(), int64)
        of_group = size(there) + (self%factors + 2) * size(self%indices)
        numbers = of_sums + self%unfinished * of_group
        there = 0
        call stream%carry_numbers(1, numbers)
        if (numbers(1) < of_sums .or. mod(numbers(1) - of_sums, of_group) /= 0) call stream%refuse()
        do i = 1, size(self%indices)
            call self%indices(i)%store_or_restore(stream)
        end do
        if (stream%is_read) self%unfinished = 0
        do k = 1, (numbers(1) - of_sums) / of_group
            i = int(k)
            if (.not. stream%is_read) there = [self%group(i)%base, merge(1_int64, 0_int64, self%group(i)%is_there)]
            call stream%carry_numbers(size(there), there)
            if (there(1) < 1 .or. all(there(2:) == 1)) call stream%refuse()
            if (allocated(stream%error)) return
            if (stream%is_read) then
                call find_group(self, there(1), i)
                self%group(i)%is_there = there(2:) == 1
            end if
            call stream%carry_memory(c_loc(self%group(i)%values(1, 1)), &
                                     (of_group - size(there)) * (storage_size(there) / 8))
        end do
    end subroutine store_or_restore

end module spintop_case_groups
