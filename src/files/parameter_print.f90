!> The table of parameters as text: the resolved namelist, and the list for the reader.
module spintop_parameter_print
    use spintop_parameter, only: parameter_t
    use spintop_parameters, only: parameter_table_t
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: print_namelist, list_parameters

    !> Lines are broken before this column where that is possible.
    integer, parameter :: line_width = 96

    !> Lines of text that grow in number.
    type :: lines_t
        type(string_t), allocatable :: line(:)
        integer :: count = 0
    contains
        procedure :: add => add_line
        procedure :: add_words
    end type lines_t

contains

    !> All values of the input as a namelist that can be run again: those given and those by
    !> default; what has no value is left out.
    subroutine print_namelist(table, lines, groups)
        type(parameter_table_t), intent(in) :: table
        type(string_t), allocatable, intent(out) :: lines(:)
        character(*), intent(in), optional :: groups !! 'a|b': print only these
        type(lines_t) :: text
        integer :: group, i, before

        do group = 1, size(table%groups)
            associate (name => table%groups(group)%name)
                if (present(groups)) then
                    if (index('|' // groups // '|', '|' // name // '|') == 0) cycle
                end if
                before = text%count
                do i = 1, size(table%parameters)
                    if (table%parameters(i)%group /= name) cycle
                    if (table%parameters(i)%value_text() == '') cycle
                    if (text%count == before) call text%add('&' // name)
                    call print_parameter(table%parameters(i), text)
                end do
                if (text%count > before) call text%add('/')
            end associate
        end do
        allocate (lines(text%count))
        if (text%count > 0) lines = text%line(:text%count)
    end subroutine print_namelist

    subroutine print_parameter(parameter, text)
        type(parameter_t), intent(in) :: parameter
        type(lines_t), intent(inout) :: text
        character(*), parameter :: indent = '    '
        type(string_t), allocatable :: elements(:)
        integer, allocatable :: columns(:)
        character(:), allocatable :: key
        integer :: row, i

        do row = 1, parameter%extents(1)
            call parameter%row_text(row, elements, columns)
            key = parameter%key
            if (parameter%rank == 2) key = key // '(' // to_text(row) // ',:)'
            if (size(columns) == 0) cycle
            if (columns(size(columns)) == size(columns)) then
                call text%add_words(indent // key // ' = ', elements, ',')
            else
                do i = 1, size(columns)
                    call text%add(indent // parameter%element_name(row, columns(i)) // ' = ' // &
                        elements(i)%text)
                end do
            end if
        end do
    end subroutine print_parameter

    !> Every parameter with its unit, default value, range and meaning, in columns.
    subroutine list_parameters(table, lines)
        type(parameter_table_t), intent(in) :: table
        type(string_t), allocatable, intent(out) :: lines(:)
        integer, parameter :: columns = 5
        type(string_t) :: cells(columns, 0:size(table%parameters))
        type(lines_t) :: text
        character(:), allocatable :: line
        integer :: widths(columns), i, j

        cells(:, 0) = [string_t('parameter'), string_t('unit'), string_t('default'), &
            string_t('range'), string_t('meaning')]
        do i = 1, size(table%parameters)
            associate (parameter => table%parameters(i))
                cells(1, i)%text = parameter%full_name()
                cells(2, i)%text = parameter%unit
                cells(3, i)%text = parameter%default
                cells(4, i)%text = parameter%rule
                cells(5, i)%text = parameter%what
            end associate
        end do
        do j = 1, columns
            widths(j) = maxval([(len(cells(j, i)%text), i=0, size(table%parameters))])
        end do
        do i = 0, size(table%parameters)
            line = ''
            do j = 1, columns
                line = line // cells(j, i)%text // &
                    repeat(' ', widths(j) - len(cells(j, i)%text) + 2)
            end do
            call text%add(trim(line))
            if (i == 0) cycle
            if (size(table%parameters(i)%choices) > 0) &
                call text%add_words('    one of: ', table%parameters(i)%choices, ',')
        end do
        lines = text%line(:text%count)
    end subroutine list_parameters

    subroutine add_line(self, line)
        class(lines_t), intent(inout) :: self
        character(*), intent(in) :: line
        type(string_t), allocatable :: more(:)

        if (.not. allocated(self%line)) allocate (self%line(64))
        if (self%count == size(self%line)) then
            allocate (more(2 * self%count))
            more(:self%count) = self%line
            call move_alloc(more, self%line)
        end if
        self%count = self%count + 1
        self%line(self%count)%text = line
    end subroutine add_line

    !> Adds words after a start, on as many lines as they need.
    subroutine add_words(self, start, words, separator)
        class(lines_t), intent(inout) :: self
        character(*), intent(in) :: start
        type(string_t), intent(in) :: words(:)
        character, intent(in) :: separator
        character(:), allocatable :: line, word
        integer :: i

        line = start
        do i = 1, size(words)
            word = words(i)%text
            if (i < size(words)) word = word // separator
            if (i > 1 .and. len(line) + len(word) > line_width) then
                call self%add(trim(line))
                line = repeat(' ', len(start))
            end if
            line = line // word
            if (i < size(words)) line = line // ' '
        end do
        call self%add(line)
    end subroutine add_words

end module spintop_parameter_print
