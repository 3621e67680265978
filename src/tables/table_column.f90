!> What a column of a table of many cases is. Cells are numbers, whatever the table makes of them.
module spintop_table_column
    use spintop_text, only: string_t
    implicit none
    private
    public :: table_column_t, column_of_reals, column_of_integers, column_of_words, column_of_notes

    !> What a cell is: a real; a whole number; the index of a category, from 0; or notes, a bit for each
    !> of the categories, from the lowest, beside which stands a text.
    integer, parameter :: column_of_reals = 1, column_of_integers = 2, column_of_words = 3, column_of_notes = 4

    !> A column: its name, unit and meaning, and what its cells are.
    type :: table_column_t
        character(64) :: name = ''
        character(16) :: unit = ''
        character(160) :: what = ''
        integer :: kind = column_of_reals
        !> The names of the categories of a categorical column or of notes.
        type(string_t), allocatable :: words(:)
        !> On a grid, the axis along which the cells vary; 0 where they differ from case to case.
        integer :: axis = 0
    end type table_column_t

end module spintop_table_column
