!> A table in memory, column by column: what a run gives to a caller of the library.
module spintop_data_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t
    use spintop_kinds, only: dp
    use spintop_loaded_table, only: read_table, table_t
    use spintop_table_column, only: column_t
    use spintop_text, only: append, split, string_t
    implicit none
    private
    public :: data_table_t, data_column_t, load_table

    !> A column: numbers, or words.
    type, extends(column_t) :: data_column_t
        !> The numbers; of a column of words the number of the word in `words`, from 0.
        real(dp), allocatable :: values(:)
        !> The words that occur, or may occur, without order; not allocated for a column of numbers.
        type(string_t), allocatable :: words(:)
    end type data_column_t

    !> A table.
    type :: data_table_t
        !> What it is: `rows`, `events`, `statistics`, `histogram`, `indices`, `residuals`.
        character(16) :: name = ''
        integer(int64) :: rows = 0
        type(data_column_t), allocatable :: column(:)
        !> The text of its file without the rows: header, names of the columns, and lines at the end such as the status.
        character(:), allocatable :: frame
    end type data_table_t

contains

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
            column%values(i) = number_of(cells(i)%text, column)
        end do
    end subroutine read_cells

    !> Number of a word of a column, from 0; a new word is added.
    integer function number_of(word, column) result(number)
        character(*), intent(in) :: word
        type(data_column_t), intent(inout) :: column
        do number = size(column%words), 1, -1
            if (column%words(number)%text == word) exit
        end do
        if (number == 0) then
            call append(column%words, word)
            number = size(column%words)
        end if
        number = number - 1
    end function number_of

end module spintop_data_table
