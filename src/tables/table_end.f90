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
    use spintop_checksum, only: add_reals_to_checksum, add_to_checksum, checksum_t, checksum_text, checksum_width
    use spintop_errors, only: error_t
    use spintop_files, only: input_file_t, read_file
    use spintop_kinds, only: dp
    use spintop_literals, only: is_number_cell
    use spintop_status, only: last_status, status_number
    use spintop_text, only: abbreviate, end_of_line, string_t, to_text
    implicit none
    private
    public :: table_end_t, table_check_t, check_table, check_table_text, place_of_summary, status_of_ending

    character, parameter :: nl = new_line('a')
    character(*), parameter :: key = '# end: ', between = ' rows, CRC-32 '
    !> A comment below the rows that tells how a motion ended.
    character(*), parameter :: ending_key = '# status: '
    !> Bytes that are read at once.
    integer, parameter :: block_size = 1024 * 1024

    !> What the last line says of the bytes so far, which are added from the first of the table on.
    type :: table_end_t
        private
        logical :: in_head = .true., in_line = .false.
        !> Of the lines before the names, and of the rest.
        type(checksum_t) :: head = checksum_t(), crc = checksum_t()
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
        procedure :: pass
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
            call add_to_checksum(self%head, text(first:first + break - 1))
            first = first + break
        end do
        call add_to_checksum(self%crc, text(first:))
    end subroutine add

    !> Number of rows so far.
    pure integer(int64) function rows(self)
        class(table_end_t), intent(in) :: self
        rows = max(0_int64, self%crc%lines - 1) + self%of_numbers
    end function rows

    !> A checksum of all bytes so far, for a journal.
    function checksum(self)
        class(table_end_t), intent(in) :: self
        character(2 * checksum_width) :: checksum
        checksum = checksum_text(self%head) // checksum_text(self%crc)
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
        call add_reals_to_checksum(self%crc, cells, size(cells, kind=int64))
        self%of_numbers = self%of_numbers + size(cells, 2)
    end subroutine add_cells

    !> The number of rows, and their checksum.
    function summary(self)
        class(table_end_t), intent(in) :: self
        character(:), allocatable :: summary
        summary = to_text(self%rows()) // between // checksum_text(self%crc)
    end function summary

    !> As long as the summary of a table with these rows, to keep its place.
    function place_of_summary(rows) result(place)
        integer(int64), intent(in) :: rows !! number of rows
        character(:), allocatable :: place
        type(checksum_t) :: nothing
        place = to_text(rows) // between // checksum_text(nothing)
    end function place_of_summary

    !> Adds bytes of the table, and gives back those that are now known to be before its last line.
    subroutine pass(self, text, passed)
        class(table_check_t), intent(inout) :: self
        character(*), intent(in) :: text !! the bytes after those that were added before
        character(:), allocatable, intent(out) :: passed !! bytes before the last line
        integer :: break
        passed = text
        if (allocated(self%last)) passed = self%last // text
        break = index(passed(:len(passed) - 1), nl, back=.true.)
        if (break == 0 .and. len(passed) > block_size) break = len(passed) ! no last line is so long
        self%last = passed(break + 1:)
        passed = passed(:break)
        call self%ending%add(passed)
    end subroutine pass

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
        logical :: has_end

        problem = wrong_row(text)
        if (problem /= '') then
            problem = 'was changed after it was written: ' // problem
            return
        end if
        said = -1
        status = 0
        has_end = index(check%last, key) == 1 ! tables of other programs and of earlier versions have none
        if (has_end) read (check%last(len(key) + 1:), *, iostat=status) said
        if (status /= 0) said = -1
        if (index(text, nl // key) == 0) then
            problem = 'is not complete: after row ' // to_text(check%rows()) // ' a last line "' // key // 'N' // between // &
                      '..." is missing; it was cut, or written by an earlier version'
        else if (.not. has_end) then
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
        type(string_t), allocatable :: names(:), cells(:)
        logical, allocatable :: is_number(:)
        real(dp) :: key_of_row, last_key, step
        integer :: first, last, line, row

        problem = ''
        line = 0
        row = -1
        step = 0
        first = 1
        do while (first <= len(text))
            last = end_of_line(text, first)
            line = line + 1
            if (index(text(first:last), '#') /= 1) then
                row = row + 1
                call cut(text(first:last), cells)
                if (row > 0) call check_row()
                if (row == 0) names = cells
            end if
            if (problem /= '') then
                problem = 'row ' // to_text(row) // ' (line ' // to_text(line) // ') ' // problem
                return
            end if
            first = last + 2
        end do

    contains

        !> Checks a row against the names and the rows before it.
        subroutine check_row()
            integer :: i, status
            logical :: counts
            if (size(cells) /= size(names)) then
                problem = 'has ' // to_text(size(cells)) // ' cells, not ' // to_text(size(names))
                return
            end if
            if (row == 1) is_number = [(is_number_cell(cells(i)%text), i=1, size(cells))]
            do i = 1, size(cells)
                if (.not. is_number(i) .or. is_number_cell(cells(i)%text)) cycle
                problem = "has '" // abbreviate(cells(i)%text) // "' in place of a number"
                return
            end do
            counts = any(names(1)%text == ['case', 'bin '])
            if (.not. counts .and. names(1)%text /= 't') return
            read (cells(1)%text, *, iostat=status) key_of_row
            if (status /= 0) return
            if (row == 2) step = key_of_row - last_key
            if (row > 1 .and. ((key_of_row - last_key) * step < tiny(step) .or. (counts .and. &
                                                                             nint(key_of_row - last_key) /= 1))) then
                problem = 'is out of order: ' // names(1)%text // ' is ' // cells(1)%text
            end if
            last_key = key_of_row
        end subroutine check_row

    end function wrong_row

    !> The cells of a line; a comma within quotes belongs to its cell.
    pure subroutine cut(line, cells)
        character(*), intent(in) :: line
        type(string_t), allocatable, intent(out) :: cells(:)
        logical :: is_quoted
        integer :: first, n, i
        allocate (cells(1 + count([(line(i:i) == ',', i=1, len(line))])))
        is_quoted = .false.
        first = 1
        n = 0
        do i = 1, len(line) + 1
            if (i <= len(line)) then
                if (line(i:i) == '"') is_quoted = .not. is_quoted
                if (line(i:i) /= ',' .or. is_quoted) cycle
            end if
            n = n + 1
            cells(n)%text = line(first:i - 1)
            first = i + 1
        end do
        if (n < size(cells)) cells = cells(:n)
    end subroutine cut

    !> Counts the rows with each status, and the comment that tells how a motion ended as a row.
    subroutine count_statuses(lines, column, counts)
        character(*), intent(in) :: lines !! whole lines of a table
        integer, intent(in) :: column !! number of the column of the statuses, all before which are numbers; 0 if there is none
        integer(int64), intent(inout) :: counts(0:last_status) !! increased by the number of rows with each status
        integer :: first, last, cell, i, status

        first = 1
        do while (first <= len(lines))
            last = end_of_line(lines, first)
            status = -1
            if (index(lines(first:min(last, first + len(ending_key) - 1)), ending_key) == 1) then
                status = status_of_ending(lines(first + len(ending_key):last))
            else if (lines(first:first) /= '#' .and. column > 0) then
                cell = first
                do i = 2, column
                    cell = cell + index(lines(cell:last), ',')
                end do
                status = status_number(lines(cell:cell + index(lines(cell:last) // ',', ',') - 2))
            end if
            if (status >= 0) counts(status) = counts(status) + 1
            first = last + 2
        end do
    end subroutine count_statuses

    !> The status with whose name a text begins; -1 if there is none.
    pure integer function status_of_ending(text) result(status)
        character(*), intent(in) :: text !! such as `at_rest at t = 3.5`
        status = status_number(text(:scan(text // ' ', ' :') - 1))
    end function status_of_ending

end module spintop_table_end
