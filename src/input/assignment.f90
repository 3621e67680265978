!> Reads assignments `key(subscripts) = values` of an input into its table: the values, which may have units, are read,
!> checked and stored.
module spintop_assignment
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_diagnostics, only: diagnostics_t, place_t
    use spintop_kinds, only: dp
    use spintop_literals, only: read_integer, read_logical, read_long, read_real, is_real_literal
    use spintop_parameter, only: all_elements, kind_integer, kind_long, kind_real, kind_text, &
        leading_elements, one_per_group, parameter_t, quoted
    use spintop_parameters, only: parameter_table_t
    use spintop_scanner, only: scanner_t, token_close, token_colon, token_comma, token_open, token_string, &
        token_t, token_word, token_end, token_group, token_slash
    use spintop_suggestions, only: names_file, suggest_word
    use spintop_text, only: abbreviate, lower_case, to_text, is_plain
    use spintop_units, only: convert_unit, units_of
    implicit none
    private
    public :: reader_t, assignment_t, names_a_unit

    character(*), parameter :: quotes_hint = 'a number with its unit is in quotes, as ''20 deg''', &
        point_hint = 'decimals follow a point, as in 25.5'

    !> The elements that an assignment names, and its state.
    type :: assignment_t
        type(place_t) :: place           !! of the key
        logical :: quotes_optional = .false.
        logical :: refused = .false.     !! an error makes the other values void
        integer :: group = 0             !! which of the groups of this name it stands in, if these may be repeated
        integer :: rank = 0              !! dimensions of what the key names: 0 for a value, 1 for a list, 2 for rows
        integer :: row = 1, first = 1, last = 1
        logical :: whole = .true.        !! the key or its row, without bounds
        integer :: count = 0             !! values so far
    end type assignment_t

    !> Reads a source into a table of parameters, one assignment after another.
    type :: reader_t
        type(scanner_t) :: scanner
        type(parameter_table_t), pointer :: table => null()
        type(diagnostics_t), pointer :: diagnostics => null() !! errors with their places are added
        character(:), allocatable :: group                    !! the group that is read, '' for none
        type(parameter_t), pointer :: parameter => null()     !! the parameter that is read
        type(assignment_t) :: now
    contains
        procedure :: read_subscripts
        procedure :: begin
        procedure :: read_values
        procedure :: at_end_of_values
        procedure :: store_values
        procedure :: finish
        procedure :: refuse
    end type reader_t

contains

    !> Reads the subscripts of the key, if there are any: `(2)`, `(1,:)`, `(1,2:4)`, `(:3)`.
    subroutine read_subscripts(self)
        class(reader_t), intent(inout) :: self
        type(token_t) :: token
        integer :: bounds(2, 2), dimensions

        associate (now => self%now, parameter => self%parameter, key => self%parameter%key)
            now%last = parameter%extents(2)
            now%rank = parameter%rank
            if (parameter%elements == one_per_group .and. now%group > 0) then
                ! In the n-th group of a name a key stands for element n of its list, or for row n.
                now%rank = now%rank - 1
                if (now%rank == 1) now%row = now%group
                if (now%rank == 0) now%first = now%group
                if (now%rank == 0) now%last = now%group
            end if
            call self%scanner%peek(token)
            if (token%kind /= token_open) then
                ! Values for several groups are told from a decimal comma by the subscript.
                if (parameter%elements == one_per_group .and. now%group == 0) now%last = 1
                if (now%rank == 2) call self%refuse(now%place, key // ' has rows', 'name one: ' // key // '(1,:) = ...')
                return
            end if
            call self%scanner%next(token)
            call read_bounds(self%scanner, bounds, dimensions, token)
            now%place%width = token%place%column - now%place%column + 1
            if (now%rank == 0) then
                call self%refuse(now%place, key // ' is a single value', 'it takes no subscript')
            else if (dimensions /= now%rank) then
                call self%refuse(now%place, 'bad subscript of ' // key, &
                                 'write ' // example(key, now%rank) // '; strides are not supported')
            else if (now%rank == 2 .and. (bounds(1, 1) < 1 .or. bounds(1, 1) /= bounds(2, 1))) then
                call self%refuse(now%place, 'one row at a time', 'write ' // example(key, now%rank))
            else
                if (now%rank == 2) now%row = bounds(1, 1)
                now%first = max(bounds(1, dimensions), 1)
                if (bounds(2, dimensions) > 0) now%last = bounds(2, dimensions)
                now%whole = all(bounds(:, dimensions) < 1)
                if (now%row < 1 .or. now%row > parameter%extents(1) .or. now%first > now%last &
                    .or. now%last > parameter%extents(2)) then
                    call self%refuse(now%place, 'subscript out of bounds', 'the array is ' // parameter%full_name())
                end if
            end if
        end associate
    end subroutine read_subscripts

    !> Example of the subscripts of a key.
    pure function example(key, rank) result(text)
        character(*), intent(in) :: key
        integer, intent(in) :: rank
        character(:), allocatable :: text
        text = key // '(1,:) or ' // key // '(1,2:3)'
        if (rank == 1) text = key // '(2) or ' // key // '(2:3)'
    end function example

    !> Reads bounds up to the closing parenthesis; absent ones are -1. `dimensions` is 0 if they are not
    !> valid.
    subroutine read_bounds(scanner, bounds, dimensions, token)
        type(scanner_t), intent(inout) :: scanner
        integer, intent(out) :: bounds(2, 2), dimensions
        type(token_t), intent(out) :: token
        character(:), allocatable :: problem, hint
        integer :: side
        logical :: good

        bounds = -1
        dimensions = 1
        side = 1
        good = .true.
        do
            call scanner%peek(token)
            select case (token%kind)
            case (token_word)
                good = good .and. side <= 2 .and. dimensions <= 2
                if (good) then
                    call read_integer(scanner%word(token), bounds(side, dimensions), problem, hint)
                    ! A zero or a negative number must not be taken for an absent bound.
                    good = problem == '' .and. bounds(side, dimensions) > 0
                end if
            case (token_colon)
                side = side + 1
            case (token_comma, token_close)
                ! A subscript without a colon is both bounds.
                if (side == 1 .and. dimensions <= 2) then
                    good = good .and. bounds(1, dimensions) > 0
                    bounds(2, dimensions) = bounds(1, dimensions)
                end if
                good = good .and. side <= 2
                side = 1
                if (token%kind == token_comma) dimensions = dimensions + 1
            case default
                good = .false.
                exit
            end select
            call scanner%next(token)
            if (token%kind == token_close) exit
        end do
        if (.not. good) dimensions = 0
    end subroutine read_bounds

    !> Checks that no element was assigned before, and makes room.
    subroutine begin(self)
        class(reader_t), intent(inout) :: self
        integer :: i

        if (self%now%refused) return
        associate (now => self%now, parameter => self%parameter)
            do i = now%first, now%last
                if (parameter%places(now%row, i)%source /= now%place%source) cycle
                call self%refuse(now%place, parameter%key // ' is given a second time', &
                                 'first on line ' // to_text(parameter%places(now%row, i)%line))
                return
            end do
            if (now%whole .and. parameter%elements == leading_elements) call parameter%clear_row(now%row)
            parameter%key_place = now%place
        end associate
    end subroutine begin

    !> Stores a value `repeats` times.
    subroutine store_values(self, token, text, repeats)
        class(reader_t), intent(inout) :: self
        type(token_t), intent(in) :: token !! the token of the value
        character(*), intent(in) :: text !! the value, without quotes
        integer, intent(in) :: repeats !! number of consecutive elements with this value
        character(:), allocatable :: hint, problem
        real(dp) :: factor
        integer :: i, room

        associate (now => self%now, parameter => self%parameter)
            room = now%last - now%first + 1
            do i = 1, repeats
                if (now%refused) return
                now%count = now%count + 1
                if (now%count > room) exit
                call store_element(self, token, text, now%first + now%count - 1)
                if (parameter%faulty) return
            end do
            if (now%count <= room .or. parameter%faulty) return
            hint = 'it takes ' // to_text(room) // ' values'
            if (room == 1) hint = 'it takes one value'
            if (room == 1 .and. parameter%kind == kind_real) hint = hint // '; ' // point_hint
            if (room == 1 .and. now%rank > 0) hint = hint // '; several: ' // example(parameter%key, now%rank)
            if (token%touches .and. parameter%kind == kind_text) then
                hint = hint // '; a quote inside a text is written twice'
            end if
            problem = ''
            if (parameter%kind == kind_real .and. has_unit('1 ' // text)) then
                hint = quotes_hint
                call convert_unit(text, text, factor, problem)
            end if
            if (problem == '') problem = 'too many values for ' // parameter%key
            call self%refuse(token%place, problem, hint)
        end associate
    end subroutine store_values

    !> Checks that the number of values is sufficient.
    subroutine finish(self)
        class(reader_t), intent(inout) :: self
        logical :: all_needed

        associate (now => self%now, parameter => self%parameter)
            if (now%refused .or. parameter%faulty) return
            all_needed = parameter%elements == all_elements .or. .not. now%whole .or. now%group > 0
            if (now%count == 0) then
                call self%refuse(now%place, 'no value for ' // parameter%key, 'omit the key to use the default')
            else if (all_needed .and. now%first + now%count <= now%last) then
                call self%refuse(now%place, 'too few values for ' // parameter%key, 'it takes ' // &
                                 to_text(now%last - now%first + 1) // ', but has ' // to_text(now%count))
            end if
        end associate
    end subroutine finish

    !> Reads, checks and stores the value of an element of the row that is read.
    subroutine store_element(self, token, text, column)
        type(reader_t), intent(inout) :: self
        type(token_t), intent(in) :: token
        character(*), intent(in) :: text
        integer, intent(in) :: column
        character(:), allocatable :: problem, hint, unit
        real(dp) :: number
        integer :: whole_number
        integer(int64) :: long_number
        logical :: flag

        associate (parameter => self%parameter, row => self%now%row)
            parameter%places(row, column) = token%place
            if (parameter%kind == kind_text) then
                call store_word(self, token, text, column)
                return
            end if
            allocate (character(0) :: unit)
            if (parameter%kind == kind_real .and. &
                (token%kind == token_string .or. self%now%quotes_optional .and. has_unit(text))) then
                call read_quantity(parameter, trim(adjustl(text)), number, unit, problem, hint)
            else if (token%kind == token_string) then
                problem = quoted(abbreviate(text)) // ' is not a valid value for ' // parameter%key
                hint = 'expected a value without quotes'
            else
                select case (parameter%kind)
                case (kind_real)
                    call read_real(text, number, problem, hint)
                    if (has_unit(text)) hint = quotes_hint
                    if (index(text, ',') > 0) hint = point_hint
                case (kind_integer)
                    call read_integer(text, whole_number, problem, hint)
                    number = whole_number
                case (kind_long)
                    call read_long(text, long_number, problem, hint)
                    number = real(long_number, dp)
                case default
                    call read_logical(text, flag, problem, hint)
                end select
            end if
            if (problem == '' .and. parameter%is_number()) then
                if (.not. parameter%range%contains(number)) then
                    problem = parameter%element_name(row, column) // ' is out of range'
                    hint = parameter%range%demand() // parameter%in_other_units()
                end if
            end if
            if (problem /= '') then
                call fail(self, token%place, problem, hint)
                return
            end if
            select case (parameter%kind)
            case (kind_real)
                parameter%reals(row, column) = number
                call parameter%set_unit(row, column, unit)
            case (kind_integer)
                parameter%integers(row, column) = whole_number
            case (kind_long)
                parameter%long = long_number
            case default
                parameter%flag = flag
            end select
        end associate
    end subroutine store_element

    !> Checks a text, or a word for one of some choices, and stores it.
    subroutine store_word(self, token, text, column)
        type(reader_t), intent(inout) :: self
        type(token_t), intent(in) :: token
        character(*), intent(in) :: text
        integer, intent(in) :: column
        character(:), allocatable :: word
        integer :: i

        word = text
        associate (parameter => self%parameter)
            if (token%kind == token_word .and. .not. self%now%quotes_optional) then
                call self%refuse(token%place, 'a text needs quotes', 'write ' // quoted(abbreviate(text)))
            else if (.not. token%closed) then
                call self%refuse(token%place, 'the quote is not closed on its line', 'the closing quote is missing')
            else if (.not. is_plain(text)) then
                call self%refuse(token%place, 'a tab, a control character or a byte that is not UTF-8', 'expected plain text')
            else if (len_trim(text) > parameter%text_length()) then
                call self%refuse(token%place, 'the text is too long', 'at most ' // to_text(parameter%text_length()) // ' bytes')
            else if (text == '' .and. parameter%rank > 0) then
                call self%refuse(token%place, 'an empty text in a list')
            else if (size(parameter%choices) > 0) then
                do i = size(parameter%choices), 1, -1
                    if (parameter%choices(i)%text == lower_case(trim(text))) exit
                end do
                if (names_file(parameter%choices, trim(text))) then
                    word = text
                else if (i > 0) then
                    word = parameter%choices(i)%text
                else
                    call fail(self, token%place, quoted(abbreviate(text)) // ' is not a valid value for ' // parameter%key, &
                              suggest_word(text, parameter%choices, parameter%aliases))
                end if
            end if
            if (.not. parameter%faulty) call parameter%add_text(column, word)
        end associate
    end subroutine store_word

    !> Reports an error in a value.
    subroutine fail(self, place, message, hint)
        class(reader_t), intent(inout) :: self
        type(place_t), intent(in) :: place
        character(*), intent(in) :: message
        character(*), intent(in), optional :: hint
        if (.not. self%now%refused) call self%diagnostics%error(place, message, hint)
        self%parameter%faulty = .true.
    end subroutine fail

    !> Reports an error that makes the other values of the assignment void.
    subroutine refuse(self, place, message, hint)
        class(reader_t), intent(inout) :: self
        type(place_t), intent(in) :: place !! place in the source
        character(*), intent(in) :: message !! what is wrong
        character(*), intent(in), optional :: hint !! what is expected
        call fail(self, place, message, hint)
        self%now%refused = .true.
    end subroutine refuse

    !> Reads the values after the equals sign into the parameter.
    subroutine read_values(self)
        class(reader_t), intent(inout) :: self
        type(token_t) :: token
        logical :: after_value

        after_value = .false.
        do
            if (self%at_end_of_values(words_expected=self%parameter%kind == kind_text)) return
            call self%scanner%next(token)
            select case (token%kind)
            case (token_word)
                call read_word(self, token)
            case (token_string)
                call self%store_values(token, self%scanner%string(token), 1)
            case (token_comma)
                if (.not. after_value) call self%refuse(token%place, 'no value before the comma')
            case (token_slash)
                call self%refuse(token%place, 'a slash inside a value', 'a number, not an expression; a text in quotes')
            case default
                call self%refuse(token%place, 'unexpected ' // quoted(self%scanner%word(token)))
            end select
            after_value = token%kind /= token_comma
        end do
    end subroutine read_values

    !> Reads a value without quotes, or a repeated one: `3*0.0`, `2*'ode45'`.
    subroutine read_word(self, token)
        type(reader_t), intent(inout) :: self
        type(token_t), intent(inout) :: token
        type(token_t) :: after
        character(:), allocatable :: word, problem, hint
        integer :: star, repeats

        word = self%scanner%word(token)
        star = index(word, '*')
        if (star < 2 .or. verify(word(:max(0, star - 1)), '0123456789') > 0) then
            call self%store_values(token, word, 1)
            return
        end if
        call read_integer(word(:star - 1), repeats, problem, hint)
        call self%scanner%peek(after)
        if (problem /= '' .or. repeats == 0) then
            call self%refuse(token%place, 'bad repeat count')
        else if (star < len(word)) then
            call self%store_values(token, word(star + 1:), repeats)
        else if (after%kind == token_string .and. after%touches) then
            call self%scanner%next(token)
            call self%store_values(token, self%scanner%string(token), repeats)
        else
            call self%refuse(token%place, 'no value after ' // abbreviate(word))
        end if
    end subroutine read_word

    !> Whether the values of an assignment end here: at the end of the group, at the next `key =`, or at a
    !> name at the beginning of a line that cannot be a value (its equals sign is missing).
    logical function at_end_of_values(self, words_expected) result(at_end)
        class(reader_t), intent(inout) :: self
        logical, intent(in) :: words_expected !! whether a value may be any word
        type(token_t) :: token

        at_end = .false.
        call self%scanner%peek(token)
        select case (token%kind)
        case (token_end, token_group)
            at_end = .true.
        case (token_slash)
            at_end = .not. self%scanner%is_inside_word()
        case (token_word)
            at_end = self%scanner%key_follows()
            if (at_end .or. .not. token%starts_line .or. .not. self%scanner%is_name(token)) return
            select case (lower_case(self%scanner%word(token)))
            case ('t', 'f', 'true', 'false', 'nan', 'inf', 'infinity')
                at_end = .false.
            case default
                at_end = .not. words_expected .or. &
                    self%table%find(self%group // '.' // lower_case(self%scanner%word(token))) > 0
            end select
        end select
    end function at_end_of_values

    !> Whether any of the values of a list, which are separated by commas, has a unit.
    pure logical function names_a_unit(text)
        character(*), intent(in) :: text !! the values
        integer :: first, last
        names_a_unit = .false.
        first = 1
        do while (first <= len(text) .and. .not. names_a_unit)
            last = first + index(text(first:) // ',', ',') - 2
            names_a_unit = has_unit(text(first:last))
            first = last + 2
        end do
    end function names_a_unit

    !> Whether a text is a number and a unit.
    pure logical function has_unit(text)
        character(*), intent(in) :: text !! any text
        character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ'
        character(:), allocatable :: unit
        integer :: last
        unit = adjustl(text)
        last = length_of_number(unit)
        unit = trim(adjustl(unit(last + 1:)))
        has_unit = last > 0 .and. (scan(unit, letters) == 1 .or. index(unit, '1/') == 1) .and. index(unit, '=') == 0
    end function has_unit

    !> Length of the longest number with which a text begins; 0 if there is none.
    pure integer function length_of_number(text) result(last)
        character(*), intent(in) :: text
        integer, parameter :: longest = 64
        do last = min(len(text), longest), 1, -1
            if (is_real_literal(text(:last))) return
        end do
    end function length_of_number

    !> Reads a number with its unit, in the unit of its key; without one it is none.
    subroutine read_quantity(parameter, text, number, unit, problem, hint)
        type(parameter_t), intent(in) :: parameter !! the key
        character(*), intent(in) :: text !! without quotes
        real(dp), intent(out) :: number !! in the unit of the key, or in its own if that is not known yet
        character(:), allocatable, intent(out) :: unit !! its unit, if that of the key is not known yet, or ''
        character(:), allocatable, intent(out) :: problem, hint !! what is wrong, and what is expected; '' without an error
        real(dp) :: factor
        integer :: last

        unit = ''
        last = length_of_number(text)
        if (last == 0 .or. last == len(text)) then
            problem = quoted(abbreviate(text)) // ' is not a valid value for ' // parameter%key
            hint = 'expected a value without quotes'
            if (parameter%unit_of /= '') hint = hint // ', or one with a unit, as ' // quoted('20 deg')
            if (parameter%unit /= '') hint = hint // ', or one with a unit, as ' // quoted('1 ' // trim(parameter%unit))
            number = 0
            return
        end if
        call read_real(text(:last), number, problem, hint)
        if (problem /= '') return
        if (verify(text(last + 1:), ', ') > 0 .and. scan(text(last + 1:), ',') == 1) then
            problem = 'a comma in the number ' // quoted(abbreviate(text))
            hint = point_hint
            return
        end if
        if (parameter%unit_of /= '') then
            unit = trim(adjustl(text(last + 1:)))
            return
        end if
        call convert_unit(text(last + 1:), trim(parameter%unit), factor, problem)
        if (problem /= '') hint = units_of(trim(parameter%unit))
        number = number * factor
    end subroutine read_quantity

end module spintop_assignment
