!> Energies of bodies with effects along the motions in lanes, and the work of the effects: the integral over each step of the
!> power, of the products of the Taylor series of a moment and the angular velocity. lane_work.h computes it.
module spintop_work_lanes
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_body, only: body_t
    use spintop_kernel_types, only: lane_kinds_t, lane_work_t
    use spintop_kinds, only: dp
    use spintop_lane_effects, only: has_drag_force, has_drag_moment, row_frame
    use spintop_loads, only: works, work_damping, work_drag, work_rotor, work_torque
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: work_lanes_t

    !> The work since the start by its parts, over the scale of the energy.
    type :: work_lanes_t
        real(dp) :: done(lanes, works) = 0
        type(lane_work_t), private :: of
        !> Moments of inertia and momentum of the rotor, likewise, and whether a part may differ from zero in any
        !> lane; that of a vibration and of a torque in space axes is known from the kinds of effects.
        real(dp), dimension(lanes, 3), private :: inertia = 0, rotor = 0
        integer(c_int), private :: acts(works) = 0
    contains
        procedure :: begin
        procedure :: add_step
        procedure :: frame_energies
    end type work_lanes_t

    interface
        pure subroutine c_add_work(order, kinds, acts, of, duration, c, more, done) bind(C, name='spintop_add_lane_work')
            import :: c_double, c_int, lane_work_t, lane_kinds_t
            integer(c_int), value :: order
            type(lane_kinds_t), intent(in) :: kinds
            integer(c_int), intent(in) :: acts(*)
            type(lane_work_t), intent(in) :: of
            real(c_double), dimension(*), intent(in) :: duration, c, more
            real(c_double), intent(inout) :: done(*)
        end subroutine c_add_work
    end interface

contains

    !> A case begins in a lane.
    pure subroutine begin(self, lane, body, scale)
        class(work_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties and effects of the body
        real(dp), intent(in) :: scale !! scale of the energy, J
        integer :: n
        self%done(lane, :) = 0
        self%inertia(lane, :) = body%inertia / scale
        n = 0
        associate (effects => body%effects, of => self%of)
            of%per_scale(lane) = 1 / scale
            of%arm(lane, :) = body%mass * body%centre_of_mass / scale
            of%damping(lane, :) = body%damping / scale
            of%torque(lane, :) = effects%torque_body / scale
            of%drive(lane, :) = effects%rotor_torque / scale
            of%drag(lane, :, :) = 0
            if (has_drag_moment(effects)) then
                n = n + 1
                of%drag(lane, :, n) = effects%drag_moment / scale
            end if
            of%linear_drag(lane, :) = 0
            if (n == 0) of%linear_drag(lane, :) = effects%drag_moment / scale
            if (has_drag_force(body)) of%drag(lane, :, n + 1) = effects%drag_force / scale
            self%rotor(lane, :) = effects%rotor_momentum / scale
        end associate
        call find_acting(self)
    end subroutine begin

    !> Finds which parts may differ from zero.
    pure subroutine find_acting(self)
        class(work_lanes_t), intent(inout) :: self
        logical :: acts(works)
        associate (of => self%of)
            acts = .false.
            acts(work_damping) = any(of%damping > 0)
            acts(work_drag) = any(of%linear_drag > 0) .or. any(of%drag > 0)
            acts(work_torque) = any(abs(of%torque) > 0)
            acts(work_rotor) = any(abs(of%drive) > 0)
        end associate
        self%acts = merge(1, 0, acts)
    end subroutine find_acting

    !> Adds the work over the last step.
    pure subroutine add_step(self, run)
        class(work_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        real(dp) :: duration(lanes)
        duration = run%now%t - run%now%t_last
        call c_add_work(run%order, run%effects%kinds, self%acts, self%of, duration, run%c, run%more, self%done)
    end subroutine add_step

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
            energy = energy - frame * (self%inertia(:, m) * frame / 2 + self%rotor(:, m) + run%now%t * self%of%drive(:, m))
        end do
    end subroutine frame_energies

end module spintop_work_lanes
