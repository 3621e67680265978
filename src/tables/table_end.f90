!> The last line of a complete table: the number of its rows, and the CRC-32 of all from the line of names on. By it a
!> table that was cut or changed after it was written is recognised.
!>
!>     t,theta
!>     0,0.3
!>     # status: ok
!>     # end: 1 rows, CRC-32 9C2E1F05
!>
!> The attribute `end` of a NetCDF table says the same of its rows as numbers of 64 bits, row by row.
module spintop_table_end
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_checksum, only: checksum_width
    use spintop_crc32, only: add_reals_to_crc32, add_to_crc32, crc32_t, crc32_text
    use spintop_errors, only: error_t
    use spintop_files, only: input_file_t, read_file
    use spintop_kinds, only: dp
    use spintop_literals, only: is_number_cell
    use spintop_status, only: last_status
    use spintop_status_counts, only: count_statuses
    use spintop_text, only: abbreviate, to_text
    implicit none
    private
    public :: table_end_t, table_check_t, check_table, check_table_text, place_of_summary

    character, parameter :: nl = new_line('a')
    character(*), parameter :: key = '# end: ', between = ' rows, CRC-32 '
    !> Bytes that are read at once.
    integer, parameter :: block_size = 1024 * 1024

    !> What the last line says of the bytes so far, which are added from the first of the table on.
    type :: table_end_t
        private
        logical :: in_head = .true., in_line = .false.
        !> Of the lines before the names, and of the rest.
        type(crc32_t) :: head = crc32_t(), crc = crc32_t()
        !> Rows that were added as numbers.
        integer(int64) :: of_numbers = 0
    contains
        procedure :: add
        procedure :: add_cells
        procedure :: summary
        procedure :: checksum
        procedure :: rows
        procedure :: line
    end type table_end_t

    !> Checks a table whose bytes are added in pieces. It keeps the last line, which is not one of the data.
    type :: table_check_t
        private
        type(table_end_t) :: ending
        character(:), allocatable :: last
    contains
        procedure :: begin
        procedure :: pass
        procedure :: has_end
        procedure :: is_right
        procedure :: rows => rows_so_far
    end type table_check_t

contains

    !> Adds bytes of a table.
    subroutine add(self, text)
        class(table_end_t), intent(inout) :: self
        character(*), intent(in) :: text !! the bytes after those that were added before
        integer :: first, break
        first = 1
        do while (self%in_head .and. first <= len(text))
            if (.not. self%in_line .and. text(first:first) /= '#') then
                self%in_head = .false.
                exit
            end if
            break = index(text(first:), nl)
            self%in_line = break == 0
            if (break == 0) break = len(text) - first + 1
            call add_to_crc32(self%head, text(first:first + break - 1))
            first = first + break
        end do
        call add_to_crc32(self%crc, text(first:))
    end subroutine add

    !> Number of rows so far.
    pure integer(int64) function rows(self)
        class(table_end_t), intent(in) :: self
        rows = max(0_int64, self%crc%lines - 1) + self%of_numbers
    end function rows

    !> A checksum of all bytes so far, for a journal.
    function checksum(self)
        class(table_end_t), intent(in) :: self
        character(checksum_width) :: checksum
        checksum = crc32_text(self%head) // crc32_text(self%crc)
    end function checksum

    !> The last line, ready to write.
    function line(self)
        class(table_end_t), intent(in) :: self
        character(:), allocatable :: line
        line = key // self%summary() // nl
    end function line

    !> Adds rows of numbers.
    subroutine add_cells(self, cells)
        class(table_end_t), intent(inout) :: self
        real(dp), intent(in), contiguous :: cells(:, :) !! the cell of column i in row k is `cells(i, k)`
        call add_reals_to_crc32(self%crc, cells)
        self%of_numbers = self%of_numbers + size(cells, 2)
    end subroutine add_cells

    !> The number of rows, and their checksum.
    function summary(self)
        class(table_end_t), intent(in) :: self
        character(:), allocatable :: summary
        summary = to_text(self%rows()) // between // crc32_text(self%crc)
    end function summary

    !> As long as the summary of a table with these rows, to keep its place.
    function place_of_summary(rows) result(place)
        integer(int64), intent(in) :: rows !! number of rows
        character(:), allocatable :: place
        type(crc32_t) :: nothing
        place = to_text(rows) // between // crc32_text(nothing)
    end function place_of_summary

    !> Begins to check a table.
    subroutine begin(self)
        class(table_check_t), intent(inout) :: self
        self%ending = table_end_t()
        self%last = ''
    end subroutine begin

    !> Adds bytes of the table, and gives back those that are now known to be before its last line.
    subroutine pass(self, text, passed)
        class(table_check_t), intent(inout) :: self
        character(*), intent(in) :: text !! the bytes after those that were added before
        character(:), allocatable, intent(out) :: passed !! bytes before the last line
        integer :: break
        passed = self%last // text
        break = index(passed(:len(passed) - 1), nl, back=.true.)
        self%last = passed(break + 1:)
        passed = passed(:break)
        call self%ending%add(passed)
    end subroutine pass

    !> Whether the table ends with such a line; tables of other programs and of earlier versions do not.
    pure logical function has_end(self)
        class(table_check_t), intent(in) :: self
        has_end = index(self%last, key) == 1
    end function has_end

    !> Whether the last line is that of the bytes before it.
    logical function is_right(self)
        class(table_check_t), intent(in) :: self
        character(:), allocatable :: expected
        expected = self%ending%line()
        is_right = self%last == expected .and. len(self%last) == len(expected)
    end function is_right

    !> Number of complete rows so far.
    pure integer(int64) function rows_so_far(self) result(rows)
        class(table_check_t), intent(in) :: self
        rows = self%ending%rows()
        if (index(self%last, nl) > 0 .and. index(self%last, '#') /= 1) rows = rows + 1
    end function rows_so_far

    !> Checks a table in a file, which must have its last line, and counts its rows by their status.
    subroutine check_table(path, problem, column, counts)
        character(*), intent(in) :: path !! path of the table
        character(:), allocatable, intent(out) :: problem !! why it is not complete, or not as it was written; '' if it is
        integer, intent(in), optional :: column !! number of the column of the statuses, after numbers; 0 if there is none
        integer(int64), intent(inout), optional :: counts(0:last_status) !! increased by the number of rows with each status
        type(input_file_t) :: file
        type(error_t), allocatable :: error
        type(table_check_t) :: check
        character(:), allocatable :: block, passed, text
        integer :: length

        problem = ''
        allocate (character(block_size) :: block)
        call check%begin()
        call file%open(path, error, is_text=.true.)
        do while (.not. allocated(error))
            call file%read(block, length, error)
            if (allocated(error) .or. length == 0) exit
            call check%pass(block(:length), passed)
            if (present(counts)) call count_statuses(passed, column, counts)
        end do
        call file%close()
        if (.not. allocated(error)) then
            if (check%is_right()) return
            call read_file(path, huge(0), text, error, is_text=.true.)
        end if
        if (allocated(error)) then
            problem = error%message
        else
            problem = path // ' ' // what_is_wrong(text, check)
        end if
    end subroutine check_table

    !> Checks a table in memory, if it has its last line.
    subroutine check_table_text(text, has_end, problem)
        character(*), intent(in) :: text !! the table
        logical, intent(out) :: has_end !! whether it has that line
        character(:), allocatable, intent(out) :: problem !! what is wrong; '' if nothing is known to be
        type(table_check_t) :: check
        character(:), allocatable :: passed

        problem = ''
        has_end = index(text, nl // key) > 0
        if (.not. has_end) return
        call check%begin()
        call check%pass(text, passed)
        if (.not. check%is_right()) problem = what_is_wrong(text, check)
    end subroutine check_table_text

    !> What is wrong with a table whose last line is not that of its rows: the first wrong row, where that can be told.
    function what_is_wrong(text, check) result(problem)
        character(*), intent(in) :: text
        type(table_check_t), intent(in) :: check
        character(:), allocatable :: problem
        integer(int64) :: said
        integer :: status

        problem = wrong_row(text)
        if (problem /= '') then
            problem = 'was changed after it was written: ' // problem
            return
        end if
        said = -1
        status = 0
        if (check%has_end()) read (check%last(len(key) + 1:), *, iostat=status) said
        if (status /= 0) said = -1
        if (index(text, nl // key) == 0) then
            problem = 'is not complete: after row ' // to_text(check%rows()) // ' a last line "' // key // 'N' // between // &
                      '..." is missing; it was cut, or written by an earlier version'
        else if (.not. check%has_end()) then
            problem = 'was changed after it was written: lines follow the one that begins with "' // trim(key) // '"'
        else if (said >= 0 .and. said /= check%rows()) then
            problem = 'was changed after it was written: it has ' // to_text(check%rows()) // ' rows, and its last line says ' // &
                      to_text(said)
        else
            problem = 'was changed after it was written: its rows do not have the CRC-32 of its last line'
        end if
    end function what_is_wrong

    !> The first row that has another number of cells, a word in place of a number, or is out of order; '' if there is none.
    function wrong_row(text) result(problem)
        character(*), intent(in) :: text
        character(:), allocatable :: problem
        logical, allocatable :: is_number(:)
        character(:), allocatable :: names
        real(dp) :: key_of_row, last_key, step
        integer :: first, last, line, row

        problem = ''
        names = ''
        line = 0
        row = -1
        step = 0
        first = 1
        do while (first <= len(text))
            last = first + index(text(first:) // nl, nl) - 2
            line = line + 1
            associate (cells => text(first:last))
                if (index(cells, '#') /= 1) then
                    row = row + 1
                    if (row == 0) then
                        names = cells
                        allocate (is_number(count_cells(cells)), source=.true.)
                    else
                        call check_row(cells)
                    end if
                end if
            end associate
            if (problem /= '') then
                problem = 'row ' // to_text(row) // ' (line ' // to_text(line) // ') ' // problem
                return
            end if
            first = last + 2
        end do

    contains

        !> Checks a row against the names and the rows before it.
        subroutine check_row(cells)
            character(*), intent(in) :: cells
            character(:), allocatable :: cell
            integer :: i, from, status
            logical :: counts
            if (count_cells(cells) /= size(is_number)) then
                problem = 'has ' // to_text(count_cells(cells)) // ' cells, not ' // to_text(size(is_number))
                return
            end if
            from = 1
            do i = 1, size(is_number)
                cell = cells(from:from + length_of_cell(cells(from:)) - 1)
                from = from + len(cell) + 1
                if (row == 1) then
                    is_number(i) = is_number_cell(cell)
                else if (is_number(i) .and. .not. is_number_cell(cell)) then
                    problem = "has '" // abbreviate(cell) // "' in place of a number"
                    return
                end if
            end do
            counts = any(names(:length_of_cell(names)) == ['case', 'bin '])
            if (.not. counts .and. names(:length_of_cell(names)) /= 't') return
            read (cells(:length_of_cell(cells)), *, iostat=status) key_of_row
            if (status /= 0) return
            if (row == 2) step = key_of_row - last_key
            if (row > 1 .and. ((key_of_row - last_key) * step < tiny(step) .or. (counts .and. &
                                                                             nint(key_of_row - last_key) /= 1))) then
                problem = 'is out of order: ' // names(:length_of_cell(names)) // ' is ' // cells(:length_of_cell(cells))
            end if
            last_key = key_of_row
        end subroutine check_row

    end function wrong_row

    !> Number of cells of a line.
    pure integer function count_cells(line) result(cells)
        character(*), intent(in) :: line
        integer :: first
        cells = 1
        first = 1
        do
            first = first + length_of_cell(line(first:)) + 1
            if (first > len(line) + 1) return
            cells = cells + 1
        end do
    end function count_cells

    !> Length of the first cell of a text; a comma within quotes belongs to it.
    pure integer function length_of_cell(text) result(length)
        character(*), intent(in) :: text
        logical :: is_quoted
        is_quoted = .false.
        do length = 0, len(text) - 1
            if (text(length + 1:length + 1) == '"') is_quoted = .not. is_quoted
            if (text(length + 1:length + 1) == ',' .and. .not. is_quoted) return
        end do
    end function length_of_cell

end module spintop_table_end
