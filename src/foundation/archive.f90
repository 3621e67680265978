!> The state of a run as bytes. What has a state names each part of it once, in one procedure, which stores the parts or
!> takes them back, as the archive wants:
!>
!>     call archive%carry(self%t)
!>     call archive%carry(c_loc(self%here), storage_size(self%here))   ! anything without pointers
!>
!> Only the program that stored a state can take it back.
module spintop_archive
    use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_loc, c_ptr
    use spintop_kinds, only: dp
    implicit none
    private
    public :: archive_t

    !> Bytes of a state.
    type :: archive_t
        !> Whether parts are taken from the bytes; otherwise they are added.
        logical :: recalls = .false.
        !> The bytes, and the number of those that were carried.
        character(:, c_char), allocatable :: bytes
        integer :: length = 0
    contains
        generic :: carry => carry_bytes, carry_real, carry_integer, carry_logical
        procedure, private :: carry_bytes
        procedure, private :: carry_real
        procedure, private :: carry_integer
        procedure, private :: carry_logical
    end type archive_t

    !> Room for bytes at first.
    integer, parameter :: first_room = 4096

contains

    !> Carries a number of bits in memory, a multiple of 8. Where there are fewer bytes, nothing is taken back.
    subroutine carry_bytes(self, first, bits)
        class(archive_t), intent(inout) :: self
        type(c_ptr), intent(in) :: first !! place of the first
        integer, intent(in) :: bits !! number of bits, such as `storage_size` gives
        character(kind=c_char), pointer :: there(:)
        character(:, c_char), allocatable :: more
        integer :: n, i

        n = bits / 8
        call c_f_pointer(first, there, [n])
        if (.not. allocated(self%bytes)) allocate (character(first_room) :: self%bytes)
        if (self%length + n > len(self%bytes)) then
            if (self%recalls) return
            allocate (character(2 * (self%length + n)) :: more)
            more(:self%length) = self%bytes(:self%length)
            call move_alloc(more, self%bytes)
        end if
        do i = 1, n
            if (self%recalls) then
                there(i) = self%bytes(self%length + i:self%length + i)
            else
                self%bytes(self%length + i:self%length + i) = there(i)
            end if
        end do
        self%length = self%length + n
    end subroutine carry_bytes

    !> Carries a real number.
    subroutine carry_real(self, x)
        class(archive_t), intent(inout) :: self
        real(dp), target, intent(inout) :: x !! the number
        call self%carry(c_loc(x), storage_size(x))
    end subroutine carry_real

    !> Carries an integer.
    subroutine carry_integer(self, n)
        class(archive_t), intent(inout) :: self
        integer, target, intent(inout) :: n !! the integer
        call self%carry(c_loc(n), storage_size(n))
    end subroutine carry_integer

    !> Carries a truth value.
    subroutine carry_logical(self, is_true)
        class(archive_t), intent(inout) :: self
        logical, target, intent(inout) :: is_true !! the truth value
        integer, target :: n
        n = merge(1, 0, is_true)
        call self%carry(c_loc(n), storage_size(n))
        is_true = n == 1
    end subroutine carry_logical

end module spintop_archive
