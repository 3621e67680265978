!> Growth of perturbations along motions: the Lyapunov exponent, the mean rate at which one of no special direction grows
!> (Benettin, Galgani, Giorgilli and Strelcyn, Meccanica 15, 1980), and the largest singular value of the tangent map, the largest
!> factor by which one grows that keeps the length of the vertical. Many motions are followed together, in lanes.
!>
!> Perturbations are measured in the scales of the motion (`state_units`): no result depends on the units of mass, length and time.
module spintop_lyapunov
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_body, only: body_t
    use spintop_kinds, only: dp, is_finite, cross
    use spintop_euler_poisson, only: euler_poisson_rate, euler_poisson_state, state_units
    use spintop_integration, only: outcome_t
    use spintop_taylor_lanes, only: lane_monitor_t, monitor_slot_t, lane_order, lanes, taylor_lanes_t, integrate_many
    use spintop_lapack, only: dgesvd
    use spintop_measures, only: growth_t, measures_t
    use spintop_motion, only: motion_t
    use spintop_status, only: is_ok, status_bad_input, status_non_finite, status_ok, status_step_limit
    use spintop_stepper, only: controls_t
    use spintop_tangent_lanes, only: components, tangent_lanes_t
    use spintop_validity, only: plain_body_status, motion_status
    implicit none
    private
    public :: growth_lanes_t, growth_t, find_growth, find_lyapunov, find_largest_singular_value
    public :: scales_of, span_perturbations, even_perturbation, scale_up

    !> The last terms of a perturbation may exceed the tolerance of the motion by this factor: each is to be
    !> multiplied by its number, compared with those of the motion.
    real(dp), parameter :: slack = 100
    !> A tolerance below is not reached.
    real(dp), parameter :: least_tolerance = 1.0e-15_dp
    !> Tolerance of motions that are integrated for the growth alone.
    real(dp), parameter :: own_tolerance = 1.0e-14_dp

    !> The slope of a motion, in its scales, below which it is not one of the perturbations: its errors are those of the motion.
    real(dp), parameter :: slow = 0.0625_dp

    !> Monitors perturbations: one that has no special direction, for the exponent; or all that keep the length of the
    !> vertical, for the singular value: `tangents`. One of these, the last, is the change along the motion, which is its slope and
    !> need not be carried. `set`, then hand it over.
    type, extends(lane_monitor_t) :: growth_lanes_t
        !> Whether the singular value is found; whether the exponent is.
        logical :: is_singular = .false., has_exponent = .true.
        !> The perturbation of the exponent is the sum of all times this.
        real(dp), private :: share(5, lanes) = 0
        !> The last perturbation is the slope of the motion times this, s; 0 where it is carried.
        real(dp), private :: along(lanes) = 0
        type(tangent_lanes_t) :: tangents
        real(dp), private :: inertia(3, lanes) = 1, unit(6, lanes) = 1
    contains
        procedure :: set
        procedure :: begin
        procedure :: observe
        procedure :: finish
    end type growth_lanes_t

contains

    !> What is to be found, and for motions of which tolerance and number of steps.
    subroutine set(self, controls, is_singular, with_exponent)
        class(growth_lanes_t), intent(inout) :: self
        type(controls_t), intent(in) :: controls !! settings of the method
        logical, intent(in) :: is_singular !! the largest singular value, not the exponent
        logical, intent(in), optional :: with_exponent !! the exponent beside the singular value
        real(dp) :: tolerance
        self%is_singular = is_singular
        self%has_exponent = .not. is_singular
        if (present(with_exponent)) self%has_exponent = with_exponent .or. .not. is_singular
        self%along = merge(1, 0, is_singular)
        tolerance = slack * max(controls%relative_tolerance, least_tolerance)
        call self%tangents%set(merge(5, 1, is_singular), tolerance, lane_order(tolerance), controls%max_steps)
    end subroutine set

    !> A case begins in a lane.
    subroutine begin(self, run, lane, body, start)
        class(growth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: x(6), z(components, size(self%tangents%z, 3)), vectors(6, size(self%tangents%z, 3)), even(6), mirror(5)
        integer :: v

        x = euler_poisson_state(body, start)
        associate (unit => self%unit(:, lane))
            unit = scales_of(body, x, run%now%t_end(lane))
            self%inertia(:, lane) = body%inertia
            if (self%is_singular) then
                call span_perturbations(x(1:3), unit, vectors)
                mirror = matmul(euler_poisson_rate(body, x) / unit, vectors / spread(unit, 2, 5))
                self%along(lane) = 0
                if (norm2(mirror) > slow * run%now%scale(lane)) then
                    ! Mirrored, so that the last one is that along the motion.
                    self%along(lane) = -sign(1 / norm2(mirror), mirror(5))
                    mirror(5) = mirror(5) + sign(norm2(mirror), mirror(5))
                    mirror = mirror / norm2(mirror)
                    vectors = vectors - 2 * spread(matmul(vectors, mirror), 2, 5) * spread(mirror, 1, 6)
                end if
                even = even_perturbation(x(1:3), unit) / unit
                self%share(:, lane) = matmul(even / norm2(even), vectors / spread(unit, 2, size(vectors, 2)))
            else
                vectors(:, 1) = even_perturbation(x(1:3), unit)
                vectors(:, 1) = vectors(:, 1) / norm2(vectors(:, 1) / unit)
                self%share(1, lane) = 1
            end if
        end associate
        do v = 1, size(z, 2)
            z(1:3, v) = vectors(4:6, v) / body%inertia
            z(4:6, v) = cross(vectors(1:3, v), x(1:3))
        end do
        if (abs(self%along(lane)) > 0) z(:, 5) = 0
        call self%tangents%load(run, lane, z)
    end subroutine begin

    !> Propagates the perturbations over the last step.
    subroutine observe(self, run)
        class(growth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        integer :: i
        associate (c => run%c, along => self%along)
            do i = 1, lanes
                if (.not. (abs(along(i)) > 0 .and. run%now%t(i) > run%now%t_last(i))) cycle
                if (sum(c(i, 4:6, 1)**2) + sum((self%inertia(:, i) * c(i, 1:3, 1) / self%unit(4, i))**2) &
                    > (slow * run%now%scale(i))**2) cycle
                call set_along(self, i, c(i, 1:3, 0), c(i, 1:3, 1))
                along(i) = 0
            end do
            self%tangents%carried = size(self%tangents%z, 3) - merge(1, 0, all(abs(along) > 0))
        end associate
        call self%tangents%propagate(run)
    end subroutine observe

    !> Sets the last perturbation in a lane, the change along the motion.
    pure subroutine set_along(self, lane, omega, omega_rate)
        class(growth_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane
        real(dp), intent(in) :: omega(3), omega_rate(3)
        self%tangents%z(lane, :, 5) = scale(self%along(lane) * [omega_rate, omega], -self%tangents%doublings(lane))
    end subroutine set_along

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, last, found)
        class(growth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(motion_t), intent(in) :: last !! the motion at the end
        type(measures_t), intent(inout) :: found !! what is measured of the case
        real(dp) :: vectors(6, size(self%tangents%z, 3)), z(components), growth
        integer :: v

        if (.not. run%now%t(lane) > 0) return
        associate (found => found%growth)
            found%exponent_status = self%tangents%status(lane)
            found%singular_status = found%exponent_status
            if (.not. is_ok(found%exponent_status)) return
            if (abs(self%along(lane)) > 0) call set_along(self, lane, last%omega, last%omega_rate)
            do v = 1, size(vectors, 2)
                z = self%tangents%z(lane, :, v)
                vectors(:, v) = [cross(run%now%state(lane, 4:6), z(4:6)), self%inertia(:, lane) * z(1:3)] / self%unit(:, lane)
            end do
            growth = log(2.0_dp) * self%tangents%doublings(lane)
            if (self%is_singular) call scale_up(vectors, growth, found%singular, found%singular_status)
            growth = growth + log(norm2(matmul(vectors, self%share(:size(vectors, 2), lane))))
            if (is_finite(growth)) then
                found%exponent = growth / run%now%t(lane)
            else
                found%exponent_status = status_non_finite
            end if
        end associate
    end subroutine finish

    !> The growth of perturbations of the motions of bodies over spans: the Lyapunov exponents, the largest singular
    !> values of the tangent maps, or both.
    subroutine find_growth(bodies, starts, t_end, with_exponent, with_singular, max_steps, growth)
        type(body_t), intent(in) :: bodies(:) !! mass properties about the fixed point, one for each case
        type(motion_t), intent(in) :: starts(:) !! attitude and angular velocity at the start, one for each case
        real(dp), intent(in) :: t_end(:) !! ends of the spans, one for each case, s
        logical, intent(in) :: with_exponent, with_singular !! what is to be found
        integer(int64), intent(in) :: max_steps !! maximum number of steps for a case
        type(growth_t), intent(out) :: growth(:) !! what was found, one for each case
        type(monitor_slot_t) :: monitors(1)
        type(growth_lanes_t) :: monitor
        type(measures_t), allocatable :: measures(:)
        type(motion_t), allocatable :: ends(:)
        type(outcome_t), allocatable :: outcomes(:)
        type(controls_t) :: controls

        controls%relative_tolerance = own_tolerance
        controls%absolute_tolerance = own_tolerance
        controls%max_steps = max_steps
        call monitor%set(controls, with_singular, with_exponent)
        allocate (monitors(1)%monitor, source=monitor)
        allocate (ends(size(bodies)), outcomes(size(bodies)), measures(size(bodies)))
        call integrate_many(controls, bodies, starts, t_end, ends, outcomes, monitors, measures)
        growth = measures%growth
        growth%steps = outcomes%counts%steps
        where (.not. is_ok(outcomes%status))
            growth%exponent_status = outcomes%status
            growth%singular_status = outcomes%status
        end where
    end subroutine find_growth

    !> The largest Lyapunov exponent of a motion over `t_end` seconds, 1/s: of a perturbation with equal components in the scales
    !> of the motion, across the vertical. It tends to its limit like log(t)/t.
    subroutine find_lyapunov(body, start, t_end, exponent, status, max_steps, steps)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: t_end !! length of the span, s
        real(dp), intent(out) :: exponent !! 1/s; 0 unless `status_ok`
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        integer, intent(in), optional :: max_steps !! maximum number of steps
        integer, intent(out), optional :: steps !! number of steps
        type(growth_t) :: growth
        call find_one(body, start, t_end, .false., growth, status, max_steps, steps)
        if (is_ok(status)) status = growth%exponent_status
        exponent = merge(growth%exponent, 0.0_dp, is_ok(status))
    end subroutine find_lyapunov

    !> The largest singular value of the tangent map of a motion over `t_end` seconds, in the scales of its start.
    subroutine find_largest_singular_value(body, start, t_end, factor, status, max_steps, steps)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: t_end !! length of the span, s
        real(dp), intent(out) :: factor !! 0 unless `status_ok`
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        integer, intent(in), optional :: max_steps !! maximum number of steps
        integer, intent(out), optional :: steps !! number of steps
        type(growth_t) :: growth
        call find_one(body, start, t_end, .true., growth, status, max_steps, steps)
        if (is_ok(status)) status = growth%singular_status
        factor = merge(growth%singular, 0.0_dp, is_ok(status))
    end subroutine find_largest_singular_value

    !> The growth of perturbations of one motion. `status_bad_input`: no positive span; `status_non_finite`, `status_bad_body`,
    !> `status_bad_start`, `status_unsuitable`: no body or no motion, or one with effects.
    subroutine find_one(body, start, t_end, is_singular, growth, status, max_steps, steps)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: t_end
        logical, intent(in) :: is_singular
        type(growth_t), intent(out) :: growth
        integer, intent(out) :: status
        integer, intent(in), optional :: max_steps
        integer, intent(out), optional :: steps
        type(controls_t) :: defaults
        type(growth_t) :: found(1)
        integer(int64) :: most_steps
        if (present(steps)) steps = 0
        status = status_bad_input
        if (.not. (t_end > 0 .and. is_finite(t_end))) return
        status = plain_body_status(body)
        if (is_ok(status)) status = motion_status(start, body)
        if (.not. is_ok(status)) return
        most_steps = defaults%max_steps
        if (present(max_steps)) most_steps = max_steps
        status = status_step_limit
        if (most_steps < 1) return
        call find_growth([body], [start], [t_end], .not. is_singular, is_singular, most_steps, found)
        growth = found(1)
        status = status_ok
        if (present(steps)) steps = int(growth%steps)
    end subroutine find_one

    !> The largest singular value of a matrix times e^growth. `status_non_finite`: it is not a number, or overflows.
    subroutine scale_up(matrix, growth, factor, status)
        real(dp), intent(in) :: matrix(6, 5), growth !! perturbations, one per column; logarithm of their factor
        real(dp), intent(out) :: factor !! 0 unless `status_ok`
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: a(6, 5), values(5), u(1, 1), v(1, 1), work(64)
        integer :: failure
        factor = 0
        status = status_non_finite
        if (.not. all(is_finite(matrix))) return
        a = matrix
        call dgesvd('N', 'N', 6, 5, a, 6, values, u, 1, v, 1, work, size(work), failure)
        if (failure /= 0 .or. .not. growth + log(values(1)) < log(huge(1.0_dp))) return
        factor = exp(growth + log(values(1)))
        status = status_ok
    end subroutine scale_up

    !> The perturbation with equal components in the scales `unit`, without its part along the vertical.
    pure function even_perturbation(vertical, unit) result(vector)
        real(dp), intent(in) :: vertical(3), unit(6) !! unit vector; scales of (Gamma, Pi)
        real(dp) :: vector(6)
        vector = unit
        vector(1:3) = vector(1:3) - dot_product(vertical, vector(1:3)) * vertical
    end function even_perturbation

    !> Perturbations, orthonormal in the scales `unit`, that keep the norm of the vertical: two of the
    !> vertical, across it, and three of the momentum.
    pure subroutine span_perturbations(vertical, unit, vectors)
        real(dp), intent(in) :: vertical(3), unit(6) !! unit vector; scales of (Gamma, Pi)
        real(dp), intent(out) :: vectors(6, 5) !! perturbations, one per column
        real(dp) :: across(3)
        integer :: i
        across = 0
        across(minloc(abs(vertical), dim=1)) = 1
        across = cross(vertical, across)
        across = across / norm2(across)
        vectors = 0
        vectors(1:3, 1) = across
        vectors(1:3, 2) = cross(vertical, across)
        do i = 4, 6
            vectors(i, i - 1) = unit(i)
        end do
    end subroutine span_perturbations

    !> The scales of a state; for a body at rest without weight, those of a rotation by one radian in the
    !> span.
    pure function scales_of(body, x, t_end) result(unit)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: x(6), t_end !! state (Gamma, Pi); length of the span, s
        real(dp) :: unit(6)
        unit = state_units(body, x)
        if (all(abs([x(4:6), body%weight_moment()]) <= 0)) unit(4:6) = maxval(body%inertia) / t_end
    end function scales_of

end module spintop_lyapunov
