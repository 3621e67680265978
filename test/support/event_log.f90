!> A search that keeps every event it meets, and a path of a motion made up for a test.
module event_log
    use spintop_attitude, only: quaternion_from_angles, vertical_from_quaternion
    use spintop_events, only: event_search_t, path_t
    use spintop_exact_motion, only: exact_motion_t
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_quantities, only: axis_height_rate
    implicit none
    private
    public :: event_log_t, closed_path_t, made_up_path_t
    public :: of_turning, of_phi, of_theta, of_psi, of_omega1, of_gamma1

    !> The quantities of the events.
    integer, parameter :: of_turning = 1, of_phi = 2, of_theta = 3, of_psi = 4, of_omega1 = 5, of_gamma1 = 6

    !> The events met are `met(:n)`, at `motions(:n)`.
    type, extends(event_search_t) :: event_log_t
        !> The quantity of each event of the list.
        integer, allocatable :: of(:)
        !> The motion ends at so many events.
        integer :: limit = huge(1)
        integer :: n = 0
        integer :: met(1000) = 0
        type(motion_t) :: motions(1000)
        !> Evaluations of the quantities.
        integer :: evaluations = 0
    contains
        procedure :: quantities
        procedure :: handle_event
        procedure :: times_of
    end type event_log_t

    !> The exact motion.
    type, extends(path_t) :: closed_path_t
        type(exact_motion_t) :: exact
    contains
        procedure :: at => exactly_at
    end type closed_path_t

    !> A motion with phi = sin t, theta = 1 + t, psi = 7 t, omega1 = tan t, turning at one radian a second.
    type, extends(path_t) :: made_up_path_t
    contains
        procedure :: at => made_up_at
    end type made_up_path_t

contains

    subroutine quantities(self, motion, values)
        class(event_log_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        real(dp), intent(out) :: values(:)
        real(dp) :: all_values(6), gamma(3)
        gamma = vertical_from_quaternion(motion%quaternion)
        all_values = [axis_height_rate(motion), motion%angle, motion%omega(1), gamma(1)]
        values = all_values(self%of)
        self%evaluations = self%evaluations + 1
    end subroutine quantities

    subroutine handle_event(self, number, motion)
        class(event_log_t), intent(inout) :: self
        integer, intent(in) :: number
        type(motion_t), intent(in) :: motion
        self%n = self%n + 1
        self%met(self%n) = number
        self%motions(self%n) = motion
        self%has_enough = self%n >= self%limit
    end subroutine handle_event

    !> The times of an event of the list.
    pure function times_of(self, number) result(times)
        class(event_log_t), intent(in) :: self
        integer, intent(in) :: number
        real(dp), allocatable :: times(:)
        times = pack(self%motions(:self%n)%t, self%met(:self%n) == number)
    end function times_of

    subroutine exactly_at(self, t, motion, with_angles)
        class(closed_path_t), intent(inout) :: self
        real(dp), intent(in) :: t
        type(motion_t), intent(out) :: motion
        logical, intent(in), optional :: with_angles
        motion = self%exact%at(t)
    end subroutine exactly_at

    subroutine made_up_at(self, t, motion, with_angles)
        class(made_up_path_t), intent(inout) :: self
        real(dp), intent(in) :: t
        type(motion_t), intent(out) :: motion
        logical, intent(in), optional :: with_angles
        motion%t = t
        motion%angle = [sin(t), 1 + t, 7 * t]
        motion%quaternion = quaternion_from_angles(motion%angle)
        motion%omega = [tan(t), 0.0_dp, 1.0_dp]
    end subroutine made_up_at

end module event_log
