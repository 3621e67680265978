!> Accumulators in a file: the snapshots from which an interrupted run resumes, and the results of parts of a sweep,
!> which are merged. The file begins with the header of the result as a table has it, so that it is identified by
!> program, build, input and part:
!>
!>     # part 1 of 3: ...
!>     # title: ...
!>     bin,cases,...
!>     spintop statistics 1: 2380 bytes of plan
!>     (the plan, then the accumulators, as they are in memory)
!>     (their checksum, from the line above)
module spintop_statistics_file
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t
    use spintop_accumulators_state, only: read_state, write_state
    use spintop_checksum, only: add_to_checksum, checksum_t, checksum_text, checksum_width
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: file_size, input_file_t, output_file_t
    use spintop_packed_plan, only: pack_plan, unpack_plan
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_table_head, only: read_head
    implicit none
    private
    public :: write_snapshot, write_part, read_statistics, is_statistics

    character, parameter :: nl = new_line('a')
    character(*), parameter :: first_words = 'spintop statistics 1: '
    !> The line after the header, and its length.
    character(*), parameter :: line_format = '(ss, a, i10, " bytes of plan", a)'
    integer, parameter :: length_of_line = len(first_words) + 24 + len(nl)

contains

    !> Writes a snapshot, which is not yet on the disk.
    subroutine write_snapshot(path, head, plan, accumulators, checksum, error)
        character(*), intent(in) :: path !! path of the file
        character(*), intent(in) :: head !! header of the result
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(accumulators_t), intent(in) :: accumulators !! the statistics
        character(checksum_width), intent(out) :: checksum !! of all after the header
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(output_file_t) :: file
        type(error_t), allocatable :: problem

        checksum = ''
        call file%create(path, error)
        if (.not. allocated(error)) call write_all(file, head, plan, accumulators, checksum, error)
        call file%close(problem)
        if (.not. allocated(error)) call move_alloc(problem, error)
    end subroutine write_snapshot

    !> Writes the result of a part of a sweep, under another name until it is complete.
    subroutine write_part(path, head, plan, accumulators, error)
        character(*), intent(in) :: path !! path of the file
        character(*), intent(in) :: head !! header of the result
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(accumulators_t), intent(in) :: accumulators !! the statistics
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(checksum_width) :: checksum
        type(output_file_t) :: file

        call file%create(path // '.new', error)
        if (.not. allocated(error)) call write_all(file, head, plan, accumulators, checksum, error)
        if (.not. allocated(error)) call file%finish_as(path, -1_int64, error)
        call file%discard()
    end subroutine write_part

    subroutine write_all(file, head, plan, accumulators, checksum, error)
        type(output_file_t), intent(in) :: file
        character(*), intent(in) :: head
        type(statistics_plan_t), intent(in) :: plan
        type(accumulators_t), intent(in) :: accumulators
        character(checksum_width), intent(out) :: checksum
        type(error_t), allocatable, intent(out) :: error
        type(checksum_t) :: sum
        character(:), allocatable :: packed
        character(length_of_line) :: line

        checksum = ''
        packed = pack_plan(plan)
        write (line, line_format) first_words, len(packed), nl
        call add_to_checksum(sum, line // packed)
        call file%write(head // line // packed, error)
        if (.not. allocated(error)) call write_state(accumulators, file, sum, error)
        if (allocated(error)) return
        checksum = checksum_text(sum)
        call file%write(checksum // nl, error)
    end subroutine write_all

    !> Whether a file is one of these; false as well if it cannot be read.
    logical function is_statistics(path)
        character(*), intent(in) :: path !! path of the file
        type(input_file_t) :: file
        type(error_t), allocatable :: error
        character(:), allocatable :: head, line
        integer :: length

        is_statistics = .false.
        call read_head(path, head, error)
        if (allocated(error)) return
        allocate (character(len(head) + length_of_line) :: line)
        call file%open(path, error)
        if (.not. allocated(error)) call file%read(line, length, error)
        call file%close()
        if (allocated(error)) return
        is_statistics = index(line(len(head) + 1:length), first_words) == 1
    end function is_statistics

    !> Reads a file. An error if it is not whole.
    subroutine read_statistics(path, plan, accumulators, checksum, error)
        character(*), intent(in) :: path !! path of the file
        type(statistics_plan_t), intent(out) :: plan !! what is gathered, without the cells of a row
        type(accumulators_t), intent(out) :: accumulators !! the statistics
        character(checksum_width), intent(out) :: checksum !! of all after the header
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(input_file_t) :: file
        type(checksum_t) :: sum
        character(:), allocatable :: head, packed
        character(length_of_line) :: line, again
        character(checksum_width + len(nl)) :: last
        integer :: length, size_of_plan, status
        logical :: is_valid
        integer, parameter :: largest_plan = 2**30

        checksum = ''
        call read_head(path, head, error)
        if (allocated(error)) return
        call file%open(path, error)
        if (.not. allocated(error)) call file%read(head, length, error)
        if (.not. allocated(error)) call file%read(line, length, error)
        if (.not. allocated(error)) then
            read (line(len(first_words) + 1:len(first_words) + 10), '(i10)', iostat=status) size_of_plan
            is_valid = status == 0 .and. length == len(line)
            if (is_valid) then
                write (again, line_format) first_words, size_of_plan, nl
                is_valid = line == again .and. size_of_plan >= 0 .and. size_of_plan <= largest_plan
            end if
            if (.not. is_valid) error = damaged()
        end if
        if (.not. allocated(error)) then
            allocate (character(size_of_plan) :: packed)
            call file%read(packed, length, error)
        end if
        if (.not. allocated(error)) then
            call add_to_checksum(sum, line // packed)
            is_valid = length == len(packed)
            if (is_valid) call unpack_plan(packed, plan, is_valid)
            ! A damaged number of bins must not ask for memory without end.
            if (is_valid) is_valid = plan%bytes_of_bins() <= file_size(path)
            if (.not. is_valid) error = damaged()
        end if
        if (.not. allocated(error)) then
            call plan%start(accumulators)
            call read_state(accumulators, file, sum, error)
        end if
        if (.not. allocated(error)) call file%read(last, length, error)
        call file%close()
        if (allocated(error)) return
        checksum = checksum_text(sum)
        if (length < len(last) .or. last /= checksum // nl) error = damaged()

    contains

        type(error_t) function damaged()
            damaged = input_error(path // ' is damaged, or shorter than it should be')
        end function damaged

    end subroutine read_statistics

end module spintop_statistics_file
