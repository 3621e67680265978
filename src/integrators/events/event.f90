!> What an event is: a passage of a quantity through a level, or an occasion that the equations of motion know.
module spintop_event
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_motions, only: instants, motions_t
    implicit none
    private
    public :: event_t, event_quantities_t
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

    !> Quantities of a motion, one for each event. An extension defines them.
    type, abstract :: event_quantities_t
        !> The events to search for.
        type(event_t), allocatable :: events(:)
        !> Whether a quantity takes the angles or their rates from the motion; otherwise they are not computed there.
        logical :: needs_angles = .true.
        !> Whether `quantities_of_several` gives all quantities; then none needs the angles.
        logical :: takes_several = .false.
    contains
        procedure(quantities), deferred :: quantities
        procedure :: quantities_of_several
    end type event_quantities_t

    abstract interface
        !> The quantities of all events. While a quantity is not finite, its events are not found.
        subroutine quantities(self, motion, values)
            import :: event_quantities_t, motion_t, dp
            class(event_quantities_t), intent(inout) :: self
            type(motion_t), intent(in) :: motion !! the motion at an instant
            real(dp), intent(out) :: values(:) !! one value for each event
        end subroutine quantities
    end interface

contains

    !> The quantities at several instants: what an extension that sets `takes_several` overrides.
    subroutine quantities_of_several(self, motions, values)
        class(event_quantities_t), intent(inout) :: self
        type(motions_t), intent(in) :: motions !! the motion at several instants
        real(dp), intent(out) :: values(:, :) !! a column for each event
        real(dp) :: one(size(values, 2))
        integer :: i
        do i = 1, instants
            call self%quantities(motions%motion(i), one)
            values(i, :) = one
        end do
    end subroutine quantities_of_several

end module spintop_event
