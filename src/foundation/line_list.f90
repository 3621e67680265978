!> A list of lines of text.
module spintop_line_list
    use spintop_text, only: split, string_t
    use spintop_wrapping, only: characters, wrapped
    implicit none
    private
    public :: line_list_t, line_width

    !> Lines are broken before this column if possible.
    integer, parameter :: line_width = 96

    !> Lines of text, added one by one.
    type :: line_list_t
        integer :: count = 0
        type(string_t), allocatable, private :: line(:)
    contains
        procedure :: add
        procedure :: add_words
        procedure :: add_wrapped
        procedure :: get
    end type line_list_t

contains

    !> Adds a line as it is.
    subroutine add(self, line)
        class(line_list_t), intent(inout) :: self
        character(*), intent(in) :: line !! one line of text
        type(string_t), allocatable :: more(:)

        if (.not. allocated(self%line)) allocate (self%line(64))
        if (self%count == size(self%line)) then
            allocate (more(2 * self%count))
            more(:self%count) = self%line
            call move_alloc(more, self%line)
        end if
        self%count = self%count + 1
        self%line(self%count)%text = line
    end subroutine add

    !> Adds words as a list with commas after a beginning, on as many lines as needed.
    subroutine add_words(self, start, words)
        class(line_list_t), intent(inout) :: self
        character(*), intent(in) :: start !! beginning of the first line
        type(string_t), intent(in) :: words(:) !! the items of the list
        character(:), allocatable :: line, word
        integer :: i

        line = start
        do i = 1, size(words)
            word = words(i)%text
            if (i < size(words)) word = word // ','
            if (i > 1 .and. len(line) + len(word) > line_width) then
                call self%add(trim(line))
                line = repeat(' ', len(start))
            end if
            line = line // word // ' '
        end do
        call self%add(trim(line))
    end subroutine add_words

    !> Adds a text that is broken at blanks, so that no line is longer than `width` if possible. All lines begin
    !> with `start`, and the second and further ones have `indent` blanks after it.
    subroutine add_wrapped(self, start, text, indent, width)
        class(line_list_t), intent(inout) :: self
        character(*), intent(in) :: start, text !! beginning of each line, and text
        integer, intent(in) :: indent, width !! blanks, and columns of a line
        character(:), allocatable :: broken
        type(string_t), allocatable :: lines(:)
        integer :: i

        broken = text
        if (characters(text) > width - len(start)) broken = wrapped(text, 0, width - len(start), indent=indent)
        call split(broken, new_line('a'), lines, keeps_blanks=.true.)
        do i = 1, size(lines)
            call self%add(start // lines(i)%text)
        end do
        if (size(lines) == 0) call self%add(start // text)
    end subroutine add_wrapped

    !> All lines so far.
    subroutine get(self, lines)
        class(line_list_t), intent(in) :: self
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        allocate (lines(self%count))
        if (self%count > 0) lines = self%line(:self%count)
    end subroutine get

end module spintop_line_list
