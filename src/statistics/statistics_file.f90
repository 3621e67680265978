!> Accumulators in a file: the snapshots from which an interrupted run resumes, and the results of parts of a sweep,
!> which are merged. The file begins with the header of the result as a table has it, so that it is identified by
!> program, build, input and part:
!>
!>     # part 1 of 3: ...
!>     # title: ...
!>     bin,cases,...
!>     spintop statistics 2
!>     (the plan, then the accumulators, as they are in memory)
!>     (their checksum, from the line above)
module spintop_statistics_file
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t
    use spintop_checksum, only: checksum_text, checksum_width
    use spintop_errors, only: error_t
    use spintop_files, only: file_size, input_file_t
    use spintop_state_stream, only: state_stream_t
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_table_head, only: read_head
    implicit none
    private
    public :: write_snapshot, write_part, read_statistics, is_statistics

    character, parameter :: nl = new_line('a')
    !> The line after the header.
    character(*), parameter :: first_line = 'spintop statistics 2' // nl

contains

    !> Writes a snapshot, which is not yet on the disk.
    subroutine write_snapshot(path, head, plan, accumulators, checksum, error)
        character(*), intent(in) :: path !! path of the file
        character(*), intent(in) :: head !! header of the result
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(accumulators_t), intent(inout) :: accumulators !! the statistics, which do not change
        character(checksum_width), intent(out) :: checksum !! of all after the header
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(state_stream_t) :: stream
        type(error_t), allocatable :: problem
        call write_all(path, head, plan, accumulators, stream, checksum)
        call stream%output%close(problem)
        call move_alloc(stream%error, error)
        if (.not. allocated(error)) call move_alloc(problem, error)
    end subroutine write_snapshot

    !> Writes the result of a part of a sweep, under another name until it is complete.
    subroutine write_part(path, head, plan, accumulators, error)
        character(*), intent(in) :: path !! path of the file
        character(*), intent(in) :: head !! header of the result
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(accumulators_t), intent(inout) :: accumulators !! the statistics, which do not change
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(state_stream_t) :: stream
        character(checksum_width) :: checksum
        call write_all(path // '.new', head, plan, accumulators, stream, checksum)
        call move_alloc(stream%error, error)
        if (.not. allocated(error)) call stream%output%finish_as(path, -1_int64, error)
        call stream%output%discard()
    end subroutine write_part

    subroutine write_all(path, head, plan, accumulators, stream, checksum)
        character(*), intent(in) :: path, head
        type(statistics_plan_t), intent(in) :: plan
        type(accumulators_t), intent(inout) :: accumulators
        type(state_stream_t), intent(inout) :: stream
        character(checksum_width), intent(out) :: checksum
        type(statistics_plan_t) :: copy
        character(len(first_line)) :: line

        line = first_line
        copy = plan
        call stream%output%create(path, stream%error)
        if (.not. allocated(stream%error)) call stream%output%write(head, stream%error)
        call stream%carry_text(line)
        call copy%carry(stream)
        call accumulators%store_or_restore(stream)
        checksum = checksum_text(stream%checksum)
        if (.not. allocated(stream%error)) call stream%output%write(checksum // nl, stream%error)
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
        allocate (character(len(head) + len(first_line)) :: line)
        call file%open(path, error)
        if (.not. allocated(error)) call file%read(line, length, error)
        call file%close()
        if (allocated(error)) return
        is_statistics = line(len(head) + 1:length) == first_line
    end function is_statistics

    !> Reads a file. An error if it is not whole.
    subroutine read_statistics(path, plan, accumulators, checksum, error)
        character(*), intent(in) :: path !! path of the file
        type(statistics_plan_t), intent(out) :: plan !! what is gathered, without the cells of a row
        type(accumulators_t), intent(out) :: accumulators !! the statistics
        character(checksum_width), intent(out) :: checksum !! of all after the header
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(state_stream_t) :: stream
        character(:), allocatable :: head
        character(len(first_line)) :: line
        character(checksum_width + len(nl)) :: last
        integer :: length

        checksum = ''
        call read_head(path, head, error)
        if (allocated(error)) return
        stream%is_read = .true.
        stream%size = file_size(path)
        call stream%input%open(path, stream%error)
        if (.not. allocated(stream%error)) call stream%input%read(head, length, stream%error)
        call stream%carry_text(line)
        if (line /= first_line) call stream%refuse()
        if (.not. allocated(stream%error)) call plan%carry(stream)
        if (.not. allocated(stream%error)) then
            call plan%start(accumulators)
            call accumulators%store_or_restore(stream)
            checksum = checksum_text(stream%checksum)
            call stream%carry_text(last)
            if (last /= checksum // nl) call stream%refuse()
        end if
        call stream%input%close()
        call move_alloc(stream%error, error)
    end subroutine read_statistics

end module spintop_statistics_file
