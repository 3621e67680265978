!> Description of a column, common to all tables.
!>
!> A study whose columns can be chosen extends the type by what gives the value of the column, and by what else it has to
!> know of it. Its registry has a line per column.
module spintop_study_column
    use spintop_table_column, only: column_t
    implicit none
    private
    public :: study_column_t, listed_column_t, place_of, proof_group

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

contains

    !> Index of a column in a list, 0 if there is none of that name.
    pure integer function place_of(columns, name) result(place)
        class(study_column_t), intent(in) :: columns(:) !! the columns
        character(*), intent(in) :: name !! name of the sought column
        do place = size(columns), 1, -1
            if (columns(place)%name == name) return
        end do
    end function place_of

end module spintop_study_column
