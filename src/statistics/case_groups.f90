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

    !> What was gathered; without factors nothing is.
    type :: case_groups_t
        integer :: factors = 0
        !> Of each column.
        type(sobol_indices_t), allocatable :: indices(:)
        !> Number of unfinished groups: rarely more than two in a part, and none in a whole sweep.
        integer :: unfinished = 0
        !> Their base points, which of their cases are there, and the values of these by case, column and group. A
        !> case without a value has a NaN.
        integer(int64), allocatable, private :: bases(:)
        logical, allocatable, private :: is_there(:, :)
        real(dp), allocatable, private :: values(:, :, :)
    contains
        procedure :: start
        procedure :: add
        procedure :: merge_with
        procedure :: carry
        procedure, private :: find_group
        procedure, private :: make_room
        procedure, private :: end_group
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
        allocate (self%bases(usual_room), self%is_there(factors + 2, usual_room), &
                  self%values(factors + 2, columns, usual_room))
    end subroutine start

    !> Adds cases, in any order, each once.
    subroutine add(self, numbers, is_ok, values)
        class(case_groups_t), intent(inout) :: self
        integer(int64), intent(in) :: numbers(:) !! numbers of the cases, from 1
        logical, intent(in) :: is_ok(:) !! a case that failed has no values
        real(dp), intent(in) :: values(:, :) !! of the columns of each case; one that is not finite is none
        type(saltelli_place_t) :: place
        integer :: k, group

        do k = 1, size(numbers)
            place = place_in_saltelli(numbers(k), self%factors)
            call self%find_group(place%base, group)
            self%is_there(place%role, group) = .true.
            self%values(place%role, :, group) = no_number
            if (is_ok(k)) self%values(place%role, :, group) = values(:, k)
            if (all(self%is_there(:, group))) call self%end_group(group)
        end do
    end subroutine add

    !> Adds the cases of another object that was started alike.
    subroutine merge_with(self, other)
        class(case_groups_t), intent(inout) :: self
        type(case_groups_t), intent(in) :: other !! the other object of this type
        integer :: i, role, group

        do i = 1, size(self%indices)
            call self%indices(i)%merge_with(other%indices(i))
        end do
        do i = 1, other%unfinished
            call self%find_group(other%bases(i), group)
            do role = 1, self%factors + 2
                if (.not. other%is_there(role, i)) cycle
                self%is_there(role, group) = .true.
                self%values(role, :, group) = other%values(role, :, i)
            end do
            if (all(self%is_there(:, group))) call self%end_group(group)
        end do
    end subroutine merge_with

    !> Finds the unfinished group of a base point, or begins it.
    subroutine find_group(self, base, group)
        class(case_groups_t), intent(inout) :: self
        integer(int64), intent(in) :: base
        integer, intent(out) :: group
        do group = self%unfinished, 1, -1
            if (self%bases(group) == base) return
        end do
        group = self%unfinished + 1
        if (group > size(self%bases)) call self%make_room(2 * size(self%bases))
        self%unfinished = group
        self%bases(group) = base
        self%is_there(:, group) = .false.
        self%values(:, :, group) = no_number
    end subroutine find_group

    !> Makes room for unfinished groups.
    subroutine make_room(self, groups)
        class(case_groups_t), intent(inout) :: self
        integer, intent(in) :: groups !! at least as many as there are
        integer(int64), allocatable :: bases(:)
        logical, allocatable :: is_there(:, :)
        real(dp), allocatable :: values(:, :, :)
        integer :: n

        n = self%unfinished
        allocate (bases(groups), is_there(size(self%is_there, 1), groups), &
                  values(size(self%values, 1), size(self%values, 2), groups))
        bases(:n) = self%bases(:n)
        is_there(:, :n) = self%is_there(:, :n)
        values(:, :, :n) = self%values(:, :, :n)
        call move_alloc(bases, self%bases)
        call move_alloc(is_there, self%is_there)
        call move_alloc(values, self%values)
    end subroutine make_room

    !> Takes a complete group into the sums of each column; the last unfinished one takes its place.
    subroutine end_group(self, group)
        class(case_groups_t), intent(inout) :: self
        integer, intent(in) :: group
        integer :: i, last

        do i = 1, size(self%indices)
            call self%indices(i)%add(self%bases(group), self%values(:, i, group))
        end do
        last = self%unfinished
        self%unfinished = last - 1
        if (group == last) return
        self%bases(group) = self%bases(last)
        self%is_there(:, group) = self%is_there(:, last)
        self%values(:, :, group) = self%values(:, :, last)
    end subroutine end_group

    !> Carries all: how many numbers follow, the sums of each column, then the unfinished groups.
    subroutine carry(self, stream)
        class(case_groups_t), target, intent(inout) :: self !! started alike if they are read; what is there is replaced
        type(state_stream_t), intent(inout) :: stream !! a file
        integer(int64) :: numbers(1), of_sums, of_group, k
        integer(int64) :: there(1 + self%factors + 2) !! the base point, and which of its cases are there
        integer :: i, group

        of_sums = size(self%indices) * int(self%indices(1)%packed_size(), int64)
        of_group = size(there) + size(self%values, 1) * size(self%values, 2)
        numbers = of_sums + self%unfinished * of_group
        there = 0
        call stream%carry_numbers(1, numbers)
        if (numbers(1) < of_sums .or. mod(numbers(1) - of_sums, of_group) /= 0) call stream%refuse()
        do i = 1, size(self%indices)
            call self%indices(i)%carry(stream)
        end do
        if (stream%is_read) self%unfinished = 0
        do k = 1, (numbers(1) - of_sums) / of_group
            group = int(k)
            if (.not. stream%is_read) there = [self%bases(group), merge(1_int64, 0_int64, self%is_there(:, group))]
            call stream%carry_numbers(size(there), there)
            if (there(1) < 1 .or. all(there(2:) == 1)) call stream%refuse()
            if (allocated(stream%error)) return
            if (stream%is_read) then
                call self%find_group(there(1), group)
                self%is_there(:, group) = there(2:) == 1
            end if
            call stream%carry_memory(c_loc(self%values(1, 1, group)), &
                                     (of_group - size(there)) * (storage_size(self%values) / 8))
        end do
    end subroutine carry

end module spintop_case_groups
