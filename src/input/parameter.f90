!> One parameter of an input: what it is, and the variable outside this module that holds it.
module spintop_parameter
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc
    use spintop_compare, only: is_equal
    use spintop_diagnostics, only: place_t
    use spintop_kinds, only: dp
    use spintop_ranges, only: range_t
    use spintop_text, only: join, replace_all, string_t, to_text
    implicit none
    private
    public :: parameter_t, unset, unset_integer, quoted
    public :: kind_real, kind_integer, kind_text, kind_logical
    public :: all_elements, leading_elements, any_elements

    !> The value of a real that was not given.
    real(dp), parameter :: unset = -huge(1.0_dp)
    !> The value of an integer that was not given. (Of a text: blank.)
    integer, parameter :: unset_integer = -huge(1)

    integer, parameter :: kind_real = 1
    integer, parameter :: kind_integer = 2
    integer, parameter :: kind_text = 3
    integer, parameter :: kind_logical = 4

    !> All elements of an array are given, or none.
    integer, parameter :: all_elements = 1
    !> A list: any number of elements from the first on; given as a whole it replaces the default.
    integer, parameter :: leading_elements = 2
    !> Each element stands for itself.
    integer, parameter :: any_elements = 3

    !> One parameter. Elements are numbered (row, column): a scalar has only (1, 1), a list only
    !> row 1.
    type :: parameter_t
        character(:), allocatable :: name    !! `group.key`
        character(:), allocatable :: group, key
        character(:), allocatable :: unit
        character(:), allocatable :: rule    !! the range as written, see spintop_ranges
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
        real(dp), pointer, private :: reals(:, :) => null()
        integer, pointer, private :: integers(:, :) => null()
        character, pointer, private :: letters(:, :) => null()
        logical, pointer, private :: flag => null()
    contains
        procedure :: bind_real, bind_reals, bind_real_rows, bind_integer, bind_integers
        procedure :: bind_text, bind_texts, bind_flag
        procedure :: put_real, put_integer, put_text, put_flag
        procedure :: text_length
        procedure :: real_target, integer_target
        procedure :: is_given
        procedure :: is_set
        procedure :: last_set
        procedure :: clear_row
        procedure :: value_text
        procedure :: row_text
        procedure :: element_name
        procedure :: full_name
        procedure :: is_number
        procedure :: in_other_units
        procedure, private :: prepare
    end type parameter_t

contains

    !> Makes it a real number, held by a variable.
    subroutine bind_real(self, variable)
        class(parameter_t), intent(inout) :: self
        real(dp), target, intent(inout) :: variable
        call c_f_pointer(c_loc(variable), self%reals, [1, 1])
        call self%prepare(kind_real, 0, [1, 1])
    end subroutine bind_real

    !> Makes it a list of reals.
    subroutine bind_reals(self, variable)
        class(parameter_t), intent(inout) :: self
        real(dp), target, contiguous, intent(inout) :: variable(:)
        self%reals(1:1, 1:size(variable)) => variable
        call self%prepare(kind_real, 1, [1, size(variable)])
    end subroutine bind_reals

    !> Makes it rows of reals.
    subroutine bind_real_rows(self, variable)
        class(parameter_t), intent(inout) :: self
        real(dp), target, intent(inout) :: variable(:, :)
        self%reals => variable
        call self%prepare(kind_real, 2, shape(variable))
    end subroutine bind_real_rows

    !> Makes it a whole number.
    subroutine bind_integer(self, variable)
        class(parameter_t), intent(inout) :: self
        integer, target, intent(inout) :: variable
        call c_f_pointer(c_loc(variable), self%integers, [1, 1])
        call self%prepare(kind_integer, 0, [1, 1])
    end subroutine bind_integer

    !> Makes it a list of whole numbers.
    subroutine bind_integers(self, variable)
        class(parameter_t), intent(inout) :: self
        integer, target, contiguous, intent(inout) :: variable(:)
        self%integers(1:1, 1:size(variable)) => variable
        call self%prepare(kind_integer, 1, [1, size(variable)])
    end subroutine bind_integers

    !> Makes it a text.
    subroutine bind_text(self, variable)
        class(parameter_t), intent(inout) :: self
        character(*), target, intent(inout) :: variable
        call c_f_pointer(c_loc(variable), self%letters, [len(variable), 1])
        call self%prepare(kind_text, 0, [1, 1])
    end subroutine bind_text

    !> Makes it a list of texts.
    subroutine bind_texts(self, variable)
        class(parameter_t), intent(inout) :: self
        character(*), target, contiguous, intent(inout) :: variable(:)
        call c_f_pointer(c_loc(variable), self%letters, [len(variable), size(variable)])
        call self%prepare(kind_text, 1, [1, size(variable)])
    end subroutine bind_texts

    !> Makes it a yes or no.
    subroutine bind_flag(self, variable)
        class(parameter_t), intent(inout) :: self
        logical, target, intent(inout) :: variable
        self%flag => variable
        call self%prepare(kind_logical, 0, [1, 1])
    end subroutine bind_flag

    subroutine prepare(self, kind, rank, extents)
        class(parameter_t), intent(inout) :: self
        integer, intent(in) :: kind, rank, extents(2)
        self%kind = kind
        self%rank = rank
        self%extents = extents
        allocate (self%places(extents(1), extents(2)))
        self%default = self%value_text()
    end subroutine prepare

    !> Whether it holds numbers.
    pure logical function is_number(self)
        class(parameter_t), intent(in) :: self
        is_number = self%kind == kind_real .or. self%kind == kind_integer
    end function is_number

    !> Which other key takes the value in other units, as the end of a sentence; '' if none does.
    pure function in_other_units(self) result(text)
        class(parameter_t), intent(in) :: self
        character(:), allocatable :: text
        text = ''
        if (allocated(self%key_in_degrees)) text = ' ' // self%unit // '; ' // self%key_in_degrees // ' takes degrees'
    end function in_other_units

    !> Sets an element that is a real.
    subroutine put_real(self, row, column, value)
        class(parameter_t), intent(inout) :: self
        integer, intent(in) :: row, column
        real(dp), intent(in) :: value
        self%reals(row, column) = value
    end subroutine put_real

    !> Sets an element that is a whole number.
    subroutine put_integer(self, row, column, value)
        class(parameter_t), intent(inout) :: self
        integer, intent(in) :: row, column, value
        self%integers(row, column) = value
    end subroutine put_integer

    !> Sets an element that is a text; what is too long is cut.
    subroutine put_text(self, column, value)
        class(parameter_t), intent(inout) :: self
        integer, intent(in) :: column
        character(*), intent(in) :: value
        integer :: i
        self%letters(:, column) = ' '
        do i = 1, min(len(value), self%text_length())
            self%letters(i, column) = value(i:i)
        end do
    end subroutine put_text

    !> Sets a yes or no.
    subroutine put_flag(self, value)
        class(parameter_t), intent(inout) :: self
        logical, intent(in) :: value
        self%flag = value
    end subroutine put_flag

    !> Characters that the variable holds.
    pure integer function text_length(self)
        class(parameter_t), intent(in) :: self
        text_length = size(self%letters, 1)
    end function text_length

    !> The variable that holds a real element.
    function real_target(self, row, column) result(variable)
        class(parameter_t), intent(in) :: self
        integer, intent(in) :: row, column
        real(dp), pointer :: variable
        variable => self%reals(row, column)
    end function real_target

    !> The variable that holds an integer element.
    function integer_target(self, row, column) result(variable)
        class(parameter_t), intent(in) :: self
        integer, intent(in) :: row, column
        integer, pointer :: variable
        variable => self%integers(row, column)
    end function integer_target

    !> Whether the input gave any element (or the element of that row and column).
    pure logical function is_given(self, row, column)
        class(parameter_t), intent(in) :: self
        integer, intent(in), optional :: row, column
        if (present(row) .and. present(column)) then
            is_given = self%places(row, column)%source > 0
        else
            is_given = any(self%places%source > 0)
        end if
    end function is_given

    !> Whether an element has a value, given or by default.
    pure logical function is_set(self, row, column)
        class(parameter_t), intent(in) :: self
        integer, intent(in) :: row, column
        select case (self%kind)
        case (kind_real)
            is_set = .not. is_equal(self%reals(row, column), unset)
        case (kind_integer)
            is_set = self%integers(row, column) /= unset_integer
        case (kind_text)
            is_set = any(self%letters(:, column) /= ' ')
        case default
            is_set = .true.
        end select
    end function is_set

    !> Column of the last element of a row that has a value; 0 if none has.
    pure integer function last_set(self, row) result(last)
        class(parameter_t), intent(in) :: self
        integer, intent(in) :: row
        do last = self%extents(2), 1, -1
            if (self%is_set(row, last)) return
        end do
    end function last_set

    !> Takes the values of a row away, and where they were given.
    subroutine clear_row(self, row)
        class(parameter_t), intent(inout) :: self
        integer, intent(in) :: row
        self%places(row, :) = place_t()
        select case (self%kind)
        case (kind_real)
            self%reals(row, :) = unset
        case (kind_integer)
            self%integers(row, :) = unset_integer
        case (kind_text)
            self%letters(:, :) = ' '
        end select
    end subroutine clear_row

    !> One element as a namelist has it; '' if it has no value.
    function element_text(self, row, column) result(text)
        class(parameter_t), intent(in) :: self
        integer, intent(in) :: row, column
        character(:), allocatable :: text
        character(:), allocatable :: letters
        integer :: i

        text = ''
        if (.not. self%is_set(row, column)) return
        select case (self%kind)
        case (kind_real)
            text = to_text(self%reals(row, column))
        case (kind_integer)
            text = to_text(self%integers(row, column))
        case (kind_text)
            letters = repeat(' ', self%text_length())
            do i = 1, len(letters)
                letters(i:i) = self%letters(i, column)
            end do
            text = quoted(trim(letters))
        case (kind_logical)
            text = trim(merge('.true. ', '.false.', self%flag))
        end select
    end function element_text

    !> The elements of a row in a list, those without a value left out.
    subroutine row_text(self, row, elements, columns)
        class(parameter_t), intent(in) :: self
        integer, intent(in) :: row
        type(string_t), allocatable, intent(out) :: elements(:)
        integer, allocatable, intent(out) :: columns(:) !! the column of each
        integer :: i, found

        found = count([(self%is_set(row, i), i=1, self%extents(2))])
        allocate (elements(found), columns(found))
        found = 0
        do i = 1, self%extents(2)
            if (.not. self%is_set(row, i)) cycle
            found = found + 1
            columns(found) = i
            elements(found)%text = element_text(self, row, i)
        end do
    end subroutine row_text

    !> All values in a list, as a namelist has them.
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

    !> The name of one element inside its group: `mass`, `inertia(2)`, `values(1,3)`.
    function element_name(self, row, column) result(name)
        class(parameter_t), intent(in) :: self
        integer, intent(in) :: row, column
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

    !> A text in quotes, as a namelist has it.
    pure function quoted(text)
        character(*), intent(in) :: text
        character(:), allocatable :: quoted
        quoted = "'" // replace_all(text, "'", "''") // "'"
    end function quoted

end module spintop_parameter
