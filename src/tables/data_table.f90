!> A table in memory, column by column: what a run gives to a caller of the library.
module spintop_data_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, internal_error
    use spintop_kinds, only: dp
    use spintop_loaded_table, only: read_table, table_t
    use spintop_row_block, only: row_block_t
    use spintop_table_column, only: column_of_notes, column_of_words, column_t, table_column_t
    use spintop_text, only: split, string_t
    implicit none
    private
    public :: data_table_t, data_column_t, load_table

    !> Notes with which a new one is compared: most rows have none, or that of a row before.
    integer, parameter :: latest_notes = 16

    !> A column: numbers, or words.
    type, extends(column_t) :: data_column_t
        !> The numbers; of a column of words the number of the word in `words`, from 0.
        real(dp), allocatable :: values(:)
        !> The words that occur, or may occur, without order; not allocated for a column of numbers.
        type(string_t), allocatable :: words(:)
        !> Whether its words are the notes of cases; and how many words there are, behind which is room for more.
        logical, private :: has_notes = .false.
        integer, private :: used = 0
    end type data_column_t

    !> A table.
    type :: data_table_t
        !> What it is: `rows`, `events`, `statistics`, `histogram`, `indices`, `residuals`.
        character(16) :: name = ''
        integer(int64) :: rows = 0
        type(data_column_t), allocatable :: column(:)
        !> The text of its file without the rows: header, names of the columns, and lines at the end such as the status.
        character(:), allocatable :: frame
    contains
        procedure :: begin
        procedure :: add
    end type data_table_t

contains

    !> Begins a table of many cases, and makes room for all its rows.
    subroutine begin(self, columns, rows, error)
        class(data_table_t), intent(out) :: self
        type(table_column_t), intent(in) :: columns(:)
        integer(int64), intent(in) :: rows !! number of rows
        type(error_t), allocatable, intent(out) :: error !! there is not enough memory
        integer :: i, status
        real(dp) :: none

        self%name = 'rows'
        allocate (self%column(size(columns)))
        do i = 1, size(columns)
            associate (column => self%column(i))
                column%column_t = columns(i)%column_t
                if (columns(i)%kind == column_of_words) column%words = columns(i)%words
                column%has_notes = columns(i)%kind == column_of_notes
                if (column%has_notes) call find_word('', column, latest_notes, none)
                allocate (column%values(rows), stat=status)
            end associate
            if (status /= 0) then
                error = internal_error('not enough memory for a table of so many rows')
                return
            end if
        end do
    end subroutine begin

    !> Adds rows.
    subroutine add(self, block)
        class(data_table_t), intent(inout) :: self
        type(row_block_t), intent(in) :: block !! rows in their order, as cells
        integer :: i, k

        do i = 1, size(self%column)
            associate (column => self%column(i), first => self%rows)
                column%values(first + 1:first + block%rows) = block%cells(i, :block%rows)
                if (.not. column%has_notes) cycle
                column%values(first + 1:first + block%rows) = 0
                do k = 1, block%rows
                    if (.not. allocated(block%notes(k)%text)) cycle
                    call find_word(block%notes(k)%text, column, latest_notes, column%values(first + k))
                end do
            end associate
        end do
        self%rows = self%rows + block%rows
    end subroutine add

    !> Loads a CSV table that the program wrote, with the units and meanings of its columns.
    subroutine load_table(path, name, table, error)
        character(*), intent(in) :: path !! path of the file
        character(*), intent(in) :: name !! what it is
        type(data_table_t), intent(out) :: table !! the table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_t) :: loaded
        type(string_t), allocatable :: lines(:)
        integer :: i

        call read_table(path, loaded, error)
        if (allocated(error)) return
        call move_alloc(loaded%frame, table%frame)
        call split(table%frame, new_line('a'), lines)
        table%name = name
        allocate (table%column(size(loaded%names)))
        do i = 1, size(loaded%names)
            associate (column => table%column(i))
                column%name = loaded%names(i)%text
                call describe_column(lines, column)
                call read_cells(loaded, loaded%names(i)%text, column)
                table%rows = size(column%values)
            end associate
        end do
    end subroutine load_table

    !> Finds unit and meaning of a column in the header: `#     name [unit]: meaning`, after the line `# columns:`.
    pure subroutine describe_column(lines, column)
        type(string_t), intent(in) :: lines(:)
        type(data_column_t), intent(inout) :: column
        character(:), allocatable :: text
        integer :: i, first, last, colon
        logical :: below

        below = .false.
        do i = 1, size(lines)
            text = lines(i)%text
            if (below .and. index(text, '#     ' // trim(column%name)) == 1) then
                first = len('#     ' // trim(column%name)) + 1
                colon = index(text(first:), ': ') + first - 1
                if (text(first:first) == ':') then
                    column%what = text(first + 2:)
                    return
                else if (text(first:min(first + 1, len(text))) == ' [' .and. colon > first) then
                    last = index(text(:colon), ']', back=.true.)
                    column%unit = text(first + 2:last - 1)
                    column%what = text(colon + 2:)
                    return
                end if
            end if
            if (text == '# columns:') below = .true.
        end do
    end subroutine describe_column

    !> Reads the cells of a column: numbers if all are numbers, otherwise words.
    subroutine read_cells(loaded, name, column)
        type(table_t), intent(in) :: loaded
        character(*), intent(in) :: name
        type(data_column_t), intent(inout) :: column
        type(error_t), allocatable :: no_numbers
        type(string_t), allocatable :: cells(:)
        integer :: i

        call loaded%read_column(name, column%values, no_numbers)
        if (.not. allocated(no_numbers)) return
        allocate (cells, source=loaded%words(name))
        allocate (column%words(0))
        do i = 1, size(cells)
            call find_word(cells(i)%text, column, huge(i), column%values(i))
        end do
        column%words = column%words(:column%used)
    end subroutine read_cells

    !> Finds a word among the latest of a column, or adds it.
    subroutine find_word(word, column, latest, number)
        character(*), intent(in) :: word
        type(data_column_t), intent(inout) :: column
        integer, intent(in) :: latest !! number of words that are compared
        real(dp), intent(inout) :: number !! its number, from 0
        type(string_t), allocatable :: larger(:)
        integer :: k

        do k = column%used, max(1, column%used - latest), -1
            number = k - 1
            if (column%words(k)%text == word) return
        end do
        if (.not. allocated(column%words)) allocate (column%words(0))
        if (column%used == size(column%words)) then
            allocate (larger(max(1, 2 * column%used)))
            larger(:column%used) = column%words
            do k = column%used + 1, size(larger)
                larger(k)%text = ''
            end do
            call move_alloc(larger, column%words)
        end if
        number = column%used
        column%used = column%used + 1
        column%words(column%used)%text = word
    end subroutine find_word

end module spintop_data_table
