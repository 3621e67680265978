!> What is watched along motions, in lanes and along single ones, and what is measured of a motion by it: whether it came to its
!> event, the extremes of quantities, the turning points of theta, and the energy error.
module spintop_measures
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_kinds, only: dp, pi, no_number, is_zero, cross
    use spintop_event, only: margin, rounding_distance
    use spintop_motion, only: motion_t
    use spintop_nutation, only: class_circulation, class_cusp, class_libration, class_loop, class_steady, class_wave, nutation_t
    use spintop_pole_passages, only: half_turns
    use spintop_poles, only: precession_is_lost
    use spintop_quantities, only: axis_height_rate
    use spintop_status, only: status_bad_input
    implicit none
    private
    public :: quantity_t, quantities, measures_t, growth_t, turns_t, turning_points_t, point_of, upper, lower, no_class
    public :: class_tolerance

    !> The quantities, in the order of the table below; none; phi and psi are in the order of `angles_at`.
    integer, parameter, public :: watch_nothing = 0, watch_phi = 1, watch_psi = 2, watch_turning = 3, watch_theta = 4, &
        watch_omega = 5, watch_vertical = 6, watch_centre_height = 7, watch_kinetic_energy = 8, watch_spin_momentum = 9, &
        watch_vertical_momentum = 10, watch_potential_energy = 11, watch_energy = 12, watch_precession_rate = 13, &
        watch_nutation_rate = 14, watch_vertical_force = 15, watch_total_force = 16
    integer, parameter, public :: watches = watch_total_force

    !> A quantity.
    type :: quantity_t
        character(20) :: name = ''
        !> Which extremes single motions look for: 1 the least values, -1 the largest, 0 both.
        integer :: direction = 0
        !> It is found by equations that hold without effects only.
        logical :: needs_plain_body = .false.
        !> A rate of an angle, of which the largest value in magnitude is kept; a quantity of body z as it was given.
        logical :: is_rate = .false., is_of_axis = .false.
    end type quantity_t

    !> The table of quantities.
    type(quantity_t), parameter :: quantities(watches) = [ &
        quantity_t('phi'), quantity_t('psi'), &
        quantity_t('slope of theta', is_of_axis=.true.), &
        quantity_t('theta'), quantity_t('omega'), quantity_t('vertical'), &
        quantity_t('height', direction=1), &
        quantity_t('kinetic energy'), &
        quantity_t('spin momentum', needs_plain_body=.true.), &
        quantity_t('vertical momentum', needs_plain_body=.true.), &
        quantity_t('potential energy', needs_plain_body=.true.), &
        quantity_t('energy', needs_plain_body=.true.), &
        quantity_t('precession rate', is_rate=.true., is_of_axis=.true.), &
        quantity_t('nutation rate', is_rate=.true., is_of_axis=.true., needs_plain_body=.true.), &
        quantity_t('vertical force', needs_plain_body=.true.), &
        quantity_t('force', direction=-1, needs_plain_body=.true.)]

    !> Kinds of turning points: where theta turns from falling to rising, and from rising to falling.
    integer, parameter :: upper = 1, lower = 2
    !> A turning point is at the end of a motion if it is nearer to it, relative to the time since the one before.
    real(dp), parameter :: at_end = 1.0e-9_dp

    !> What the turning points of one kind were.
    type :: turning_points_t
        integer :: n = 0
        !> Time, s, phi and psi without the half turns at poles, rad, of the first and the last.
        real(dp), dimension(3) :: first = 0, last = 0
        !> Extremes of theta, rad, and of the precession rate there, rad/s.
        real(dp) :: theta(2) = [huge(1.0_dp), -huge(1.0_dp)]
        real(dp) :: rate(2) = [huge(1.0_dp), -huge(1.0_dp)]
    contains
        procedure, private :: count_in
    end type turning_points_t

    !> Turning points of both kinds, each with its time, phi, psi, theta and precession rate. One that is within the noise of the
    !> motion interrupts the count of both kinds, but counts for the extremes: the count ends there, or begins anew if no whole
    !> nutation was counted before.
    type :: turns_t
        type(turning_points_t) :: of(upper:lower) = turning_points_t()
        logical :: is_interrupted = .false.
        logical, private :: has_ended = .false., starts_turning = .false.
        !> The start.
        real(dp) :: start(5) = 0
    contains
        procedure :: begin
        procedure :: add
        procedure :: count_end
    end type turns_t

    !> The growth along a motion: the Lyapunov exponent, 1/s, and the largest singular value, each with its status.
    type :: growth_t
        real(dp) :: exponent = 0, singular = 0
        integer :: exponent_status = status_bad_input, singular_status = status_bad_input
        !> Number of steps of the motion.
        integer(int64) :: steps = 0
    end type growth_t

    integer, private :: k

    !> What is measured of a motion.
    type :: measures_t
        !> Whether the event that ends the motion occurred.
        logical :: event_occurred = .false.
        !> The extremes of each quantity that is watched, in its unit; of rates of angles only `largest`, in magnitude, with its
        !> sign.
        real(dp) :: least(watches) = huge(1.0_dp)
        real(dp) :: largest(watches) = [(merge(0.0_dp, -huge(1.0_dp), quantities(k)%is_rate), k=1, watches)]
        type(turns_t) :: turns = turns_t()
        !> theta at the start and at the end, rad.
        real(dp) :: ends(2) = 0
        !> The largest relative energy error, and the change of phi in T_p, rad, if the motion reached that.
        real(dp) :: energy_error = no_number, azimuth = no_number
        type(growth_t) :: growth = growth_t()
    contains
        procedure :: keep
        procedure :: find_nutation
    end type measures_t

    !> Class of a motion whose nutations belong to several classes.
    integer, parameter :: no_class = 0
    !> A precession rate at the upper turning points within this fraction of the largest one and of that of the nutation, and a
    !> range of theta within this angle, rad, count as zero. Beside a pole the largest one may have any value.
    real(dp), parameter :: class_tolerance = 1.0e-6_dp

contains

    !> Notes the start, which is not an event, but may be a turning point of the other kind than the first event.
    subroutine begin(self, start, omega_rate)
        class(turns_t), intent(out) :: self
        type(motion_t), intent(in) :: start !! the motion in the axes in which the body was given
        real(dp), intent(in) :: omega_rate(3) !! its angular acceleration, rad/s^2
        real(dp) :: slope, terms(4)
        self%start = point_of(start)
        if (.not. is_zero(axis_height_rate(start))) return
        call find_bend(start, omega_rate, slope, terms)
        self%starts_turning = abs(sum(terms)) > margin * rounding_distance * sum(abs(terms))
    end subroutine begin

    !> Time, s, phi and psi without the half turns at poles, theta, rad, and precession rate, rad/s, of a motion.
    pure function point_of(motion) result(point)
        type(motion_t), intent(in) :: motion
        real(dp) :: point(5)
        point = [motion%t, motion%angle(1:3:2) - pi * half_turns(motion%passed), motion%angle(2), motion%rate(1)]
    end function point_of

    !> Adds the next turning point, or one that is within the noise of the motion.
    pure subroutine add(self, kind, point, is_noise)
        class(turns_t), intent(inout) :: self
        integer, intent(in) :: kind !! `upper` or `lower`
        real(dp), intent(in) :: point(5) !! as by `point_of`
        logical, intent(in) :: is_noise !! whether it is within the noise
        if (self%starts_turning .and. .not. is_noise) call self%of(upper + lower - kind)%count_in(self%start, .not. self%has_ended)
        self%starts_turning = .false.
        if (is_noise) then
            self%is_interrupted = .true.
            self%has_ended = any(self%of%n > 1)
            if (.not. self%has_ended) self%of%n = 0
        end if
        call self%of(kind)%count_in(point, .not. (is_noise .or. self%has_ended))
    end subroutine add

    !> Adds a turning point to those of its kind: to their extremes, and if it counts to the others.
    pure subroutine count_in(self, point, counts)
        class(turning_points_t), intent(inout) :: self
        real(dp), intent(in) :: point(5)
        logical, intent(in) :: counts
        self%theta = [min(self%theta(1), point(4)), max(self%theta(2), point(4))]
        self%rate = [min(self%rate(1), point(5)), max(self%rate(2), point(5))]
        if (.not. counts) return
        self%last = point(:3)
        if (self%n == 0) self%first = self%last
        self%n = self%n + 1
    end subroutine count_in

    !> Counts the end of a motion that ends in a turning point, as at an event: whether rounding errors put it before or
    !> after the end does not matter.
    pure subroutine count_end(self, last, omega_rate)
        class(turns_t), intent(inout) :: self
        type(motion_t), intent(in) :: last !! the end of the motion in the axes in which the body was given
        real(dp), intent(in) :: omega_rate(3) !! angular acceleration then, rad/s^2
        real(dp) :: slope, terms(4), bend, since
        integer :: kind, before

        if (self%is_interrupted) return
        call find_bend(last, omega_rate, slope, terms)
        bend = sum(terms)
        kind = merge(upper, lower, bend < 0)
        before = upper + lower - kind
        since = last%t - self%start(1)
        if (self%of(before)%n > 0) since = last%t - self%of(before)%last(1)
        if (.not. abs(slope) < at_end * abs(bend) * since) return
        if (self%of(kind)%n > 0) then
            ! The last one may be this one.
            if (self%of(before)%n == 0 .or. self%of(kind)%last(1) > self%of(before)%last(1)) return
        end if
        call self%add(kind, point_of(last), is_noise=.false.)
    end subroutine count_end

    !> The slope of the height of body z, and the terms of its second derivative.
    pure subroutine find_bend(motion, omega_rate, slope, terms)
        type(motion_t), intent(in) :: motion
        real(dp), intent(in) :: omega_rate(3)
        real(dp), intent(out) :: slope, terms(4)
        real(dp) :: gamma(3), gamma_rate(3)
        gamma = vertical_from_quaternion(motion%quaternion)
        gamma_rate = cross(gamma, motion%omega)
        slope = gamma_rate(3)
        terms = [gamma_rate(1) * motion%omega(2), -gamma_rate(2) * motion%omega(1), &
                 gamma(1) * omega_rate(2), -gamma(2) * omega_rate(1)]
    end subroutine find_bend

    !> Keeps a value of a quantity if it is the least or the largest up to now: where the slope rises the least, where it falls
    !> the largest, at an end of the motion, which has none, either.
    pure subroutine keep(self, watch, value, slope, gamma, omega)
        class(measures_t), intent(inout) :: self
        integer, intent(in) :: watch !! the quantity
        real(dp), intent(in) :: value, slope !! its value, and what has the sign of its slope's slope; 0 at an end
        real(dp), intent(in) :: gamma(2), omega(2) !! components of the vertical and the angular velocity along body x and y
        associate (least => self%least(watch), largest => self%largest(watch))
            if (.not. quantities(watch)%is_rate) then
                if (value < least .and. slope >= 0) least = value
                if (value > largest .and. slope <= 0) largest = value
            else if (abs(value) > abs(largest) .and. abs(value) <= huge(value)) then
                if (watch == watch_precession_rate) then
                    if (precession_is_lost(gamma, omega)) return
                end if
                largest = value
            end if
        end associate
    end subroutine keep

    !> The nutation in a span: the extremes of theta; and if `is_whole`, which reports whether there was a whole nutation,
    !> means over all whole ones between turning points. The class is `no_class` if it changes.
    pure subroutine find_nutation(self, measured, is_whole)
        class(measures_t), intent(in) :: self
        type(nutation_t), intent(out) :: measured !! the nutation as measured
        logical, intent(out) :: is_whole !! whether there is a whole nutation
        real(dp) :: passed(3)
        integer :: kind

        measured%class = no_class
        measured%phi_rate_max = self%largest(watch_precession_rate)
        associate (turns => self%turns%of)
            measured%theta_min = min(minval(turns%theta(1)), minval(self%ends))
            measured%theta_max = max(maxval(turns%theta(2)), maxval(self%ends))
            measured%delta_u = 2 * sin((measured%theta_max + measured%theta_min) / 2) &
                               * sin((measured%theta_max - measured%theta_min) / 2)
            kind = merge(upper, lower, turns(upper)%n >= turns(lower)%n)
            is_whole = turns(kind)%n > 1
            if (.not. is_whole) return
            passed = (turns(kind)%last - turns(kind)%first) / (turns(kind)%n - 1)
            measured%period = passed(1)
            measured%precession = passed(2)
            measured%spin = passed(3)
            measured%precession_rate = measured%precession / measured%period
            measured%spin_rate = measured%spin / measured%period
            measured%class = class_of(turns, measured%phi_rate_max, measured%period)
        end associate
    end subroutine find_nutation

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

end module spintop_measures
