!> A table of many cases that stays in memory, column by column.
module spintop_memory_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_data_table, only: data_table_t
    use spintop_errors, only: error_t, internal_error
    use spintop_kinds, only: dp
    use spintop_row_block, only: row_block_t
    use spintop_row_table, only: row_table_t
    use spintop_table_column, only: column_of_notes, column_of_words
    use spintop_text, only: string_t
    implicit none
    private
    public :: memory_table_t

    !> A table in memory.
    type, extends(row_table_t) :: memory_table_t
        type(data_table_t) :: data
        !> Number of texts in the column of notes.
        integer, private :: texts = 0
    contains
        procedure :: begin
        procedure :: append
        procedure :: finish
        procedure :: abandon
    end type memory_table_t

contains

    !> Begins a table with the current columns, and makes room for all its rows.
    subroutine begin(self, rows, error)
        class(memory_table_t), intent(inout) :: self
        integer(int64), intent(in) :: rows !! number of rows
        type(error_t), allocatable, intent(out) :: error !! there is not enough memory
        integer :: i, status

        self%remark = ''
        self%data%name = 'rows'
        allocate (self%data%column(size(self%columns)))
        do i = 1, size(self%columns)
            associate (column => self%data%column(i), described => self%columns(i))
                column%column_t = described%column_t
                if (described%kind == column_of_words) column%words = described%words
                if (described%kind == column_of_notes) then
                    allocate (column%words(1))
                    column%words(1)%text = ''
                end if
                allocate (column%values(rows), stat=status)
                if (status == 0) cycle
            end associate
            error = internal_error('not enough memory for a table of so many rows')
            return
        end do
        self%texts = 1
    end subroutine begin

    !> Adds rows.
    subroutine append(self, block, error)
        class(memory_table_t), intent(inout) :: self
        type(row_block_t), intent(in) :: block !! rows in their order
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer(int64) :: first
        integer :: i, k

        if (allocated(error)) return
        first = self%data%rows
        do i = 1, size(self%columns)
            associate (values => self%data%column(i)%values(first + 1:first + block%rows))
                if (self%columns(i)%kind == column_of_notes) then
                    do k = 1, block%rows
                        values(k) = 0
                        if (allocated(block%notes(k)%text)) values(k) = number_of(self, i, block%notes(k)%text)
                    end do
                else
                    values = block%cells(i, :block%rows)
                end if
            end associate
        end do
        self%data%rows = first + block%rows
        self%counts = self%counts + block%counts
        self%doubtful = self%doubtful + block%doubtful
    end subroutine append

    !> Number of a note, from 0. The latest notes are compared with it: most rows have none, or that of a row before.
    real(dp) function number_of(self, i, text) result(number)
        class(memory_table_t), intent(inout) :: self
        integer, intent(in) :: i !! the column
        character(*), intent(in) :: text
        integer, parameter :: latest = 16
        type(string_t), allocatable :: larger(:)
        integer :: k

        do k = self%texts, max(1, self%texts - latest), -1
            number = k - 1
            if (self%data%column(i)%words(k)%text == text) return
        end do
        if (self%texts == size(self%data%column(i)%words)) then
            allocate (larger(2 * self%texts))
            larger(:self%texts) = self%data%column(i)%words
            do k = self%texts + 1, size(larger)
                larger(k)%text = ''
            end do
            call move_alloc(larger, self%data%column(i)%words)
        end if
        number = self%texts
        self%texts = self%texts + 1
        self%data%column(i)%words(self%texts)%text = text
    end function number_of

    !> The table is complete; nothing is left to do.
    subroutine finish(self, error)
        class(memory_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (allocated(error)) return
    end subroutine finish

    !> Discards the rows after an error.
    subroutine abandon(self, error)
        class(memory_table_t), intent(inout) :: self
        type(error_t), intent(inout) :: error !! not changed
        self%data%rows = 0
    end subroutine abandon

end module spintop_memory_table
