!> Measures a motion without a closed form by events, where the quantities that are watched turn (`spintop_measures`). All are
!> those of body z as it was given, which is another axis than that of the computation where the body was given by an inertia
!> tensor.
module spintop_nutation_recorder
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_case, only: case_t
    use spintop_kinds, only: dp, pi, is_finite, is_zero
    use spintop_event_recorder, only: event_recorder_t
    use spintop_events, only: event_t
    use spintop_kernel_types, only: lane_body_t
    use spintop_lane_series, only: lanes, parts
    use spintop_lane_watch, only: watched_t
    use spintop_measures, only: class_tolerance, lower, measures_t, point_of, quantities_of => quantities, upper, &
        watch_centre_height, watch_nutation_rate, watch_precession_rate, watch_total_force, watch_turning, &
        watch_vertical_force, watches
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_motions, only: instants, motions_t, axis_slopes, centre_slopes, find_force_slopes, &
        nutation_slopes, precession_slopes
    use spintop_nutation, only: nutation_t
    use spintop_pole_passages, only: through_pole
    use spintop_poles, only: exactly_plane, polar_precession_rate, swings_over_poles
    use spintop_quantities, only: angular_acceleration
    use spintop_taylor_lanes, only: set_body
    implicit none
    private
    public :: nutation_recorder_t

    !> Searches for the events of the scene, and measures the nutation on request.
    type, extends(event_recorder_t) :: nutation_recorder_t
        !> What is measured: for each quantity, whether it is.
        logical :: wanted(watches) = .false.
        !> What was measured.
        type(measures_t) :: found
        type(case_t), private :: case
        logical, private :: is_plane = .false.
        !> The quantities of the measured events, which follow those of the scene.
        integer, allocatable, private :: own(:)
        !> Those of which extremes are kept, and the body, in the first lane.
        type(watched_t), allocatable, private :: extremes(:)
        type(lane_body_t), private :: body
    contains
        procedure :: measure_nutation
        procedure :: quantities
        procedure :: quantities_of_several
        procedure :: handle_event
        procedure :: knows_class
        procedure :: include_end
    end type nutation_recorder_t

contains

    !> Requests measurements; call after `set`.
    subroutine measure_nutation(self, case, wanted)
        class(nutation_recorder_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! the case whose motion is measured, in the axes in which its body was given
        integer, intent(in) :: wanted(:) !! the quantities that are measured
        type(motion_t) :: given
        real(dp) :: gamma(3)
        integer :: k
        self%wanted = [(any(wanted == k), k=1, watches)]
        self%takes_noise = .true.
        self%case = case
        ! Only the events of the scene may depend on the angles.
        self%needs_angles = self%needs_angles .and. size(self%events) > 0
        self%needs_turns = size(self%events) > 0 .or. self%wanted(watch_turning)
        self%takes_several = size(self%events) == 0 .and. .not. case%body%given%differ
        self%own = pack([(k, k=1, watches)], self%wanted)
        ! Without an arm the support force is constant.
        if (all(is_zero(case%body%centre_of_mass))) self%own = pack(self%own, self%own < watch_vertical_force)
        if (self%wanted(watch_turning)) self%events = [self%events, event_t('upper', -1), event_t('lower', 1)]
        self%own = pack(self%own, self%own /= watch_turning)
        self%events = [self%events, (event_t(quantities_of(self%own(k))%name, quantities_of(self%own(k))%direction), &
                                     k=1, size(self%own))]
        if (self%wanted(watch_turning)) self%own = [watch_turning, watch_turning, self%own]
        ! The precession is fastest near a pole.
        if (any(self%wanted .and. quantities_of%is_rate)) self%pole_axis = case%turn%vector([0.0_dp, 0.0_dp, 1.0_dp])
        self%is_plane = swings_over_poles(case%body, case%start, exactly_plane) .and. .not. case%body%given%differ
        call set_body(self%body, 1, case%body)
        self%extremes = [watched_t ::]
        do k = watch_turning + 1, watches
            if (.not. (self%wanted(k) .or. k == watch_precession_rate) .or. (k == watch_precession_rate .and. self%is_plane)) cycle
            self%extremes = [self%extremes, watched_t(k)]
            call self%extremes(size(self%extremes))%set_lane(1, case%body, case%start%omega, 0.0_dp)
        end do
        given = case%start
        given%omega_rate = angular_acceleration(case%body, given)
        given = as_given(self, given)
        call self%found%turns%begin(given, given%omega_rate)
        self%found%ends = given%angle(2)
        call update_extremes(self, case%start, given)
        ! From a pole the motion begins with the limit of the precession rate.
        gamma = vertical_from_quaternion(given%quaternion)
        if (hypot(gamma(1), gamma(2)) > through_pole .or. self%is_plane) return
        associate (fastest => self%found%largest(watch_precession_rate))
            fastest = polar_precession_rate(given)
            if (.not. is_finite(fastest)) fastest = 0
        end associate
    end subroutine measure_nutation

    !> A motion of the computation in the axes in which the body was given.
    pure type(motion_t) function as_given(self, motion) result(given)
        class(nutation_recorder_t), intent(in) :: self
        type(motion_t), intent(in) :: motion
        given = motion
        if (.not. self%case%body%given%differ) return
        given = self%case%turn%back(motion, motion%given_angle)
        ! In a pole the attitude does not tell phi and psi.
        if (given%passed%arrived) given%angle(1:3:2) = motion%given_angle(1:3:2)
    end function as_given

    !> The quantities of the events of the scene, and the slopes of the measured ones.
    subroutine quantities(self, motion, values)
        class(nutation_recorder_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion at an instant
        real(dp), intent(out) :: values(:) !! one value for each event
        type(motions_t) :: motions, given
        real(dp) :: slopes(instants, size(values))
        integer :: n

        n = size(values)
        if (allocated(self%own)) then
            n = n - size(self%own)
            call motions%fill(motion)
            call given%fill(as_given(self, motion))
            call find_slopes(self, motions, given, slopes(:, n + 1:))
            values(n + 1:) = slopes(1, n + 1:)
        end if
        if (n > 0) call self%event_recorder_t%quantities(motion, values(:n))
    end subroutine quantities

    !> The same at several instants, where only measured ones are wanted, and those of the axes of the computation.
    subroutine quantities_of_several(self, motions, values)
        class(nutation_recorder_t), intent(inout) :: self
        type(motions_t), intent(in) :: motions !! the motion at several instants
        real(dp), intent(out) :: values(:, :) !! a column for each event
        call find_slopes(self, motions, motions, values)
    end subroutine quantities_of_several

    !> The slopes of the measured quantities, of motions in the axes of the computation and in those in which the body was given.
    subroutine find_slopes(self, motions, given, slopes)
        class(nutation_recorder_t), intent(in) :: self
        type(motions_t), intent(in) :: motions, given
        real(dp), intent(out) :: slopes(:, :)
        real(dp) :: forces(instants, watch_vertical_force:watch_total_force)
        integer :: k
        associate (wanted => self%wanted, body => self%case%body)
            if (wanted(watch_vertical_force) .or. wanted(watch_total_force)) call find_force_slopes(body, motions, &
                forces(:, watch_vertical_force), forces(:, watch_total_force))
            do k = 1, size(self%own)
                select case (self%own(k))
                case (watch_turning)
                    slopes(:, k) = axis_slopes(given)
                case (watch_centre_height)
                    slopes(:, k) = centre_slopes(body, motions)
                case (watch_precession_rate)
                    slopes(:, k) = precession_slopes(given)
                case (watch_nutation_rate)
                    slopes(:, k) = nutation_slopes(given)
                case (watch_vertical_force, watch_total_force)
                    slopes(:, k) = forces(:, self%own(k))
                end select
            end do
        end associate
    end subroutine find_slopes

    !> Handles an event.
    subroutine handle_event(self, number, motion)
        class(nutation_recorder_t), intent(inout) :: self
        integer, intent(in) :: number !! index of the event in `events`
        type(motion_t), intent(in) :: motion !! the motion at the event
        type(motion_t) :: given
        integer :: k
        k = number - size(self%events)
        if (allocated(self%own)) k = k + size(self%own)
        if (k <= 0) then
            call self%event_recorder_t%handle_event(number, motion)
            return
        end if
        given = as_given(self, motion)
        call update_extremes(self, motion, given)
        if (self%own(k) /= watch_turning) return
        call self%found%turns%add(merge(upper, lower, self%events(number)%direction < 0), point_of(given), self%is_noise)
    end subroutine handle_event

    !> Includes the end of the motion, where the quantities may have their extremes.
    subroutine include_end(self)
        class(nutation_recorder_t), intent(inout) :: self
        type(motion_t) :: given
        if (.not. self%needs_angles) then
            associate (here => self%here)
                self%here = motion_from_quaternion(here%t, here%quaternion, here%omega, here%angle)
            end associate
        end if
        self%here%omega_rate = angular_acceleration(self%case%body, self%here)
        given = as_given(self, self%here)
        self%found%ends(2) = given%angle(2)
        if (self%wanted(watch_turning)) call self%found%turns%count_end(given, given%omega_rate)
        call update_extremes(self, self%here, given)
    end subroutine include_end

    !> Updates the extremes by a motion, which is given in the axes of the computation and in those of the body as well.
    subroutine update_extremes(self, motion, given)
        class(nutation_recorder_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion, given
        real(dp) :: x(lanes, parts), value(lanes)
        integer :: i
        x = 0
        do i = 1, size(self%extremes)
            associate (of => self%extremes(i))
                x(1, :6) = [motion%omega, vertical_from_quaternion(motion%quaternion)]
                if (quantities_of(of%quantity)%is_of_axis) x(1, :6) = [given%omega, vertical_from_quaternion(given%quaternion)]
                call of%find_values(self%body, x, value)
                call self%found%keep(of%quantity, value(1), 0.0_dp, x(1, 4:5), x(1, 1:2))
            end associate
        end do
    end subroutine update_extremes

    !> Whether the class is certain although the largest precession rate may lie between the turning points: there may be a
    !> cusp only if the rates at all upper turning points are small compared to that of the nutation. Call after `include_end`.
    pure logical function knows_class(self)
        class(nutation_recorder_t), intent(in) :: self
        type(nutation_t) :: measured
        logical :: is_whole
        call self%found%find_nutation(measured, is_whole)
        knows_class = self%wanted(watch_precession_rate) .or. self%is_plane .or. .not. is_whole
        if (.not. knows_class) then
            knows_class = any(abs(self%found%turns%of(upper)%rate) > class_tolerance * 2 * pi / measured%period)
        end if
    end function knows_class

end module spintop_nutation_recorder
