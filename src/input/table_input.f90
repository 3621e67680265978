!> The input in the header of a table, from which the table was computed.
module spintop_table_input
    implicit none
    private
    public :: input_of_table

contains

    !> The text of a table as an input: the lines below `# input:` without their `#`, and an empty line for each other
    !> line of the header, so that lines keep their numbers.
    pure function input_of_table(table) result(input)
        character(*), intent(in) :: table !! text of a table
        character(:), allocatable :: input
        character(*), parameter :: title = '# input:', mark = '#     '
        integer :: first, length, written
        logical :: is_input

        allocate (character(len(table)) :: input)
        written = 0
        is_input = .false.
        first = 1
        do while (first <= len(table))
            if (table(first:first) /= '#') exit
            length = index(table(first:), new_line('a')) - 1
            if (length < 0) length = len(table) - first + 1
            associate (line => table(first:first + length - 1))
                is_input = (is_input .and. index(line, mark) == 1) .or. line == title
                if (is_input .and. line /= title) then
                    input(written + 1:written + length) = ' ' // line(2:)
                    written = written + length
                end if
            end associate
            input(written + 1:written + 1) = new_line('a')
            written = written + 1
            first = first + length + 1
        end do
        input = input(:min(written, len(input)))
    end function input_of_table

end module spintop_table_input
