!> The columns of a work-precision table: a line of the registry and a procedure each. The help, the units in the
!> header and the cells derive from it. The swept parameters follow them.
module spintop_precision_columns
    use spintop_kinds, only: no_number
    use spintop_precision_table, only: precision_row_t
    use spintop_reference_motion, only: reference_t
    use spintop_status, only: status_names, status_ok
    use spintop_study_column, only: study_column_t
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trial, only: errors_t
    implicit none
    private
    public :: precision_column_t, precision_view_t, precision_columns

    !> What the cells of a row are made of: the problem, and a row of it that is looked at.
    type :: precision_view_t
        !> Name of the problem, and its reference motion.
        character(:), allocatable :: problem
        type(reference_t) :: reference
        type(precision_row_t) :: row
        !> Its largest errors, and those at the end; NaN if the computation failed.
        type(errors_t) :: largest, last
    contains
        procedure :: look
    end type precision_view_t

    !> A column of a work-precision table.
    type, extends(study_column_t) :: precision_column_t
        !> Adds the cell of the column to those of a row.
        procedure(put_i), pointer, nopass :: put => null()
        !> Its cells are words, not numbers.
        logical :: words = .false.
    end type precision_column_t

    abstract interface
        !> Adds the cell of the row that is looked at.
        subroutine put_i(now, cells)
            import :: precision_view_t, text_buffer_t
            implicit none
            type(precision_view_t), intent(in) :: now
            type(text_buffer_t), intent(inout) :: cells
        end subroutine put_i
    end interface

    !> Errors that a failed computation has not reached.
    type(errors_t), parameter :: unknown = errors_t(no_number, no_number, no_number, no_number, no_number, &
        no_number, no_number, no_number)

contains

    !> All columns, in the order of the table.
    function precision_columns() result(columns)
        type(precision_column_t), allocatable :: columns(:)
        columns = [ &
            precision_column_t('problem', '', 'input, and case of it where a parameter is swept', &
                               'trial', put_problem, words=.true.), &
            precision_column_t('method', '', 'method', 'trial', put_method, words=.true.), &
            precision_column_t('formulation', '', 'formulation of the equations of motion', &
                               'trial', put_formulation, words=.true.), &
            precision_column_t('setting', '', 'relative tolerance, or number of steps of fixed size', &
                               'trial', put_setting, words=.true.), &
            precision_column_t('orientation_error', 'rad', 'rotation angle from the reference attitude at the end', &
                               'errors', put_orientation_error), &
            precision_column_t('tip_error', '', 'distance of the axis tip from that of the reference at the end', &
                               'errors', put_tip_error), &
            precision_column_t('error_max', 'rad', 'largest rotation angle from the reference attitude', &
                               'errors', put_error_max), &
            precision_column_t('steps', '', 'steps', 'cost', put_steps), &
            precision_column_t('rejected', '', 'rejected steps', 'cost', put_rejected), &
            precision_column_t('evaluations', '', &
                               'RHS evaluations of that run; a Taylor series of order p counts as p', &
                               'cost', put_evaluations), &
            precision_column_t('time_s', 's', 'shortest computing time of the repeats, for the state at the end', &
                               'cost', put_time_s), &
            precision_column_t('energy_error', '', 'largest energy error over (kinetic at start + m g |r|)', &
                               'errors', put_energy_error), &
            precision_column_t('status', '', 'status of the run', 'status', put_status, words=.true.), &
            precision_column_t('tip_error_max', '', 'largest distance of the axis tip from that of the reference', &
                               'errors', put_tip_error_max), &
            precision_column_t('jacobians', '', 'Jacobian evaluations', 'cost', put_jacobians), &
            precision_column_t('lz_error', '', 'largest error of the vertical momentum, over its scale', &
                               'errors', put_lz_error), &
            precision_column_t('l3_error', '', 'largest error of the momentum about body z, over the same scale', &
                               'errors', put_l3_error), &
            precision_column_t('norm_error', '', 'largest norm error abs(q) - 1 of the quaternion', &
                               'errors', put_norm_error), &
            precision_column_t('phi_error', 'rad', 'error of phi at the end, within half a turn', &
                               'angles', put_phi_error), &
            precision_column_t('theta_error', 'rad', 'error of theta at the end', 'angles', put_theta_error), &
            precision_column_t('psi_error', 'rad', 'error of psi at the end, within half a turn', &
                               'angles', put_psi_error), &
            precision_column_t('phi_rate_error', 'rad/s', 'error of the precession rate at the end', &
                               'angles', put_phi_rate_error), &
            precision_column_t('theta_rate_error', 'rad/s', 'error of the nutation rate at the end', &
                               'angles', put_theta_rate_error), &
            precision_column_t('psi_rate_error', 'rad/s', 'error of the spin rate at the end', &
                               'angles', put_psi_rate_error), &
            precision_column_t('phi_error_max', 'rad', 'largest error of phi', 'angles', put_phi_error_max), &
            precision_column_t('theta_error_max', 'rad', 'largest error of theta', 'angles', put_theta_error_max), &
            precision_column_t('psi_error_max', 'rad', 'largest error of psi', 'angles', put_psi_error_max), &
            precision_column_t('phi_rate_error_max', 'rad/s', 'largest error of the precession rate', &
                               'angles', put_phi_rate_error_max), &
            precision_column_t('theta_rate_error_max', 'rad/s', 'largest error of the nutation rate', &
                               'angles', put_theta_rate_error_max), &
            precision_column_t('psi_rate_error_max', 'rad/s', 'largest error of the spin rate', &
                               'angles', put_psi_rate_error_max), &
            precision_column_t('inherent_error', 'rad', 'error of the attitude due to rounding of the data', &
                               'errors', put_inherent_error), &
            precision_column_t('reference', '', 'reference of the comparison', 'reference', put_reference, words=.true.), &
            precision_column_t('reference_error', 'rad', 'difference between two computations of the reference', &
                               'reference', put_reference_error), &
            precision_column_t('reference_check', 'rad', &
                               'difference between the reference and an independent computation', &
                               'reference', put_reference_check), &
            precision_column_t('front', '', 'yes: no other numerical method is both faster and more accurate', &
                               'choice', put_front, words=.true.), &
            precision_column_t('auto', '', "yes: method = 'auto' takes this method at this tolerance", &
                               'choice', put_auto, words=.true.)]
    end function precision_columns

    !> Looks at a row of the problem.
    subroutine look(self, row)
        class(precision_view_t), intent(inout) :: self
        type(precision_row_t), intent(in) :: row !! the row
        self%row = row
        self%largest = row%trial%errors
        self%last = row%trial%last
        if (row%trial%status == status_ok) return
        self%largest = unknown
        self%last = unknown
    end subroutine look

    !> A logical in a table.
    pure character(3) function yes_or_no(is_so)
        logical, intent(in) :: is_so
        yes_or_no = merge('yes', 'no ', is_so)
    end function yes_or_no

    subroutine put_problem(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(now%problem)
    end subroutine put_problem

    subroutine put_method(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(now%row%method)
    end subroutine put_method

    subroutine put_formulation(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(now%row%formulation)
    end subroutine put_formulation

    subroutine put_setting(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(now%row%setting)
    end subroutine put_setting

    subroutine put_orientation_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%last%orientation])
    end subroutine put_orientation_error

    subroutine put_tip_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%last%tip])
    end subroutine put_tip_error

    subroutine put_error_max(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%orientation])
    end subroutine put_error_max

    subroutine put_steps(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_integer(now%row%trial%counts%steps)
    end subroutine put_steps

    subroutine put_rejected(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_integer(now%row%trial%counts%rejected)
    end subroutine put_rejected

    subroutine put_evaluations(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_integer(now%row%trial%counts%evaluations)
    end subroutine put_evaluations

    subroutine put_time_s(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%row%time])
    end subroutine put_time_s

    subroutine put_energy_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%energy])
    end subroutine put_energy_error

    subroutine put_status(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(status_names(now%row%trial%status))
    end subroutine put_status

    subroutine put_tip_error_max(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%tip])
    end subroutine put_tip_error_max

    subroutine put_jacobians(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_integer(now%row%trial%counts%jacobians)
    end subroutine put_jacobians

    subroutine put_lz_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%vertical])
    end subroutine put_lz_error

    subroutine put_l3_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%axial])
    end subroutine put_l3_error

    subroutine put_norm_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%quaternion])
    end subroutine put_norm_error

    subroutine put_phi_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%last%angle(1)])
    end subroutine put_phi_error

    subroutine put_theta_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%last%angle(2)])
    end subroutine put_theta_error

    subroutine put_psi_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%last%angle(3)])
    end subroutine put_psi_error

    subroutine put_phi_rate_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%last%rate(1)])
    end subroutine put_phi_rate_error

    subroutine put_theta_rate_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%last%rate(2)])
    end subroutine put_theta_rate_error

    subroutine put_psi_rate_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%last%rate(3)])
    end subroutine put_psi_rate_error

    subroutine put_phi_error_max(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%angle(1)])
    end subroutine put_phi_error_max

    subroutine put_theta_error_max(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%angle(2)])
    end subroutine put_theta_error_max

    subroutine put_psi_error_max(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%angle(3)])
    end subroutine put_psi_error_max

    subroutine put_phi_rate_error_max(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%rate(1)])
    end subroutine put_phi_rate_error_max

    subroutine put_theta_rate_error_max(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%rate(2)])
    end subroutine put_theta_rate_error_max

    subroutine put_psi_rate_error_max(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%largest%rate(3)])
    end subroutine put_psi_rate_error_max

    subroutine put_inherent_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([maxval(now%reference%floor)])
    end subroutine put_inherent_error

    subroutine put_reference(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(now%reference%source)
    end subroutine put_reference

    subroutine put_reference_error(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%reference%uncertainty])
    end subroutine put_reference_error

    subroutine put_reference_check(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([now%reference%disagreement])
    end subroutine put_reference_check

    subroutine put_front(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(yes_or_no(now%row%is_front))
    end subroutine put_front

    subroutine put_auto(now, cells)
        type(precision_view_t), intent(in) :: now
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(yes_or_no(now%row%is_auto))
    end subroutine put_auto

end module spintop_precision_columns
