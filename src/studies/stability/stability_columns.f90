!> The columns of a stability table, and its rows. The help and the header derive from the list of columns.
module spintop_stability_columns
    use spintop_kinds, only: dp, no_number
    use spintop_status, only: status_names
    use spintop_study_column, only: listed_column_t
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trial, only: trial_t
    use spintop_verdict, only: verdict_names, verdict_unsuitable
    implicit none
    private
    public :: stability_row_t, stability_columns, add_row

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

    !> All columns, in the order of the table.
    type(listed_column_t), parameter :: stability_columns(*) = [ &
        listed_column_t('case', '', 'case of the catalogue', 'trial', words=.true.), &
        listed_column_t('method', '', 'method', 'trial', words=.true.), &
        listed_column_t('formulation', '', 'formulation of the equations of motion', 'trial', words=.true.), &
        listed_column_t('verdict', '', 'verdict on the computed motion', 'verdict', words=.true.), &
        listed_column_t('orientation_error', 'rad', 'largest rotation angle from the reference attitude', 'errors'), &
        listed_column_t('tip_error', '', 'largest distance of the axis tip from that of the reference', 'errors'), &
        listed_column_t('energy_error', '', 'largest energy error over (kinetic at start + m g |r|)', 'errors'), &
        listed_column_t('lz_error', '', 'largest error of the vertical momentum, over its scale', 'errors'), &
        listed_column_t('l3_error', '', 'largest error of the momentum about body z, over the same scale', 'errors'), &
        listed_column_t('norm_error', '', 'largest norm error abs(q) - 1 of the quaternion', 'errors'), &
        listed_column_t('inherent_error', 'rad', 'error of the attitude due to rounding of the data', 'errors'), &
        listed_column_t('steps', '', 'steps', 'cost'), &
        listed_column_t('rejected', '', 'rejected steps', 'cost'), &
        listed_column_t('evaluations', '', 'RHS evaluations', 'cost'), &
        listed_column_t('time_s', 's', 'computing time', 'cost'), &
        listed_column_t('status', '', 'status of the run', 'verdict', words=.true.), &
        listed_column_t('t', 's', 'time reached', 'verdict'), &
        listed_column_t('upright_growth', '1/s', &
                        'largest growth rate of the symmetric top sleeping upright with this spin', &
                           'growth'), &
        listed_column_t('lyapunov_exponent', '1/s', 'mean growth rate of perturbations over the span', 'growth'), &
        listed_column_t('reference', '', 'reference of the comparison', 'reference', words=.true.), &
        listed_column_t('reference_error', 'rad', 'difference between two computations of the reference', &
                        'reference'), &
        listed_column_t('reason', '', 'reason of the verdict', 'verdict', words=.true.)]

contains

    !> Adds a row, a cell per column.
    subroutine add_row(row, cells)
        type(stability_row_t), intent(in) :: row !! the row
        type(text_buffer_t), intent(inout) :: cells !! the row is appended
        call cells%add_text(row%case)
        call cells%add_text(row%method)
        call cells%add_text(row%formulation)
        call cells%add_text(verdict_names(row%verdict))
        associate (errors => row%trial%errors, counts => row%trial%counts)
            call cells%add_reals([errors%orientation, errors%tip, errors%energy, errors%vertical, errors%axial, &
                                  errors%quaternion, row%inherent_error])
            call cells%add_integer(counts%steps)
            call cells%add_integer(counts%rejected)
            call cells%add_integer(counts%evaluations)
        end associate
        call cells%add_reals([row%trial%time])
        ! A combination that does not suit the body was not run.
        if (row%verdict == verdict_unsuitable) then
            call cells%add_text(verdict_names(verdict_unsuitable))
        else
            call cells%add_text(status_names(row%trial%status))
        end if
        call cells%add_reals([row%trial%t, row%upright_growth, row%lyapunov_exponent])
        call cells%add_text(row%reference)
        call cells%add_reals([row%reference_error])
        call cells%add_text(row%reason)
        call cells%end_row()
    end subroutine add_row

end module spintop_stability_columns
