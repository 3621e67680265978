!> The cases of the design of Saltelli, gathered group by group for the Sobol' indices of columns. Groups are
!> consecutive cases, which blocks and parts of a sweep may cut anywhere: the values of an unfinished group are kept
!> until the others are added, or merged.
!>
!>     call groups%start(factors=3, groups=4096_int64, columns=2)
!>     call groups%add(numbers, is_ok, values)
!>     call groups%indices(column)%estimate(factor, index)
module spintop_case_groups
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, no_number
    use spintop_sample_design, only: place_in_saltelli, saltelli_place_t
    use spintop_sobol_indices, only: sobol_indices_t
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
        procedure :: pack_groups
        procedure :: unpack_groups
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

    !> All sums and unfinished groups as a list of numbers, to be stored.
    subroutine pack_groups(self, numbers)
        class(case_groups_t), intent(in) :: self
        integer(int64), allocatable, intent(out) :: numbers(:) !! sums of each column, then the unfinished groups
        integer(int64), allocatable :: of_column(:)
        integer :: i, first, roles, columns

        roles = self%factors + 2
        columns = size(self%indices)
        allocate (of_column(self%indices(1)%packed_size()))
        allocate (numbers(columns * size(of_column) + self%unfinished * (1 + roles + roles * columns)))
        first = 1
        do i = 1, columns
            call self%indices(i)%pack_sums(of_column)
            call put(of_column)
        end do
        do i = 1, self%unfinished
            call put([self%bases(i)])
            call put(merge(1_int64, 0_int64, self%is_there(:, i)))
            call put(transfer(self%values(:, :, i), numbers, roles * columns))
        end do

    contains

        subroutine put(some)
            integer(int64), intent(in) :: some(:)
            numbers(first:first + size(some) - 1) = some
            first = first + size(some)
        end subroutine put

    end subroutine pack_groups

    !> Takes a stored list in place of what is there.
    subroutine unpack_groups(self, numbers, is_valid)
        class(case_groups_t), intent(inout) :: self
        integer(int64), intent(in) :: numbers(:) !! as `pack_groups` makes them
        logical, intent(out) :: is_valid !! the list is one that pack_groups could have made
        integer :: i, first, roles, columns, of_column, of_group

        roles = self%factors + 2
        columns = size(self%indices)
        of_column = self%indices(1)%packed_size()
        of_group = 1 + roles + roles * columns
        is_valid = size(numbers) >= columns * of_column
        if (is_valid) is_valid = mod(size(numbers) - columns * of_column, of_group) == 0
        if (.not. is_valid) return
        do i = 1, columns
            call self%indices(i)%unpack_sums(numbers((i - 1) * of_column + 1:i * of_column))
        end do
        self%unfinished = 0
        call self%make_room(max(usual_room, (size(numbers) - columns * of_column) / of_group))
        do first = columns * of_column + 1, size(numbers), of_group
            i = self%unfinished + 1
            self%unfinished = i
            self%bases(i) = numbers(first)
            self%is_there(:, i) = numbers(first + 1:first + roles) == 1
            self%values(:, :, i) = reshape(transfer(numbers(first + roles + 1:first + of_group - 1), [real(dp) ::], &
                                                    roles * columns), [roles, columns])
            is_valid = is_valid .and. self%bases(i) >= 1 .and. .not. all(self%is_there(:, i))
        end do
    end subroutine unpack_groups

end module spintop_case_groups
