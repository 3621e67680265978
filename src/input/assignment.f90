!> An assignment `key(subscripts) = values`: its values, which may have units, are read, checked and stored.
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
    public :: assignment_t, read_values, skip_values, read_quantity, names_a_unit, has_unit

    character(*), parameter :: quotes_hint = 'a number with its unit is in quotes, as ''20 deg'''

    !> The elements that an assignment names, and its state.
    type :: assignment_t
        type(place_t) :: place           !! of the key
        logical :: quotes_optional = .false.
        logical :: refused = .false.     !! an error makes the other values void
        integer :: group = 0             !! which of the groups of this name it stands in, if these may be repeated
        integer, private :: rank = 0     !! dimensions of what the key names: 0 for a value, 1 for a list, 2 for rows
        integer, private :: row = 1, first = 1, last = 1
        logical, private :: whole = .true. !! the key or its row, without bounds
        integer :: count = 0             !! values so far
    contains
        procedure :: read_subscripts
        procedure :: begin
        procedure :: store_values
        procedure :: finish
        procedure :: refuse
    end type assignment_t

contains

    !> Reads the subscripts, if there are any: `(2)`, `(1,:)`, `(1,2:4)`, `(:3)`.
    subroutine read_subscripts(self, parameter, scanner, diagnostics)
        class(assignment_t), intent(inout) :: self
        type(parameter_t), intent(inout) :: parameter !! the parameter
        type(scanner_t), intent(inout) :: scanner !! the scanner, after the key
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(token_t) :: token
        integer :: bounds(2, 2), dimensions

        self%last = parameter%extents(2)
        self%rank = parameter%rank
        if (parameter%elements == one_per_group .and. self%group > 0) call select_group(self)
        call scanner%peek(token)
        if (token%kind /= token_open) then
            if (self%rank == 2) call self%refuse(parameter, diagnostics, self%place, &
                parameter%key // ' has rows', 'name one: ' // parameter%key // '(1,:) = ...')
            return
        end if
        call scanner%next(token)
        call read_bounds(scanner, bounds, dimensions, token)
        self%place%width = token%place%column - self%place%column + 1
        if (self%rank == 0) then
            call self%refuse(parameter, diagnostics, self%place, &
                parameter%key // ' is a single value', 'it takes no subscript')
        else if (dimensions /= self%rank) then
            call self%refuse(parameter, diagnostics, self%place, 'bad subscript of ' // &
                parameter%key, 'write ' // example(parameter, self%rank) // '; strides are not supported')
        else if (self%rank == 2 .and. &
            (bounds(1, 1) < 1 .or. bounds(1, 1) /= bounds(2, 1))) then
            call self%refuse(parameter, diagnostics, self%place, &
                'one row at a time', 'write ' // example(parameter, self%rank))
        else
            if (self%rank == 2) self%row = bounds(1, 1)
            call set_bounds(self, parameter, bounds(:, dimensions), diagnostics)
        end if
    end subroutine read_subscripts

    !> In the n-th group of a name a key stands for element n of its list, or for row n.
    pure subroutine select_group(self)
        class(assignment_t), intent(inout) :: self
        self%rank = self%rank - 1
        if (self%rank == 1) then
            self%row = self%group
        else
            self%first = self%group
            self%last = self%group
        end if
    end subroutine select_group

    !> Example of the subscripts of a parameter.
    function example(parameter, rank) result(text)
        type(parameter_t), intent(in) :: parameter
        integer, intent(in) :: rank
        character(:), allocatable :: text
        if (rank == 1) then
            text = parameter%key // '(2) or ' // parameter%key // '(2:3)'
        else
            text = parameter%key // '(1,:) or ' // parameter%key // '(1,2:3)'
        end if
    end function example

    subroutine set_bounds(self, parameter, bounds, diagnostics)
        class(assignment_t), intent(inout) :: self
        type(parameter_t), intent(inout) :: parameter
        integer, intent(in) :: bounds(2)
        type(diagnostics_t), intent(inout) :: diagnostics

        self%first = max(bounds(1), 1)
        if (bounds(2) > 0) self%last = bounds(2)
        self%whole = bounds(1) < 1 .and. bounds(2) < 1
        if (self%row < 1 .or. self%row > parameter%extents(1) .or. self%first > self%last &
            .or. self%last > parameter%extents(2)) then
            call self%refuse(parameter, diagnostics, self%place, 'subscript out of bounds', &
                'the array is ' // parameter%full_name())
        end if
    end subroutine set_bounds

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
    subroutine begin(self, parameter, diagnostics)
        class(assignment_t), intent(inout) :: self
        type(parameter_t), intent(inout) :: parameter !! the parameter
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        integer :: i

        if (self%refused) return
        do i = self%first, self%last
            if (parameter%places(self%row, i)%source /= self%place%source) cycle
            call self%refuse(parameter, diagnostics, self%place, parameter%key // &
                ' is given a second time', 'first on line ' // &
                to_text(parameter%places(self%row, i)%line))
            return
        end do
        if (self%whole .and. parameter%elements == leading_elements) then
            call parameter%clear_row(self%row)
        end if
        parameter%key_place = self%place
    end subroutine begin

    !> Stores a value `repeats` times.
    subroutine store_values(self, parameter, token, text, repeats, diagnostics)
        class(assignment_t), intent(inout) :: self
        type(parameter_t), intent(inout) :: parameter !! the parameter
        type(token_t), intent(in) :: token !! the token of the value
        character(*), intent(in) :: text !! the value, without quotes
        integer, intent(in) :: repeats !! number of consecutive elements with this value
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        character(:), allocatable :: hint, problem
        real(dp) :: factor
        integer :: i

        do i = 1, repeats
            if (self%refused) return
            self%count = self%count + 1
            if (self%count > self%last - self%first + 1) then
                if (parameter%faulty) return
                hint = 'it takes ' // values(self%last - self%first + 1)
                if (self%last == self%first .and. self%rank > 0) hint = hint // '; several: ' &
                    // parameter%key // ' = ..., or ' // example(parameter, self%rank)
                if (token%touches .and. parameter%kind == kind_text) then
                    hint = hint // '; a quote inside a text is written twice'
                end if
                problem = ''
                if (parameter%kind == kind_real .and. has_unit('1 ' // text)) then
                    hint = quotes_hint
                    call convert_unit(text, text, factor, problem)
                end if
                if (problem == '') problem = 'too many values for ' // parameter%key
                call self%refuse(parameter, diagnostics, token%place, problem, hint)
                return
            end if
            call store_element(self, parameter, token, text, self%first + self%count - 1, diagnostics)
            if (parameter%faulty) return
        end do
    end subroutine store_values

    !> Checks that the number of values is sufficient.
    subroutine finish(self, parameter, diagnostics)
        class(assignment_t), intent(inout) :: self
        type(parameter_t), intent(inout) :: parameter !! the parameter
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        logical :: all_needed

        if (self%refused .or. parameter%faulty) return
        all_needed = parameter%elements == all_elements .or. .not. self%whole .or. self%group > 0
        if (self%count == 0) then
            call self%refuse(parameter, diagnostics, self%place, &
                'no value for ' // parameter%key, 'omit the key to use the default')
        else if (all_needed .and. self%first + self%count <= self%last) then
            call self%refuse(parameter, diagnostics, self%place, 'too few values for ' // &
                parameter%key, 'it takes ' // to_text(self%last - self%first + 1) // &
                ', but has ' // to_text(self%count))
        end if
    end subroutine finish

    pure function values(number) result(text)
        integer, intent(in) :: number
        character(:), allocatable :: text
        text = to_text(number) // ' values'
        if (number == 1) text = 'one value'
    end function values

    subroutine store_element(self, parameter, token, text, column, diagnostics)
        class(assignment_t), intent(inout) :: self
        type(parameter_t), intent(inout) :: parameter
        type(token_t), intent(in) :: token
        character(*), intent(in) :: text
        integer, intent(in) :: column
        type(diagnostics_t), intent(inout) :: diagnostics
        character(:), allocatable :: problem, hint, unit
        real(dp) :: number
        integer :: whole_number
        integer(int64) :: long_number
        logical :: flag

        parameter%places(self%row, column) = token%place
        if (parameter%kind == kind_text) then
            call store_word(self, parameter, token, text, column, diagnostics)
            return
        end if
        allocate (character(0) :: unit)
        if (parameter%kind == kind_real .and. (token%kind == token_string .or. self%quotes_optional .and. has_unit(text))) then
            call read_quantity(parameter, trim(adjustl(text)), number, unit, problem, hint)
        else if (token%kind == token_string) then
            problem = quoted(abbreviate(text)) // ' is not a valid value for ' // parameter%key
            hint = 'expected a value without quotes'
        else
            select case (parameter%kind)
            case (kind_real)
                call read_real(text, number, problem, hint)
                if (has_unit(text)) hint = quotes_hint
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
                problem = parameter%element_name(self%row, column) // ' is out of range'
                hint = 'must be ' // parameter%rule
                if (scan(parameter%rule, '[(') == 1) hint = 'must be in ' // parameter%rule
                hint = hint // parameter%in_other_units()
            end if
        end if
        if (problem /= '') then
            call fail(self, parameter, diagnostics, token%place, problem, hint)
            return
        end if
        select case (parameter%kind)
        case (kind_real)
            parameter%reals(self%row, column) = number
            call parameter%set_unit(self%row, column, unit)
        case (kind_integer)
            parameter%integers(self%row, column) = whole_number
        case (kind_long)
            parameter%long = long_number
        case default
            parameter%flag = flag
        end select
    end subroutine store_element

    subroutine store_word(self, parameter, token, text, column, diagnostics)
        class(assignment_t), intent(inout) :: self
        type(parameter_t), intent(inout) :: parameter
        type(token_t), intent(in) :: token
        character(*), intent(in) :: text
        integer, intent(in) :: column
        type(diagnostics_t), intent(inout) :: diagnostics
        character(:), allocatable :: word
        integer :: i

        word = text
        if (token%kind == token_word .and. .not. self%quotes_optional) then
            call self%refuse(parameter, diagnostics, token%place, &
                'a text needs quotes', 'write ' // quoted(abbreviate(text)))
        else if (.not. token%closed) then
            call self%refuse(parameter, diagnostics, token%place, &
                'the quote is not closed on its line', 'the closing quote is missing')
        else if (.not. is_plain(text)) then
            call self%refuse(parameter, diagnostics, token%place, &
                'a tab, a control character or a byte that is not UTF-8', 'expected plain text')
        else if (len_trim(text) > parameter%text_length()) then
            call self%refuse(parameter, diagnostics, token%place, 'the text is too long', &
                'at most ' // to_text(parameter%text_length()) // ' bytes')
        else if (text == '' .and. parameter%rank > 0) then
            call self%refuse(parameter, diagnostics, token%place, 'an empty text in a list')
        else if (size(parameter%choices) > 0) then
            do i = size(parameter%choices), 1, -1
                if (parameter%choices(i)%text == lower_case(trim(text))) exit
            end do
            if (names_file(parameter%choices, trim(text))) then
                word = text
            else if (i > 0) then
                word = parameter%choices(i)%text
            else
                call fail(self, parameter, diagnostics, token%place, quoted(abbreviate(text)) // &
                    ' is not a valid value for ' // parameter%key, &
                    suggest_word(text, parameter%choices, parameter%aliases))
            end if
        end if
        if (.not. parameter%faulty) call parameter%add_text(column, word)
    end subroutine store_word

    !> Reports an error in a value.
    subroutine fail(self, parameter, diagnostics, place, message, hint)
        class(assignment_t), intent(in) :: self
        type(parameter_t), intent(inout) :: parameter
        type(diagnostics_t), intent(inout) :: diagnostics
        type(place_t), intent(in) :: place
        character(*), intent(in) :: message
        character(*), intent(in), optional :: hint
        if (.not. self%refused) call diagnostics%error(place, message, hint)
        parameter%faulty = .true.
    end subroutine fail

    !> Reports an error that makes the other values of the assignment void.
    subroutine refuse(self, parameter, diagnostics, place, message, hint)
        class(assignment_t), intent(inout) :: self
        type(parameter_t), intent(inout) :: parameter !! the parameter
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(place_t), intent(in) :: place !! place in the source
        character(*), intent(in) :: message !! what is wrong
        character(*), intent(in), optional :: hint !! what is expected
        call fail(self, parameter, diagnostics, place, message, hint)
        self%refused = .true.
    end subroutine refuse

    !> Reads the values after an equals sign into the parameter.
    subroutine read_values(scanner, group, table, parameter, assignment, diagnostics)
        type(scanner_t), intent(inout) :: scanner !! the scanner, after the equals sign
        character(*), intent(in) :: group !! name of the group that has the key
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(parameter_t), intent(inout) :: parameter !! the parameter
        type(assignment_t), intent(inout) :: assignment !! the assignment
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(token_t) :: token
        logical :: after_value

        after_value = .false.
        do
            if (at_end_of_values(scanner, group, table, parameter%kind == kind_text)) return
            call scanner%next(token)
            select case (token%kind)
            case (token_word)
                call read_word(scanner, token, parameter, assignment, diagnostics)
            case (token_string)
                call assignment%store_values(parameter, token, scanner%string(token), 1, diagnostics)
            case (token_comma)
                if (.not. after_value) call assignment%refuse(parameter, diagnostics, &
                    token%place, 'no value before the comma')
            case (token_slash)
                call assignment%refuse(parameter, diagnostics, token%place, &
                    'a slash inside a value', 'a number, not an expression; a text in quotes')
            case default
                call assignment%refuse(parameter, diagnostics, token%place, &
                    'unexpected ' // quoted(scanner%word(token)))
            end select
            after_value = token%kind /= token_comma
        end do
    end subroutine read_values

    !> Reads a value without quotes, or a repeated one: `3*0.0`, `2*'ode45'`.
    subroutine read_word(scanner, token, parameter, assignment, diagnostics)
        type(scanner_t), intent(inout) :: scanner
        type(token_t), intent(inout) :: token
        type(parameter_t), intent(inout) :: parameter
        type(assignment_t), intent(inout) :: assignment
        type(diagnostics_t), intent(inout) :: diagnostics
        type(token_t) :: after
        character(:), allocatable :: word, problem, hint
        integer :: star, repeats

        word = scanner%word(token)
        star = index(word, '*')
        if (star < 2 .or. verify(word(:max(0, star - 1)), '0123456789') > 0) then
            call assignment%store_values(parameter, token, word, 1, diagnostics)
            return
        end if
        call read_integer(word(:star - 1), repeats, problem, hint)
        call scanner%peek(after)
        if (problem /= '' .or. repeats == 0) then
            call assignment%refuse(parameter, diagnostics, token%place, 'bad repeat count')
        else if (star < len(word)) then
            call assignment%store_values(parameter, token, word(star + 1:), repeats, diagnostics)
        else if (after%kind == token_string .and. after%touches) then
            call scanner%next(token)
            call assignment%store_values(parameter, token, scanner%string(token), repeats, diagnostics)
        else
            call assignment%refuse(parameter, diagnostics, token%place, &
                'no value after ' // abbreviate(word))
        end if
    end subroutine read_word

    !> Skips values of an unknown key.
    subroutine skip_values(scanner, group, table)
        type(scanner_t), intent(inout) :: scanner !! the scanner, after the equals sign
        character(*), intent(in) :: group !! name of the group that has the key
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(token_t) :: token
        do while (.not. at_end_of_values(scanner, group, table, .true.))
            call scanner%next(token)
        end do
    end subroutine skip_values

    !> Whether the values of an assignment end here: at the end of the group, at the next `key =`, or at a
    !> name at the beginning of a line that cannot be a value (its equals sign is missing).
    logical function at_end_of_values(scanner, group, table, words_expected) result(at_end)
        type(scanner_t), intent(inout) :: scanner
        character(*), intent(in) :: group
        type(parameter_table_t), intent(in) :: table
        logical, intent(in) :: words_expected
        type(token_t) :: token

        at_end = .false.
        call scanner%peek(token)
        select case (token%kind)
        case (token_end, token_group)
            at_end = .true.
        case (token_slash)
            at_end = .not. scanner%is_inside_word()
        case (token_word)
            at_end = scanner%key_follows()
            if (at_end .or. .not. token%starts_line .or. .not. scanner%is_name(token)) return
            select case (lower_case(scanner%word(token)))
            case ('t', 'f', 'true', 'false', 'nan', 'inf', 'infinity')
                at_end = .false.
            case default
                at_end = .not. words_expected .or. &
                    table%find(group // '.' // lower_case(scanner%word(token))) > 0
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
            hint = 'decimals follow a point, as in 25.5'
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
