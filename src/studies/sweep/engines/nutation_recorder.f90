!> Measures the nutation of a motion without a closed form by events: the turning points of theta, the maxima
!> of the precession rate, and the minima of the height of the centre of mass. All are those of body z as it was given,
!> which is another axis than that of the computation where the body was given by an inertia tensor.
module spintop_nutation_recorder
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_case, only: case_t
    use spintop_compare, only: is_finite, is_zero
    use spintop_euler_poisson, only: euler_poisson_rate
    use spintop_event_recorder, only: event_recorder_t
    use spintop_events, only: event_t
    use spintop_kinds, only: dp, no_number, pi
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_motions, only: instants, motions_t, axis_slopes, centre_slopes, find_force_slopes, &
        nutation_slopes, precession_slopes
    use spintop_nutation, only: nutation_t, class_loop, class_cusp, class_wave, class_steady, &
        class_libration, class_circulation
    use spintop_pole_passages, only: through_pole
    use spintop_poles, only: exactly_plane, polar_precession_rate, precession_is_lost, swings_over_poles
    use spintop_quantities, only: angular_acceleration, axis_height_rate, support_force
    use spintop_turning_record, only: count_end, interrupt, turning_points_t, turns_at, upper, lower
    implicit none
    private
    public :: nutation_recorder_t, measures_t, nutation_of, no_class, lowest_centre, fastest, fastest_nutation
    public :: vertical_force, largest_force, own_names, own_directions

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

    !> Class of a motion whose nutations belong to several classes.
    integer, parameter :: no_class = 0

    !> A precession rate at the upper turning points within this fraction of the largest one and of that of the nutation, and a
    !> range of theta within this angle, rad, count as zero. Beside a pole the largest one may have any value.
    real(dp), parameter :: class_tolerance = 1.0e-6_dp

    !> Searches for the events of the scene, and measures the nutation on request.
    type, extends(event_recorder_t) :: nutation_recorder_t
        !> Minimum height of the centre of mass so far, m.
        real(dp) :: com_z_min = huge(1.0_dp)
        !> What is measured: the largest nutation rate so far, rad/s, and the extremes of the support force, N.
        type(measures_t) :: measures = measures_t(.false., .false., .false.)
        real(dp) :: theta_rate_max = 0, force_max = 0, force_z_min = huge(1.0_dp), force_z_max = -huge(1.0_dp)
        type(case_t), private :: case
        logical, private :: starts_turning = .false., is_plane = .false.
        !> The measured events.
        integer, allocatable, private :: own(:)
        type(turning_points_t), private :: turns(upper:lower)
        !> The inclination at the start and at the end, rad.
        real(dp), private :: end_theta(2) = 0
        real(dp), private :: phi_rate_max = 0
    contains
        procedure :: measure_nutation
        procedure :: quantities
        procedure :: quantities_of_several
        procedure :: handle_event
        procedure :: handle_doubtful_event
        procedure :: nutation
        procedure :: is_noisy
        procedure :: knows_class
        procedure :: include_end
    end type nutation_recorder_t

contains

    !> Requests measurements; call after `set`.
    subroutine measure_nutation(self, case, measures)
        class(nutation_recorder_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! the case whose motion is measured, in the axes in which its body was given
        type(measures_t), intent(in) :: measures !! what is measured
        type(motion_t) :: given
        real(dp) :: gamma(3)
        integer :: k
        self%measures = measures
        self%case = case
        ! Only the events of the scene may depend on the angles.
        self%needs_angles = self%needs_angles .and. size(self%events) > 0
        self%needs_turns = size(self%events) > 0 .or. measures%turning
        self%takes_several = size(self%events) == 0 .and. .not. case%body%given%differ
        self%own = measures%events()
        ! Without an arm the support force is constant.
        if (all(is_zero(case%body%centre_of_mass))) self%own = pack(self%own, self%own < vertical_force)
        self%events = [self%events, (event_t(own_names(self%own(k)), own_directions(self%own(k))), k=1, size(self%own))]
        ! The precession is fastest near a pole.
        if (measures%fastest .or. measures%nutation_rate) self%pole_axis = case%turn%vector([0.0_dp, 0.0_dp, 1.0_dp])
        self%is_plane = swings_over_poles(case%body, case%start, exactly_plane) .and. .not. case%body%given%differ
        given = case%start
        given%omega_rate = angular_acceleration(case%body, given)
        given = as_given(self, given)
        self%starts_turning = turns_at(given, given%omega_rate)
        self%end_theta = given%angle(2)
        call update_extremes(self, case%start, given)
        ! From a pole the motion begins with the limit of the precession rate.
        gamma = vertical_from_quaternion(given%quaternion)
        if (hypot(gamma(1), gamma(2)) > through_pole .or. self%is_plane) return
        self%phi_rate_max = polar_precession_rate(given)
        if (.not. is_finite(self%phi_rate_max)) self%phi_rate_max = 0
    end subroutine measure_nutation

    !> A motion of the computation in the axes in which the body was given.
    pure type(motion_t) function as_given(self, motion) result(given)
        class(nutation_recorder_t), intent(in) :: self
        type(motion_t), intent(in) :: motion
        given = motion
        if (.not. self%case%body%given%differ) return
        given = self%case%turn%back(motion, motion%given_angle)
        given%passed = motion%given_passed
        ! In a pole the attitude does not tell phi and psi.
        if (given%passed%arrived) given%angle(1:3:2) = motion%given_angle(1:3:2)
    end function as_given

    !> The quantities of the events of the scene, and of the measured ones.
    subroutine quantities(self, motion, values)
        class(nutation_recorder_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion at an instant
        real(dp), intent(out) :: values(:) !! one value for each event
        type(motions_t) :: motions, given
        real(dp) :: own(instants, largest_force)
        integer :: n

        n = size(values)
        if (allocated(self%own)) then
            n = n - size(self%own)
            call motions%fill(motion)
            if (self%case%body%given%differ) then
                call given%fill(as_given(self, motion))
                call find_own(self, motions, given, own)
            else
                call find_own(self, motions, motions, own)
            end if
            values(n + 1:) = own(1, self%own)
        end if
        if (n > 0) call self%event_recorder_t%quantities(motion, values(:n))
    end subroutine quantities

    !> The same at several instants, where only measured ones are wanted, and those of the axes of the computation.
    subroutine quantities_of_several(self, motions, values)
        class(nutation_recorder_t), intent(inout) :: self
        type(motions_t), intent(in) :: motions !! the motion at several instants
        real(dp), intent(out) :: values(:, :) !! a column for each event
        real(dp) :: own(instants, largest_force)
        integer :: k
        call find_own(self, motions, motions, own)
        do k = 1, size(self%own)
            values(:, k) = own(:, self%own(k))
        end do
    end subroutine quantities_of_several

    !> The measured quantities, of motions in the axes of the computation and in those in which the body was given.
    subroutine find_own(self, motions, given, own)
        class(nutation_recorder_t), intent(in) :: self
        type(motions_t), intent(in) :: motions, given
        real(dp), intent(out) :: own(instants, largest_force)

        own = 0
        associate (measures => self%measures, body => self%case%body)
            if (measures%turning) then
                own(:, upper) = axis_slopes(given)
                own(:, lower) = own(:, upper)
            end if
            if (measures%lowest) own(:, lowest_centre) = centre_slopes(body, motions)
            if (measures%fastest) own(:, fastest) = precession_slopes(given)
            if (measures%nutation_rate) own(:, fastest_nutation) = nutation_slopes(given)
            if (measures%vertical_force .or. measures%force) then
                call find_force_slopes(body, motions, own(:, vertical_force), own(:, largest_force))
            end if
        end associate
    end subroutine find_own

    !> Handles an event.
    subroutine handle_event(self, number, motion)
        class(nutation_recorder_t), intent(inout) :: self
        integer, intent(in) :: number !! index of the event in `events`
        type(motion_t), intent(in) :: motion !! the motion at the event
        integer :: n
        n = size(self%events)
        if (allocated(self%own)) n = n - size(self%own)
        if (number > n) then
            call handle_own_event(self, number - n, motion, is_noise=.false.)
        else
            call self%event_recorder_t%handle_event(number, motion)
        end if
    end subroutine handle_event

    !> Handles a measured event, or a passage within the noise of its quantity.
    subroutine handle_own_event(self, number, motion, is_noise)
        class(nutation_recorder_t), intent(inout) :: self
        integer, intent(in) :: number
        type(motion_t), intent(in) :: motion
        logical, intent(in) :: is_noise
        type(motion_t) :: given
        integer :: kind

        if (number <= 0) return
        kind = self%own(number)
        given = as_given(self, motion)
        call update_extremes(self, motion, given)
        if (kind /= upper .and. kind /= lower) return
        ! A start at a turning point is not an event, but it is a turning point of the other kind than the
        ! first event.
        if (self%starts_turning .and. .not. is_noise) call self%turns(upper + lower - kind)%add(as_given(self, self%case%start))
        self%starts_turning = .false.
        if (is_noise) then
            call interrupt(self%turns)
            call self%turns(kind)%count_in(given)
        else
            call self%turns(kind)%add(given)
        end if
    end subroutine handle_own_event

    !> Handles a passage within the noise of its quantity.
    subroutine handle_doubtful_event(self, number, motion)
        class(nutation_recorder_t), intent(inout) :: self
        integer, intent(in) :: number !! index of the event in `events`
        type(motion_t), intent(in) :: motion !! the motion at the passage
        if (allocated(self%own)) call handle_own_event(self, number - (size(self%events) - size(self%own)), motion, &
            is_noise=.true.)
    end subroutine handle_doubtful_event

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
        self%end_theta(2) = given%angle(2)
        if (self%measures%turning) call count_end(self%turns, as_given(self, self%case%start), given, given%omega_rate)
        call update_extremes(self, self%here, given)
    end subroutine include_end

    !> Updates the extremes of the rates, of the height of the centre of mass and of the force by a motion, which is given in
    !> the axes of the computation and in those of the body as well.
    subroutine update_extremes(self, motion, given)
        class(nutation_recorder_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion, given
        real(dp) :: gamma(3), height
        if (is_finite(given%rate(1)) .and. abs(given%rate(1)) > abs(self%phi_rate_max) .and. .not. self%is_plane) then
            gamma = vertical_from_quaternion(given%quaternion)
            if (.not. precession_is_lost(gamma(:2), given%omega(:2))) self%phi_rate_max = given%rate(1)
        end if
        height = dot_product(self%case%body%centre_of_mass, vertical_from_quaternion(motion%quaternion))
        self%com_z_min = min(self%com_z_min, height)
        if (self%measures%has_forces()) call update_force_extremes(self, motion, given)
    end subroutine update_extremes

    !> Updates the extremes of the nutation rate and of the support force.
    subroutine update_force_extremes(self, motion, given)
        class(nutation_recorder_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion, given
        type(motion_t) :: here
        real(dp) :: force(3), gamma(3), rate(6), sine

        associate (inertia => self%case%body%inertia)
            gamma = vertical_from_quaternion(motion%quaternion)
            here = motion
            rate = euler_poisson_rate(self%case%body, [gamma, inertia * motion%omega])
            here%omega_rate = rate(4:6) / inertia
        end associate
        force = support_force(self%case%body, here)
        self%force_max = max(self%force_max, norm2(force))
        self%force_z_min = min(self%force_z_min, force(3))
        self%force_z_max = max(self%force_z_max, force(3))
        gamma = vertical_from_quaternion(given%quaternion)
        sine = hypot(gamma(1), gamma(2))
        ! At a pole theta' has two signs, and a limit.
        if (sine > through_pole) then
            self%theta_rate_max = max(self%theta_rate_max, abs(axis_height_rate(given)) / sine)
        else
            self%theta_rate_max = max(self%theta_rate_max, hypot(given%omega(1), given%omega(2)))
        end if
    end subroutine update_force_extremes

    !> The measured nutation; `is_whole` reports whether there was a whole one.
    pure subroutine nutation(self, measured, is_whole)
        class(nutation_recorder_t), intent(in) :: self
        type(nutation_t), intent(out) :: measured !! the nutation as measured
        logical, intent(out) :: is_whole !! whether there is a whole nutation
        call nutation_of(self%turns, self%end_theta, measured, is_whole, self%phi_rate_max)
        if (.not. self%measures%fastest) measured%phi_rate_max = no_number
    end subroutine nutation

    !> Whether turning points were within the noise of the motion.
    pure logical function is_noisy(self)
        class(nutation_recorder_t), intent(in) :: self
        is_noisy = any(self%turns%is_interrupted)
    end function is_noisy

    !> Whether the class is certain although the largest precession rate may lie between the turning points: there may be a
    !> cusp only if the rates at all upper turning points are small compared to that of the nutation. Call after `include_end`.
    pure logical function knows_class(self)
        class(nutation_recorder_t), intent(in) :: self
        type(nutation_t) :: measured
        logical :: is_whole
        call self%nutation(measured, is_whole)
        knows_class = self%measures%fastest .or. self%is_plane .or. .not. is_whole
        if (.not. knows_class) knows_class = any(abs(self%turns(upper)%rate) > class_tolerance * 2 * pi / measured%period)
    end function knows_class

    !> The nutation in a span: the extremes of theta; and if `is_whole`, which reports whether there was a whole nutation,
    !> means over all whole ones between turning points. The class is `no_class` if it changes, or if the largest
    !> precession rate is not given.
    pure subroutine nutation_of(turns, ends, measured, is_whole, phi_rate_max)
        type(turning_points_t), intent(in) :: turns(upper:lower) !! the turning points of both kinds
        real(dp), intent(in) :: ends(2) !! theta at the start and at the end, rad
        type(nutation_t), intent(out) :: measured !! the nutation as measured
        logical, intent(out) :: is_whole !! whether there is a whole nutation
        real(dp), intent(in), optional :: phi_rate_max !! precession rate that is largest in magnitude, rad/s
        integer :: kind, whole

        measured%class = no_class
        measured%phi_rate_max = no_number
        if (present(phi_rate_max)) measured%phi_rate_max = phi_rate_max
        measured%theta_min = min(minval(turns%theta(1)), minval(ends))
        measured%theta_max = max(maxval(turns%theta(2)), maxval(ends))
        measured%delta_u = 2 * sin((measured%theta_max + measured%theta_min) / 2) &
                           * sin((measured%theta_max - measured%theta_min) / 2)
        kind = merge(upper, lower, turns(upper)%n >= turns(lower)%n)
        whole = turns(kind)%n - 1
        is_whole = whole > 0
        if (.not. is_whole) return
        associate (passed => (turns(kind)%last - turns(kind)%first) / whole)
            measured%period = passed(1)
            measured%precession = passed(2)
            measured%spin = passed(3)
        end associate
        measured%precession_rate = measured%precession / measured%period
        measured%spin_rate = measured%spin / measured%period
        if (present(phi_rate_max)) measured%class = class_of(turns, phi_rate_max, measured%period)
    end subroutine nutation_of

    !> The class, from the turning points, the largest precession rate and the period.
    pure integer function class_of(turns, phi_rate_max, period) result(found)
        type(turning_points_t), intent(in) :: turns(upper:lower)
        real(dp), intent(in) :: phi_rate_max, period
        real(dp) :: range, no_rate
        found = no_class
        range = maxval(turns%theta(2)) - minval(turns%theta(1))
        no_rate = class_tolerance * min(abs(phi_rate_max), 2 * pi / period)
        associate (above => turns(upper)%rate, below => turns(lower)%rate)
            if (range <= class_tolerance) then
                found = class_steady
            else if (is_zero(phi_rate_max)) then
                found = merge(class_circulation, class_libration, range >= pi - class_tolerance)
            else if (all(abs(above) <= no_rate)) then
                found = class_cusp
            else if (all([above, below] > 0) .or. all([above, below] < 0)) then
                found = class_wave
            else if (all([above, -below] > 0) .or. all([above, -below] < 0)) then
                found = class_loop
            end if
        end associate
    end function class_of

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

end module spintop_nutation_recorder
