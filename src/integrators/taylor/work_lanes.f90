!> Energies of bodies with effects along the motions in lanes, and the work of the effects: the integral over each step of the
!> Taylor series of the power, whose terms are sums of products of known series.
module spintop_work_lanes
    use spintop_body, only: body_t
    use spintop_kinds, only: dp
    use spintop_lane_effects, only: has_drag_force, has_drag_moment, most_drags, row_drags, row_frame, row_moment, row_push, &
        row_torque, rows_of_drag
    use spintop_loads, only: works, work_damping, work_drag, work_rotor, work_torque, work_vibration
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: work_lanes_t

    !> The work since the start by its parts, and constants of the power, all over the scale of the energy.
    type :: work_lanes_t
        real(dp) :: done(lanes, works) = 0
        real(dp), dimension(lanes, 3), private :: inertia = 0, arm = 0, damping = 0, linear_drag = 0, torque = 0, &
            rotor = 0, drive = 0
        real(dp), private :: drag(lanes, 3, most_drags) = 0, per_scale(lanes) = 0
    contains
        procedure :: begin
        procedure :: add_step
        procedure :: frame_energies
    end type work_lanes_t

contains

    !> A case begins in a lane.
    pure subroutine begin(self, lane, body, scale)
        class(work_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties and effects of the body
        real(dp), intent(in) :: scale !! scale of the energy, J
        integer :: n
        self%done(lane, :) = 0
        self%per_scale(lane) = 1 / scale
        n = 0
        associate (effects => body%effects)
            self%inertia(lane, :) = body%inertia / scale
            self%arm(lane, :) = body%mass * body%centre_of_mass / scale
            self%damping(lane, :) = body%damping / scale
            self%torque(lane, :) = effects%torque_body / scale
            self%rotor(lane, :) = effects%rotor_momentum / scale
            self%drive(lane, :) = effects%rotor_torque / scale
            self%drag(lane, :, :) = 0
            if (has_drag_moment(effects)) then
                n = n + 1
                self%drag(lane, :, n) = effects%drag_moment / scale
            end if
            self%linear_drag(lane, :) = 0
            if (n == 0) self%linear_drag(lane, :) = effects%drag_moment / scale
            if (has_drag_force(body)) self%drag(lane, :, n + 1) = effects%drag_force / scale
        end associate
    end subroutine begin

    !> Adds the work over the last step.
    pure subroutine add_step(self, run)
        class(work_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        real(dp), dimension(lanes, 0:run%order, 3) :: w, moment
        integer :: m, n, next, last

        associate (kinds => run%effects%kinds, order => run%order, more => run%more)
            do m = 1, 3
                w(:, :, m) = run%c(:, m, :)
            end do
            if (any(self%damping > 0)) then
                do m = 1, 3
                    moment(:, :, m) = -spread(self%damping(:, m), 2, order + 1) * w(:, :, m)
                end do
                call add_work(self, run, work_damping, w, moment)
            end if
            if (kinds%drags > 0 .or. any(self%linear_drag > 0)) then
                do m = 1, 3
                    moment(:, :, m) = -spread(self%linear_drag(:, m), 2, order + 1) * w(:, :, m)
                    do n = 1, kinds%drags
                        moment(:, :, m) = moment(:, :, m) - spread(self%drag(:, m, n), 2, order + 1) &
                            * more(:, row_drags + rows_of_drag * (n - 1) + row_moment + m - 1, :)
                    end do
                end do
                call add_work(self, run, work_drag, w, moment)
            end if
            if (kinds%vibrates > 0) then
                do m = 1, 3
                    next = mod(m, 3) + 1
                    last = mod(m + 1, 3) + 1
                    moment(:, :, m) = spread(self%arm(:, last), 2, order + 1) * more(:, row_push + next - 1, :) &
                        - spread(self%arm(:, next), 2, order + 1) * more(:, row_push + last - 1, :)
                end do
                call add_work(self, run, work_vibration, w, moment)
            end if
            if (kinds%twists > 0 .or. any(abs(self%torque) > 0)) then
                moment = 0
                do m = 1, 3
                    if (kinds%twists > 0) moment(:, :, m) = spread(self%per_scale, 2, order + 1) &
                        * more(:, row_torque + m - 1, :)
                    moment(:, 0, m) = moment(:, 0, m) + self%torque(:, m)
                end do
                call add_work(self, run, work_torque, w, moment)
            end if
            if (any(abs(self%drive) > 0)) then
                moment = 0
                do m = 1, 3
                    if (kinds%turns > 0) w(:, :, m) = w(:, :, m) + more(:, row_frame + m - 1, :)
                    moment(:, 0, m) = -self%drive(:, m)
                end do
                call add_work(self, run, work_rotor, w, moment)
            end if
        end associate
    end subroutine add_step

    !> Adds the integral over the step of the power of a moment. Two terms of the product are computed at once, as in
    !> `multiply` of `spintop_lane_products`.
    pure subroutine add_work(self, run, part, w, moment)
        type(work_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: part
        real(dp), dimension(lanes, 0:run%order, 3), intent(in) :: w, moment
        real(dp) :: power(lanes, 0:run%order), sum(lanes), t(lanes), even, odd
        integer :: i, j, k, half

        do half = 0, (run%order - 1) / 2
            !$omp simd private(even, odd, j)
            do i = 1, lanes
                even = 0
                odd = w(i, 2 * half + 1, 1) * moment(i, 0, 1) + w(i, 2 * half + 1, 2) * moment(i, 0, 2) &
                    + w(i, 2 * half + 1, 3) * moment(i, 0, 3)
                do j = 0, max(2 * half, 0)
                    even = even + (w(i, j, 1) * moment(i, 2 * half - j, 1) + w(i, j, 2) * moment(i, 2 * half - j, 2) &
                                   + w(i, j, 3) * moment(i, 2 * half - j, 3))
                    odd = odd + (w(i, j, 1) * moment(i, 2 * half + 1 - j, 1) + w(i, j, 2) * moment(i, 2 * half + 1 - j, 2) &
                                 + w(i, j, 3) * moment(i, 2 * half + 1 - j, 3))
                end do
                power(i, 2 * half) = even
                power(i, 2 * half + 1) = odd
            end do
        end do
        t = run%now%t - run%now%t_last
        sum = 0
        do k = run%order - 1, 0, -1
            sum = (sum + power(:, k) * (1.0_dp / (k + 1))) * t
        end do
        self%done(:, part) = self%done(:, part) + sum
    end subroutine add_work

    !> Potential energies of the motion of the frame at the ends of the last step, -O.IO/2 - O.h.
    pure subroutine frame_energies(self, run, energy)
        class(work_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        real(dp), intent(out) :: energy(lanes) !! energies over the scale
        real(dp) :: frame(lanes), t(lanes)
        integer :: k, m
        energy = 0
        if (run%effects%kinds%turns == 0) return
        t = run%now%t - run%now%t_last
        do m = 1, 3
            frame = 0
            do k = run%order, 0, -1
                frame = frame * t + run%more(:, row_frame + m - 1, k)
            end do
            energy = energy - frame * (self%inertia(:, m) * frame / 2 + self%rotor(:, m) + run%now%t * self%drive(:, m))
        end do
    end subroutine frame_energies

end module spintop_work_lanes
