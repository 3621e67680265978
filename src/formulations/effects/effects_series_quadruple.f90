!> Power series of the motion of a body with effects, in quadruple precision: see effects_series.inc.
module spintop_effects_series_quadruple
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_series_order, max_states
    use spintop_effects, only: effects_t
    use spintop_kinds, only: dp, no_number, wp => qp
    use spintop_torque_table, only: max_degree
    implicit none
    private
    public :: find_series

    include 'effects_series.inc'

end module spintop_effects_series_quadruple
