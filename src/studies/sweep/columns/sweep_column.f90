!> A column of a sweep table: its description, and the procedures that fill and explain its cells.
module spintop_sweep_column
    use spintop_case, only: case_t
    use spintop_kinds, only: dp
    use spintop_study_column, only: study_column_t
    use spintop_sweep_notes, only: note_t
    use spintop_sweep_result, only: sweep_result_t
    implicit none
    private
    public :: sweep_column_t

    !> A column of a sweep. Columns of a group are computed together, when one of them is asked for.
    type, extends(study_column_t) :: sweep_column_t
        !> Fills the cells of the column.
        procedure(fill_i), pointer, nopass :: fill => null()
        !> It is in the table when the input names no columns: it costs no more than the rest.
        logical :: is_default = .false.
        !> Every case has it that ends well.
        logical :: always_exists = .false.
        !> It is a class of motion, and not a number.
        logical :: is_class = .false.
        !> It is a word that tells whether the bounds are proved.
        logical :: is_proof = .false.
        !> Notes why a case lacks it, where nothing else that comes with it does.
        procedure(explain_i), pointer, nopass :: explain => null()
    end type sweep_column_t

    abstract interface
        !> The cells of a column, one per case.
        pure subroutine fill_i(results, cells)
            import :: dp, sweep_result_t
            implicit none
            type(sweep_result_t), intent(in) :: results(:)
            real(dp), intent(out) :: cells(:)
        end subroutine fill_i

        !> Adds a note if there is something to add.
        subroutine explain_i(case, note)
            import :: case_t, note_t
            implicit none
            type(case_t), intent(in) :: case
            type(note_t), intent(inout) :: note
        end subroutine explain_i
    end interface

end module spintop_sweep_column
