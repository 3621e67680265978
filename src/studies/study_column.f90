!> A column of a table, of every kind of study: a line of the registry of its kind says all that is known of it. What an input
!> chooses are such lines with the name and the unit that they have in its table.
module spintop_study_column
    use spintop_kinds, only: dp
    use spintop_table_column, only: column_length, column_t
    use spintop_text, only: did_you_mean, join, string_t
    use spintop_units, only: find_unit, is_unit_word, suffixes_of
    implicit none
    private
    public :: study_column_t, place_of, find_column, proof_group, by_default, categorical, needs_exact, compares, needs_effects, &
        needs_work, near_poles, off_poles, is_end, always

    !> What separates the name of a column from that of its unit.
    character(*), parameter :: unit_mark = '_'

    !> The group of the columns that prove others. `columns = 'all'` leaves it out: bounds cost more than the rest.
    character(*), parameter :: proof_group = 'proof'

    !> What a column is, as a sum: it is in the table when the input names no columns; its cells are words; it needs the exact
    !> motion; it compares the motion with that, and is no default where the motion is exact; it is for bodies with effects; it
    !> contains their work, which is known in the rows of a motion only.
    integer, parameter :: by_default = 1, categorical = 2, needs_exact = 4, compares = 8, needs_effects = 16, needs_work = 32
    !> It depends on phi or psi, and may vary near a pole much faster than the attitude turns; it does not exist at a pole. It is
    !> the end of the motion, and a default only where an event may end it. Every case that ends well has it.
    integer, parameter :: near_poles = 64, off_poles = 128, is_end = 256, always = 512

    !> A column of a table of a study.
    type, extends(column_t) :: study_column_t
        !> Columns of a group are about the same thing, or are computed together.
        character(12) :: group = ''
        !> Where its value comes from: the number of a vector of the motion (spintop_trajectory_columns), of which it is a
        !> component, or a place among the quantities of a case (spintop_sweep_result). What it is: a sum of the numbers above.
        integer :: source = 0, traits = 0, component = 1
        !> Of a trajectory: what passes a value of it in a polynomial of each step, if anything does (spintop_measures).
        integer :: passing = 0
        !> Of a sweep: what is to be computed for it, a bit for each kind of work; and the note on a case that lacks it, where
        !> nothing else that comes with it does.
        integer :: needs = 0, missing = 0
        !> In a table: its place in the list, its name there, and what a number of the table is to be multiplied with. `theta_deg`
        !> is the column `theta` in degrees.
        integer :: place = 0
        character(column_length) :: listed_as = ''
        real(dp) :: size = 1
    contains
        procedure :: is => has_trait
        procedure :: is_converted
        procedure :: quantity
    end type study_column_t

contains

    !> Whether the column is so (`by_default` and the like).
    elemental logical function has_trait(self, trait)
        class(study_column_t), intent(in) :: self
        integer, intent(in) :: trait !! one of the numbers above
        has_trait = iand(self%traits, trait) /= 0
    end function has_trait

    !> Whether the unit is not that of the list.
    elemental logical function is_converted(self)
        class(study_column_t), intent(in) :: self
        is_converted = self%size < 1 .or. self%size > 1
    end function is_converted

    !> The name in the list: `theta` of the column `theta_deg`.
    elemental character(column_length) function quantity(self)
        class(study_column_t), intent(in) :: self
        quantity = merge(self%name, self%listed_as, self%listed_as == '')
    end function quantity

    !> The column of a name, which may end in a unit: `theta`, `theta_deg`, `omega3_rpm`.
    subroutine find_column(known, name, found, problem, hint)
        type(study_column_t), intent(in) :: known(:) !! all columns
        character(*), intent(in) :: name !! name of the sought column
        type(study_column_t), intent(out) :: found !! its place is 0 if there is none
        character(:), allocatable, intent(out) :: problem, hint !! what is wrong, and what to do; '' if it was found
        character(:), allocatable :: unit
        real(dp) :: size
        integer :: place, last

        problem = ''
        hint = ''
        place = place_of(known, name)
        if (place > 0) then
            found = known(place)
            found%place = place
            return
        end if
        problem = "there is no column '" // name // "'"
        hint = did_you_mean(name, known%name)
        last = index(name, unit_mark, back=.true.)
        ! Also without its own unit: `azimuth_after_period` of `azimuth_after_period_deg`.
        associate (stem => name(:max(0, last - 1)))
            place = place_of(known, stem)
            if (place == 0) place = findloc(known%name == stem // unit_mark // known%unit, .true., dim=1, back=.true.)
        end associate
        if (place == 0) return
        call find_unit(name(last + 1:), trim(known(place)%unit), unit, size, problem)
        if (problem == '') then
            found = known(place)
            found%place = place
            found%listed_as = found%name
            found%name = name
            found%unit = unit
            found%size = size
            hint = ''
        else if (is_unit_word(name(last + 1:))) then
            problem = "column '" // name // "': " // problem
            hint = other_names(known(place))
        else
            problem = "there is no column '" // name // "'"
            if (hint == '') hint = other_names(known(place))
        end if
    end subroutine find_column

    !> The names that a column has in other units, for a message.
    function other_names(column) result(text)
        type(study_column_t), intent(in) :: column
        character(:), allocatable :: text
        type(string_t), allocatable :: suffixes(:)

        call suffixes_of(trim(column%unit), suffixes)
        if (column%unit == '') then
            text = "use '" // trim(column%name) // "'"
        else
            text = trim(column%name) // ' is in ' // trim(column%unit) // ', and can have a suffix: _' // join(suffixes, ', _')
        end if
    end function other_names

    !> Index of a column in a list, 0 if there is none of that name.
    pure integer function place_of(columns, name) result(place)
        type(study_column_t), intent(in) :: columns(:) !! the columns
        character(*), intent(in) :: name !! name of the sought column
        place = findloc(columns%name, name, dim=1)
    end function place_of

end module spintop_study_column
