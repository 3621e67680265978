!> What an event is: a passage of a quantity through a level, or an occasion that the equations of motion know; and the
!> interface of a motion along which it is searched, at any time within an interval.
module spintop_event
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_loads, only: works
    use spintop_motion, only: motion_t
    use spintop_motions, only: instants, motions_t
    implicit none
    private
    public :: event_t, event_quantities_t, occasion_none, occasion_stuck, occasion_slip, occasion_knot, path_t

    !> What an event is: a passage; dry friction stops the body; the torques overcome dry friction, and the body begins
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

    !> An extension defines the motion, and how many evaluations are allowed.
    type, abstract :: path_t
        !> A bound of the angular velocity along the path, rad/s; 0 if none is known.
        real(dp) :: greatest_rate = 0
        !> Evaluations so far, and how many are allowed.
        integer(int64) :: looks = 0, most_looks = huge(1_int64)
    contains
        procedure(at), deferred :: at
        procedure :: at_several
        procedure :: work_until
        procedure :: is_spent
    end type path_t

    abstract interface
        !> The motion at a time, with angles and their rates unless they are not needed and it is cheaper without.
        subroutine at(self, t, motion, with_angles)
            import :: path_t, motion_t, dp
            class(path_t), intent(inout) :: self
            real(dp), intent(in) :: t !! time, s
            type(motion_t), intent(out) :: motion !! the motion at that time
            logical, intent(in), optional :: with_angles !! whether they are needed, which is so without it
        end subroutine at
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

    !> The motion, without angles, at several instants. By default one after the other.
    subroutine at_several(self, t, used, motions)
        class(path_t), intent(inout) :: self
        real(dp), intent(in) :: t(instants) !! times, s
        integer, intent(in) :: used !! how many of them are different: those that count as work
        type(motions_t), intent(out) :: motions !! the motion at these times
        type(motion_t) :: motion
        integer :: i
        do i = 1, instants
            if (i <= used) call self%at(t(i), motion, with_angles=.false.)
            call motions%set_motion(i, motion)
        end do
    end subroutine at_several

    !> The work of effects from the start to a time, by its parts, J; by default there are none.
    function work_until(self, t) result(work)
        class(path_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: work(works)
        work = 0
    end function work_until

    !> Whether the allowed number of evaluations is used up.
    logical function is_spent(self)
        class(path_t), intent(in) :: self
        is_spent = self%looks >= self%most_looks
    end function is_spent

end module spintop_event
