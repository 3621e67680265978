!> A table that takes its rows in the order of their cases, block by block.
!>
!>     call table%format(block)                      ! by any thread
!>     call table%put(block, error)                  ! by one thread at a time, as
!>     call table%take_entry(entry, due, error)      ! this and `end_entry` are called;
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

    !> What tables of every format have in common.
    type, abstract :: row_table_t
        type(table_column_t), allocatable :: columns(:)
        !> Rows of each status: written so far, and those of them kept from an earlier run.
        integer(int64) :: counts(0:last_status) = 0, taken_over(0:last_status) = 0
        !> Whether an interrupted run keeps its rows.
        logical :: is_resumable = .false.
        !> The table already exists and is complete.
        logical :: is_complete = .false.
        !> What was found of earlier runs, ready to print; empty if nothing.
        character(:), allocatable :: remark
    contains
        procedure :: rows
        procedure :: format => leave_rows
        procedure(put), deferred :: put
        procedure :: take_entry => take_no_entry
        procedure :: keep_entry => keep_no_entry
        procedure :: end_entry => end_no_entry
        procedure(finish), deferred :: finish
        procedure(abandon), deferred :: abandon
    end type row_table_t

    abstract interface
        !> Adds rows.
        subroutine put(self, block, error)
            import :: row_table_t, row_block_t, error_t
            class(row_table_t), intent(inout) :: self
            type(row_block_t), intent(in) :: block
            type(error_t), allocatable, intent(out) :: error
        end subroutine put

        !> Gives the table its name, once all of it is on the disk.
        subroutine finish(self, error)
            import :: row_table_t, error_t
            class(row_table_t), intent(inout) :: self
            type(error_t), allocatable, intent(out) :: error
        end subroutine finish

        !> Abandons the table after an error; the message then says what is kept of the table.
        subroutine abandon(self, error)
            import :: row_table_t, error_t
            class(row_table_t), intent(inout) :: self
            type(error_t), intent(inout) :: error
        end subroutine abandon
    end interface

contains

    !> Rows so far.
    pure integer(int64) function rows(self)
        class(row_table_t), intent(in) :: self
        rows = sum(self%counts)
    end function rows

    !> Formats the cells of a block for the table; here nothing is to be done.
    subroutine leave_rows(self, block)
        class(row_table_t), intent(in) :: self
        type(row_block_t), intent(inout) :: block
        associate (unused => self, also_unused => block)
        end associate
    end subroutine leave_rows

    !> Notes how far the table is, where it keeps a journal and the last entry is old enough: here
    !> it keeps none.
    subroutine take_no_entry(self, entry, due, error)
        class(row_table_t), intent(inout) :: self
        type(journal_entry_t), intent(inout) :: entry
        logical, intent(out) :: due
        type(error_t), allocatable, intent(inout) :: error
        associate (unused => self, also_unused => entry)
        end associate
        due = .false.
        if (allocated(error)) return
    end subroutine take_no_entry

    !> Makes sure that the rows of an entry are on the disk, and then the entry. Other threads may
    !> put rows meanwhile.
    subroutine keep_no_entry(self, entry, error)
        class(row_table_t), intent(in) :: self
        type(journal_entry_t), intent(in) :: entry
        type(error_t), allocatable, intent(out) :: error
        associate (unused => self, also_unused => entry)
        end associate
        if (allocated(error)) return
    end subroutine keep_no_entry

    !> The entry taken is kept.
    subroutine end_no_entry(self)
        class(row_table_t), intent(inout) :: self
        associate (unused => self)
        end associate
    end subroutine end_no_entry

end module spintop_row_table
