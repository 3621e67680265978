!> A plan of statistics as bytes, which the same build can read: with it the accumulators of parts can be merged,
!> and their result written, without the input.
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
    real(dp), parameter :: most_groups = 2.0_dp**53

    !> Bytes that are read from the first to the last.
    type :: packed_t
        character(:), allocatable :: bytes
        integer :: at = 0
        !> Whether there was all that was read so far.
        logical :: is_valid = .true.
    contains
        procedure :: put_integers
        procedure :: put_reals
        procedure :: put_text
        procedure :: put_columns
        procedure :: get_integer
        procedure :: get_integers
        procedure :: get_reals
        procedure :: get_text
        procedure :: get_columns
        procedure, private :: take
    end type packed_t

contains

    !> The bytes of a plan.
    function pack_plan(plan) result(bytes)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        character(:), allocatable :: bytes
        type(packed_t) :: packed
        integer :: i

        packed%bytes = ''
        call packed%put_integers([size(plan%over), merge(1, 0, plan%by_bin), merge(1, 0, plan%is_netcdf), &
                                  merge(1, 0, plan%has_indices())])
        do i = 1, size(plan%over)
            call packed%put_columns([plan%over(i)%column])
            call packed%put_reals(plan%over(i)%bins%edge)
            call packed%put_reals(plan%over(i)%bins%value)
        end do
        call packed%put_columns(plan%numbers)
        call packed%put_columns(plan%categories)
        call packed%put_reals(plan%shares)
        if (plan%has_indices()) then
            call packed%put_columns(plan%factors)
            call packed%put_reals([real(plan%groups, dp)])
        end if
        bytes = packed%bytes
    end function pack_plan

    !> The plan of some bytes; it does not know the cells of a row.
    subroutine unpack_plan(bytes, plan, is_valid)
        character(*), intent(in) :: bytes !! as `pack_plan` makes them
        type(statistics_plan_t), intent(out) :: plan !! what is gathered
        logical, intent(out) :: is_valid !! whether the bytes are a plan
        type(packed_t) :: packed
        type(table_column_t), allocatable :: column(:)
        integer, allocatable :: numbers(:)
        real(dp), allocatable :: groups(:)
        integer :: i

        packed%bytes = bytes
        call packed%get_integers(numbers)
        is_valid = packed%is_valid .and. size(numbers) == 4
        if (.not. is_valid) return
        plan%is_wanted = .true.
        plan%by_bin = numbers(2) == 1
        plan%is_netcdf = numbers(3) == 1
        is_valid = numbers(1) >= 0 .and. numbers(1) <= 2
        if (.not. is_valid) return
        allocate (plan%over(numbers(1)))
        do i = 1, size(plan%over)
            call packed%get_columns(column)
            call packed%get_reals(plan%over(i)%bins%edge)
            call packed%get_reals(plan%over(i)%bins%value)
            is_valid = packed%is_valid .and. size(column) == 1 &
                       .and. size(plan%over(i)%bins%edge) == size(plan%over(i)%bins%value) + 1
            if (.not. is_valid) return
            plan%over(i)%column = column(1)
        end do
        call packed%get_columns(plan%numbers)
        call packed%get_columns(plan%categories)
        call packed%get_reals(plan%shares)
        is_valid = packed%is_valid
        if (is_valid .and. numbers(4) == 1) then
            call packed%get_columns(plan%factors)
            call packed%get_reals(groups)
            is_valid = packed%is_valid .and. size(groups) == 1
            if (is_valid) is_valid = groups(1) >= 1 .and. groups(1) <= most_groups
            if (is_valid) plan%groups = int(groups(1), int64)
            is_valid = is_valid .and. plan%has_indices()
        end if
        is_valid = is_valid .and. packed%at == len(bytes)
    end subroutine unpack_plan

    subroutine put_integers(self, numbers)
        class(packed_t), intent(inout) :: self
        integer, intent(in) :: numbers(:)
        integer(int64) :: whole(size(numbers) + 1)
        whole = [size(numbers), numbers]
        self%bytes = self%bytes // transfer(whole, repeat(' ', width * size(whole)))
    end subroutine put_integers

    subroutine put_reals(self, numbers)
        class(packed_t), intent(inout) :: self
        real(dp), intent(in) :: numbers(:)
        call self%put_integers([size(numbers)])
        self%bytes = self%bytes // transfer(numbers, repeat(' ', width * size(numbers)))
    end subroutine put_reals

    subroutine put_text(self, text)
        class(packed_t), intent(inout) :: self
        character(*), intent(in) :: text
        call self%put_integers([len(text)])
        self%bytes = self%bytes // text
    end subroutine put_text

    subroutine put_columns(self, columns)
        class(packed_t), intent(inout) :: self
        type(table_column_t), intent(in) :: columns(:)
        integer :: i, k, words
        call self%put_integers([size(columns)])
        do i = 1, size(columns)
            words = 0
            if (allocated(columns(i)%words)) words = size(columns(i)%words)
            call self%put_integers([columns(i)%kind, words])
            call self%put_text(trim(columns(i)%name))
            call self%put_text(trim(columns(i)%unit))
            call self%put_text(trim(columns(i)%what))
            do k = 1, words
                call self%put_text(columns(i)%words(k)%text)
            end do
        end do
    end subroutine put_columns

    !> The next bytes; blanks where there are not so many.
    subroutine take(self, count, bytes)
        class(packed_t), intent(inout) :: self
        integer, intent(in) :: count
        character(:), allocatable, intent(out) :: bytes
        self%is_valid = self%is_valid .and. count >= 0 .and. count <= len(self%bytes) - self%at
        if (self%is_valid) then
            bytes = self%bytes(self%at + 1:self%at + count)
            self%at = self%at + count
        else
            bytes = ''
        end if
    end subroutine take

    subroutine get_integers(self, numbers)
        class(packed_t), intent(inout) :: self
        integer, allocatable, intent(out) :: numbers(:)
        character(:), allocatable :: bytes
        integer(int64) :: count
        integer(int64), allocatable :: whole(:)

        allocate (numbers(0))
        call self%take(width, bytes)
        if (.not. self%is_valid) return
        count = transfer(bytes, count)
        self%is_valid = count >= 0 .and. count <= len(self%bytes) / width
        if (.not. self%is_valid) return
        call self%take(width * int(count), bytes)
        if (.not. self%is_valid) return
        allocate (whole(count))
        whole = transfer(bytes, whole, int(count))
        self%is_valid = all(abs(whole) <= huge(1))
        if (self%is_valid) numbers = int(whole)
    end subroutine get_integers

    !> A list of one integer; 0 if it is not one.
    subroutine get_integer(self, number)
        class(packed_t), intent(inout) :: self
        integer, intent(out) :: number
        integer, allocatable :: numbers(:)
        call self%get_integers(numbers)
        self%is_valid = self%is_valid .and. size(numbers) == 1
        number = 0
        if (self%is_valid) number = numbers(1)
        self%is_valid = self%is_valid .and. number >= 0 .and. number <= len(self%bytes)
        if (.not. self%is_valid) number = 0
    end subroutine get_integer

    subroutine get_reals(self, numbers)
        class(packed_t), intent(inout) :: self
        real(dp), allocatable, intent(out) :: numbers(:)
        character(:), allocatable :: bytes
        integer :: count
        call self%get_integer(count)
        if (count > len(self%bytes) / width) self%is_valid = .false.
        if (.not. self%is_valid) count = 0
        call self%take(width * count, bytes)
        if (.not. self%is_valid) count = 0
        allocate (numbers(count))
        if (count > 0) numbers = transfer(bytes, numbers, count)
    end subroutine get_reals

    subroutine get_text(self, text)
        class(packed_t), intent(inout) :: self
        character(:), allocatable, intent(out) :: text
        integer :: count
        call self%get_integer(count)
        call self%take(count, text)
    end subroutine get_text

    subroutine get_columns(self, columns)
        class(packed_t), intent(inout) :: self
        type(table_column_t), allocatable, intent(out) :: columns(:)
        character(:), allocatable :: text
        integer, allocatable :: numbers(:)
        integer :: i, k, count

        call self%get_integer(count)
        allocate (columns(count))
        do i = 1, count
            call self%get_integers(numbers)
            self%is_valid = self%is_valid .and. size(numbers) == 2
            if (self%is_valid) self%is_valid = numbers(2) >= 0 .and. numbers(2) <= len(self%bytes)
            if (.not. self%is_valid) return
            columns(i)%kind = numbers(1)
            call self%get_text(text)
            columns(i)%name = text
            call self%get_text(text)
            columns(i)%unit = text
            call self%get_text(text)
            columns(i)%what = text
            if (.not. self%is_valid) return
            allocate (columns(i)%words(numbers(2)))
            do k = 1, numbers(2)
                call self%get_text(columns(i)%words(k)%text)
            end do
        end do
    end subroutine get_columns

end module spintop_packed_plan
