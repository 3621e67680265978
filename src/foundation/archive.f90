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
        !> The numbers, how many of them were stored or restored, and whether what was wanted back was never stored.
        real(dp), allocatable, private :: numbers(:)
        integer, private :: length = 0
        logical, private :: is_damaged = .false.
    contains
        generic :: store_or_restore => store_or_restore_real, store_or_restore_reals, store_or_restore_integer, &
            store_or_restore_long, store_or_restore_logical, store_or_restore_text
        procedure :: store_or_restore_count
        procedure :: store_or_restore_list
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
                self%is_damaged = .true.
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
        integer(int64) :: long
        long = n
        call self%store_or_restore_long(long)
        if (abs(long) <= huge(n)) then
            n = int(long)
        else
            self%is_damaged = .true.
        end if
    end subroutine store_or_restore_integer

    !> Stores or restores an integer of at most 2^53.
    subroutine store_or_restore_long(self, n)
        class(archive_t), intent(inout) :: self
        integer(int64), intent(inout) :: n !! the integer
        real(dp), parameter :: largest = 2.0_dp**53
        real(dp) :: x
        x = real(n, dp)
        call self%store_or_restore_real(x)
        if (abs(x) <= largest) then
            n = nint(x, int64)
        else
            self%is_damaged = .true.
        end if
    end subroutine store_or_restore_long

    !> Stores or restores the size of a list, of whose elements each is at least one number: 0 if there are not so many.
    subroutine store_or_restore_count(self, n)
        class(archive_t), intent(inout) :: self
        integer, intent(inout) :: n !! the size
        call self%store_or_restore_integer(n)
        if (.not. self%restores) return
        if (n < 0 .or. n > size(self%numbers) - self%length) self%is_damaged = .true.
        if (self%is_damaged) n = 0
    end subroutine store_or_restore_count

    !> Stores or restores a list of real numbers with its size. One that is not allocated comes back empty.
    subroutine store_or_restore_list(self, x)
        class(archive_t), intent(inout) :: self
        real(dp), allocatable, intent(inout) :: x(:) !! the numbers
        integer :: n
        n = 0
        if (allocated(x)) n = size(x)
        call self%store_or_restore_count(n)
        if (allocated(x)) then
            if (size(x) /= n) deallocate (x)
        end if
        if (.not. allocated(x)) allocate (x(n), source=0.0_dp)
        call self%store_or_restore_reals(x)
    end subroutine store_or_restore_list

    !> Stores or restores a truth value.
    subroutine store_or_restore_logical(self, is_true)
        class(archive_t), intent(inout) :: self
        logical, intent(inout) :: is_true !! the truth value
        real(dp) :: x
        x = merge(1, 0, is_true)
        call self%store_or_restore_real(x)
        is_true = x > 0
    end subroutine store_or_restore_logical

    !> Stores or restores a text of fixed length: the bytes of numbers.
    subroutine store_or_restore_text(self, text)
        class(archive_t), intent(inout) :: self
        character(*), intent(inout) :: text !! the text
        real(dp) :: x((len(text) + width - 1) / width)
        character(width * size(x)) :: bytes
        bytes = text
        x = transfer(bytes, x)
        call self%store_or_restore_reals(x)
        text = transfer(x, bytes)
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
        self%is_damaged = modulo(len(bytes), width) /= 0
        self%numbers = transfer(bytes, self%numbers, len(bytes) / width)
    end subroutine load

    !> Whether all that was stored has been restored, and nothing else was wanted.
    pure logical function has_restored_all(self)
        class(archive_t), intent(in) :: self
        has_restored_all = self%restores .and. .not. self%is_damaged
        if (has_restored_all) has_restored_all = self%length == size(self%numbers)
    end function has_restored_all

end module spintop_archive
