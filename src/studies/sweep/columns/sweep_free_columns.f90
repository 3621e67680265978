!> The columns of a sweep table that are constants of the motion of a free body.
module spintop_sweep_free_columns
    use spintop_sweep_column, only: sweep_column_t
    use spintop_sweep_result, only: of_free, of_geometric, set_of
    implicit none
    private
    public :: sweep_free_columns

contains

    !> The columns, in the order of the documentation.
    function sweep_free_columns() result(columns)
        type(sweep_column_t), allocatable :: columns(:)
        columns = [ &
            sweep_column_t('momentum_period', 's', 'period of the angular momentum in a free body', &
                           'free', set_of([of_free])), &
            sweep_column_t('momentum_turn', 'rad', 'turn about the momentum in that period', 'free', set_of([of_free])), &
            sweep_column_t('momentum_turn_geometric', 'rad', 'geometric phase, momentum_turn less 2 E momentum_period/L', &
                           'free', set_of([of_free, of_geometric])), &
            sweep_column_t('momentum_axis', '', 'body axis about which the angular momentum circulates (1, 2, 3)', &
                           'free', set_of([of_free])), &
            sweep_column_t('omega_max', 'rad/s', 'maximum angular velocity of a free body', 'free', set_of([of_free]))]
    end function sweep_free_columns

end module spintop_sweep_free_columns
