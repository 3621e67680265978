!> Writing of JSON (RFC 8259): one object, its members on lines of their own, and the elements of its
!> lists, too; what is deeper stands in one line.
!>
!>     call json%begin()
!>     call json%open_list('methods')
!>     call json%open_object()
!>     call json%add('name', 'rk4')
!>     call json%add('order', 4)
!>     call json%close()
!>     call json%close()
!>     call json%finish(lines)
module spintop_json
    use spintop_kinds, only: dp, is_finite
    use spintop_text, only: append, string_t, strings_of, to_text
    implicit none
    private
    public :: json_t

    !> Containers down to this depth have a line per item.
    integer, parameter :: depth_of_lines = 2

    !> A document that is being written.
    type :: json_t
        private
        type(string_t), allocatable :: lines(:)
        !> The line that is not yet complete, and what closes each open container.
        character(:), allocatable :: line, closing
        !> Whether each open container has an item already.
        logical, allocatable :: has_item(:)
    contains
        procedure :: begin
        procedure :: open_object
        procedure :: open_list
        procedure :: close => close_container
        procedure :: finish
        !> `add(key, value)`: a member of the innermost object. A text, an integer, a real (null where it
        !> is not finite), a logical, or a list of texts.
        generic :: add => add_value, add_texts, add_strings
        procedure :: add_null
        procedure, private :: add_value, add_texts, add_strings
    end type json_t

contains

    !> Begins the document, an object.
    subroutine begin(self)
        class(json_t), intent(out) :: self
        self%line = '{'
        self%closing = '}'
        self%has_item = [.false.]
    end subroutine begin

    !> Opens an object: a member of an object, or, without a key, an element of a list.
    subroutine open_object(self, key)
        class(json_t), intent(inout) :: self
        character(*), intent(in), optional :: key !! name of the member
        call add_item(self, '{', key, closing='}')
    end subroutine open_object

    !> Opens a list: a member of an object, or, without a key, an element of a list.
    subroutine open_list(self, key)
        class(json_t), intent(inout) :: self
        character(*), intent(in), optional :: key !! name of the member
        call add_item(self, '[', key, closing=']')
    end subroutine open_list

    !> Closes the innermost container.
    subroutine close_container(self)
        class(json_t), intent(inout) :: self
        associate (depth => size(self%has_item))
            if (depth <= depth_of_lines .and. self%has_item(depth)) then
                call append(self%lines, self%line)
                self%line = repeat(' ', 2 * (depth - 1))
            end if
            self%line = self%line // self%closing(depth:)
            self%closing = self%closing(:depth - 1)
        end associate
        self%has_item = self%has_item(:len(self%closing))
    end subroutine close_container

    !> Closes the document, and gives its lines.
    subroutine finish(self, lines)
        class(json_t), intent(inout) :: self
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        do while (self%closing /= '')
            call self%close()
        end do
        call append(self%lines, self%line)
        call move_alloc(self%lines, lines)
    end subroutine finish

    !> Adds a member without a value.
    subroutine add_null(self, key)
        class(json_t), intent(inout) :: self
        character(*), intent(in) :: key !! name of the member
        call add_item(self, 'null', key)
    end subroutine add_null

    subroutine add_value(self, key, value)
        class(json_t), intent(inout) :: self
        character(*), intent(in) :: key
        class(*), intent(in) :: value
        select type (value)
        type is (character(*))
            call add_item(self, quoted(trim(value)), key)
        type is (integer)
            call add_item(self, to_text(value), key)
        type is (logical)
            call add_item(self, trim(merge('true ', 'false', value)), key)
        type is (real(dp))
            if (is_finite(value)) call add_item(self, to_text(value), key)
            if (.not. is_finite(value)) call self%add_null(key)
        end select
    end subroutine add_value

    subroutine add_texts(self, key, values)
        class(json_t), intent(inout) :: self
        character(*), intent(in) :: key
        character(*), intent(in) :: values(:)
        call self%add(key, strings_of(values))
    end subroutine add_texts

    subroutine add_strings(self, key, values)
        class(json_t), intent(inout) :: self
        character(*), intent(in) :: key
        type(string_t), intent(in) :: values(:)
        integer :: i
        call self%open_list(key)
        do i = 1, size(values)
            call add_item(self, quoted(values(i)%text))
        end do
        call self%close()
    end subroutine add_strings

    !> Adds the text of a value, or of the beginning of a container, to the innermost container.
    subroutine add_item(self, text, key, closing)
        class(json_t), intent(inout) :: self
        character(*), intent(in) :: text
        character(*), intent(in), optional :: key, closing
        associate (depth => size(self%has_item))
            if (self%has_item(depth)) self%line = self%line // ','
            if (depth <= depth_of_lines) then
                call append(self%lines, self%line)
                self%line = repeat(' ', 2 * depth)
            else if (self%has_item(depth)) then
                self%line = self%line // ' '
            end if
            self%has_item(depth) = .true.
        end associate
        if (present(key)) self%line = self%line // quoted(key) // ': '
        self%line = self%line // text
        if (.not. present(closing)) return
        self%closing = self%closing // closing
        self%has_item = [self%has_item, .false.]
    end subroutine add_item

    !> A text in quotes, with what JSON wants to have escaped.
    pure function quoted(text)
        character(*), intent(in) :: text
        character(:), allocatable :: quoted
        character(2) :: code
        integer :: i
        quoted = '"'
        do i = 1, len(text)
            select case (text(i:i))
            case ('"', '\')
                quoted = quoted // '\' // text(i:i)
            case (achar(0):achar(31))
                write (code, '(z2.2)') iachar(text(i:i))
                quoted = quoted // '\u00' // code
            case default
                quoted = quoted // text(i:i)
            end select
        end do
        quoted = quoted // '"'
    end function quoted

end module spintop_json
