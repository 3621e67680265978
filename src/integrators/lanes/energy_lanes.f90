!> Energy errors along the motions in lanes, at the ends of the steps.
module spintop_energy_lanes
    use spintop_kinds, only: dp, no_number
    use spintop_body, only: body_t
    use spintop_lane_monitor, only: lane_monitor_t
    use spintop_motion, only: motion_t
    use spintop_quantities, only: energy_scale, kinetic_energy, potential_energy
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    use spintop_work_lanes, only: work_lanes_t
    implicit none
    private
    public :: energy_lanes_t

    !> Watches the energy, of bodies with effects less their work; `error_max` is the largest relative error of each case.
    type, extends(lane_monitor_t) :: energy_lanes_t
        real(dp), allocatable :: error_max(:)
        !> Half the moments of inertia, and the torque of gravity, both over the scale of the energy; the energy at
        !> the start, likewise.
        real(dp), dimension(lanes, 3), private :: half_inertia = 0, moment = 0
        real(dp), dimension(lanes), private :: at_start = 0, largest = 0
        type(work_lanes_t), private :: work
    contains
        procedure :: prepare
        procedure :: begin
        procedure :: observe
        procedure :: finish
    end type energy_lanes_t

contains

    !> Makes room for so many cases.
    subroutine prepare(self, cases)
        class(energy_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%error_max)) deallocate (self%error_max)
        allocate (self%error_max(cases), source=no_number)
    end subroutine prepare

    !> A case begins in a lane.
    subroutine begin(self, run, lane, body, start)
        class(energy_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: energy(lanes)
        self%half_inertia(lane, :) = body%inertia / 2 / energy_scale(body, start)
        self%moment(lane, :) = body%weight_moment() / energy_scale(body, start)
        call find_energies(self, run, energy)
        self%at_start(lane) = energy(lane)
        self%largest(lane) = 0
        if (.not. allocated(body%effects)) return
        self%at_start(lane) = (kinetic_energy(body, start) + potential_energy(body, start)) / energy_scale(body, start)
        call self%work%begin(lane, body, energy_scale(body, start))
    end subroutine begin

    !> Records the errors at the ends of the last step.
    subroutine observe(self, run)
        class(energy_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), dimension(lanes) :: energy, frame, scale
        integer :: i
        call find_energies(self, run, energy)
        if (allocated(run%effects)) then
            call self%work%add_step(run)
            call self%work%frame_energies(run, frame)
            scale = max(1.0_dp, sum(abs(self%work%done), dim=2))
            energy = self%at_start + (energy + frame - self%at_start - sum(self%work%done, dim=2)) / scale
        end if
        !$omp simd
        do i = 1, lanes
            energy(i) = abs(energy(i) - self%at_start(i))
            ! What is not finite stays.
            self%largest(i) = merge(self%largest(i), energy(i), energy(i) <= self%largest(i) &
                                    .or. .not. self%largest(i) <= huge(1.0_dp))
        end do
    end subroutine observe

    !> Energies over their scales.
    pure subroutine find_energies(self, run, energy)
        class(energy_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(out) :: energy(lanes)
        integer :: i
        associate (x => run%now%state, half => self%half_inertia, moment => self%moment)
            !$omp simd
            do i = 1, lanes
                energy(i) = half(i, 1) * x(i, 1)**2 + half(i, 2) * x(i, 2)**2 + half(i, 3) * x(i, 3)**2 &
                    + (moment(i, 1) * x(i, 4) + moment(i, 2) * x(i, 5) + moment(i, 3) * x(i, 6))
            end do
        end associate
    end subroutine find_energies

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, case)
        class(energy_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        self%error_max(case) = self%largest(lane)
    end subroutine finish

end module spintop_energy_lanes
