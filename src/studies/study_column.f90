!> Description of a column, common to all tables.
!>
!> A study whose columns can be chosen extends the type by what gives the value of the column, and by what else it has to
!> know of it. Its registry has a line per column.
module spintop_study_column
    use spintop_kinds, only: dp
    use spintop_table_column, only: column_length, column_t
    use spintop_text, only: did_you_mean, join, string_t
    use spintop_units, only: find_unit, is_unit_word, suffixes_of
    implicit none
    private
    public :: study_column_t, listed_column_t, chosen_column_t, place_of, chosen_columns, find_column, proof_group

    !> What separates the name of a column from that of its unit.
    character(*), parameter :: unit_mark = '_'

    !> The group of the columns that prove others. `columns = 'all'` leaves it out: bounds cost more than the rest.
    character(*), parameter :: proof_group = 'proof'

    !> A column of a table of a study.
    type, extends(column_t) :: study_column_t
        !> Columns of a group are about the same thing, or are computed together.
        character(12) :: group = ''
    end type study_column_t

    !> A column in the list of all columns of a study.
    type, extends(study_column_t) :: listed_column_t
        !> Its cells are words, not numbers.
        logical :: words = .false.
        !> It is in the table when the input names no columns.
        logical :: is_default = .true.
        !> It compares with the exact motion; it is for bodies with effects.
        logical :: needs_exact_motion = .false., needs_effects = .false.
        !> It compares the motion with the exact one; and it is the end of the motion, which an event may have ended. Neither is
        !> a default column where the other is known to be the same.
        logical :: compares = .false., ends = .false.
    end type listed_column_t

    !> A column that was chosen: its place in the list of all, and its name and unit in the table. `theta_deg` is the column
    !> `theta` in degrees.
    type :: chosen_column_t
        integer :: place = 0
        character(column_length) :: name = ''
        character(32) :: unit = ''
        !> The value of the column is the number in the table times this.
        real(dp) :: size = 1
    contains
        procedure :: is_converted
    end type chosen_column_t

contains

    !> Whether the unit is not that of the list.
    elemental logical function is_converted(self)
        class(chosen_column_t), intent(in) :: self
        is_converted = self%size < 1 .or. self%size > 1
    end function is_converted

    !> The columns at some places of a list, in their own units.
    pure function chosen_columns(known, places) result(chosen)
        class(study_column_t), intent(in) :: known(:) !! all columns
        integer, intent(in) :: places(:) !! the places
        type(chosen_column_t) :: chosen(size(places))
        chosen%place = places
        chosen%name = known(places)%name
        chosen%unit = known(places)%unit
    end function chosen_columns

    !> The column of a name, which may end in a unit: `theta`, `theta_deg`, `omega3_rpm`.
    subroutine find_column(known, name, chosen, problem, hint)
        class(study_column_t), intent(in) :: known(:) !! all columns
        character(*), intent(in) :: name !! name of the sought column
        type(chosen_column_t), intent(out) :: chosen !! its place is 0 if there is none
        character(:), allocatable, intent(out) :: problem, hint !! what is wrong, and what to do; '' if it was found
        character(:), allocatable :: unit
        integer :: last

        problem = ''
        hint = ''
        chosen%place = place_of(known, name)
        if (chosen%place > 0) then
            chosen = chosen_column_t(chosen%place, known(chosen%place)%name, known(chosen%place)%unit)
            return
        end if
        problem = "there is no column '" // name // "'"
        hint = did_you_mean(name, known%name)
        last = index(name, unit_mark, back=.true.)
        chosen%place = place_of_stem(known, name(:max(0, last - 1)))
        if (chosen%place == 0) return
        associate (column => known(chosen%place))
            call find_unit(name(last + 1:), trim(column%unit), unit, chosen%size, problem)
            if (problem == '') then
                chosen%name = name
                chosen%unit = unit
                hint = ''
                return
            end if
            if (is_unit_word(name(last + 1:))) then
                problem = "column '" // name // "': " // problem
                hint = other_names(column)
            else
                problem = "there is no column '" // name // "'"
                if (hint == '') hint = other_names(column)
            end if
        end associate
        chosen = chosen_column_t()
    end subroutine find_column

    !> The names that a column has in other units, for a message.
    function other_names(column) result(text)
        class(study_column_t), intent(in) :: column
        character(:), allocatable :: text
        type(string_t), allocatable :: suffixes(:)

        call suffixes_of(trim(column%unit), suffixes)
        if (column%unit == '') then
            text = "use '" // trim(column%name) // "'"
        else
            text = trim(column%name) // ' is in ' // trim(column%unit) // ', and can have a suffix: _' // join(suffixes, ', _')
        end if
    end function other_names

    !> Index of the column whose name, but for its own unit, is `stem`: `azimuth_after_period` of `azimuth_after_period_deg`.
    pure integer function place_of_stem(columns, stem) result(place)
        class(study_column_t), intent(in) :: columns(:)
        character(*), intent(in) :: stem
        place = place_of(columns, stem)
        if (place > 0) return
        do place = size(columns), 1, -1
            if (columns(place)%name == stem // unit_mark // columns(place)%unit) return
        end do
    end function place_of_stem

    !> Index of a column in a list, 0 if there is none of that name.
    pure integer function place_of(columns, name) result(place)
        class(study_column_t), intent(in) :: columns(:) !! the columns
        character(*), intent(in) :: name !! name of the sought column
        do place = size(columns), 1, -1
            if (columns(place)%name == name) return
        end do
    end function place_of

end module spintop_study_column
