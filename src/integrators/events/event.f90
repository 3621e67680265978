!> What an event is: a passage of a quantity through a level, or an occasion that the equations of motion know.
module spintop_event
    use spintop_kinds, only: dp, pi
    implicit none
    private
    public :: event_t, side_t, sign_of, turns_far
    public :: occasion_none, occasion_stuck, occasion_slip, occasion_knot

    !> Occasions: none (a passage); dry friction stops the body; the torques overcome dry friction, and the body begins
    !> to move; a row of a table of torques.
    integer, parameter :: occasion_none = 0, occasion_stuck = 1, occasion_slip = 2, occasion_knot = 3

    !> An event to search for, and the number of its occurrences.
    type :: event_t
        !> Name in tables.
        character(80) :: name = ''
        !> 1 if the quantity rises through the level, -1 if it falls.
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

    !> The side of its level on which a quantity is.
    type :: side_t
        real(dp) :: level = huge(1.0_dp)
        !> 1 above, -1 below, 0 unknown; the time since which it is known, and the distance from the level
        !> then.
        integer :: sign = 0
        real(dp) :: t = 0, distance = 0
        !> Distance below which the side is unknown: the rounding error, where it was measured.
        real(dp) :: rounding = 0
        logical :: is_measured = .false.
        !> Largest distance at the instants of the interval.
        real(dp) :: farthest = 0
    end type side_t

    !> An angle that changes by more between two instants was not followed.
    real(dp), parameter :: farthest_turn = 1.5_dp * pi

contains

    !> Whether an angle with turns changes too much between two instants to be followed.
    elemental logical function turns_far(event, before, after)
        type(event_t), intent(in) :: event !! the event with this quantity
        real(dp), intent(in) :: before, after !! its values at the two instants
        turns_far = (event%every_turn .or. event%turn_by_turn) .and. abs(after - before) > farthest_turn
    end function turns_far

    !> 1 or -1.
    elemental integer function sign_of(x)
        real(dp), intent(in) :: x !! a number
        sign_of = merge(1, -1, x > 0)
    end function sign_of

end module spintop_event
