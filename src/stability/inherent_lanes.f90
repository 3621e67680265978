!> Inherent errors of the motions in lanes: errors of the attitude that are due to rounding of the data to double
!> precision, for bodies without a closed form (`spintop_conditioning` has those of tops).
!>
!> Each datum of the body and of the start is changed by half a unit in the last place. The changes of the attitude,
!> to first order, are perturbations of the motion; those due to data of the body are forced. They are combined as
!> independent errors.
module spintop_inherent_lanes
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_attitude, only: conjugate_quaternion, omega_from_rates, quaternion_product
    use spintop_body, only: body_t
    use spintop_conditioning, only: half_unit
    use spintop_integration, only: outcome_t
    use spintop_kinds, only: dp, epsilon_dp, pi, no_number
    use spintop_lane_monitor, only: lane_monitor_t, monitor_slot_t
    use spintop_lyapunov_lanes, only: growth_lanes_t
    use spintop_many_bodies, only: integrate_many
    use spintop_motion, only: motion_t
    use spintop_regular_start, only: rates_describe
    use spintop_status, only: is_ok, status_step_limit
    use spintop_stepper, only: controls_t
    use spintop_tangent_lanes, only: components, tangent_lanes_t
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    use spintop_validity, only: plain_body_status
    implicit none
    private
    public :: inherent_lanes_t, find_inherent_errors

    !> Largest relative error of a rounded datum: the unit of the perturbations.
    real(dp), parameter :: rounding = epsilon_dp / 2
    !> Perturbations for the data of the start: of the attitude and of the angular velocity; and for those of the body:
    !> gravitational torque, inertia, damping.
    integer, parameter :: of_start = 6, of_body = 9
    integer, parameter :: moments = 0, inertias = 3, dampings = 6
    !> The perturbations are an estimate of errors: a part in a thousand will do. Their series need fewer terms
    !> than those of the motion.
    real(dp), parameter :: tolerance = 1.0e-4_dp
    integer, parameter :: order = 9

    !> Monitors the perturbations; `error` is the inherent error of each case, rad.
    type, extends(lane_monitor_t) :: inherent_lanes_t
        real(dp), allocatable :: error(:)
        integer, allocatable :: status(:)
        !> The growth, if it is found as well: errors of the start are then sums of its perturbations.
        type(growth_lanes_t), allocatable :: growth
        real(dp), private :: parts(6, of_start, lanes) = 0
        type(tangent_lanes_t), private :: tangents
        !> Error of phi at the start, which stays, in units of `rounding`.
        real(dp), private :: azimuth(lanes) = 0
    contains
        procedure :: set
        procedure :: prepare
        procedure :: begin
        procedure :: observe
        procedure :: finish
    end type inherent_lanes_t

contains

    !> For motions of at most so many steps.
    subroutine set(self, max_steps, growth)
        class(inherent_lanes_t), intent(inout) :: self
        integer(int64), intent(in) :: max_steps !! number of steps and of parts of steps for a case
        type(growth_lanes_t), intent(in), optional :: growth !! what finds largest singular values of the same motions
        if (allocated(self%growth)) deallocate (self%growth)
        if (present(growth)) then
            allocate (self%growth, source=growth)
            call self%tangents%set(of_body, of_body, tolerance, order, max_steps)
        else
            call self%tangents%set(of_start + of_body, of_body, tolerance, order, max_steps)
        end if
    end subroutine set

    !> Makes room for so many cases.
    subroutine prepare(self, cases)
        class(inherent_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%error)) deallocate (self%error, self%status)
        allocate (self%error(cases), source=no_number)
        allocate (self%status(cases), source=status_step_limit)
        if (allocated(self%growth)) call self%growth%prepare(cases)
    end subroutine prepare

    !> A case begins in a lane.
    subroutine begin(self, run, lane, body, start)
        class(inherent_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: z(components, of_start + of_body), torque(3, 3)
        integer :: i, k

        z = 0
        self%azimuth(lane) = 0
        if (rates_describe(start)) then
            self%azimuth(lane) = abs(start%angle(1)) * share_of(start%angle(1))
            call change_angles(start, z(:, :of_start))
        else
            call change_quaternion(start, z(:, :of_start))
        end if
        if (allocated(self%growth)) then
            call self%growth%begin(run, lane, body, start)
            self%parts(:, :, lane) = self%growth%parts_of(lane, body, start, z(:, :of_start))
            call self%tangents%load(run, lane, z(:, of_start + 1:))
        else
            call self%tangents%load(run, lane, z)
        end if
        call change_torque(body, torque)
        do i = 1, 3
            k = mod(i, 3) + 1
            associate (now => run%now, inertia => body%inertia, by_torque => self%tangents%change(moments + i), &
                       by_inertia => self%tangents%change(inertias + i), by_damping => self%tangents%change(dampings + i))
                by_torque%pull(lane, :) = cshift(torque(:, i), -1) / inertia
                by_torque%swing(lane, :) = cshift(torque(:, i), 1) / inertia
                ! Of (I2 - I3)/I1 and cyclic, by I_i; and of what is divided by I_i.
                by_inertia%coupling(lane, i) = -now%body%coupling(lane, i)
                by_inertia%coupling(lane, k) = -inertia(i) / inertia(k)
                by_inertia%coupling(lane, 6 - i - k) = inertia(i) / inertia(6 - i - k)
                by_inertia%pull(lane, i) = -now%body%pull(lane, i)
                by_inertia%swing(lane, i) = -now%body%swing(lane, i)
                by_inertia%decay(lane, i) = -now%body%decay(lane, i)
                by_inertia%coupling(lane, :) = share_of(inertia(i)) * by_inertia%coupling(lane, :)
                by_inertia%pull(lane, i) = share_of(inertia(i)) * by_inertia%pull(lane, i)
                by_inertia%swing(lane, i) = share_of(inertia(i)) * by_inertia%swing(lane, i)
                by_inertia%decay(lane, i) = share_of(inertia(i)) * by_inertia%decay(lane, i)
                by_damping%decay(lane, i) = share_of(body%damping(i)) * now%body%decay(lane, i)
            end associate
        end do
    end subroutine begin

    !> Half a unit in the last place of a datum, relative to it, in units of `rounding`.
    elemental real(dp) function share_of(datum)
        real(dp), intent(in) :: datum
        share_of = half_unit(datum) / rounding
    end function share_of

    !> Changes of the start for its angles and rates; phi is left out.
    pure subroutine change_angles(start, z)
        type(motion_t), intent(in) :: start
        real(dp), intent(out) :: z(components, of_start)
        real(dp) :: c, s, rate(3)
        integer :: n
        z = 0
        c = cos(start%angle(3))
        s = sin(start%angle(3))
        associate (theta => start%angle(2), psi => start%angle(3), phi_rate => start%rate(1), theta_rate => start%rate(2))
            z(:, 1) = share_of(theta) * theta * [phi_rate * cos(theta) * s, phi_rate * cos(theta) * c, -phi_rate * sin(theta), &
                               c, -s, 0.0_dp]
            z(:, 2) = [phi_rate * sin(theta) * c - theta_rate * s, -phi_rate * sin(theta) * s - theta_rate * c, &
                       0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp]
            z(:, 2) = share_of(psi) * psi * z(:, 2)
        end associate
        do n = 1, 3
            rate = 0
            rate(n) = share_of(start%rate(n)) * start%rate(n)
            z(1:3, 2 + n) = omega_from_rates(start%angle, rate)
        end do
    end subroutine change_angles

    !> Changes of the start for its quaternion and its angular velocity.
    pure subroutine change_quaternion(start, z)
        type(motion_t), intent(in) :: start
        real(dp), intent(out) :: z(components, of_start)
        real(dp) :: q(4), change(4), turns(3, 4)
        integer :: n
        z = 0
        q = start%quaternion / norm2(start%quaternion)
        do n = 1, 4
            change = 0
            change(n) = share_of(start%quaternion(n)) * q(n)
            change = quaternion_product(conjugate_quaternion(q), change)
            turns(:, n) = 2 * change(2:4)
        end do
        z(4:6, 1:3) = three_for(turns)
        do n = 1, 3
            z(n, 3 + n) = share_of(start%omega(n)) * start%omega(n)
        end do
    end subroutine change_quaternion

    !> Changes of the gravitational torque for mass and gravity, and for each coordinate of the centre of mass.
    pure subroutine change_torque(body, torque)
        type(body_t), intent(in) :: body
        real(dp), intent(out) :: torque(3, 3)
        real(dp) :: changes(3, 4)
        integer :: n
        changes = 0
        changes(:, 4) = body%weight_moment()
        do n = 1, 3
            changes(n, n) = share_of(body%centre_of_mass(n)) * changes(n, 4)
        end do
        changes(:, 4) = norm2(share_of([body%mass, body%gravity])) * changes(:, 4)
        torque = three_for(changes)
    end subroutine change_torque

    !> Three vectors that stand for four independent errors: with the same covariance (Cholesky).
    pure function three_for(four) result(three)
        real(dp), intent(in) :: four(3, 4)
        real(dp) :: three(3, 3), square(3, 3), pivot
        integer :: i, j
        square = matmul(four, transpose(four))
        three = 0
        do j = 1, 3
            pivot = square(j, j) - sum(three(j, :j - 1)**2)
            if (.not. pivot > 16 * epsilon_dp * square(j, j)) cycle
            do i = j, 3
                three(i, j) = (square(i, j) - dot_product(three(i, :j - 1), three(j, :j - 1))) / sqrt(pivot)
            end do
        end do
    end function three_for

    !> Propagates the perturbations over the last step.
    subroutine observe(self, run)
        class(inherent_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        if (allocated(self%growth)) then
            call self%growth%observe(run)
            associate (others => self%growth%tangents)
                self%tangents%beside = scale(others%whole, others%doublings - self%tangents%doublings)
            end associate
        end if
        call self%tangents%propagate(run)
    end subroutine observe

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, case)
        class(inherent_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        real(dp) :: error
        self%status(case) = self%tangents%status(lane)
        if (allocated(self%growth)) then
            call self%growth%finish(run, lane, case)
            if (is_ok(self%status(case))) self%status(case) = self%growth%tangents%status(lane)
        end if
        if (.not. is_ok(self%status(case))) return
        error = norm2([self%tangents%z(lane, 4:6, :), self%tangents%about(lane, :)])
        error = scale(error, min(self%tangents%doublings(lane), maxexponent(error) / 2))
        if (allocated(self%growth)) error = norm2([error, self%growth%rotation_of(lane, self%parts(:, :, lane))])
        error = rounding * norm2([error, self%azimuth(lane)])
        self%error(case) = merge(pi, error, error > pi)
    end subroutine finish

    !> The inherent errors of bodies at the ends of spans, rad; zero unless `status_ok`.
    subroutine find_inherent_errors(bodies, starts, t_end, max_steps, errors, status)
        type(body_t), intent(in) :: bodies(:) !! mass properties about the fixed point, one for each case
        type(motion_t), intent(in) :: starts(:) !! attitude and angular velocity at the start, one for each case
        real(dp), intent(in) :: t_end(:) !! ends of the spans, one for each case, s
        integer(int64), intent(in) :: max_steps !! maximum number of steps for a case
        real(dp), intent(out) :: errors(:) !! inherent errors at these times, one for each case, rad
        integer, intent(out) :: status(:) !! `status_ok`, or the reasons of failures (spintop_status)
        !> The perturbations need no more.
        real(dp), parameter :: enough = 1.0e-10_dp
        type(monitor_slot_t) :: monitors(1)
        type(inherent_lanes_t) :: monitor
        type(motion_t), allocatable :: ends(:)
        type(outcome_t), allocatable :: outcomes(:)
        type(controls_t) :: controls
        integer, allocatable :: valid(:)
        integer :: i

        errors = 0
        do i = 1, size(bodies)
            status(i) = plain_body_status(bodies(i))
        end do
        valid = pack([(i, i=1, size(bodies))], is_ok(status))
        controls%relative_tolerance = enough
        controls%absolute_tolerance = enough
        controls%max_steps = max_steps
        call monitor%set(max_steps)
        allocate (monitors(1)%monitor, source=monitor)
        allocate (ends(size(valid)), outcomes(size(valid)))
        call integrate_many(controls, bodies(valid), starts(valid), t_end(valid), ends, outcomes, monitors)
        status(valid) = outcomes%status
        select type (monitor => monitors(1)%monitor)
        type is (inherent_lanes_t)
            where (is_ok(status(valid))) status(valid) = monitor%status
            where (is_ok(status(valid))) errors(valid) = monitor%error
        end select
    end subroutine find_inherent_errors

end module spintop_inherent_lanes
