!> The axes of a sweep: how they combine into cases, and the values of each case. Any case is computed
!> by itself, at a cost and in a memory that do not grow with the number of cases.
module spintop_sweep_axes
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t
    use spintop_permutation, only: make_permutation, permutation_t
    use spintop_random, only: uniform
    use spintop_sweep_axis, only: axis_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: axes_t, put_values, combination_names, combine_grid, combine_zip, combine_random, &
        combine_latin_hypercube

    !> All combinations, the last axis varying fastest; the values of all axes side by side;
    !> independent draws; draws of which each stratum of each axis, of as many as there are cases, has
    !> one (M. D. McKay, R. J. Beckman and W. J. Conover, Technometrics 21, 1979).
    integer, parameter :: combine_grid = 1, combine_zip = 2, combine_random = 3, combine_latin_hypercube = 4
    !> The words for these in an input.
    character(*), parameter :: combination_names(4) = [character(15) :: 'grid', 'zip', 'random', 'latin_hypercube']

    !> Axes and their combination.
    type :: axes_t
        type(axis_t), allocatable :: axis(:)
        integer(int64) :: cases = 0
        integer :: combination = combine_grid
        integer(int64) :: seed = 1
        !> The strata of a Latin hypercube in the order of the cases, and for axes of a number of values
        !> the place in all strata: then no value is drawn more than once oftener than another.
        type(permutation_t), allocatable, private :: strata(:)
        real(dp), allocatable, private :: place_in_stratum(:)
    contains
        procedure :: combine
        procedure :: values_of
        procedure :: find_values
        procedure :: slots_in
        procedure :: place_of
        procedure :: varies
        procedure :: varies_any
        procedure :: in_words
    end type axes_t

contains

    !> Fixes the number of cases: that of a grid is the product of the axes' numbers of values, of a zip
    !> the number that all have. A grid of more than can be counted is left without cases.
    pure subroutine combine(self, combination, cases, seed)
        class(axes_t), intent(inout) :: self
        integer, intent(in) :: combination
        integer(int64), intent(in) :: cases, seed !! of what is drawn
        integer(int64) :: i

        self%combination = combination
        self%seed = seed
        self%cases = cases
        select case (combination)
        case (combine_grid)
            self%cases = 0
            if (product(real(self%axis%count, dp)) < real(huge(cases), dp)) then
                self%cases = product(int(self%axis%count, int64))
            end if
        case (combine_zip)
            self%cases = self%axis(1)%count
        case (combine_latin_hypercube)
            self%strata = [(make_permutation(cases, seed, stream_of_strata(i)), i=1, size(self%axis))]
            self%place_in_stratum = [(uniform(seed, 0_int64, stream_of_values(i)), i=1, size(self%axis))]
        end select
    end subroutine combine

    !> The streams of random numbers of an axis.
    elemental integer(int64) function stream_of_values(axis)
        integer(int64), intent(in) :: axis
        stream_of_values = 2 * axis
    end function stream_of_values

    elemental integer(int64) function stream_of_strata(axis)
        integer(int64), intent(in) :: axis
        stream_of_strata = 2 * axis + 1
    end function stream_of_strata

    !> The values of the axes in case `number`, from 1.
    pure function values_of(self, number) result(values)
        class(axes_t), intent(in) :: self
        integer(int64), intent(in) :: number
        real(dp) :: values(size(self%axis))
        call self%find_values(number, values)
    end function values_of

    !> The same into memory of the caller, for those who ask for millions.
    pure subroutine find_values(self, number, values)
        class(axes_t), intent(in) :: self
        integer(int64), intent(in) :: number
        real(dp), intent(out) :: values(:)
        integer(int64) :: rest, n, i
        real(dp) :: place

        select case (self%combination)
        case (combine_grid)
            rest = number - 1
            do i = size(self%axis), 1, -1
                n = self%axis(i)%count
                values(i) = self%axis(i)%value(int(mod(rest, n)) + 1)
                rest = rest / n
            end do
        case (combine_zip)
            values = self%axis%value(int(number))
        case (combine_random)
            do i = 1, size(self%axis)
                values(i) = self%axis(i)%draw(uniform(self%seed, number, stream_of_values(i)))
            end do
        case (combine_latin_hypercube)
            do i = 1, size(self%axis)
                if (self%axis(i)%is_discrete()) then
                    place = self%place_in_stratum(i)
                else
                    place = uniform(self%seed, number, stream_of_values(i))
                end if
                values(i) = self%axis(i)%draw((self%strata(i)%place(number - 1) + place) / self%cases)
            end do
        end select
    end subroutine find_values

    !> Where the values of the axes go in the scene that a table describes.
    function slots_in(self, table) result(slots)
        class(axes_t), intent(in) :: self
        type(parameter_table_t), intent(in) :: table
        type(number_slot_t), allocatable :: slots(:)
        character(:), allocatable :: problem
        integer :: i
        allocate (slots(size(self%axis)))
        do i = 1, size(slots)
            call table%find_number(self%axis(i)%name, slots(i), problem)
        end do
    end function slots_in

    !> Place of the parameter of an axis in a table.
    integer function place_of(self, i, table)
        class(axes_t), intent(in) :: self
        integer, intent(in) :: i
        type(parameter_table_t), intent(in) :: table
        place_of = table%find(base_of(self%axis(i)%name))
    end function place_of

    !> Name of a parameter without its subscript.
    pure function base_of(name) result(base)
        character(*), intent(in) :: name
        character(:), allocatable :: base
        base = name(:index(name // '(', '(') - 1)
    end function base_of

    !> Puts the values of a case into the slots of a scene.
    subroutine put_values(slots, values)
        type(number_slot_t), intent(in) :: slots(:)
        real(dp), intent(in) :: values(:)
        integer :: i
        do i = 1, size(slots)
            call slots(i)%put(values(i))
        end do
    end subroutine put_values

    !> Whether a parameter of a group varies.
    pure logical function varies(self, group)
        class(axes_t), intent(in) :: self
        character(*), intent(in) :: group
        integer :: i
        varies = .false.
        do i = 1, size(self%axis)
            varies = varies .or. index(self%axis(i)%name, group // '.') == 1
        end do
    end function varies

    !> Whether one of these parameters varies, or an element of one.
    pure logical function varies_any(self, names)
        class(axes_t), intent(in) :: self
        character(*), intent(in) :: names(:)
        integer :: i
        varies_any = .false.
        do i = 1, size(self%axis)
            varies_any = varies_any .or. any(names == base_of(self%axis(i)%name))
        end do
    end function varies_any

    !> How the cases come about, for a reader.
    function in_words(self) result(text)
        class(axes_t), intent(in) :: self
        character(:), allocatable :: text
        text = to_text(self%cases)
        if (self%cases == 1) then
            text = text // ' case: '
        else
            text = text // ' cases: '
        end if
        select case (self%combination)
        case (combine_grid)
            text = text // 'all combinations, the last axis varying fastest'
        case (combine_zip)
            text = text // 'the values of all axes side by side'
        case (combine_random)
            text = text // 'drawn independently with seed ' // to_text(self%seed)
        case (combine_latin_hypercube)
            text = text // 'a Latin hypercube, drawn with seed ' // to_text(self%seed)
        end select
    end function in_words

end module spintop_sweep_axes
