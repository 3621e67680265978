!> The columns of a sweep table that are constants of the motion of a free body.
module spintop_sweep_free_columns
    use spintop_kinds, only: dp
    use spintop_sweep_column, only: sweep_column_t
    use spintop_sweep_result, only: sweep_result_t
    implicit none
    private
    public :: sweep_free_columns

contains

    !> The columns, in the order of the documentation.
    function sweep_free_columns() result(columns)
        type(sweep_column_t), allocatable :: columns(:)
        columns = [ &
            sweep_column_t('momentum_period', 's', 'period of the angular momentum in a free body', &
                           'free', fill_momentum_period), &
            sweep_column_t('momentum_turn', 'rad', 'turn about the momentum in that period', 'free', fill_momentum_turn), &
            sweep_column_t('momentum_axis', '', 'body axis about which the angular momentum circulates (1, 2, 3)', &
                           'free', fill_momentum_axis), &
            sweep_column_t('omega_max', 'rad/s', 'maximum angular velocity of a free body', 'free', fill_omega_max)]
    end function sweep_free_columns

    pure subroutine fill_momentum_period(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%momentum_period
    end subroutine fill_momentum_period

    pure subroutine fill_momentum_turn(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%momentum_turn
    end subroutine fill_momentum_turn

    pure subroutine fill_momentum_axis(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%momentum_axis
    end subroutine fill_momentum_axis

    pure subroutine fill_omega_max(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%omega_max
    end subroutine fill_omega_max

end module spintop_sweep_free_columns
