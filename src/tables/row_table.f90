!> A table whose rows are added in the order of their cases, block by block.
!>
!>     call table%format(block)                      ! by any thread
!>     call table%append(block, error)               ! by one thread at a time, as
!>     call table%make_entry_if_due(entry, due, error)      ! this and `end_entry` are called;
!>     if (due) call table%keep_entry(entry, error)  ! this without holding up the others
!>     if (due) call table%end_entry()
!>     call table%finish(error)                      ! or, after an error, table%abandon(error)
module spintop_row_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t
    use spintop_journal, only: journal_entry_t
    use spintop_row_block, only: row_block_t
    use spintop_status, only: last_status
    use spintop_table_column, only: table_column_t
    implicit none
    private
    public :: row_table_t

    !> The common part of tables of all formats.
    type, abstract :: row_table_t
        type(table_column_t), allocatable :: columns(:)
        !> Number of rows with each status: written so far, and those of them from an earlier run.
        integer(int64) :: counts(0:last_status) = 0, taken_over(0:last_status) = 0
        !> Number of rows of this run that a note makes doubtful.
        integer(int64) :: doubtful = 0
        !> Whether the rows of an interrupted run are kept.
        logical :: is_resumable = .false.
        !> Whether the table already exists and is complete.
        logical :: is_complete = .false.
        !> Whether an entry of the journal is wanted at once, however old the last one is; whether one is being written.
        logical :: entry_wanted = .false., in_entry = .false.
        !> A remark on earlier runs, ready to print; may be empty.
        character(:), allocatable :: remark
    contains
        procedure :: rows
        procedure :: format => leave_rows
        procedure(append), deferred :: append
        procedure :: make_entry_if_due => make_no_entry
        procedure :: keep_entry => keep_no_entry
        procedure :: end_entry => end_no_entry
        procedure(finish), deferred :: finish
        procedure(abandon), deferred :: abandon
    end type row_table_t

    abstract interface
        !> Adds rows.
        subroutine append(self, block, error)
            import :: row_table_t, row_block_t, error_t
            class(row_table_t), intent(inout) :: self
            type(row_block_t), intent(in) :: block !! rows in their order
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine append

        !> Renames the file to the table, when all data are on the disk.
        subroutine finish(self, error)
            import :: row_table_t, error_t
            class(row_table_t), intent(inout) :: self
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine finish

        !> Ends the table after an error; the message is completed with what is kept of the table.
        subroutine abandon(self, error)
            import :: row_table_t, error_t
            class(row_table_t), intent(inout) :: self
            type(error_t), intent(inout) :: error !! its message is completed
        end subroutine abandon
    end interface

contains

    !> Number of rows so far.
    pure integer(int64) function rows(self)
        class(row_table_t), intent(in) :: self
        rows = sum(self%counts)
    end function rows

    !> Formats the cells of a block for the table; by default nothing is done.
    subroutine leave_rows(self, block)
        class(row_table_t), intent(in) :: self
        type(row_block_t), intent(inout) :: block !! not changed
    end subroutine leave_rows

    !> Makes an entry of the current size, if the table has a journal and the last entry is old enough; by
    !> default there is no journal.
    subroutine make_no_entry(self, entry, due, error)
        class(row_table_t), intent(inout) :: self
        type(journal_entry_t), intent(inout) :: entry !! not changed
        logical, intent(out) :: due !! whether an entry is due
        type(error_t), allocatable, intent(inout) :: error !! allocated on failure
        due = .false.
        if (allocated(error)) return
    end subroutine make_no_entry

    !> Waits until the rows of an entry are on the disk, and then writes the entry. Other threads may add rows
    !> meanwhile.
    subroutine keep_no_entry(self, entry, error)
        class(row_table_t), intent(in) :: self
        type(journal_entry_t), intent(in) :: entry !! entry of the journal
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (allocated(error)) return
    end subroutine keep_no_entry

    !> Called after an entry was written.
    subroutine end_no_entry(self)
        class(row_table_t), intent(inout) :: self
    end subroutine end_no_entry

end module spintop_row_table
