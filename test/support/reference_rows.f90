!> Reads the tables in test/reference: comment lines, a line of column names, then numbers.
module reference_rows
    use spintop_kinds, only: dp
    implicit none
    private
    public :: reference_t, read_reference

    !> A table of numbers with named columns.
    type :: reference_t
        character(:), allocatable :: names(:)
        !> values(row, column)
        real(dp), allocatable :: values(:, :)
    contains
        procedure :: column
        procedure :: rows
    end type reference_t

    integer, parameter :: longest_line = 4096

contains

    !> Reads test/reference/NAME.csv; the tests run in the root of the checkout.
    subroutine read_reference(name, table)
        character(*), intent(in) :: name
        type(reference_t), intent(out) :: table
        character(longest_line) :: line
        character(32) :: names(64)
        integer :: unit, status, rows, columns, row, i

        open (newunit=unit, file='test/reference/' // name // '.csv', status='old', action='read')
        columns = 0
        rows = 0
        do
            read (unit, '(a)', iostat=status) line
            if (status /= 0) exit
            if (line(1:1) == '#' .or. line == '') cycle
            if (columns > 0) then
                rows = rows + 1
                cycle
            end if
            columns = 1 + count([(line(i:i) == ',', i = 1, len_trim(line))])
            call split_names(line, names(:columns))
        end do
        allocate (character(32) :: table%names(columns))
        table%names(:) = names(:columns)
        allocate (table%values(rows, columns))
        rewind (unit)
        row = -1
        do while (row < rows)
            read (unit, '(a)') line
            if (line(1:1) == '#' .or. line == '') cycle
            row = row + 1
            if (row > 0) read (line, *) table%values(row, :)
        end do
        close (unit)
    end subroutine read_reference

    !> The words of a line between commas.
    pure subroutine split_names(line, names)
        character(*), intent(in) :: line
        character(*), intent(out) :: names(:)
        integer :: i, first, length
        first = 1
        do i = 1, size(names)
            length = index(line(first:) // ',', ',') - 1
            names(i) = line(first:first + length - 1)
            first = first + length + 1
        end do
    end subroutine split_names

    !> A column by its name. A name that does not exist is a mistake in the test.
    function column(self, name) result(values)
        class(reference_t), intent(in) :: self
        character(*), intent(in) :: name
        real(dp), allocatable :: values(:)
        integer :: i
        do i = 1, size(self%names)
            if (self%names(i) == name) then
                values = self%values(:, i)
                return
            end if
        end do
        error stop 'reference_rows: no such column'
    end function column

    !> Number of rows.
    pure integer function rows(self)
        class(reference_t), intent(in) :: self
        rows = size(self%values, 1)
    end function rows

end module reference_rows
