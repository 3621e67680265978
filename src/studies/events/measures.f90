!> What a nutation recorder measures of a motion, and the events by which it does.
module spintop_measures
    implicit none
    private
    public :: measures_t, lowest_centre, fastest, fastest_nutation, vertical_force, largest_force, own_names, own_directions

    !> The events that can be measured; those that are wanted follow those of the scene. The turning points are
    !> the first two (`spintop_turning_record`).
    integer, parameter :: lowest_centre = 3, fastest = 4, fastest_nutation = 5, vertical_force = 6, largest_force = 7
    !> Their names and directions.
    character(*), parameter :: own_names(largest_force) = [character(16) :: 'upper', 'lower', 'lowest', 'fastest', &
        'fastest nutation', 'vertical force', 'largest force']
    integer, parameter :: own_directions(largest_force) = [-1, 1, 1, 0, 0, 0, -1]

    !> What is measured.
    type :: measures_t
        logical :: turning = .true. !! the turning points
        logical :: lowest = .true. !! the minimum height of the centre of mass
        logical :: fastest = .true. !! the largest precession rate
        logical :: nutation_rate = .false. !! the largest nutation rate
        logical :: vertical_force = .false. !! the extremes of the vertical support force
        logical :: force = .false. !! the largest support force
    contains
        procedure :: has_forces
        procedure :: events => wanted_events
    end type measures_t

contains

    !> Whether the nutation rate or the support force is measured.
    pure logical function has_forces(self)
        class(measures_t), intent(in) :: self !! what is measured
        has_forces = self%nutation_rate .or. self%vertical_force .or. self%force
    end function has_forces

    !> The events that are to be found.
    pure function wanted_events(self) result(own)
        class(measures_t), intent(in) :: self !! what is measured
        integer, allocatable :: own(:)
        integer :: k
        own = pack([(k, k=1, largest_force)], [self%turning, self%turning, self%lowest, self%fastest, &
            self%nutation_rate, self%vertical_force, self%force])
    end function wanted_events

end module spintop_measures
