!> Power series of the motion of a body with effects, in double precision: see effects_series.inc.
module spintop_effects_series
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_series_order, max_states
    use spintop_effects, only: effects_t
    use spintop_kinds, only: dp, no_number, wp => dp
    use spintop_torque_table, only: max_degree
    implicit none
    private
    public :: find_series

    include 'effects_series.inc'

end module spintop_effects_series
