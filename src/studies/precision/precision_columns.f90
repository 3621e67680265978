!> The columns of a work-precision table, and its rows: their order, and the front of the best ones. The help and the header
!> derive from the list of columns. The swept parameters follow them.
module spintop_precision_columns
    use spintop_kinds, only: dp, no_number
    use spintop_reference_motion, only: reference_t
    use spintop_status, only: is_ok, status_names
    use spintop_study_column, only: listed_column_t
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trial, only: errors_t, trial_t
    implicit none
    private
    public :: precision_row_t, precision_view_t, precision_columns, sort_rows, mark_front, add_row

    !> A method with a setting.
    type :: precision_row_t
        character(20) :: method = ''
        character(16) :: formulation = ''
        character(32) :: setting = ''
        type(trial_t) :: trial
        !> Minimum time of the repeats, s.
        real(dp) :: time = 0
        !> Whether it is a numerical method, and not the exact solution.
        logical :: is_stepped = .true.
        !> Whether method = 'auto' selects it for this tolerance.
        logical :: is_auto = .false.
        logical :: is_front = .false.
    end type precision_row_t

    !> What the cells of a row are made of: the problem, and its current row.
    type :: precision_view_t
        !> Name of the problem, and its reference motion.
        character(:), allocatable :: problem
        type(reference_t) :: reference
        type(precision_row_t) :: row
        !> Its largest errors, and those at the end; NaN if the computation failed.
        type(errors_t) :: largest, last
    contains
        procedure :: set_row
    end type precision_view_t

    !> Errors that a failed computation has not reached.
    type(errors_t), parameter :: unknown = errors_t(no_number, no_number, no_number, no_number, no_number, &
        no_number, no_number, no_number)

    !> All columns, in the order of the table.
    type(listed_column_t), parameter :: precision_columns(*) = [ &
        listed_column_t('problem', '', 'input, and case of it where a parameter is swept', 'trial', words=.true.), &
        listed_column_t('method', '', 'method', 'trial', words=.true.), &
        listed_column_t('formulation', '', 'formulation of the equations of motion', 'trial', words=.true.), &
        listed_column_t('setting', '', 'relative tolerance, or number of steps of fixed size', &
                        'trial', words=.true.), &
        listed_column_t('orientation_error', 'rad', 'rotation angle from the reference attitude at the end', &
                        'errors'), &
        listed_column_t('tip_error', '', 'distance of the axis tip from that of the reference at the end', 'errors'), &
        listed_column_t('error_max', 'rad', 'largest rotation angle from the reference attitude', 'errors'), &
        listed_column_t('steps', '', 'steps', 'cost'), &
        listed_column_t('rejected', '', 'rejected steps', 'cost'), &
        listed_column_t('evaluations', '', 'RHS evaluations of that run; a Taylor series of order p counts as p', &
                        'cost'), &
        listed_column_t('time_s', 's', 'shortest computing time of the repeats, for the state at the end', 'cost'), &
        listed_column_t('energy_error', '', 'largest energy error over (kinetic at start + m g |r|)', 'errors'), &
        listed_column_t('status', '', 'status of the run', 'status', words=.true.), &
        listed_column_t('tip_error_max', '', 'largest distance of the axis tip from that of the reference', &
                        'errors'), &
        listed_column_t('jacobians', '', 'Jacobian evaluations', 'cost'), &
        listed_column_t('lz_error', '', 'largest error of the vertical momentum, over its scale', 'errors'), &
        listed_column_t('l3_error', '', 'largest error of the momentum about body z, over the same scale', 'errors'), &
        listed_column_t('norm_error', '', 'largest norm error abs(q) - 1 of the quaternion', 'errors'), &
        listed_column_t('phi_error', 'rad', 'error of phi at the end, within half a turn', 'angles'), &
        listed_column_t('theta_error', 'rad', 'error of theta at the end', 'angles'), &
        listed_column_t('psi_error', 'rad', 'error of psi at the end, within half a turn', 'angles'), &
        listed_column_t('phi_rate_error', 'rad/s', 'error of the precession rate at the end', 'angles'), &
        listed_column_t('theta_rate_error', 'rad/s', 'error of the nutation rate at the end', 'angles'), &
        listed_column_t('psi_rate_error', 'rad/s', 'error of the spin rate at the end', 'angles'), &
        listed_column_t('phi_error_max', 'rad', 'largest error of phi', 'angles'), &
        listed_column_t('theta_error_max', 'rad', 'largest error of theta', 'angles'), &
        listed_column_t('psi_error_max', 'rad', 'largest error of psi', 'angles'), &
        listed_column_t('phi_rate_error_max', 'rad/s', 'largest error of the precession rate', 'angles'), &
        listed_column_t('theta_rate_error_max', 'rad/s', 'largest error of the nutation rate', 'angles'), &
        listed_column_t('psi_rate_error_max', 'rad/s', 'largest error of the spin rate', 'angles'), &
        listed_column_t('inherent_error', 'rad', 'error of the attitude due to rounding of the data', 'errors'), &
        listed_column_t('reference', '', 'reference of the comparison', 'reference', words=.true.), &
        listed_column_t('reference_error', 'rad', 'difference between two computations of the reference', &
                        'reference'), &
        listed_column_t('reference_check', 'rad', 'difference between the reference and an independent computation', &
                        'reference'), &
        listed_column_t('front', '', 'yes: no other numerical method is both faster and more accurate', &
                        'choice', words=.true.), &
        listed_column_t('auto', '', "yes: method = 'auto' takes this method at this tolerance", &
                        'choice', words=.true.)]

contains

    !> Sorts rows by time.
    pure subroutine sort_rows(rows)
        type(precision_row_t), intent(inout) :: rows(:) !! rows of a problem
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

    !> Marks the rows, sorted by time, for which no numerical method is both faster and at least as accurate.
    pure subroutine mark_front(rows)
        type(precision_row_t), intent(inout) :: rows(:) !! rows of a problem, sorted by time
        real(dp) :: best
        integer :: i
        best = huge(best)
        do i = 1, size(rows)
            associate (row => rows(i))
                row%is_front = is_ok(row%trial%status) .and. row%trial%errors%orientation < best
                if (row%is_front .and. row%is_stepped) best = row%trial%errors%orientation
            end associate
        end do
    end subroutine mark_front

    !> Sets the current row of the problem.
    subroutine set_row(self, row)
        class(precision_view_t), intent(inout) :: self
        type(precision_row_t), intent(in) :: row !! the row
        self%row = row
        self%largest = row%trial%errors
        self%last = row%trial%last
        if (is_ok(row%trial%status)) return
        self%largest = unknown
        self%last = unknown
    end subroutine set_row

    !> Adds the current row, a cell per column, and the values of the swept parameters.
    subroutine add_row(now, values, cells)
        type(precision_view_t), intent(in) :: now !! the problem and its row
        real(dp), intent(in) :: values(:) !! of the swept parameters
        type(text_buffer_t), intent(inout) :: cells !! the row is appended
        call cells%add_text(now%problem)
        call cells%add_text(now%row%method)
        call cells%add_text(now%row%formulation)
        call cells%add_text(now%row%setting)
        associate (largest => now%largest, last => now%last, counts => now%row%trial%counts, reference => now%reference)
            call cells%add_reals([last%orientation, last%tip, largest%orientation])
            call cells%add_integer(counts%steps)
            call cells%add_integer(counts%rejected)
            call cells%add_integer(counts%evaluations)
            call cells%add_reals([now%row%time, largest%energy])
            call cells%add_text(status_names(now%row%trial%status))
            call cells%add_reals([largest%tip])
            call cells%add_integer(counts%jacobians)
            call cells%add_reals([largest%vertical, largest%axial, largest%quaternion])
            call cells%add_reals([last%angle, last%rate, largest%angle, largest%rate])
            call cells%add_reals([maxval(reference%floor)])
            call cells%add_text(reference%source)
            call cells%add_reals([reference%uncertainty, reference%disagreement])
        end associate
        call cells%add_text(yes_or_no(now%row%is_front))
        call cells%add_text(yes_or_no(now%row%is_auto))
        call cells%add_reals(values)
        call cells%end_row()
    end subroutine add_row

    !> A logical in a table.
    pure character(3) function yes_or_no(is_so)
        logical, intent(in) :: is_so
        yes_or_no = merge('yes', 'no ', is_so)
    end function yes_or_no

end module spintop_precision_columns
