!> One parameter of an input: its description, and the variable outside this module that contains its value.
module spintop_parameter
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, is_equal
    use spintop_diagnostics, only: place_t
    use spintop_number_slot, only: range_t
    use spintop_text, only: join, replace_all, string_t, to_text
    implicit none
    private
    public :: parameter_t, unset, unset_integer, is_set, given, quoted
    public :: kind_real, kind_integer, kind_long, kind_text, kind_logical
    public :: all_elements, leading_elements, any_elements, one_per_group

    !> Value of a real that was not given.
    real(dp), parameter :: unset = -huge(1.0_dp)
    !> Value of an integer that was not given. (A text that was not given is blank.)
    integer, parameter :: unset_integer = -huge(1)

    integer, parameter :: kind_real = 1
    integer, parameter :: kind_integer = 2
    integer, parameter :: kind_text = 3
    integer, parameter :: kind_logical = 4
    !> An integer of 64 bits.
    integer, parameter :: kind_long = 5

    !> All elements of an array must be given, or none.
    integer, parameter :: all_elements = 1
    !> A list: any number of elements from the first one. A list that is given as a whole replaces the
    !> default.
    integer, parameter :: leading_elements = 2
    !> Each element may be given independently.
    integer, parameter :: any_elements = 3
    !> The group may be repeated; the n-th group has element n of a list, or row n.
    integer, parameter :: one_per_group = 4

    !> One parameter. Elements are numbered (row, column): a scalar has only (1, 1), a list has only row 1.
    type :: parameter_t
        character(:), allocatable :: name    !! `group.key`
        character(:), allocatable :: group, key
        character(:), allocatable :: unit
        !> The key whose texts name what has the unit of each element, as sweep.parameter; '' for none.
        character(:), allocatable :: unit_of
        character(:), allocatable :: what    !! one line that says what it is
        character(:), allocatable :: default !! as in a namelist, '' for none
        type(range_t) :: range
        type(string_t), allocatable :: choices(:) !! words allowed; none means any
        character(48), allocatable :: aliases(:)  !! `other=own`: another name of one of the choices
        character(:), allocatable :: key_in_degrees !! the key that takes the same angle in degrees
        integer :: kind = kind_real
        integer :: rank = 0
        integer :: elements = any_elements
        integer :: extents(2) = 1
        type(place_t), allocatable :: places(:, :) !! where each element was given
        type(place_t) :: key_place                 !! where the key was given last
        logical :: faulty = .false.                !! an error was found in what was given
        !> Units in which elements of such a parameter were given, and are until they are converted.
        type(string_t), allocatable :: units(:, :)
        !> The variable, which must exist as long as the parameter: that of its kind. A text is a column of letters.
        real(dp), pointer :: reals(:, :) => null()
        integer, pointer :: integers(:, :) => null()
        integer(int64), pointer :: long => null()
        character, pointer :: letters(:, :) => null()
        logical, pointer :: flag => null()
    contains
        procedure :: complete
        procedure :: add_text
        procedure :: text_length
        procedure :: text_at
        procedure :: set_unit
        procedure :: is_given
        procedure :: is_set => is_element_set
        procedure :: clear_row
        procedure :: value_text
        procedure :: row_text
        procedure :: element_name
        procedure :: full_name
        procedure :: is_number
        procedure :: in_other_units
    end type parameter_t

contains

    !> Whether a number of an input was given.
    elemental logical function is_set(x)
        real(dp), intent(in) :: x !! a number
        is_set = x > unset
    end function is_set

    !> A number that was given, or zero.
    elemental real(dp) function given(x)
        real(dp), intent(in) :: x !! a number
        given = merge(x, 0.0_dp, is_set(x))
    end function given

    !> Completes a parameter that is bound to its variable: kind, extents, and default value.
    subroutine complete(self, rank)
        class(parameter_t), intent(inout) :: self
        integer, intent(in) :: rank !! 0 for a scalar, 1 for a list, 2 for rows
        self%rank = rank
        if (associated(self%reals)) then
            self%kind = kind_real
            self%extents = shape(self%reals)
        else if (associated(self%integers)) then
            self%kind = kind_integer
            self%extents = shape(self%integers)
        else if (associated(self%letters)) then
            self%kind = kind_text
            self%extents(2) = size(self%letters, 2)
        else
            self%kind = merge(kind_long, kind_logical, associated(self%long))
        end if
        allocate (self%places(self%extents(1), self%extents(2)))
        self%default = self%value_text()
        if (self%kind == kind_logical) self%default = trim(merge('.true. ', '.false.', self%flag))
    end subroutine complete

    !> Whether its values are numbers.
    pure logical function is_number(self)
        class(parameter_t), intent(in) :: self
        is_number = any(self%kind == [kind_real, kind_integer, kind_long])
    end function is_number

    !> The other key that takes the value in another unit, as the end of a sentence; '' if there is none.
    pure function in_other_units(self) result(text)
        class(parameter_t), intent(in) :: self
        character(:), allocatable :: text
        text = ''
        if (allocated(self%key_in_degrees)) text = ' ' // self%unit // '; ' // self%key_in_degrees // ' takes degrees'
    end function in_other_units

    !> Sets a text element; a text that is too long is truncated.
    subroutine add_text(self, column, value)
        class(parameter_t), intent(inout) :: self
        integer, intent(in) :: column !! column of the element, from 1
        character(*), intent(in) :: value !! the new value of the element
        self%letters(:, column) = transfer(value // repeat(' ', self%text_length()), ' ', self%text_length())
    end subroutine add_text

    !> A text element.
    pure function text_at(self, column) result(text)
        class(parameter_t), intent(in) :: self
        integer, intent(in) :: column !! column of the element, from 1
        character(:), allocatable :: text
        text = repeat(' ', self%text_length())
        text = transfer(self%letters(:, column), text)
    end function text_at

    !> Sets the unit in which an element was given.
    subroutine set_unit(self, row, column, unit)
        class(parameter_t), intent(inout) :: self
        integer, intent(in) :: row, column !! row and column of the element, from 1
        character(*), intent(in) :: unit !! '' for that which it has to have
        if (unit == '' .and. .not. allocated(self%units)) return
        if (.not. allocated(self%units)) allocate (self%units(self%extents(1), self%extents(2)))
        self%units(row, column)%text = unit
    end subroutine set_unit

    !> Number of characters of a text variable.
    pure integer function text_length(self)
        class(parameter_t), intent(in) :: self
        text_length = size(self%letters, 1)
    end function text_length

    !> Whether the input gave any element.
    pure logical function is_given(self)
        class(parameter_t), intent(in) :: self
        is_given = any(self%places%source > 0)
    end function is_given

    !> Whether an element has a value, given or by default.
    pure logical function is_element_set(self, row, column) result(is_set)
        class(parameter_t), intent(in) :: self
        integer, intent(in) :: row, column !! row and column of the element, from 1
        select case (self%kind)
        case (kind_real)
            is_set = .not. is_equal(self%reals(row, column), unset)
        case (kind_integer)
            is_set = self%integers(row, column) /= unset_integer
        case (kind_long)
            is_set = self%long /= unset_integer
        case (kind_text)
            is_set = any(self%letters(:, column) /= ' ')
        case default
            is_set = self%flag .or. self%is_given()
        end select
    end function is_element_set

    !> Deletes the values of a row, and the places where they were given.
    subroutine clear_row(self, row)
        class(parameter_t), intent(inout) :: self
        integer, intent(in) :: row !! row of the parameter, from 1
        integer :: column
        self%places(row, :) = place_t()
        do column = 1, self%extents(2)
            call self%set_unit(row, column, '')
        end do
        select case (self%kind)
        case (kind_real)
            self%reals(row, :) = unset
        case (kind_integer)
            self%integers(row, :) = unset_integer
        case (kind_long)
            self%long = unset_integer
        case (kind_text)
            self%letters(:, :) = ' '
        end select
    end subroutine clear_row

    !> The elements of a row as a list, without those that have no value.
    subroutine row_text(self, row, elements, columns)
        class(parameter_t), intent(in) :: self
        integer, intent(in) :: row !! row of the parameter, from 1
        type(string_t), allocatable, intent(out) :: elements(:) !! the elements as in a namelist
        integer, allocatable, intent(out) :: columns(:) !! the column of each
        integer :: i, found

        found = count([(self%is_set(row, i), i=1, self%extents(2))])
        allocate (elements(found), columns(found))
        found = 0
        do i = 1, self%extents(2)
            if (.not. self%is_set(row, i)) cycle
            found = found + 1
            columns(found) = i
            select case (self%kind)
            case (kind_real)
                elements(found)%text = to_text(self%reals(row, i))
            case (kind_integer)
                elements(found)%text = to_text(self%integers(row, i))
            case (kind_long)
                elements(found)%text = to_text(self%long)
            case (kind_text)
                elements(found)%text = quoted(trim(self%text_at(i)))
            case (kind_logical)
                elements(found)%text = trim(merge('.true. ', '.false.', self%flag))
            end select
        end do
    end subroutine row_text

    !> All values as a list, as in a namelist.
    function value_text(self) result(text)
        class(parameter_t), intent(in) :: self
        character(:), allocatable :: text
        type(string_t), allocatable :: elements(:)
        integer, allocatable :: columns(:)
        integer :: row

        text = ''
        do row = 1, self%extents(1)
            call self%row_text(row, elements, columns)
            if (row > 1 .and. size(columns) > 0) text = text // '; '
            text = text // join(elements, ', ')
        end do
    end function value_text

    !> The name of an element inside its group: `mass`, `inertia(2)`, `values(1,3)`.
    function element_name(self, row, column) result(name)
        class(parameter_t), intent(in) :: self
        integer, intent(in) :: row, column !! row and column of the element, from 1
        character(:), allocatable :: name
        name = self%key
        if (self%rank == 1) name = name // '(' // to_text(column) // ')'
        if (self%rank == 2) name = name // '(' // to_text(row) // ',' // to_text(column) // ')'
    end function element_name

    !> The name with the extents of an array: `top.inertia(3)`, `sweep.values(4,1000)`.
    function full_name(self) result(name)
        class(parameter_t), intent(in) :: self
        character(:), allocatable :: name
        name = self%group // '.' // self%element_name(self%extents(1), self%extents(2))
    end function full_name

    !> A text in quotes, as in a namelist.
    pure function quoted(text)
        character(*), intent(in) :: text !! the text without quotes
        character(:), allocatable :: quoted
        quoted = "'" // replace_all(text, "'", "''") // "'"
    end function quoted

end module spintop_parameter
