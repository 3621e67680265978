!> The state of statistics to a file, or back from it, as it is in memory: it comes back bit for bit. What has a state names
!> each part of it once, in one procedure for both directions:
!>
!>     call stream%carry_numbers(size(self%cases), self%cases)
!>     call stream%carry_memory(c_loc(self%sums), bytes)      ! anything without pointers
!>
!> Only the build that wrote a state can read it, and only where the checksum is right may it be used. After an error nothing
!> more is carried.
module spintop_state_stream
    use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_loc, c_ptr
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_checksum, only: add_to_checksum, checksum_t
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: file_size, input_file_t, output_file_t
    use spintop_kinds, only: dp
    implicit none
    private
    public :: state_stream_t

    !> Bytes that are written or read at once.
    integer, parameter :: block_size = 1024 * 1024

    !> A state that is written, or read.
    type :: state_stream_t
        !> Whether it is read from `input`; otherwise it is written to `output`.
        logical :: is_read = .false.
        type(input_file_t) :: input
        type(output_file_t) :: output
        !> Of all that was carried.
        type(checksum_t) :: checksum
        !> The first error.
        type(error_t), allocatable :: error
    contains
        procedure :: carry_text
        procedure :: carry_count
        procedure :: carry_flag
        procedure :: carry_list
        procedure :: carry_numbers
        procedure :: carry_memory
        procedure :: refuse
    end type state_stream_t

contains

    !> Carries bytes; an error if the file ends before them.
    subroutine carry_text(self, text)
        class(state_stream_t), intent(inout) :: self
        character(*), intent(inout) :: text !! the bytes
        integer :: length
        if (allocated(self%error)) return
        length = len(text)
        if (self%is_read) then
            call self%input%read(text, length, self%error)
            if (length < len(text)) call self%refuse()
        else
            call self%output%write(text, self%error)
        end if
        call add_to_checksum(self%checksum, text(:length))
    end subroutine carry_text

    !> Carries the number of elements of a list, of which each takes so many bytes at least.
    subroutine carry_count(self, n, least)
        class(state_stream_t), intent(inout) :: self
        integer, intent(inout) :: n !! the number; 0 after an error
        integer, intent(in) :: least !! bytes of an element
        integer(int64) :: numbers(1)
        numbers = n
        call self%carry_numbers(1, numbers)
        if (.not. self%is_read) return
        ! A damaged file may not ask for more than it can contain.
        if (numbers(1) < 0 .or. numbers(1) > min(file_size(self%input%path) / least, int(huge(n), int64))) call self%refuse()
        n = 0
        if (.not. allocated(self%error)) n = int(numbers(1))
    end subroutine carry_count

    !> Carries a logical value.
    subroutine carry_flag(self, flag)
        class(state_stream_t), intent(inout) :: self
        logical, intent(inout) :: flag !! the value
        integer :: n
        n = merge(1, 0, flag)
        call self%carry_count(n, 1)
        flag = n == 1
    end subroutine carry_flag

    !> Carries a list of real numbers with its size. One that is not allocated comes back empty.
    subroutine carry_list(self, x)
        class(state_stream_t), intent(inout) :: self
        real(dp), allocatable, target, intent(inout) :: x(:) !! the numbers
        integer :: n
        n = 0
        if (allocated(x)) n = size(x)
        call self%carry_count(n, storage_size(x) / 8)
        if (self%is_read) allocate (x(n), source=0.0_dp)
        if (n > 0) call self%carry_memory(c_loc(x), n * (storage_size(x) / 8_int64))
    end subroutine carry_list

    !> Carries integers.
    subroutine carry_numbers(self, n, numbers)
        class(state_stream_t), intent(inout) :: self
        integer, intent(in) :: n !! number of them
        integer(int64), target, intent(inout) :: numbers(n) !! the integers
        if (n > 0) call self%carry_memory(c_loc(numbers), n * (storage_size(numbers) / 8_int64))
    end subroutine carry_numbers

    !> Carries what is in memory.
    subroutine carry_memory(self, first, bytes)
        class(state_stream_t), intent(inout) :: self
        type(c_ptr), intent(in) :: first !! place of the first byte
        integer(int64), intent(in) :: bytes !! number of bytes
        character(c_char), pointer :: there(:)
        integer(int64) :: at
        call c_f_pointer(first, there, [bytes])
        do at = 1, bytes, block_size
            call carry_block(int(min(int(block_size, int64), bytes - at + 1)), there(at))
        end do

    contains

        !> Carries consecutive bytes.
        subroutine carry_block(length, block)
            integer, intent(in) :: length
            character(length, c_char), intent(inout) :: block(1)
            call self%carry_text(block(1))
        end subroutine carry_block

    end subroutine carry_memory

    !> Makes the error of a file whose contents were not written like that, unless there is one.
    subroutine refuse(self)
        class(state_stream_t), intent(inout) :: self
        if (allocated(self%error)) return
        self%error = input_error(self%input%path // ' is damaged, or shorter than it should be')
    end subroutine refuse

end module spintop_state_stream
