!> Divides the text of a namelist into tokens with their places.
module spintop_scanner
    use spintop_diagnostics, only: place_t
    implicit none
    private
    public :: scanner_t, token_t
    public :: token_end, token_group, token_slash, token_word, token_string, token_equals
    public :: token_comma, token_open, token_close, token_colon, token_other

    !> End of the text.
    integer, parameter :: token_end = 0
    !> `&name`
    integer, parameter :: token_group = 1
    integer, parameter :: token_slash = 2
    !> A sequence of any other characters: a name, a number, `3*0.0`, `.true.`
    integer, parameter :: token_word = 3
    !> A text in quotes.
    integer, parameter :: token_string = 4
    integer, parameter :: token_equals = 5
    integer, parameter :: token_comma = 6
    integer, parameter :: token_open = 7
    integer, parameter :: token_close = 8
    integer, parameter :: token_colon = 9
    !> A character that has no meaning in a namelist.
    integer, parameter :: token_other = 10

    character, parameter :: tab = achar(9), line_feed = achar(10), carriage_return = achar(13)
    character(*), parameter :: blanks = ' ' // tab // carriage_return
    !> The signs that are tokens, and the kinds of these.
    character(*), parameter :: signs = '/=,():'
    integer, parameter :: kinds_of_signs(len(signs)) = [token_slash, token_equals, token_comma, token_open, token_close, &
        token_colon]
    !> The last one only where there are comments.
    character(*), parameter :: ends_of_word = blanks // line_feed // signs // '&''"!'
    character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ'
    character(*), parameter :: name_characters = letters // '0123456789_'
    character(*), parameter :: byte_order_mark = char(239) // char(187) // char(191)

    !> A token: its kind and its place.
    type :: token_t
        integer :: kind = token_end
        integer :: first = 1, last = 0     !! bytes of the text
        type(place_t) :: place
        logical :: starts_line = .false.   !! only blanks precede it on its line
        logical :: touches = .false.       !! no blank between it and the character before
        logical :: closed = .true.         !! a string has its closing quote
    end type token_t

    !> The position of the scanner in its text.
    type :: cursor_t
        integer :: position = 1, line = 1, line_start = 1
    end type cursor_t

    !> Reads a text token by token.
    type :: scanner_t
        character(:), allocatable :: text
        type(cursor_t), private :: at
        integer, private :: source = 0
        logical, private :: comments = .true.
    contains
        procedure :: start
        procedure :: next
        procedure :: peek
        procedure :: key_follows
        procedure :: is_inside_word
        procedure :: rest
        procedure :: word
        procedure :: string
        procedure :: is_name
    end type scanner_t

contains

    !> Starts at the beginning of a text.
    subroutine start(self, text, source, comments)
        class(scanner_t), intent(inout) :: self
        character(*), intent(in) :: text !! the namelist
        integer, intent(in) :: source   !! number of the source for places
        logical, intent(in) :: comments !! whether `!` starts a comment
        self%text = text
        self%source = source
        self%comments = comments
        self%at = cursor_t()
        if (index(text(:min(3, len(text))), byte_order_mark) == 1) then
            self%at%position = 1 + len(byte_order_mark)
            self%at%line_start = self%at%position
        end if
    end subroutine start

    !> Reads the next token.
    subroutine next(self, token)
        class(scanner_t), intent(inout) :: self
        type(token_t), intent(out) :: token !! the token
        integer :: before, length

        before = self%at%position
        call skip_blanks(self, token%starts_line)
        token%touches = before == self%at%position .and. .not. token%starts_line
        token%first = self%at%position
        token%last = self%at%position
        if (self%at%position > len(self%text)) then
            token%last = self%at%position - 1
        else
            select case (self%text(self%at%position:self%at%position))
            case ('&')
                length = run(self, self%at%position + 1, name_characters, .true.)
                token%kind = merge(token_group, token_other, length > 0)
                token%last = self%at%position + length
            case ('/', '=', ',', '(', ')', ':')
                token%kind = kinds_of_signs(index(signs, self%text(self%at%position:self%at%position)))
            case ('''', '"')
                token%kind = token_string
                call end_of_string(self, token%last, token%closed)
            case default
                token%kind = token_word
                length = run(self, self%at%position, ends_of_word(:len(ends_of_word) - merge(0, 1, self%comments)), .false.)
                token%last = self%at%position + length - 1
            end select
        end if
        token%place = place_t(self%source, self%at%line, token%first - self%at%line_start + 1, &
            token%last - token%first + 1)
        self%at%position = token%last + 1
    end subroutine next

    !> The next token, which remains the next one.
    subroutine peek(self, token)
        class(scanner_t), intent(inout) :: self
        type(token_t), intent(out) :: token !! the token
        type(cursor_t) :: here

        here = self%at
        call self%next(token)
        self%at = here
    end subroutine peek

    !> Whether a key and its equals sign come next: `name =` or `name(subscripts) =`.
    logical function key_follows(self)
        class(scanner_t), intent(inout) :: self
        integer, parameter :: most_tokens = 8 ! of `(1, 2:3)`, and one in hand
        type(cursor_t) :: here
        type(token_t) :: token
        integer :: i

        here = self%at
        call self%next(token)
        key_follows = self%is_name(token)
        if (key_follows) call self%next(token)
        if (token%kind == token_open) then
            do i = 1, most_tokens
                call self%next(token)
                if (token%kind == token_close .or. token%kind == token_end) exit
            end do
            call self%next(token)
        end if
        key_follows = key_follows .and. token%kind == token_equals
        self%at = here
    end function key_follows

    !> Whether the next token touches characters on both sides.
    logical function is_inside_word(self)
        class(scanner_t), intent(inout) :: self
        type(cursor_t) :: here
        type(token_t) :: token, after

        here = self%at
        call self%next(token)
        call self%next(after)
        is_inside_word = token%touches .and. after%touches .and. after%kind == token_word
        self%at = here
    end function is_inside_word

    !> The text that has not been read.
    pure function rest(self)
        class(scanner_t), intent(in) :: self
        character(:), allocatable :: rest
        rest = self%text(self%at%position:)
    end function rest

    !> Number of consecutive characters from a position that are in a set (or are not).
    pure integer function run(self, position, set, inside)
        class(scanner_t), intent(in) :: self
        integer, intent(in) :: position
        character(*), intent(in) :: set
        logical, intent(in) :: inside
        if (inside) then
            run = verify(self%text(position:), set) - 1
        else
            run = scan(self%text(position:), set) - 1
        end if
        if (run < 0) run = len(self%text) - position + 1
    end function run

    !> The characters of a token.
    pure function word(self, token)
        class(scanner_t), intent(in) :: self
        type(token_t), intent(in) :: token !! the token
        character(:), allocatable :: word
        word = self%text(token%first:token%last)
    end function word

    !> The text of a string token, without quotes, and with doubled quotes made single.
    pure function string(self, token)
        class(scanner_t), intent(in) :: self
        type(token_t), intent(in) :: token !! the token
        character(:), allocatable :: string
        character :: quote
        integer :: from, to, last

        last = token%last
        if (token%closed) last = last - 1
        quote = self%text(token%first:token%first)
        string = self%text(token%first + 1:last)
        from = 1
        to = 0
        do while (from <= len(string))
            to = to + 1
            string(to:to) = string(from:from)
            if (string(from:from) == quote) from = from + 1
            from = from + 1
        end do
        string = string(:to)
    end function string

    !> Whether a token is a name: a letter, then letters, digits and underscores, and dots in keys such as `top.mass`.
    pure logical function is_name(self, token)
        class(scanner_t), intent(in) :: self
        type(token_t), intent(in) :: token !! the token
        is_name = token%kind == token_word
        if (is_name) is_name = verify(self%text(token%first:token%first), letters) == 0 .and. &
            verify(self%text(token%first:token%last), name_characters // '.') == 0
    end function is_name

    !> Moves to the next byte that is neither blank nor in a comment.
    subroutine skip_blanks(self, new_line)
        class(scanner_t), intent(inout) :: self
        logical, intent(out) :: new_line !! whether that byte is the first of its line

        new_line = self%at%position == self%at%line_start
        do while (self%at%position <= len(self%text))
            if (self%text(self%at%position:self%at%position) == '!' .and. self%comments) then
                self%at%position = self%at%position + run(self, self%at%position, line_feed, .false.)
            else if (self%text(self%at%position:self%at%position) == line_feed) then
                self%at%position = self%at%position + 1
                self%at%line = self%at%line + 1
                self%at%line_start = self%at%position
                new_line = .true.
            else if (scan(self%text(self%at%position:self%at%position), blanks) > 0) then
                self%at%position = self%at%position + 1
            else
                exit
            end if
        end do
    end subroutine skip_blanks

    !> Finds the closing quote of the string that starts here, or the end of the line.
    subroutine end_of_string(self, last, closed)
        class(scanner_t), intent(in) :: self
        integer, intent(out) :: last
        logical, intent(out) :: closed
        character :: quote, after

        quote = self%text(self%at%position:self%at%position)
        last = self%at%position
        do
            closed = .false.
            if (last == len(self%text)) return
            after = self%text(last + 1:last + 1)
            if (after == line_feed .or. after == carriage_return) return
            last = last + 1
            if (after /= quote) cycle
            closed = .true.
            if (last == len(self%text)) return
            if (self%text(last + 1:last + 1) /= quote) return
            last = last + 1
        end do
    end subroutine end_of_string

end module spintop_scanner
