!> Columns of tables: what every column has, and the columns of a table of many cases, whose cells are numbers in
!> every format.
module spintop_table_column
    use spintop_text, only: string_t
    implicit none
    private
    public :: column_t, table_column_t, column_of_reals, column_of_integers, column_of_words, column_of_notes, status_column, &
        column_length

    !> Kind of the cells: a real; an integer; the index of a category, from 0; or notes, one bit for each
    !> category from the lowest, with a separate text.
    integer, parameter :: column_of_reals = 1, column_of_integers = 2, column_of_words = 3, column_of_notes = 4

    !> Name of the column that tells how a case ended; and of the attribute that tells it of a single motion.
    character(*), parameter :: status_column = 'status'

    !> Maximum length of the name of a column, such as a derivative `COLUMN__KEY`.
    integer, parameter :: column_length = 80

    !> A column: its name, unit and meaning.
    type :: column_t
        character(column_length) :: name = ''
        character(32) :: unit = ''
        character(160) :: what = ''
    end type column_t

    !> A column of a table of many cases, with the kind of its cells.
    type, extends(column_t) :: table_column_t
        integer :: kind = column_of_reals
        !> The names of the categories of a categorical column or of notes.
        type(string_t), allocatable :: words(:)
        !> On a grid, the axis along which the cells vary; 0 if they vary from case to case.
        integer :: axis = 0
    contains
        procedure :: set_words
    end type table_column_t

contains

    !> Makes the column one of words.
    pure subroutine set_words(self, words, kind)
        class(table_column_t), intent(inout) :: self
        character(*), intent(in) :: words(:) !! the names of the categories
        integer, intent(in), optional :: kind !! of the column, if it is not `column_of_words`
        integer :: i
        self%kind = column_of_words
        if (present(kind)) self%kind = kind
        if (allocated(self%words)) deallocate (self%words)
        allocate (self%words(size(words)))
        do i = 1, size(words)
            self%words(i)%text = trim(words(i))
        end do
    end subroutine set_words

end module spintop_table_column
