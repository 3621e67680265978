!> Measures the nutation of a motion without a closed form by events: the turning points of theta, the maxima
!> of the precession rate, and the minima of the height of the centre of mass.
module spintop_nutation_watch
    use spintop_kinds, only: dp, pi
    use spintop_case, only: case_t
    use spintop_compare, only: is_finite, is_zero
    use spintop_event_recorder, only: event_recorder_t
    use spintop_events, only: event_t
    use spintop_motion, only: motion_t
    use spintop_nutation, only: nutation_t, class_loop, class_cusp, class_wave, class_steady, &
        class_libration, class_circulation
    use spintop_quantities, only: axis_height_rate
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_turning_record, only: turning_points_t, upper, lower
    use spintop_vectors, only: cross
    implicit none
    private
    public :: nutation_watch_t, nutation_of, no_class

    !> Class of a motion whose nutations belong to several classes.
    integer, parameter :: no_class = 0

    !> The measured events, which follow those of the scene.
    integer, parameter :: lowest_centre = 3, fastest(2) = [4, 5], own_events = 5

    !> A precession rate at the upper turning points within this fraction of the largest one, and a range of
    !> theta within this angle, rad, count as zero.
    real(dp), parameter :: class_tolerance = 1.0e-6_dp

    !> Searches for the events of the scene, and measures the nutation on request.
    type, extends(event_recorder_t) :: nutation_watch_t
        !> Minimum height of the centre of mass so far, m.
        real(dp) :: com_z_min = huge(1.0_dp)
        type(case_t), private :: case
        logical, private :: measures = .false., starts_turning = .false.
        type(turning_points_t), private :: turns(upper:lower)
        real(dp), private :: phi_rate_max = 0
    contains
        procedure :: measure_nutation
        procedure :: quantities
        procedure :: meet
        procedure :: nutation
        procedure :: take_end
        procedure, private :: take_extremes
    end type nutation_watch_t

contains

    !> Requests the measurement of the nutation; call after `set`.
    subroutine measure_nutation(self, case)
        class(nutation_watch_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! body, start and span
        self%measures = .true.
        self%case = case
        self%events = [self%events, event_t('upper', -1), event_t('lower', 1), event_t('lowest', 1), &
                       event_t('fastest', 1), event_t('fastest', -1)]
        ! The precession is fastest near a pole.
        self%pole_axis = [0.0_dp, 0.0_dp, 1.0_dp]
        self%starts_turning = is_zero(axis_height_rate(case%start))
        call self%take_extremes(case%start)
    end subroutine measure_nutation

    !> The quantities of the events of the scene, and of the measured ones.
    subroutine quantities(self, motion, values)
        class(nutation_watch_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion at an instant
        real(dp), intent(out) :: values(:) !! one value for each event
        real(dp) :: own(own_events), gamma(3), gamma_rate(3)
        integer :: n

        n = size(values)
        if (self%measures) then
            n = n - own_events
            gamma = vertical_from_quaternion(motion%quaternion)
            gamma_rate = cross(gamma, motion%omega)
            own([upper, lower]) = axis_height_rate(motion)
            own(lowest_centre) = dot_product(self%case%body%centre_of_mass, gamma_rate)
            own(fastest) = precession_slope(gamma, gamma_rate, motion%omega, motion%omega_rate)
            values(n + 1:) = own
        end if
        if (n > 0) call self%event_recorder_t%quantities(motion, values(:n))
    end subroutine quantities

    !> Angular acceleration of phi times sin(theta)^4, which is smooth at the poles; from phi' = (gamma1
    !> omega1 + gamma2 omega2)/sin(theta)^2.
    pure real(dp) function precession_slope(gamma, gamma_rate, omega, omega_rate) result(slope)
        real(dp), intent(in), dimension(3) :: gamma, gamma_rate, omega, omega_rate
        associate (turn => dot_product(gamma(1:2), omega(1:2)), sine2 => sum(gamma(1:2)**2))
            slope = (dot_product(gamma_rate(1:2), omega(1:2)) + dot_product(gamma(1:2), omega_rate(1:2))) * sine2 &
                    - 2 * turn * dot_product(gamma(1:2), gamma_rate(1:2))
        end associate
    end function precession_slope

    !> Receives an event.
    subroutine meet(self, number, motion)
        class(nutation_watch_t), intent(inout) :: self
        integer, intent(in) :: number !! index of the event in `events`
        type(motion_t), intent(in) :: motion !! the motion at the event
        integer :: kind

        kind = 0
        if (self%measures) kind = number - (size(self%events) - own_events)
        if (kind <= 0) then
            call self%event_recorder_t%meet(number, motion)
            return
        end if
        call self%take_extremes(motion)
        if (kind /= upper .and. kind /= lower) return
        ! A start at a turning point is not an event, but it is a turning point of the other kind than the
        ! first event.
        if (self%starts_turning) call self%turns(upper + lower - kind)%take(self%case%start)
        self%starts_turning = .false.
        call self%turns(kind)%take(motion)
    end subroutine meet

    !> Includes the end of the motion, where the precession rate and the height may have their extremes.
    subroutine take_end(self)
        class(nutation_watch_t), intent(inout) :: self
        call self%take_extremes(self%here)
    end subroutine take_end

    !> Updates the extremes of the precession rate and of the height of the centre of mass.
    subroutine take_extremes(self, motion)
        class(nutation_watch_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        if (is_finite(motion%rate(1)) .and. abs(motion%rate(1)) > abs(self%phi_rate_max)) then
            self%phi_rate_max = motion%rate(1)
        end if
        self%com_z_min = min(self%com_z_min, dot_product(self%case%body%centre_of_mass, &
                                                         vertical_from_quaternion(motion%quaternion)))
    end subroutine take_extremes

    !> The measured nutation; `seen` reports whether there was a whole one.
    subroutine nutation(self, measured, seen)
        class(nutation_watch_t), intent(in) :: self
        type(nutation_t), intent(out) :: measured !! the nutation as measured
        logical, intent(out) :: seen !! whether there is a whole nutation
        call nutation_of(self%turns, measured, seen, self%phi_rate_max)
    end subroutine nutation

    !> The nutation between turning points: means over all whole nutations, extremes over all turning points;
    !> `seen` reports whether there was a whole one. The class is `no_class` if it changes, or if the largest
    !> precession rate is not given.
    pure subroutine nutation_of(turns, measured, seen, phi_rate_max)
        type(turning_points_t), intent(in) :: turns(upper:lower) !! the turning points of both kinds
        type(nutation_t), intent(out) :: measured !! the nutation as measured
        logical, intent(out) :: seen !! whether there is a whole nutation
        real(dp), intent(in), optional :: phi_rate_max !! precession rate that is largest in magnitude, rad/s
        integer :: kind, whole

        measured%class = no_class
        kind = merge(upper, lower, turns(upper)%n >= turns(lower)%n)
        whole = turns(kind)%n - 1
        seen = whole > 0
        if (.not. seen) return
        measured%theta_min = min(turns(upper)%theta(1), turns(lower)%theta(1))
        measured%theta_max = max(turns(upper)%theta(2), turns(lower)%theta(2))
        measured%delta_u = 2 * sin((measured%theta_max + measured%theta_min) / 2) &
                           * sin((measured%theta_max - measured%theta_min) / 2)
        associate (passed => (turns(kind)%last - turns(kind)%first) / whole)
            measured%period = passed(1)
            measured%precession = passed(2)
            measured%spin = passed(3)
        end associate
        measured%precession_rate = measured%precession / measured%period
        measured%spin_rate = measured%spin / measured%period
        if (.not. present(phi_rate_max)) return
        measured%phi_rate_max = phi_rate_max
        measured%class = class_of(turns(upper)%rate, turns(lower)%rate, measured)
    end subroutine nutation_of

    !> The class, from the extremes of the precession rate at the upper and the lower turning points.
    pure integer function class_of(above, below, measured) result(found)
        real(dp), intent(in) :: above(2), below(2)
        type(nutation_t), intent(in) :: measured
        found = no_class
        if (measured%theta_max - measured%theta_min <= class_tolerance) then
            found = class_steady
        else if (is_zero(measured%phi_rate_max)) then
            found = merge(class_circulation, class_libration, &
                          measured%theta_max - measured%theta_min >= pi - class_tolerance)
        else if (all(abs(above) <= class_tolerance * abs(measured%phi_rate_max))) then
            found = class_cusp
        else if (all([above, below] > 0) .or. all([above, below] < 0)) then
            found = class_wave
        else if (all([above, -below] > 0) .or. all([above, -below] < 0)) then
            found = class_loop
        end if
    end function class_of

end module spintop_nutation_watch
