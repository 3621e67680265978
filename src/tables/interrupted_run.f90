!> Rows of an interrupted run that are on the disk according to its journal. They are discarded only on
!> request.
module spintop_interrupted_run
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: file_exists, output_file_t
    use spintop_journal, only: journal_entry_t, journal_of, read_journal
    use spintop_table_file, only: part_of
    use spintop_text, only: to_text
    implicit none
    private
    public :: refuse_to_discard, refuse_to_discard_idle

contains

    !> Returns an error if an interrupted run has left rows of a table, or a journal that cannot be read.
    subroutine refuse_to_discard(path, error)
        character(*), intent(in) :: path !! of the table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(journal_entry_t) :: entry
        character(:), allocatable :: problem, rows

        if (.not. (file_exists(part_of(path)) .and. file_exists(journal_of(path)))) return
        call read_journal(path, entry, problem)
        if (problem == '' .and. sum(entry%counts) == 0 .and. entry%state == 0) return
        rows = to_text(sum(entry%counts)) // ' rows are kept'
        if (problem /= '') rows = problem
        error = input_error('an interrupted run of ' // path // ' is there: ' // rows // new_line('a') // &
                            '--resume resumes it; --restart discards it and computes all from the beginning')
    end subroutine refuse_to_discard

    !> The same, except if a run is writing the table: its rows are not in danger, and it cannot be resumed.
    subroutine refuse_to_discard_idle(path, error)
        character(*), intent(in) :: path !! of the table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(error_t), allocatable :: in_use, ignored
        type(output_file_t) :: part

        call refuse_to_discard(path, error)
        if (.not. allocated(error)) return
        call part%open(part_of(path), in_use)
        call part%close(ignored)
        if (allocated(in_use)) deallocate (error)
    end subroutine refuse_to_discard_idle

end module spintop_interrupted_run
