!> The state of a run as a list of numbers. What has a state names each part of it once, in one procedure, which stores the
!> parts or restores them, as the archive wants:
!>
!>     call archive%store_or_restore(self%t)
!>     call archive%store_or_restore(self%is_resting)
module spintop_archive
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    implicit none
    private
    public :: archive_t

    !> Numbers of a state.
    type :: archive_t
        !> Whether parts are taken from the numbers; otherwise they are added.
        logical :: restores = .false.
        !> The numbers, how many of them were stored or restored, and whether more were wanted back than there are.
        real(dp), allocatable, private :: numbers(:)
        integer, private :: length = 0
        logical, private :: is_short = .false.
    contains
        generic :: store_or_restore => store_or_restore_real, store_or_restore_reals, store_or_restore_integer, &
            store_or_restore_long, store_or_restore_logical, store_or_restore_text
        procedure, private :: store_or_restore_real
        procedure, private :: store_or_restore_reals
        procedure, private :: store_or_restore_integer
        procedure, private :: store_or_restore_long
        procedure, private :: store_or_restore_logical
        procedure, private :: store_or_restore_text
        procedure :: bytes
        procedure :: load
        procedure :: has_restored_all
    end type archive_t

    !> Room for numbers at first, and bytes of a number.
    integer, parameter :: first_room = 512, width = storage_size(1.0_dp) / 8

contains

    !> Stores or restores real numbers. Where there are fewer, nothing is restored: see `has_restored_all`.
    subroutine store_or_restore_reals(self, x)
        class(archive_t), intent(inout) :: self
        real(dp), intent(inout) :: x(:) !! the numbers
        real(dp), allocatable :: more(:)
        integer :: last
        if (.not. allocated(self%numbers)) allocate (self%numbers(first_room))
        last = self%length + size(x)
        if (last > size(self%numbers)) then
            if (self%restores) then
                self%is_short = .true.
                return
            end if
            allocate (more(2 * last))
            more(:self%length) = self%numbers(:self%length)
            call move_alloc(more, self%numbers)
        end if
        if (self%restores) then
            x = self%numbers(self%length + 1:last)
        else
            self%numbers(self%length + 1:last) = x
        end if
        self%length = last
    end subroutine store_or_restore_reals

    !> Stores or restores a real number.
    subroutine store_or_restore_real(self, x)
        class(archive_t), intent(inout) :: self
        real(dp), intent(inout) :: x !! the number
        real(dp) :: one(1)
        one = x
        call self%store_or_restore_reals(one)
        x = one(1)
    end subroutine store_or_restore_real

    !> Stores or restores an integer.
    subroutine store_or_restore_integer(self, n)
        class(archive_t), intent(inout) :: self
        integer, intent(inout) :: n !! the integer
        real(dp) :: x
        x = n
        call self%store_or_restore_real(x)
        n = nint(x)
    end subroutine store_or_restore_integer

    !> Stores or restores a count, which is less than 2^53.
    subroutine store_or_restore_long(self, n)
        class(archive_t), intent(inout) :: self
        integer(int64), intent(inout) :: n !! the count
        real(dp) :: x
        x = real(n, dp)
        call self%store_or_restore_real(x)
        n = nint(x, int64)
    end subroutine store_or_restore_long

    !> Stores or restores a truth value.
    subroutine store_or_restore_logical(self, is_true)
        class(archive_t), intent(inout) :: self
        logical, intent(inout) :: is_true !! the truth value
        real(dp) :: x
        x = merge(1, 0, is_true)
        call self%store_or_restore_real(x)
        is_true = x > 0
    end subroutine store_or_restore_logical

    !> Stores or restores a text of fixed length.
    subroutine store_or_restore_text(self, text)
        class(archive_t), intent(inout) :: self
        character(*), intent(inout) :: text !! the text
        integer :: i, code
        do i = 1, len(text)
            code = ichar(text(i:i))
            call self%store_or_restore_integer(code)
            text(i:i) = char(code)
        end do
    end subroutine store_or_restore_text

    !> The state as bytes.
    pure function bytes(self)
        class(archive_t), intent(in) :: self
        character(:), allocatable :: bytes
        allocate (character(width * self%length) :: bytes)
        bytes = transfer(self%numbers(:self%length), bytes)
    end function bytes

    !> Begins to restore the state that these bytes are.
    subroutine load(self, bytes)
        class(archive_t), intent(out) :: self
        character(*), intent(in) :: bytes !! the bytes
        self%restores = .true.
        self%numbers = transfer(bytes, self%numbers, len(bytes) / width)
    end subroutine load

    !> Whether all that was stored has been restored, and no more than that was wanted.
    pure logical function has_restored_all(self)
        class(archive_t), intent(in) :: self
        has_restored_all = self%restores .and. self%length == size(self%numbers) .and. .not. self%is_short
    end function has_restored_all

end module spintop_archive
