!> Growth of perturbations along the motions in lanes: the Lyapunov exponent, and the largest singular value of the
!> tangent map, as in `spintop_lyapunov`.
module spintop_lyapunov_lanes
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_euler_poisson, only: euler_poisson_state
    use spintop_integration, only: outcome_t
    use spintop_kinds, only: dp
    use spintop_lane_monitor, only: lane_monitor_t, monitor_slot_t
    use spintop_lyapunov, only: even_perturbation, scale_up, scales_of, span_perturbations
    use spintop_many_bodies, only: integrate_many
    use spintop_motion, only: motion_t
    use spintop_status, only: is_ok, status_bad_input, status_non_finite
    use spintop_stepper, only: controls_t
    use spintop_tangent_lanes, only: components, tangent_lanes_t
    use spintop_taylor_lanes, only: lane_order, lanes, taylor_lanes_t
    use spintop_vectors, only: cross
    implicit none
    private
    public :: growth_lanes_t, growth_t, find_growth

    !> The last terms of a perturbation may exceed the tolerance of the motion by this factor: each is to be
    !> multiplied by its number, compared with those of the motion.
    real(dp), parameter :: slack = 100
    !> A tolerance below is not reached.
    real(dp), parameter :: least_tolerance = 1.0e-15_dp
    !> Tolerance of motions that are integrated for the growth alone.
    real(dp), parameter :: own_tolerance = 1.0e-14_dp

    !> The growth along a motion: the Lyapunov exponent, 1/s, and the largest singular value, each with its status.
    type :: growth_t
        real(dp) :: exponent = 0, singular = 0
        integer :: exponent_status = status_bad_input, singular_status = status_bad_input
        !> Number of steps of the motion.
        integer(int64) :: steps = 0
    end type growth_t

    !> Monitors perturbations: one that has no special direction, for the exponent; or all that keep the length of the
    !> vertical, for the singular value: `tangents`. `set`, then hand it over.
    type, extends(lane_monitor_t) :: growth_lanes_t
        !> What is found for each case.
        type(growth_t), allocatable :: growth(:)
        !> Whether the singular value is found; whether the exponent is.
        logical :: is_singular = .false., has_exponent = .true.
        !> The perturbation of the exponent is the sum of all times this.
        real(dp), private :: share(5, lanes) = 0
        type(tangent_lanes_t) :: tangents
        real(dp), private :: inertia(3, lanes) = 1, unit(6, lanes) = 1
    contains
        procedure :: set
        procedure :: prepare
        procedure :: begin
        procedure :: observe
        procedure :: finish
        procedure :: parts_of
        procedure :: rotation_of
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
        tolerance = slack * max(controls%relative_tolerance, least_tolerance)
        call self%tangents%set(merge(5, 1, is_singular), 0, tolerance, lane_order(tolerance), int(controls%max_steps, int64))
    end subroutine set

    !> Makes room for so many cases.
    subroutine prepare(self, cases)
        class(growth_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%growth)) deallocate (self%growth)
        allocate (self%growth(cases))
    end subroutine prepare

    !> A case begins in a lane.
    subroutine begin(self, run, lane, body, start)
        class(growth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: x(6), z(components, size(self%tangents%z, 3)), vectors(6, size(self%tangents%z, 3)), even(6)
        integer :: v

        x = euler_poisson_state(body, start)
        associate (unit => self%unit(:, lane))
            unit = scales_of(body, x, run%now%t_end(lane))
            self%inertia(:, lane) = body%inertia
            if (self%is_singular) then
                call span_perturbations(x(1:3), unit, vectors)
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
        call self%tangents%load(run, lane, z)
    end subroutine begin

    !> Propagates the perturbations over the last step.
    subroutine observe(self, run)
        class(growth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        call self%tangents%propagate(run)
    end subroutine observe

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, case)
        class(growth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        real(dp) :: vectors(6, size(self%tangents%z, 3)), z(components), growth
        integer :: v

        if (.not. run%now%t(lane) > 0) return
        associate (found => self%growth(case))
            found%exponent_status = self%tangents%status(lane)
            found%singular_status = found%exponent_status
            if (.not. is_ok(found%exponent_status)) return
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

    !> Perturbations of the start as sums of those of the singular value: their multiples, and the rotation about the vertical.
    pure function parts_of(self, lane, body, start, z) result(parts)
        class(growth_lanes_t), intent(in) :: self
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp), intent(in) :: z(:, :) !! the perturbations: (delta, epsilon), one per column
        real(dp) :: parts(6, size(z, 2)), x(6), vectors(6, 5)
        integer :: n
        x = euler_poisson_state(body, start)
        associate (unit => self%unit(:, lane))
            call span_perturbations(x(1:3), unit, vectors)
            do n = 1, size(z, 2)
                parts(:5, n) = matmul([cross(x(1:3), z(4:6, n)), body%inertia * z(1:3, n)] / unit, &
                                      vectors / spread(unit, 2, size(vectors, 2)))
            end do
        end associate
        parts(6, :) = matmul(x(1:3), z(4:6, :))
    end function parts_of

    !> The rotation that such perturbations have become, all of them together as independent errors, rad.
    pure real(dp) function rotation_of(self, lane, parts) result(angle)
        class(growth_lanes_t), intent(in) :: self
        integer, intent(in) :: lane !! index of the lane
        real(dp), intent(in) :: parts(:, :) !! `parts_of` the perturbations
        real(dp) :: turned(4, size(parts, 2))
        associate (found => self%tangents)
            turned(:3, :) = matmul(found%z(lane, 4:6, :), parts(:5, :))
            turned(4, :) = matmul(found%about(lane, :), parts(:5, :))
            turned = scale(turned, min(found%doublings(lane), maxexponent(angle) / 2))
        end associate
        turned(4, :) = turned(4, :) + parts(6, :)
        angle = norm2(turned)
    end function rotation_of

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
        type(motion_t), allocatable :: ends(:)
        type(outcome_t), allocatable :: outcomes(:)
        type(controls_t) :: controls

        controls%relative_tolerance = own_tolerance
        controls%absolute_tolerance = own_tolerance
        controls%max_steps = max_steps
        call monitor%set(controls, with_singular, with_exponent)
        allocate (monitors(1)%monitor, source=monitor)
        allocate (ends(size(bodies)), outcomes(size(bodies)))
        call integrate_many(controls, bodies, starts, t_end, ends, outcomes, monitors)
        select type (found => monitors(1)%monitor)
        type is (growth_lanes_t)
            growth = found%growth
        end select
        growth%steps = outcomes%counts%steps
        where (.not. is_ok(outcomes%status))
            growth%exponent_status = outcomes%status
            growth%singular_status = outcomes%status
        end where
    end subroutine find_growth

end module spintop_lyapunov_lanes
