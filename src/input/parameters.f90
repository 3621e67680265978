!> The table of all parameters of an input. Each parameter is bound once to its variable (a component of a
!> derived type with default values and the `target` attribute, which exists at least as long as the table).
!> Reading, checking, printing and listing use the table.
!>
!>     call table%add('top.mass', scene%mass, 'kg', '> 0', 'mass of the body')
!>     call table%add('top.inertia', scene%inertia, 'kg m^2', '> 0', 'principal moments')
!>     call table%add('study.kind', scene%kind, choices='trajectory|sweep', what='what to do')
!>     call table%add('sweep.from', scene%from, '', '', 'first values', elements=any_elements)
module spintop_parameters
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_diagnostics, only: place_t
    use spintop_errors, only: error_t, internal_error
    use spintop_kinds, only: dp
    use spintop_literals, only: read_subscript
    use spintop_number_slot, only: number_slot_t, parse_range
    use spintop_parameter, only: all_elements, any_elements, given, is_set, kind_integer, kind_real, &
        leading_elements, one_per_group, parameter_t, quoted, unset, unset_integer
    use spintop_text, only: did_you_mean, split, string_t, to_text
    use spintop_units, only: find_unit
    implicit none
    private
    public :: parameter_table_t, unit_hint, unset, unset_integer, is_set, given, all_elements, leading_elements
    public :: any_elements, one_per_group, missing_element, find_missing_beside

    character(*), parameter :: degrees = '_deg' !! suffix of the name of an angle in degrees
    integer, parameter :: first_room = 256      !! room for parameters at first

    !> A group of the input, and the place where it was given.
    type :: group_t
        character(:), allocatable :: name
        type(place_t) :: place = place_t()
        integer :: count = 0 !! how many times it was given
        integer :: most = 1  !! how often it may be given
    end type group_t

    !> All parameters of an input, and the places where they were given.
    type :: parameter_table_t
        type(parameter_t), allocatable :: parameters(:) !! in the order in which they were added
        integer :: count = 0                            !! number of them; the others are room for more
        type(group_t), allocatable :: groups(:)         !! in the order of their first parameter
        type(place_t) :: place = place_t()                          !! the input as a whole
        character(40), allocatable :: aliases(:)        !! `other=group.key`: another name of a key, for suggestions
        character(:), allocatable, private :: defect
    contains
        !> `add(name, variable, unit, range, what [, elements])` for reals and integers,
        !> `add(name, variable, [choices,] what [, elements])` for texts,
        !> `add(name, variable, what)` for logicals.
        generic :: add => add_real, add_reals, add_real_rows, add_integer, add_integers, add_long, &
            add_text, add_texts, add_flag
        procedure :: find, find_group, find_number, is_given, locate, place_of, unset_twin
        procedure :: verify => verify_table
        procedure, private :: add_real, add_reals, add_real_rows, add_integer, add_integers, add_long
        procedure, private :: add_text, add_texts, add_flag
    end type parameter_table_t

contains

    !> A real number.
    subroutine add_real(self, name, variable, unit, range, what)
        class(parameter_table_t), intent(inout) :: self
        character(*), intent(in) :: name, unit, range, what
        real(dp), target, intent(inout) :: variable
        type(parameter_t) :: parameter
        call c_f_pointer(c_loc(variable), parameter%reals, [1, 1])
        call append(self, parameter, 0, name, what, unit=unit, range=range)
    end subroutine add_real

    !> Reals; `elements` specifies which must be given together (default: all_elements).
    subroutine add_reals(self, name, variable, unit, range, what, elements)
        class(parameter_table_t), intent(inout) :: self
        character(*), intent(in) :: name, unit, range, what
        real(dp), target, contiguous, intent(inout) :: variable(:)
        integer, intent(in), optional :: elements
        type(parameter_t) :: parameter
        parameter%elements = all_elements
        parameter%reals(1:1, 1:size(variable)) => variable
        call append(self, parameter, 1, name, what, unit=unit, range=range, elements=elements)
    end subroutine add_reals

    !> Rows of reals; `elements` specifies which of a row must be given together (default: leading_elements).
    subroutine add_real_rows(self, name, variable, unit, range, what, elements)
        class(parameter_table_t), intent(inout) :: self
        character(*), intent(in) :: name, unit, range, what
        real(dp), target, intent(inout) :: variable(:, :)
        integer, intent(in), optional :: elements
        type(parameter_t) :: parameter
        parameter%elements = leading_elements
        parameter%reals => variable
        call append(self, parameter, 2, name, what, unit=unit, range=range, elements=elements)
    end subroutine add_real_rows

    !> An integer.
    subroutine add_integer(self, name, variable, unit, range, what)
        class(parameter_table_t), intent(inout) :: self
        character(*), intent(in) :: name, unit, range, what
        integer, target, intent(inout) :: variable
        type(parameter_t) :: parameter
        call c_f_pointer(c_loc(variable), parameter%integers, [1, 1])
        call append(self, parameter, 0, name, what, unit=unit, range=range)
    end subroutine add_integer

    !> An integer of 64 bits. It cannot be an axis of a sweep.
    subroutine add_long(self, name, variable, unit, range, what)
        class(parameter_table_t), intent(inout) :: self
        character(*), intent(in) :: name, unit, range, what
        integer(int64), target, intent(inout) :: variable
        type(parameter_t) :: parameter
        parameter%long => variable
        call append(self, parameter, 0, name, what, unit=unit, range=range)
    end subroutine add_long

    !> Integers; `elements` specifies which must be given together (default: all_elements).
    subroutine add_integers(self, name, variable, unit, range, what, elements)
        class(parameter_table_t), intent(inout) :: self
        character(*), intent(in) :: name, unit, range, what
        integer, target, contiguous, intent(inout) :: variable(:)
        integer, intent(in), optional :: elements
        type(parameter_t) :: parameter
        parameter%elements = all_elements
        parameter%integers(1:1, 1:size(variable)) => variable
        call append(self, parameter, 1, name, what, unit=unit, range=range, elements=elements)
    end subroutine add_integers

    !> A text, or one of the words in `choices` ('a|b|c').
    subroutine add_text(self, name, variable, choices, what, aliases)
        class(parameter_table_t), intent(inout) :: self
        character(*), intent(in) :: name, what
        character(*), target, intent(inout) :: variable
        character(*), intent(in), optional :: choices
        character(*), intent(in), optional :: aliases(:) !! `other=own`: another name of one of the choices
        type(parameter_t) :: parameter
        call c_f_pointer(c_loc(variable), parameter%letters, [len(variable), 1])
        if (present(aliases)) allocate (parameter%aliases, source=[character(len(parameter%aliases)) :: aliases])
        call append(self, parameter, 0, name, what, choices=choices)
    end subroutine add_text

    !> Texts; `elements` specifies which must be given together (default: leading_elements).
    subroutine add_texts(self, name, variable, choices, what, elements)
        class(parameter_table_t), intent(inout) :: self
        character(*), intent(in) :: name, what
        character(*), target, contiguous, intent(inout) :: variable(:)
        character(*), intent(in), optional :: choices
        integer, intent(in), optional :: elements
        type(parameter_t) :: parameter
        parameter%elements = leading_elements
        call c_f_pointer(c_loc(variable), parameter%letters, [len(variable), size(variable)])
        call append(self, parameter, 1, name, what, choices=choices, elements=elements)
    end subroutine add_texts

    !> A logical value.
    subroutine add_flag(self, name, variable, what)
        class(parameter_table_t), intent(inout) :: self
        character(*), intent(in) :: name, what
        logical, target, intent(inout) :: variable
        type(parameter_t) :: parameter
        parameter%flag => variable
        call append(self, parameter, 0, name, what)
    end subroutine add_flag

    !> Adds a parameter that is bound to its variable.
    subroutine append(self, parameter, rank, name, what, unit, range, choices, elements)
        class(parameter_table_t), intent(inout) :: self
        type(parameter_t), intent(inout) :: parameter
        integer, intent(in) :: rank
        character(*), intent(in) :: name, what
        character(*), intent(in), optional :: unit, range, choices
        integer, intent(in), optional :: elements
        type(parameter_t), allocatable :: more(:)
        character(*), parameter :: of = 'of ' ! `of sweep.parameter`: element i has the unit of what element i names there
        type(group_t) :: group
        character(:), allocatable :: rule
        integer :: known
        logical :: valid

        if (.not. allocated(self%parameters)) allocate (self%parameters(first_room), self%groups(0))
        if (index(name, '.') == 0 .or. self%find(name) > 0) self%defect = name // ': bad name'

        call parameter%complete(rank)
        parameter%name = name
        parameter%group = name(:index(name, '.') - 1)
        parameter%key = name(index(name, '.') + 1:)
        parameter%what = what
        parameter%unit = ''
        parameter%unit_of = ''
        if (present(unit)) parameter%unit = unit
        if (index(parameter%unit, of) == 1) then
            parameter%unit_of = unit(len(of) + 1:)
            parameter%unit = ''
        end if
        call split('', '|', parameter%choices)
        if (present(choices)) call split(choices, '|', parameter%choices)
        if (.not. allocated(parameter%aliases)) allocate (parameter%aliases(0))
        if (present(elements)) parameter%elements = elements
        rule = ''
        if (present(range)) rule = range
        call parse_range(rule, parameter%range, valid)
        if (.not. valid) self%defect = name // ': bad range ' // rule

        if (self%count == size(self%parameters)) then
            allocate (more(2 * self%count))
            more(:self%count) = self%parameters
            call move_alloc(more, self%parameters)
        end if
        self%count = self%count + 1
        self%parameters(self%count) = parameter
        known = find_in_radians(self, name)
        if (known > 0) self%parameters(known)%key_in_degrees = parameter%key
        if (self%find_group(parameter%group) > 0) return
        group%name = parameter%group
        if (parameter%elements == one_per_group) group%most = parameter%extents(merge(2, 1, rank == 1))
        self%groups = [self%groups, group]
    end subroutine append

    !> Returns an internal error if a row of the table itself is wrong.
    subroutine verify_table(self, error)
        class(parameter_table_t), intent(in) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (allocated(self%defect)) error = internal_error('parameter table: ' // self%defect)
    end subroutine verify_table

    !> Index of the parameter with a name (`group.key`), 0 if there is none.
    pure integer function find(self, name) result(number)
        class(parameter_table_t), intent(in) :: self
        character(*), intent(in) :: name !! `group.key`
        do number = self%count, 1, -1
            if (self%parameters(number)%name == name) return
        end do
    end function find

    !> Index of the group with a name, 0 if there is none.
    pure integer function find_group(self, name) result(number)
        class(parameter_table_t), intent(in) :: self
        character(*), intent(in) :: name !! `group.key`
        do number = size(self%groups), 1, -1
            if (self%groups(number)%name == name) return
        end do
    end function find_group

    !> Finds the numeric element of a name such as `top.mass` or `top.inertia(2)`.
    subroutine find_number(self, name, slot, problem)
        class(parameter_table_t), intent(in) :: self
        character(*), intent(in) :: name !! `group.key`
        type(number_slot_t), intent(out) :: slot !! the element, if there is no problem
        character(:), allocatable, intent(out) :: problem !! what is wrong with the name, or ''
        integer :: number, row, column

        call self%locate(name, number, row, column, problem)
        if (problem /= '') return
        associate (parameter => self%parameters(number))
            if (.not. parameter%is_number()) then
                problem = quoted(name) // ' is not a number'
                return
            end if
            slot%range = parameter%range
            slot%range%rule = parameter%range%rule // parameter%in_other_units()
        end associate
        if (self%parameters(number)%kind == kind_real) slot%real_value => self%parameters(number)%reals(row, column)
        if (self%parameters(number)%kind == kind_integer) slot%integer_value => self%parameters(number)%integers(row, column)
    end subroutine find_number

    !> Whether the input gave the parameter, or the element, of that name.
    logical function is_given(self, name)
        class(parameter_table_t), intent(in) :: self
        character(*), intent(in) :: name !! `group.key`
        type(place_t) :: place
        place = given_place(self, name)
        is_given = place%source > 0
    end function is_given

    !> The place for a message about a parameter, an element or a group: where it was given, else its group,
    !> else the input as a whole.
    type(place_t) function place_of(self, name) result(place)
        class(parameter_table_t), intent(in) :: self
        character(*), intent(in) :: name !! `group.key`
        integer :: number

        place = given_place(self, name)
        if (place%source > 0) return
        number = self%find_group(name(:index(name // '.', '.') - 1))
        if (number > 0) place = self%groups(number)%place
        if (place%source == 0) place = self%place
    end function place_of

    !> Where the input gave an element, or the first one of a parameter; none if it did not.
    type(place_t) function given_place(self, name) result(place)
        type(parameter_table_t), intent(in) :: self
        character(*), intent(in) :: name
        character(:), allocatable :: problem
        integer :: number, row, column

        number = self%find(name)
        if (number == 0) then
            call self%locate(name, number, row, column, problem)
            if (problem == '') place = self%parameters(number)%places(row, column)
            return
        end if
        associate (places => self%parameters(number)%places)
            do row = 1, size(places, 1)
                column = findloc(places(row, :)%source > 0, .true., dim=1)
                if (column == 0) cycle
                place = places(row, column)
                return
            end do
        end associate
    end function given_place

    !> Finds the element of a name such as `top.mass`, `top.inertia(2)`, `sweep.values(1,3)`.
    subroutine locate(self, name, number, row, column, problem)
        class(parameter_table_t), intent(in) :: self
        character(*), intent(in) :: name !! `group.key`
        integer, intent(out) :: number, row, column !! index of the parameter, row and column of the element, from 1
        character(:), allocatable, intent(out) :: problem !! what is wrong with the name, or ''
        type(string_t), allocatable :: subscripts(:), names(:)
        character(:), allocatable :: hint
        integer :: open, last, i, values(2)

        problem = ''
        row = 1
        column = 1
        last = len_trim(name)
        open = index(name // '(', '(')
        number = self%find(name(:open - 1))
        if (number == 0) then
            allocate (names(self%count))
            do i = 1, size(names)
                names(i)%text = self%parameters(i)%name
            end do
            problem = 'unknown parameter ' // quoted(name(:open - 1))
            hint = unit_hint(self, name(:open - 1))
            if (hint == '') hint = did_you_mean(name(:open - 1), names)
            if (hint /= '') problem = problem // '; ' // hint
            return
        end if

        associate (parameter => self%parameters(number))
            call split(name(min(open, last) + 1:last - 1), ',', subscripts)
            if (size(subscripts) /= parameter%rank .or. (open < last .and. name(last:) /= ')')) then
                problem = quoted(name) // ' is not one number: '
                if (parameter%rank == 0) problem = problem // parameter%key // ' takes no subscript'
                if (parameter%rank > 0) problem = problem // 'name an element, such as ' // &
                    quoted(parameter%group // '.' // parameter%element_name(1, 1))
                return
            end if
            values = 1
            do i = 1, parameter%rank
                call read_subscript(subscripts(i)%text, values(2 - parameter%rank + i))
            end do
            if (any(values < 1 .or. values > parameter%extents)) then
                problem = quoted(name) // ' has a subscript that is not in ' // parameter%full_name()
                return
            end if
            row = values(1)
            column = values(2)
        end associate
    end subroutine locate

    !> Index of the parameter whose name this one is, but for the suffix for degrees; 0 if there is none.
    pure integer function find_in_radians(self, name) result(number)
        type(parameter_table_t), intent(in) :: self
        character(*), intent(in) :: name
        integer :: last
        number = 0
        last = len_trim(name) - len(degrees)
        if (last <= 0) return
        if (name(last + 1:) == degrees) number = self%find(name(:last))
    end function find_in_radians

    !> Deletes elements of the other parameter for the same angles, that in radians or that in degrees: these have new values.
    subroutine unset_twin(self, number, row, first, last)
        class(parameter_table_t), intent(inout) :: self
        integer, intent(in) :: number !! index of the parameter that has them
        integer, intent(in) :: row, first, last !! row of the elements, and their columns
        integer :: twin
        twin = max(find_in_radians(self, self%parameters(number)%name), self%find(self%parameters(number)%name // degrees))
        if (twin == 0) return
        self%parameters(twin)%reals(row, first:last) = unset
        self%parameters(twin)%places(row, first:last) = place_t()
    end subroutine unset_twin

    !> The hint for a parameter whose name has a unit, as `initial.phi_rate_deg`; '' for other names.
    function unit_hint(table, name) result(hint)
        class(parameter_table_t), intent(in) :: table !! the parameters of an input
        character(*), intent(in) :: name !! `group.key`
        character(:), allocatable :: hint, unit, problem
        real(dp) :: size
        integer :: number, last
        hint = ''
        last = index(name, '_', back=.true.)
        number = table%find(name(:max(0, last - 1)))
        if (number == 0) return
        associate (own => table%parameters(number)%unit)
            call find_unit(name(last + 1:), own, unit, size, problem)
            if (problem == '') hint = quoted(table%parameters(number)%key) // ' is in ' // own // ': 1 ' // own // ' = ' // &
                                      to_text(1 / size) // ' ' // unit
        end associate
    end function unit_hint

    !> Name of the first element that the others require, without the group; '' if none is missing.
    function missing_element(parameter, filled) result(name)
        type(parameter_t), intent(in) :: parameter !! a parameter of an input
        logical, intent(in), optional :: filled(:, :) !! its elements that get their values elsewhere, by row and column
        character(:), allocatable :: name
        logical :: has_value(parameter%extents(1), parameter%extents(2))
        logical :: concerned
        integer :: row, column, needed

        name = ''
        concerned = parameter%is_given()
        has_value = reshape([((parameter%is_set(row, column), row=1, parameter%extents(1)), column=1, parameter%extents(2))], &
                            shape(has_value))
        if (present(filled)) then
            concerned = concerned .or. any(filled)
            has_value = has_value .or. filled
        end if
        if (.not. concerned) return
        do row = 1, parameter%extents(1)
            needed = 0
            if (parameter%elements == all_elements) needed = parameter%extents(2)
            if (parameter%elements == one_per_group .and. parameter%rank == 2 .and. any(has_value(row, :))) then
                needed = parameter%extents(2)
            end if
            if (parameter%elements == leading_elements) needed = findloc(has_value(row, :), .true., dim=1, back=.true.)
            column = findloc(has_value(row, :needed), .false., dim=1)
            if (column == 0) cycle
            name = parameter%element_name(row, column)
            return
        end do
    end function missing_element

    !> Finds the first element that is missing beside those that get their values elsewhere, as the axes of a sweep give
    !> them.
    subroutine find_missing_beside(table, names, missing, given)
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(string_t), intent(in) :: names(:) !! the elements with values from elsewhere, as `top.inertia(2)`; all are known
        character(:), allocatable, intent(out) :: missing !! its full name; '' if none is missing
        integer, intent(out) :: given !! which of `names` requires it; 0 if none is missing
        character(:), allocatable :: problem
        logical, allocatable :: filled(:, :)
        integer :: at(3, size(names)), i, k

        do i = 1, size(names)
            call table%locate(names(i)%text, at(1, i), at(2, i), at(3, i), problem)
        end do
        missing = ''
        do i = 1, size(names)
            associate (parameter => table%parameters(at(1, i)))
                allocate (filled(parameter%extents(1), parameter%extents(2)), source=.false.)
                do k = 1, size(names)
                    if (at(1, k) == at(1, i)) filled(at(2, k), at(3, k)) = .true.
                end do
                missing = missing_element(parameter, filled)
                deallocate (filled)
                if (missing == '') cycle
                given = i
                missing = parameter%group // '.' // missing
                return
            end associate
        end do
        given = 0
    end subroutine find_missing_beside

end module spintop_parameters
