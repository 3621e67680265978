!> What an event is: a passage of a quantity through a level, or an occasion that the equations of motion know.
module spintop_event
    use spintop_kinds, only: dp
    implicit none
    private
    public :: event_t
    public :: occasion_none, occasion_stuck, occasion_slip, occasion_knot

    !> Occasions: none (a passage); dry friction stops the body; the torques overcome dry friction, and the body begins
    !> to move; a row of a table of torques.
    integer, parameter :: occasion_none = 0, occasion_stuck = 1, occasion_slip = 2, occasion_knot = 3

    !> An event to search for, and the number of its occurrences.
    type :: event_t
        !> Name in tables.
        character(80) :: name = ''
        !> 1 if the quantity rises through the level, -1 if it falls, 0 for both.
        integer :: direction = 1
        !> The level, in the unit of the quantity.
        real(dp) :: level = 0
        !> Whether the levels are `level` + 2 pi n for all integers n.
        logical :: every_turn = .false.
        !> Whether the levels are 2 pi, 4 pi, ..., each met once, in this order.
        logical :: turn_by_turn = .false.
        !> Number of events so far.
        integer :: count = 0
        !> The occasion, if the event is not a passage; its quantity then never reaches its level.
        integer :: occasion = occasion_none
    end type event_t

end module spintop_event
