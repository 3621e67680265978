!> A plan of statistics as bytes, which the same build can read: with it the accumulators of parts can be merged,
!> and their result written, without the input, whose other files need not be there.
module spintop_packed_plan
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_table_column, only: table_column_t
    implicit none
    private
    public :: pack_plan, unpack_plan

    !> Bytes of an integer or a real.
    integer, parameter :: width = 8
    !> More groups than any sweep has: each number of them is a real.
    integer(int64), parameter :: most_groups = 2_int64**53

    !> Bytes from which parts are taken one after the other (`recalls`), or to which they are added.
    type :: packed_t
        logical :: recalls = .false.
        character(:), allocatable :: bytes
        !> Number of bytes that were taken.
        integer :: at = 0
        !> Whether there was all that was taken so far.
        logical :: is_valid = .true.
    contains
        procedure :: store_or_restore_bytes
        procedure :: carry_number
        procedure :: carry_count
        procedure :: carry_flag
        procedure :: carry_reals
        procedure :: carry_column
        procedure :: carry_columns
    end type packed_t

contains

    !> The bytes of a plan.
    function pack_plan(plan) result(bytes)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        character(:), allocatable :: bytes
        type(statistics_plan_t) :: copy
        type(packed_t) :: packed
        copy = plan
        packed%bytes = ''
        call carry_plan(packed, copy)
        bytes = packed%bytes
    end function pack_plan

    !> The plan of some bytes; it does not know the cells of a row.
    subroutine unpack_plan(bytes, plan, is_valid)
        character(*), intent(in) :: bytes !! as `pack_plan` makes them
        type(statistics_plan_t), intent(out) :: plan !! what is gathered
        logical, intent(out) :: is_valid !! whether the bytes are a plan
        type(packed_t) :: packed
        integer :: i

        packed%recalls = .true.
        packed%bytes = bytes
        plan%is_wanted = .true.
        call carry_plan(packed, plan)
        is_valid = packed%is_valid .and. packed%at == len(bytes)
        do i = 1, size(plan%over)
            if (is_valid) is_valid = size(plan%over(i)%bins%edge) == size(plan%over(i)%bins%value) + 1
        end do
        if (is_valid .and. size(plan%factors) > 0) then
            is_valid = plan%has_indices() .and. plan%groups >= 1 .and. plan%groups <= most_groups
        end if
    end subroutine unpack_plan

    !> Carries a plan.
    subroutine carry_plan(packed, plan)
        type(packed_t), intent(inout) :: packed
        type(statistics_plan_t), intent(inout) :: plan
        integer, parameter :: most_over = 2
        integer :: i, n

        n = 0
        if (allocated(plan%over)) n = size(plan%over)
        call packed%carry_count(n)
        if (packed%recalls) then
            packed%is_valid = packed%is_valid .and. n <= most_over
            allocate (plan%over(min(n, most_over)))
        end if
        do i = 1, size(plan%over)
            call packed%carry_column(plan%over(i)%column)
            call packed%carry_reals(plan%over(i)%bins%edge)
            call packed%carry_reals(plan%over(i)%bins%value)
        end do
        call packed%carry_columns(plan%numbers)
        call packed%carry_columns(plan%categories)
        call packed%carry_reals(plan%shares)
        call packed%carry_flag(plan%by_bin)
        call packed%carry_flag(plan%is_netcdf)
        call packed%carry_columns(plan%factors)
        call packed%carry_number(plan%groups)
    end subroutine carry_plan

    !> Carries bytes. Where there are fewer, nothing is taken.
    subroutine store_or_restore_bytes(self, part)
        class(packed_t), intent(inout) :: self
        character(*), intent(inout) :: part
        if (.not. self%recalls) then
            self%bytes = self%bytes // part
            return
        end if
        self%is_valid = self%is_valid .and. len(part) <= len(self%bytes) - self%at
        if (.not. self%is_valid) return
        part = self%bytes(self%at + 1:self%at + len(part))
        self%at = self%at + len(part)
    end subroutine store_or_restore_bytes

    !> Stores or restores an integer.
    subroutine carry_number(self, number)
        class(packed_t), intent(inout) :: self
        integer(int64), intent(inout) :: number
        character(width) :: bytes
        bytes = transfer(number, bytes)
        call self%store_or_restore_bytes(bytes)
        number = transfer(bytes, number)
    end subroutine carry_number

    !> Carries the number of parts that follow, of a byte at least; 0 if there are not so many bytes.
    subroutine carry_count(self, count)
        class(packed_t), intent(inout) :: self
        integer, intent(inout) :: count
        integer(int64) :: number
        number = count
        call self%carry_number(number)
        if (self%recalls) self%is_valid = self%is_valid .and. number >= 0 .and. number <= len(self%bytes)
        count = 0
        if (self%is_valid) count = int(number)
    end subroutine carry_count

    !> Stores or restores a truth value.
    subroutine carry_flag(self, is_true)
        class(packed_t), intent(inout) :: self
        logical, intent(inout) :: is_true
        integer(int64) :: number
        number = merge(1, 0, is_true)
        call self%carry_number(number)
        is_true = number == 1
    end subroutine carry_flag

    !> Carries a list of reals.
    subroutine carry_reals(self, numbers)
        class(packed_t), intent(inout) :: self
        real(dp), allocatable, intent(inout) :: numbers(:)
        character(:), allocatable :: bytes
        integer :: n
        n = 0
        if (allocated(numbers)) n = size(numbers)
        call self%carry_count(n)
        bytes = repeat(' ', width * n)
        if (n > 0 .and. .not. self%recalls) bytes = transfer(numbers, bytes)
        call self%store_or_restore_bytes(bytes)
        if (self%recalls) numbers = transfer(bytes, [real(dp) ::], n)
    end subroutine carry_reals

    !> Carries the description of a column.
    subroutine carry_column(self, column)
        class(packed_t), intent(inout) :: self
        type(table_column_t), intent(inout) :: column
        integer :: k, n, length

        call self%store_or_restore_bytes(column%name)
        call self%store_or_restore_bytes(column%unit)
        call self%store_or_restore_bytes(column%what)
        call self%carry_count(column%kind)
        n = 0
        if (allocated(column%words)) n = size(column%words)
        call self%carry_count(n)
        if (self%recalls) allocate (column%words(n))
        do k = 1, n
            length = 0
            if (.not. self%recalls) length = len(column%words(k)%text)
            call self%carry_count(length)
            if (self%recalls) column%words(k)%text = repeat(' ', length)
            call self%store_or_restore_bytes(column%words(k)%text)
        end do
    end subroutine carry_column

    !> Carries a list of columns.
    subroutine carry_columns(self, columns)
        class(packed_t), intent(inout) :: self
        type(table_column_t), allocatable, intent(inout) :: columns(:)
        integer :: i, n
        n = 0
        if (allocated(columns)) n = size(columns)
        call self%carry_count(n)
        if (self%recalls) allocate (columns(n))
        do i = 1, n
            call self%carry_column(columns(i))
        end do
    end subroutine carry_columns

end module spintop_packed_plan
