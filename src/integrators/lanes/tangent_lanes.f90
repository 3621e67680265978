!> Perturbations of the motions in lanes, carried along with their steps.
!>
!> The series of a perturbation may converge more slowly than that of the motion: a body at rest has a motion of one
!> step, however its perturbations oscillate or grow. The step of a lane is then divided, and the polynomials of the
!> motion are developed anew about the beginning of each part: the motion itself stays as it is.
module spintop_tangent_lanes
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_lane_series, only: carry_tangents, components, rows
    use spintop_status, only: is_ok, status_non_finite, status_ok, status_step_limit
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: tangent_lanes_t, components

    !> Growth by which a perturbation is scaled: far from overflow, also of squares.
    real(dp), parameter :: far = 2.0_dp**200
    !> Fraction of the part that the last terms allow, its smallest and largest ratio to the one before.
    real(dp), parameter :: safety = 0.8_dp, least_ratio = 1.0e-3_dp, most_ratio = 4

    !> Perturbations of the motions in all lanes. `set`, `load` some lanes, then `propagate` after every step.
    type :: tangent_lanes_t
        !> The perturbations (lane, component, number): delta, epsilon, across the vertical.
        real(dp), allocatable :: z(:, :, :)
        !> Those from the first to this one are carried; the others must be zero.
        integer :: carried = 0
        !> All of a lane are to be multiplied by 2 to this power.
        integer :: doublings(lanes) = 0
        !> `status_ok`, or why the perturbations of a lane ended.
        integer :: status(lanes) = status_ok
        !> Their sizes before the last step or part of one, and those after it.
        real(dp), private :: whole(lanes) = 0
        real(dp), allocatable, private :: next(:, :, :)
        real(dp), private :: tolerance = 0
        integer, private :: most_order = 0
        integer(int64), private :: max_parts = 0, parts(lanes) = 0
    contains
        procedure :: set
        procedure :: load
        procedure :: propagate
    end type tangent_lanes_t

contains

    !> Makes room for so many perturbations in each lane.
    subroutine set(self, number, tolerance, most_order, max_parts)
        class(tangent_lanes_t), intent(out) :: self
        integer, intent(in) :: number !! number of perturbations
        real(dp), intent(in) :: tolerance !! of the last terms of a series, relative to the perturbations
        integer, intent(in) :: most_order !! order of the series, unless that of the motion is lower
        integer(int64), intent(in) :: max_parts !! number of steps and parts of steps for a case
        allocate (self%z(lanes, components, number), source=0.0_dp)
        allocate (self%next, source=self%z)
        self%carried = number
        self%tolerance = tolerance
        self%most_order = most_order
        self%max_parts = max_parts
    end subroutine set

    !> Begins perturbations in a lane.
    pure subroutine load(self, run, lane, z)
        class(tangent_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        real(dp), intent(in) :: z(:, :) !! the perturbations: (delta, epsilon), one per column
        self%z(lane, :, :) = z
        self%next(lane, :, :) = z
        call settle_lane(self, lane, run%now%state(lane, 4:6))
        self%doublings(lane) = 0
        self%parts(lane) = 0
        self%status(lane) = status_ok
    end subroutine load

    !> Propagates all perturbations over the last step, in parts where it is too long for them.
    subroutine propagate(self, run)
        class(tangent_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        real(dp), allocatable :: before(:, :, :)
        real(dp) :: duration(lanes), excess(lanes)

        duration = run%now%t - run%now%t_last
        call try(self, run, run%c, duration, excess)
        if (all(excess <= 1)) then
            call move_alloc(self%z, before)
            call move_alloc(self%next, self%z)
            call move_alloc(before, self%next)
            self%parts = self%parts + merge(1, 0, duration > 0)
        else
            call divide(self, run, duration, excess)
        end if
        call settle(self, run)
        call scale_down(self, run, duration)
    end subroutine propagate

    !> Perturbations after a duration, in `next`. `excess` is the ratio of the last terms to the tolerance; in lanes that do
    !> not move it is zero.
    subroutine try(self, run, c, duration, excess)
        class(tangent_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(in) :: c(lanes, rows, 0:run%order), duration(lanes)
        real(dp), intent(out) :: excess(lanes)
        real(dp) :: whole(lanes), last(lanes)
        associate (now => run%now)
            call carry_tangents(min(self%most_order, run%order), now%body, c, duration, now%scale, self%carried, self%z, &
                                self%next, whole, last)
        end associate
        self%whole = merge(whole, self%whole, duration > 0)
        excess = merge(last / (self%tolerance * self%whole), 0.0_dp, last > self%tolerance * self%whole)
        ! What is not finite exceeds as well.
        excess = merge(excess, huge(1.0_dp), last <= huge(1.0_dp) .and. excess <= huge(1.0_dp))
        excess = merge(excess, 0.0_dp, duration > 0 .and. is_ok(self%status))
    end subroutine try

    !> Propagates the perturbations over the last step in parts, in the lanes that need it; the others take `next`.
    subroutine divide(self, run, duration, excess)
        class(tangent_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(in) :: duration(lanes)
        real(dp), intent(inout) :: excess(lanes)
        real(dp) :: c(lanes, rows, 0:run%order), left(lanes), part(lanes)
        integer :: lane, order

        order = min(self%most_order, run%order)
        c = run%c
        left = duration
        part = duration
        do
            do lane = 1, lanes
                if (.not. left(lane) > 0) cycle
                self%parts(lane) = self%parts(lane) + 1
                if (excess(lane) <= 1) then
                    self%z(lane, :, :) = self%next(lane, :, :)
                    left(lane) = left(lane) - part(lane)
                    if (left(lane) > 0) then
                        call move_origin(run%order, part(lane), c(lane, :6, :))
                        call settle_lane(self, lane, c(lane, 4:6, 0))
                    end if
                end if
                part(lane) = min(left(lane), part(lane) * min(max(least_ratio, safety &
                                 * (1 / max(excess(lane), tiny(1.0_dp)))**(1.0_dp / order)), most_ratio))
                if (self%parts(lane) > self%max_parts) self%status(lane) = status_step_limit
                ! A part that is too short to be taken: the terms overflow.
                if (left(lane) > 0 .and. .not. left(lane) - part(lane) < left(lane)) self%status(lane) = status_non_finite
                if (.not. is_ok(self%status(lane))) left(lane) = 0
                if (.not. left(lane) > 0) part(lane) = 0
            end do
            if (.not. any(left > 0)) exit
            call scale_down(self, run, left)
            call try(self, run, c, part, excess)
        end do
    end subroutine divide

    !> Develops polynomials anew about a later time.
    pure subroutine move_origin(order, t, c)
        integer, intent(in) :: order
        real(dp), intent(in) :: t
        real(dp), intent(inout) :: c(6, 0:order)
        integer :: j, k
        do k = 0, order - 1
            do j = order - 1, k, -1
                c(:, j) = c(:, j) + t * c(:, j + 1)
            end do
        end do
    end subroutine move_origin

    !> Makes the rotations those across the vertical: one about it changes nothing else, and stays the same for all times. On
    !> their own they would come off it by rounding, and after a long decay nothing else would be left.
    pure subroutine settle(self, run)
        class(tangent_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp) :: along, per_square(lanes)
        integer :: i, v
        associate (x => run%now%state, z => self%z)
            !$omp simd
            do i = 1, lanes
                per_square(i) = 1 / max(x(i, 4)**2 + x(i, 5)**2 + x(i, 6)**2, tiny(along))
            end do
            do v = 1, size(z, 3)
                !$omp simd private(along)
                do i = 1, lanes
                    along = (x(i, 4) * z(i, 4, v) + x(i, 5) * z(i, 5, v) + x(i, 6) * z(i, 6, v)) * per_square(i)
                    z(i, 4, v) = z(i, 4, v) - along * x(i, 4)
                    z(i, 5, v) = z(i, 5, v) - along * x(i, 5)
                    z(i, 6, v) = z(i, 6, v) - along * x(i, 6)
                end do
            end do
        end associate
    end subroutine settle

    !> The same in one lane.
    pure subroutine settle_lane(self, lane, vertical)
        class(tangent_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane
        real(dp), intent(in) :: vertical(3)
        real(dp) :: along
        integer :: v
        do v = 1, size(self%z, 3)
            along = dot_product(vertical, self%z(lane, 4:6, v)) / sum(vertical**2)
            self%z(lane, 4:6, v) = self%z(lane, 4:6, v) - along * vertical
        end do
    end subroutine settle_lane

    !> Divides perturbations that have become very large or small by a power of two, in lanes that have time left: the others
    !> do not know how long a step is in parts.
    pure subroutine scale_down(self, run, left)
        class(tangent_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(in) :: left(lanes)
        real(dp), dimension(lanes) :: peak, fast, turned
        integer :: i, v, m
        fast = 0
        turned = 0
        do v = 1, size(self%z, 3)
            !$omp simd
            do i = 1, lanes
                fast(i) = max(fast(i), max(abs(self%z(i, 1, v)), abs(self%z(i, 2, v)), abs(self%z(i, 3, v))))
                turned(i) = max(turned(i), max(abs(self%z(i, 4, v)), abs(self%z(i, 5, v)), abs(self%z(i, 6, v))))
            end do
        end do
        peak = max(turned, fast / run%now%scale)
        if (all(peak < far .and. peak * far > 1)) return
        do i = 1, lanes
            if (.not. left(i) > 0) cycle
            if ((peak(i) < far .and. peak(i) * far > 1) .or. .not. (peak(i) > 0 .and. peak(i) <= huge(1.0_dp))) cycle
            m = exponent(peak(i))
            self%z(i, :, :) = scale(self%z(i, :, :), -m)
            self%doublings(i) = self%doublings(i) + m
        end do
    end subroutine scale_down

end module spintop_tangent_lanes
