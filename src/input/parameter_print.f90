!> The table of parameters as text: the resolved namelist, and the list for users.
module spintop_parameter_print
    use spintop_parameter, only: parameter_t
    use spintop_parameters, only: parameter_table_t
    use spintop_text, only: append, append_words, string_t, to_text
    implicit none
    private
    public :: print_namelist, list_parameters, given_groups

contains

    !> All values of the input as a namelist that can be run: those that were given, and default values.
    !> Parameters without a value are omitted.
    subroutine print_namelist(table, lines, groups)
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        character(*), intent(in), optional :: groups !! 'a|b': print only these
        integer :: group, i, before, number

        allocate (lines(0))
        do group = 1, size(table%groups)
            associate (name => table%groups(group)%name, most => table%groups(group)%most)
                if (present(groups)) then
                    if (index('|' // groups // '|', '|' // name // '|') == 0) cycle
                end if
                do number = 1, most
                    before = size(lines)
                    call append(lines, '&' // name)
                    do i = 1, table%count
                        if (table%parameters(i)%group /= name) cycle
                        call print_parameter(table%parameters(i), merge(number, 0, most > 1), lines)
                    end do
                    if (size(lines) > before + 1) then
                        call append(lines, '/')
                    else
                        lines = lines(:before)
                    end if
                end do
            end associate
        end do
    end subroutine print_namelist

    !> The groups in which the input gives something, as `a|b`.
    function given_groups(table) result(groups)
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        character(:), allocatable :: groups
        integer :: i
        groups = ''
        do i = 1, table%count
            associate (parameter => table%parameters(i))
                if (.not. parameter%is_given()) cycle
                if (index('|' // groups // '|', '|' // parameter%group // '|') > 0) cycle
                if (groups /= '') groups = groups // '|'
                groups = groups // parameter%group
            end associate
        end do
    end function given_groups

    !> All that a parameter has, or what it has in one of the groups of this name.
    subroutine print_parameter(parameter, number, lines)
        type(parameter_t), intent(in) :: parameter
        integer, intent(in) :: number !! of the group, 0 if there is only one
        type(string_t), allocatable, intent(inout) :: lines(:)
        character(*), parameter :: indent = '    '
        type(string_t), allocatable :: elements(:)
        integer, allocatable :: columns(:)
        character(:), allocatable :: key
        integer :: row, i

        key = indent // parameter%key
        do row = 1, parameter%extents(1)
            if (parameter%rank == 2 .and. number > 0 .and. row /= number) cycle
            call parameter%row_text(row, elements, columns)
            if (size(columns) == 0) cycle
            if (parameter%rank == 2 .and. number == 0) key = indent // parameter%key // '(' // to_text(row) // ',:)'
            if (parameter%rank == 1 .and. number > 0) then
                i = findloc(columns, number, dim=1)
                if (i > 0) call append(lines, key // ' = ' // elements(i)%text)
            else if (columns(size(columns)) == size(columns)) then
                call append_words(lines, key // ' = ', elements)
            else
                do i = 1, size(columns)
                    call append(lines, indent // parameter%element_name(row, columns(i)) // ' = ' // elements(i)%text)
                end do
            end if
        end do
    end subroutine print_parameter

    !> Every parameter with its unit, default value, range and meaning.
    subroutine list_parameters(table, lines)
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        integer, parameter :: columns = 5
        type(string_t) :: cells(columns, 0:table%count)
        character(:), allocatable :: line
        integer :: widths(columns), i, j

        cells(1, 0)%text = 'parameter'
        cells(2, 0)%text = 'unit'
        cells(3, 0)%text = 'default'
        cells(4, 0)%text = 'range'
        cells(5, 0)%text = 'meaning'
        do i = 1, table%count
            associate (parameter => table%parameters(i))
                cells(1, i)%text = parameter%full_name()
                cells(2, i)%text = parameter%unit
                cells(3, i)%text = parameter%default
                cells(4, i)%text = parameter%range%rule
                cells(5, i)%text = parameter%what
            end associate
        end do
        do j = 1, columns
            widths(j) = maxval([(len(cells(j, i)%text), i=0, table%count)])
        end do
        do i = 0, table%count
            line = ''
            do j = 1, columns
                line = line // cells(j, i)%text // &
                    repeat(' ', widths(j) - len(cells(j, i)%text) + 2)
            end do
            call append(lines, trim(line))
            if (i == 0) cycle
            if (size(table%parameters(i)%choices) > 0) then
                call append_words(lines, '    one of: ', table%parameters(i)%choices)
            end if
        end do
    end subroutine list_parameters

end module spintop_parameter_print
