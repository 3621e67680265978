!> The columns of a stability table: a line of the registry and a procedure each. The help, the units in the header
!> and the cells derive from it.
module spintop_stability_columns
    use spintop_kinds, only: dp, no_number
    use spintop_status, only: status_names
    use spintop_study_column, only: study_column_t
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trial, only: trial_t
    use spintop_verdict, only: verdict_names, verdict_unsuitable
    implicit none
    private
    public :: stability_column_t, stability_row_t, stability_columns, put_row

    !> A method on a case: what the cells of a row are made of.
    type :: stability_row_t
        character(24) :: case = ''
        character(20) :: method = ''
        character(16) :: formulation = ''
        !> One of the verdict constants, and the reason for it.
        integer :: verdict = verdict_unsuitable
        character(:), allocatable :: reason
        type(trial_t) :: trial
        !> Inherent error of the attitude, rad.
        real(dp) :: inherent_error = no_number
        !> Growth rates, 1/s; NaN if they do not exist.
        real(dp) :: upright_growth = no_number, lyapunov_exponent = no_number
        !> Source of the reference, and the difference of two computations of it, rad.
        character(24) :: reference = ''
        real(dp) :: reference_error = no_number
    end type stability_row_t

    !> A column of a stability table.
    type, extends(study_column_t) :: stability_column_t
        !> Adds the cell of the column to those of a row.
        procedure(put_i), pointer, nopass :: put => null()
        !> Its cells are words, not numbers.
        logical :: words = .false.
    end type stability_column_t

    abstract interface
        !> Adds a cell of a row.
        subroutine put_i(row, cells)
            import :: stability_row_t, text_buffer_t
            implicit none
            type(stability_row_t), intent(in) :: row
            type(text_buffer_t), intent(inout) :: cells
        end subroutine put_i
    end interface

contains

    !> All columns, in the order of the table.
    function stability_columns() result(columns)
        type(stability_column_t), allocatable :: columns(:)
        columns = [ &
            stability_column_t('case', '', 'case of the catalogue', 'trial', put_case, words=.true.), &
            stability_column_t('method', '', 'method', 'trial', put_method, words=.true.), &
            stability_column_t('formulation', '', 'formulation of the equations of motion', &
                               'trial', put_formulation, words=.true.), &
            stability_column_t('verdict', '', 'verdict on the computed motion', 'verdict', put_verdict, words=.true.), &
            stability_column_t('orientation_error', 'rad', 'largest rotation angle from the reference attitude', &
                               'errors', put_orientation_error), &
            stability_column_t('tip_error', '', 'largest distance of the axis tip from that of the reference', &
                               'errors', put_tip_error), &
            stability_column_t('energy_error', '', 'largest energy error over (kinetic at start + m g |r|)', &
                               'errors', put_energy_error), &
            stability_column_t('lz_error', '', 'largest error of the vertical momentum, over its scale', &
                               'errors', put_lz_error), &
            stability_column_t('l3_error', '', 'largest error of the momentum about body z, over the same scale', &
                               'errors', put_l3_error), &
            stability_column_t('norm_error', '', 'largest norm error abs(q) - 1 of the quaternion', &
                               'errors', put_norm_error), &
            stability_column_t('inherent_error', 'rad', 'error of the attitude due to rounding of the data', &
                               'errors', put_inherent_error), &
            stability_column_t('steps', '', 'steps', 'cost', put_steps), &
            stability_column_t('rejected', '', 'rejected steps', 'cost', put_rejected), &
            stability_column_t('evaluations', '', 'RHS evaluations', 'cost', put_evaluations), &
            stability_column_t('time_s', 's', 'computing time', 'cost', put_time_s), &
            stability_column_t('status', '', 'status of the run', 'verdict', put_status, words=.true.), &
            stability_column_t('t', 's', 'time reached', 'verdict', put_t), &
            stability_column_t('upright_growth', '1/s', &
                               'largest growth rate of the symmetric top sleeping upright with this spin', &
                               'growth', put_upright_growth), &
            stability_column_t('lyapunov_exponent', '1/s', 'mean growth rate of perturbations over the span', &
                               'growth', put_lyapunov_exponent), &
            stability_column_t('reference', '', 'reference of the comparison', 'reference', put_reference, words=.true.), &
            stability_column_t('reference_error', 'rad', 'difference between two computations of the reference', &
                               'reference', put_reference_error), &
            stability_column_t('reason', '', 'reason of the verdict', 'verdict', put_reason, words=.true.)]
    end function stability_columns

    !> Adds a row of all columns.
    subroutine put_row(row, cells)
        type(stability_row_t), intent(in) :: row !! the row
        type(text_buffer_t), intent(inout) :: cells !! the row is appended
        type(stability_column_t), allocatable :: columns(:)
        integer :: i
        allocate (columns, source=stability_columns())
        do i = 1, size(columns)
            call columns(i)%put(row, cells)
        end do
        call cells%end_row()
    end subroutine put_row

    subroutine put_case(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%case)
    end subroutine put_case

    subroutine put_method(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%method)
    end subroutine put_method

    subroutine put_formulation(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%formulation)
    end subroutine put_formulation

    subroutine put_verdict(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(verdict_names(row%verdict))
    end subroutine put_verdict

    subroutine put_orientation_error(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%trial%errors%orientation])
    end subroutine put_orientation_error

    subroutine put_tip_error(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%trial%errors%tip])
    end subroutine put_tip_error

    subroutine put_energy_error(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%trial%errors%energy])
    end subroutine put_energy_error

    subroutine put_lz_error(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%trial%errors%vertical])
    end subroutine put_lz_error

    subroutine put_l3_error(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%trial%errors%axial])
    end subroutine put_l3_error

    subroutine put_norm_error(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%trial%errors%quaternion])
    end subroutine put_norm_error

    subroutine put_inherent_error(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%inherent_error])
    end subroutine put_inherent_error

    subroutine put_steps(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_integer(row%trial%counts%steps)
    end subroutine put_steps

    subroutine put_rejected(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_integer(row%trial%counts%rejected)
    end subroutine put_rejected

    subroutine put_evaluations(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_integer(row%trial%counts%evaluations)
    end subroutine put_evaluations

    subroutine put_time_s(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%trial%time])
    end subroutine put_time_s

    !> A combination that does not suit the body was not run.
    subroutine put_status(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        if (row%verdict == verdict_unsuitable) then
            call cells%put_text(verdict_names(verdict_unsuitable))
        else
            call cells%put_text(status_names(row%trial%status))
        end if
    end subroutine put_status

    subroutine put_t(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%trial%t])
    end subroutine put_t

    subroutine put_upright_growth(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%upright_growth])
    end subroutine put_upright_growth

    subroutine put_lyapunov_exponent(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%lyapunov_exponent])
    end subroutine put_lyapunov_exponent

    subroutine put_reference(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%reference)
    end subroutine put_reference

    subroutine put_reference_error(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%reference_error])
    end subroutine put_reference_error

    subroutine put_reason(row, cells)
        type(stability_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%reason)
    end subroutine put_reason

end module spintop_stability_columns
