!> Measures the nutation of a motion that has no closed form, by its events on the way: the turning
!> points of theta, where the precession is fastest, and where the centre of mass is lowest.
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
    use spintop_vectors, only: cross
    implicit none
    private
    public :: nutation_watch_t, no_class

    !> Class of a motion whose nutations are of several classes.
    integer, parameter :: no_class = 0

    !> The events measured, after those that the scene asks for.
    integer, parameter :: upper = 1, lower = 2, lowest_centre = 3, fastest(2) = [4, 5], own_events = 5

    !> A precession rate at the upper turning points within this share of the largest, and a swing
    !> of theta within this angle, rad, are none.
    real(dp), parameter :: class_tolerance = 1.0e-6_dp

    !> What the turning points of one kind were.
    type :: turns_t
        integer :: n = 0
        type(motion_t) :: first, last
        !> Extremes of theta, rad, and of the precession rate there, rad/s.
        real(dp) :: theta(2) = [huge(1.0_dp), -huge(1.0_dp)]
        real(dp) :: rate(2) = [huge(1.0_dp), -huge(1.0_dp)]
    contains
        procedure :: take
    end type turns_t

    !> Looks for the events of the scene, and measures the nutation where it is told to.
    type, extends(event_recorder_t) :: nutation_watch_t
        !> Lowest height of the centre of mass so far, m.
        real(dp) :: com_z_min = huge(1.0_dp)
        type(case_t), private :: case
        logical, private :: measures = .false., starts_turning = .false.
        type(turns_t), private :: turns(upper:lower)
        real(dp), private :: phi_rate_max = 0
    contains
        procedure :: measure_nutation
        procedure :: quantities
        procedure :: meet
        procedure :: nutation
        procedure, private :: take_extremes
    end type nutation_watch_t

contains

    !> Measures the nutation, too; after `set`.
    subroutine measure_nutation(self, case)
        class(nutation_watch_t), intent(inout) :: self
        type(case_t), intent(in) :: case
        self%measures = .true.
        self%case = case
        self%events = [self%events, event_t('upper', -1), event_t('lower', 1), event_t('lowest', 1), &
                       event_t('fastest', 1), event_t('fastest', -1)]
        ! The precession is fastest near a pole.
        self%pole_axis = [0.0_dp, 0.0_dp, 1.0_dp]
        self%starts_turning = is_zero(axis_height_rate(case%start))
        call self%take_extremes(case%start)
    end subroutine measure_nutation

    !> The quantities of the events of the scene, and of those measured.
    subroutine quantities(self, motion, values)
        class(nutation_watch_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        real(dp), intent(out) :: values(:)
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

    !> Acceleration of phi times sin(theta)^4: what is smooth at the poles, of
    !> phi' = (gamma1 omega1 + gamma2 omega2)/sin(theta)^2.
    pure real(dp) function precession_slope(gamma, gamma_rate, omega, omega_rate) result(slope)
        real(dp), intent(in), dimension(3) :: gamma, gamma_rate, omega, omega_rate
        associate (turn => dot_product(gamma(1:2), omega(1:2)), sine2 => sum(gamma(1:2)**2))
            slope = (dot_product(gamma_rate(1:2), omega(1:2)) + dot_product(gamma(1:2), omega_rate(1:2))) * sine2 &
                    - 2 * turn * dot_product(gamma(1:2), gamma_rate(1:2))
        end associate
    end function precession_slope

    !> Takes an event.
    subroutine meet(self, number, motion)
        class(nutation_watch_t), intent(inout) :: self
        integer, intent(in) :: number
        type(motion_t), intent(in) :: motion
        integer :: kind

        kind = 0
        if (self%measures) kind = number - (size(self%events) - own_events)
        if (kind <= 0) then
            call self%event_recorder_t%meet(number, motion)
            return
        end if
        call self%take_extremes(motion)
        if (kind /= upper .and. kind /= lower) return
        ! A start at a turning point is no event, but it is one of the other kind than the first.
        if (self%starts_turning) call self%turns(upper + lower - kind)%take(self%case%start)
        self%starts_turning = .false.
        call self%turns(kind)%take(motion)
    end subroutine meet

    !> Takes the precession rate and the height of the centre of mass.
    subroutine take_extremes(self, motion)
        class(nutation_watch_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        if (is_finite(motion%rate(1)) .and. abs(motion%rate(1)) > abs(self%phi_rate_max)) then
            self%phi_rate_max = motion%rate(1)
        end if
        self%com_z_min = min(self%com_z_min, dot_product(self%case%body%centre_of_mass, &
                                                         vertical_from_quaternion(motion%quaternion)))
    end subroutine take_extremes

    !> Takes a turning point.
    subroutine take(self, motion)
        class(turns_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        if (self%n == 0) self%first = motion
        self%last = motion
        self%n = self%n + 1
        self%theta = [min(self%theta(1), motion%angle(2)), max(self%theta(2), motion%angle(2))]
        self%rate = [min(self%rate(1), motion%rate(1)), max(self%rate(2), motion%rate(1))]
    end subroutine take

    !> The nutation as measured: means over all the whole nutations seen, extremes over all turning
    !> points; `seen` tells whether there was a whole one. The class is `no_class` where it changes.
    subroutine nutation(self, measured, seen)
        class(nutation_watch_t), intent(in) :: self
        type(nutation_t), intent(out) :: measured
        logical, intent(out) :: seen
        integer :: kind, whole

        kind = merge(upper, lower, self%turns(upper)%n >= self%turns(lower)%n)
        whole = self%turns(kind)%n - 1
        seen = whole > 0
        if (.not. seen) return
        measured%theta_min = min(self%turns(upper)%theta(1), self%turns(lower)%theta(1))
        measured%theta_max = max(self%turns(upper)%theta(2), self%turns(lower)%theta(2))
        measured%delta_u = 2 * sin((measured%theta_max + measured%theta_min) / 2) &
                           * sin((measured%theta_max - measured%theta_min) / 2)
        associate (first => self%turns(kind)%first, last => self%turns(kind)%last)
            measured%period = (last%t - first%t) / whole
            measured%precession = (last%angle(1) - first%angle(1)) / whole
            measured%spin = (last%angle(3) - first%angle(3)) / whole
        end associate
        measured%precession_rate = measured%precession / measured%period
        measured%spin_rate = measured%spin / measured%period
        measured%phi_rate_max = self%phi_rate_max
        measured%class = class_of(self%turns(upper)%rate, self%turns(lower)%rate, measured)
    end subroutine nutation

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
