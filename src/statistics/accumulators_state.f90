!> Accumulators in a file, from which the same build can go on: their memory as it is, so that they come back
!> bit for bit. The reader starts accumulators alike (bins, columns, quantiles) before it reads.
module spintop_accumulators_state
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t, moments_t
    use spintop_checksum, only: add_to_checksum, checksum_t
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: file_size, input_file_t, output_file_t
    implicit none
    private
    public :: write_state, read_state

    !> Bytes that are written or read at once, about.
    integer, parameter :: block_size = 1024 * 1024

contains

    !> Writes accumulators where a file is open; `checksum` takes the bytes.
    subroutine write_state(accumulators, file, checksum, error)
        type(accumulators_t), intent(in) :: accumulators !! the statistics to write
        type(output_file_t), intent(in) :: file !! file descriptor
        type(checksum_t), intent(inout) :: checksum !! checksum of these bytes
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer :: i

        call put_integers(accumulators%cases)
        call put_integers(accumulators%failed)
        call put_integers(reshape(accumulators%words, [size(accumulators%words)]))
        call put_moments()
        do i = 1, size(accumulators%sizes)
            call put_counts()
        end do
        if (accumulators%groups%factors > 0) call put_groups()

    contains

        subroutine put(bytes)
            character(*), intent(in) :: bytes
            if (allocated(error)) return
            call add_to_checksum(checksum, bytes)
            call file%write(bytes, error)
        end subroutine put

        subroutine put_integers(numbers)
            integer(int64), intent(in) :: numbers(:)
            call put(transfer(numbers, repeat(' ', size(numbers) * (storage_size(numbers) / 8))))
        end subroutine put_integers

        subroutine put_moments()
            integer(int64) :: first, last
            integer :: width
            width = size(accumulators%moments, 1) * (storage_size(accumulators%moments) / 8)
            do first = 1, accumulators%bin_count + 1, bins_at_once(width)
                last = min(first + bins_at_once(width) - 1, accumulators%bin_count + 1)
                call put(transfer(accumulators%moments(:, first:last), repeat(' ', width * int(last - first + 1))))
            end do
        end subroutine put_moments

        subroutine put_counts()
            integer(int64), allocatable :: numbers(:)
            call accumulators%sizes(i)%pack_counts(numbers)
            call put_integers([size(numbers, kind=int64)])
            call put_integers(numbers)
        end subroutine put_counts

        subroutine put_groups()
            integer(int64), allocatable :: numbers(:)
            call accumulators%groups%pack_groups(numbers)
            call put_integers([size(numbers, kind=int64)])
            call put_integers(numbers)
        end subroutine put_groups

    end subroutine write_state

    !> Reads accumulators from where a file is open; `checksum` takes the bytes. An error if the file ends before
    !> they do. Only where the checksum is right may they be used.
    subroutine read_state(accumulators, file, checksum, error)
        type(accumulators_t), intent(inout) :: accumulators !! started
        type(input_file_t), intent(in) :: file !! file descriptor
        type(checksum_t), intent(inout) :: checksum !! checksum of these bytes
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer(int64), allocatable :: numbers(:)
        logical :: is_valid
        integer :: i

        call read_integers(file, checksum, size(accumulators%cases, kind=int64), numbers, error)
        if (.not. allocated(error)) accumulators%cases = numbers
        call read_integers(file, checksum, size(accumulators%failed, kind=int64), numbers, error)
        if (.not. allocated(error)) accumulators%failed = numbers
        call read_integers(file, checksum, size(accumulators%words, kind=int64), numbers, error)
        if (.not. allocated(error)) accumulators%words = reshape(numbers, shape(accumulators%words))
        call read_moments(accumulators, file, checksum, error)
        do i = 1, size(accumulators%sizes)
            call read_list(file, checksum, numbers, error)
            if (allocated(error)) return
            call accumulators%sizes(i)%unpack_counts(numbers, is_valid)
            if (.not. is_valid) error = damaged(file)
        end do
        if (accumulators%groups%factors == 0) return
        call read_list(file, checksum, numbers, error)
        if (allocated(error)) return
        call accumulators%groups%unpack_groups(numbers, is_valid)
        if (.not. is_valid) error = damaged(file)
    end subroutine read_state

    !> Reads bytes, unless there is an error.
    subroutine read_bytes(file, checksum, bytes, error)
        type(input_file_t), intent(in) :: file
        type(checksum_t), intent(inout) :: checksum
        character(*), intent(inout) :: bytes
        type(error_t), allocatable, intent(inout) :: error
        integer :: length
        if (allocated(error)) return
        call file%read(bytes, length, error)
        if (allocated(error)) return
        if (length < len(bytes)) error = input_error(file%path // ' is shorter than it should be')
        call add_to_checksum(checksum, bytes(:length))
    end subroutine read_bytes

    !> Reads integers, unless there is an error.
    subroutine read_integers(file, checksum, count, numbers, error)
        type(input_file_t), intent(in) :: file
        type(checksum_t), intent(inout) :: checksum
        integer(int64), value :: count !! a copy: it may come from the numbers that it replaces
        integer(int64), allocatable, intent(inout) :: numbers(:)
        type(error_t), allocatable, intent(inout) :: error
        character(:), allocatable :: bytes
        if (allocated(error)) return
        if (allocated(numbers)) deallocate (numbers)
        allocate (numbers(count))
        bytes = repeat(' ', int(count) * (storage_size(numbers) / 8))
        call read_bytes(file, checksum, bytes, error)
        if (.not. allocated(error)) numbers = transfer(bytes, numbers, int(count))
    end subroutine read_integers

    !> Reads integers after their number.
    subroutine read_list(file, checksum, numbers, error)
        type(input_file_t), intent(in) :: file
        type(checksum_t), intent(inout) :: checksum
        integer(int64), allocatable, intent(inout) :: numbers(:)
        type(error_t), allocatable, intent(inout) :: error
        integer(int64) :: bytes
        call read_integers(file, checksum, 1_int64, numbers, error)
        if (allocated(error)) return
        ! A damaged length must not ask for memory without end.
        bytes = file_size(file%path)
        if (numbers(1) < 0 .or. numbers(1) > bytes / (storage_size(numbers) / 8)) then
            error = damaged(file)
        else
            call read_integers(file, checksum, numbers(1), numbers, error)
        end if
    end subroutine read_list

    !> Reads the moments of all bins, unless there is an error.
    subroutine read_moments(accumulators, file, checksum, error)
        type(accumulators_t), intent(inout) :: accumulators
        type(input_file_t), intent(in) :: file
        type(checksum_t), intent(inout) :: checksum
        type(error_t), allocatable, intent(inout) :: error
        character(:), allocatable :: bytes
        integer(int64) :: first, last
        integer :: width, columns, bins

        columns = size(accumulators%moments, 1)
        width = columns * (storage_size(accumulators%moments) / 8)
        bytes = repeat(' ', width * int(bins_at_once(width)))
        do first = 1, accumulators%bin_count + 1, bins_at_once(width)
            last = min(first + bins_at_once(width) - 1, accumulators%bin_count + 1)
            bins = int(last - first + 1)
            call read_bytes(file, checksum, bytes(:width * bins), error)
            if (allocated(error)) return
            accumulators%moments(:, first:last) = &
                reshape(transfer(bytes(:width * bins), [moments_t ::], columns * bins), [columns, bins])
        end do
    end subroutine read_moments

    !> The error of a file with contents that were not written like that.
    type(error_t) function damaged(file)
        type(input_file_t), intent(in) :: file
        damaged = input_error(file%path // ' is damaged')
    end function damaged

    !> Bins whose moments are about a block.
    pure integer(int64) function bins_at_once(width)
        integer, intent(in) :: width !! bytes of a bin
        bins_at_once = max(1, block_size / max(width, 1))
    end function bins_at_once

end module spintop_accumulators_state
