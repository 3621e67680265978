!> A column of a sweep table: its description, what it needs, and the procedure that explains its cells.
module spintop_sweep_column
    use spintop_case, only: case_t
    use spintop_kinds, only: dp
    use spintop_study_column, only: study_column_t
    use spintop_sweep_notes, only: note_t
    use spintop_sweep_result, only: kinds_of_work
    implicit none
    private
    public :: sweep_column_t

    !> A column of a sweep.
    type, extends(study_column_t) :: sweep_column_t
        !> What is to be computed for it (spintop_sweep_result).
        logical :: needs(kinds_of_work) = .false.
        !> Its place in the list of all columns, and of its value in that of a result.
        integer :: place = 0
        !> It is in the table when the input names no columns: it costs no more than the rest.
        logical :: is_default = .false.
        !> It is the end of the motion.
        logical :: is_end = .false.
        !> Every case has it that ends well.
        logical :: always_exists = .false.
        !> It is a class of motion, and not a number.
        logical :: is_class = .false.
        !> It is a word that tells whether the bounds are proved.
        logical :: is_proof = .false.
        !> The quantity (spintop_certificate) that it contains, or whose bound it is; 0 if there is none.
        integer :: proof_of = 0
        !> Notes why a case lacks it, where nothing else that comes with it does.
        procedure(explain_i), pointer, nopass :: explain => null()
        !> In a table: the quantity is the number in it times the size of its unit.
        real(dp) :: size = 1
    end type sweep_column_t

    abstract interface
        !> Adds a note if there is something to add.
        subroutine explain_i(case, note)
            import :: case_t, note_t
            implicit none
            type(case_t), intent(in) :: case
            type(note_t), intent(inout) :: note
        end subroutine explain_i
    end interface

end module spintop_sweep_column
