!> The table of a work-precision study.
module spintop_precision_table
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
    use spintop_kinds, only: dp
    use spintop_reference_motion, only: reference_t
    use spintop_status, only: status_names, status_ok
    use spintop_study_column, only: study_column_t
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trial, only: errors_t, trial_t
    implicit none
    private
    public :: precision_row_t, precision_columns, put_row, sort_rows, mark_front

    !> The columns, in the order of the table; the swept parameters come after them.
    type(study_column_t), parameter :: precision_columns(*) = [ &
        study_column_t('problem', '', 'input, and case of it where a parameter is swept'), &
        study_column_t('method', '', 'method'), &
        study_column_t('formulation', '', 'formulation of the equations of motion'), &
        study_column_t('setting', '', 'relative tolerance, or number of steps of fixed size'), &
        study_column_t('orientation_error', 'rad', 'rotation angle from the reference attitude at the end'), &
        study_column_t('tip_error', '', 'distance of the axis tip from that of the reference at the end'), &
        study_column_t('error_max', 'rad', 'largest rotation angle from the reference attitude'), &
        study_column_t('steps', '', 'steps'), &
        study_column_t('rejected', '', 'rejected steps'), &
        study_column_t('evaluations', '', 'RHS evaluations of that run; a Taylor series of order p counts as p'), &
        study_column_t('time_s', 's', 'shortest computing time of the repeats, for the state at the end'), &
        study_column_t('energy_error', '', 'largest energy error over (kinetic at start + m g |r|)'), &
        study_column_t('status', '', 'status of the run'), &
        study_column_t('tip_error_max', '', 'largest distance of the axis tip from that of the reference'), &
        study_column_t('jacobians', '', 'Jacobian evaluations'), &
        study_column_t('lz_error', '', 'largest error of the vertical momentum, over its scale'), &
        study_column_t('l3_error', '', 'largest error of the momentum about body z, over the same scale'), &
        study_column_t('norm_error', '', 'largest norm error abs(q) - 1 of the quaternion'), &
        study_column_t('phi_error', 'rad', 'error of phi at the end, within half a turn'), &
        study_column_t('theta_error', 'rad', 'error of theta at the end'), &
        study_column_t('psi_error', 'rad', 'error of psi at the end, within half a turn'), &
        study_column_t('phi_rate_error', 'rad/s', 'error of the precession rate at the end'), &
        study_column_t('theta_rate_error', 'rad/s', 'error of the nutation rate at the end'), &
        study_column_t('psi_rate_error', 'rad/s', 'error of the spin rate at the end'), &
        study_column_t('phi_error_max', 'rad', 'largest error of phi'), &
        study_column_t('theta_error_max', 'rad', 'largest error of theta'), &
        study_column_t('psi_error_max', 'rad', 'largest error of psi'), &
        study_column_t('phi_rate_error_max', 'rad/s', 'largest error of the precession rate'), &
        study_column_t('theta_rate_error_max', 'rad/s', 'largest error of the nutation rate'), &
        study_column_t('psi_rate_error_max', 'rad/s', 'largest error of the spin rate'), &
        study_column_t('inherent_error', 'rad', 'error of the attitude due to rounding of the data'), &
        study_column_t('reference', '', 'reference of the comparison'), &
        study_column_t('reference_error', 'rad', 'difference between two computations of the reference'), &
        study_column_t('reference_check', 'rad', 'difference between the reference and an independent computation'), &
        study_column_t('front', '', 'yes: no stepping method is both faster and more accurate'), &
        study_column_t('auto', '', "yes: method = 'auto' takes this method at this tolerance")]

    !> A method with a setting.
    type :: precision_row_t
        character(20) :: method = ''
        character(16) :: formulation = ''
        character(32) :: setting = ''
        type(trial_t) :: trial
        !> Least time of the repeats, s.
        real(dp) :: time = 0
        !> Takes steps, unlike the exact motion.
        logical :: is_stepped = .true.
        !> What method = 'auto' takes, for a tolerance as large.
        logical :: is_auto = .false.
        logical :: is_front = .false.
    end type precision_row_t

contains

    !> A row as text, followed by the values of swept parameters. What a computation that gave up has
    !> not reached is no number.
    subroutine put_row(problem, row, reference, parameters, text)
        character(*), intent(in) :: problem
        type(precision_row_t), intent(in) :: row
        type(reference_t), intent(in) :: reference
        real(dp), intent(in) :: parameters(:)
        type(text_buffer_t), intent(inout) :: text
        type(errors_t) :: largest, last

        largest = row%trial%errors
        last = row%trial%last
        if (row%trial%status /= status_ok) call lose(last)
        if (row%trial%status /= status_ok) call lose(largest)
        call text%put_text(problem)
        call text%put_text(row%method)
        call text%put_text(row%formulation)
        call text%put_text(row%setting)
        call text%put_reals([last%orientation, last%tip, largest%orientation])
        call text%put_integer(row%trial%counts%steps)
        call text%put_integer(row%trial%counts%rejected)
        call text%put_integer(row%trial%counts%evaluations)
        call text%put_reals([row%time, largest%energy])
        call text%put_text(trim(status_names(row%trial%status)))
        call text%put_reals([largest%tip])
        call text%put_integer(row%trial%counts%jacobians)
        call text%put_reals([largest%vertical, largest%axial, largest%quaternion, last%angle, last%rate, &
                             largest%angle, largest%rate, maxval(reference%floor)])
        call text%put_text(reference%source)
        call text%put_reals([reference%uncertainty, reference%disagreement])
        call text%put_text(trim(merge('yes', 'no ', row%is_front)))
        call text%put_text(trim(merge('yes', 'no ', row%is_auto)))
        call text%put_reals(parameters)
        call text%end_row()
    end subroutine put_row

    !> Errors that are not known.
    subroutine lose(errors)
        type(errors_t), intent(out) :: errors
        real(dp) :: nan
        nan = ieee_value(nan, ieee_quiet_nan)
        errors = errors_t(nan, nan, nan, nan, nan, nan, nan, nan)
    end subroutine lose

    !> Sorts rows by time.
    pure subroutine sort_rows(rows)
        type(precision_row_t), intent(inout) :: rows(:)
        type(precision_row_t) :: row
        integer :: i, place
        do i = 2, size(rows)
            row = rows(i)
            place = i
            do while (place > 1)
                if (rows(place - 1)%time <= row%time) exit
                rows(place) = rows(place - 1)
                place = place - 1
            end do
            rows(place) = row
        end do
    end subroutine sort_rows

    !> Marks, in rows sorted by time, those than which no stepping method is faster and at least as exact.
    pure subroutine mark_front(rows)
        type(precision_row_t), intent(inout) :: rows(:)
        real(dp) :: best
        integer :: i
        best = huge(best)
        do i = 1, size(rows)
            associate (row => rows(i))
                row%is_front = row%trial%status == status_ok .and. row%trial%errors%orientation < best
                if (row%is_front .and. row%is_stepped) best = row%trial%errors%orientation
            end associate
        end do
    end subroutine mark_front

end module spintop_precision_table
