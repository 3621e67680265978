!> A column of a study whose table has columns of its own.
module spintop_study_column
    implicit none
    private
    public :: study_column_t

    !> Name, unit, and what it is.
    type :: study_column_t
        character(24) :: name
        character(8) :: unit
        character(96) :: what
    end type study_column_t

end module spintop_study_column
