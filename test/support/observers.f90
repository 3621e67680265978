!> An observer of an integration that keeps every motion it is shown, a search that keeps every event it meets, and paths of a
!> motion.
module observers
    use tested
    implicit none
    private
    public :: recorder_t, event_log_t, closed_path_t, made_up_path_t
    public :: of_turning, of_phi, of_theta, of_psi, of_omega1, of_gamma1

    !> The motions seen are `motions(:count)`.
    type, extends(observer_t) :: recorder_t
        type(motion_t), allocatable :: motions(:)
        integer :: count = 0
        !> Ends the run after so many motions.
        integer :: limit = huge(1)
    contains
        procedure :: observe
        procedure :: last
        procedure :: times
    end type recorder_t

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

    subroutine observe(self, formulation, t, y, near)
        class(recorder_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        type(motion_t), allocatable :: larger(:)

        if (.not. allocated(self%motions)) allocate (self%motions(64))
        if (self%count == size(self%motions)) then
            allocate (larger(2 * self%count))
            larger(:self%count) = self%motions
            call move_alloc(larger, self%motions)
        end if
        self%count = self%count + 1
        self%motions(self%count) = formulation%motion(t, y, near)
        self%has_enough = self%count >= self%limit
    end subroutine observe

    !> The motion seen last.
    type(motion_t) function last(self)
        class(recorder_t), intent(in) :: self
        last = self%motions(self%count)
    end function last

    !> The times at which the motion was seen.
    function times(self)
        class(recorder_t), intent(in) :: self
        real(dp), allocatable :: times(:)
        allocate (times(0))
        if (self%count > 0) times = self%motions(:self%count)%t
    end function times

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

end module observers
