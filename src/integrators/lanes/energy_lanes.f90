!> Energy errors along the motions in lanes, at the ends of the steps: of bodies with effects less their work.
!>
!> The power of an effect is the product of its moment and the angular velocity, so its integral over a step is that of a product
!> of two series.
module spintop_energy_lanes
    use spintop_body, only: body_t
    use spintop_body_numbers, only: has_drag_moment, numbers_of
    use spintop_formulation, only: max_series_order
    use spintop_kernel_types, only: body_numbers_t, more_rows, most_drags, motion_kinds_t
    use spintop_kinds, only: dp
    use spintop_measures, only: measures_t
    use spintop_taylor_lanes, only: lane_monitor_t, lanes, taylor_lanes_t
    use spintop_bernstein, only: multiply, square
    use spintop_lane_series, only: row_drags, row_frame, row_moment, row_push, row_torque, rows, rows_of_drag
    use spintop_motion, only: motion_t
    use spintop_quantities, only: energy_scale, kinetic_energy, potential_energy
    implicit none
    private
    public :: energy_lanes_t

    !> Parts of the work: of what is linear in the angular velocity, of other drags, of the vibration, of torques, of the rotor.
    integer, parameter :: by_damping = 1, by_drag = 2, by_vibration = 3, by_torque = 4, by_rotor = 5, works = 5

    !> Terms of a product of series that are taken behind the degree of both: what is left out is then less than what these
    !> leave out.
    integer, parameter :: further = 2
    !> Integrals of the powers over the unit interval.
    integer, private :: k
    real(dp), parameter :: of_power(0:max_series_order + further) = [(1.0_dp / (k + 1), k=0, max_series_order + further)]

    !> Watches the energy, of bodies with effects less their work.
    type, extends(lane_monitor_t) :: energy_lanes_t
        !> Half the moments of inertia, and the torque of gravity, both over the scale of the energy; the energy at the start,
        !> and 1, likewise.
        real(dp), dimension(lanes, 3), private :: half_inertia = 0, moment = 0
        real(dp), dimension(lanes), private :: at_start = 0, largest = 0, per_scale = 0
        !> Of effects, likewise: the coefficients of damping and of drags, m r, the torque in body axes, the angular momentum of
        !> the rotor at the start and its rate.
        real(dp), dimension(lanes, 3), private :: damping = 0, arm = 0, torque = 0, rotor = 0, drive = 0
        real(dp), private :: drag(lanes, 3, most_drags) = 0
        !> The work so far by its parts, likewise.
        real(dp), private :: done(lanes, works) = 0
    contains
        procedure :: begin
        procedure :: observe
        procedure :: finish
    end type energy_lanes_t

contains

    !> A case begins in a lane.
    subroutine begin(self, run, lane, body, start)
        class(energy_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        type(body_numbers_t) :: of
        real(dp) :: energy(lanes), scale
        scale = energy_scale(body, start)
        self%half_inertia(lane, :) = body%inertia / 2 / scale
        self%moment(lane, :) = body%weight_moment() / scale
        self%done(lane, :) = 0
        self%largest(lane) = 0
        call find_energies(self, run, energy)
        self%at_start(lane) = energy(lane)
        if (.not. allocated(body%effects)) return
        ! The energy of the frame counts with effects.
        self%at_start(lane) = (kinetic_energy(body, start) + potential_energy(body, start)) / scale
        of = numbers_of(body)
        self%per_scale(lane) = 1 / scale
        self%damping(lane, :) = of%damping / scale
        if (.not. has_drag_moment(body%effects)) self%damping(lane, :) = (of%damping + of%drag_moment) / scale
        self%drag(lane, :, 1) = of%drag_moment / scale
        self%drag(lane, :, 2) = of%drag_force / scale
        self%arm(lane, :) = of%mass * of%centre / scale
        self%torque(lane, :) = of%torque_body / scale
        self%rotor(lane, :) = of%rotor / scale
        self%drive(lane, :) = of%drive / scale
    end subroutine begin

    !> Records the errors at the ends of the last step.
    subroutine observe(self, run)
        class(energy_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), dimension(lanes) :: energy, work, frame
        integer :: i, m
        call find_energies(self, run, energy)
        if (allocated(run%effects)) then
            call add_work(self, run%order, run%effects, run%power, run%c, run%more)
            ! The potential energies of the motion of the frame, -O.IO/2 - O.h.
            do m = 1, merge(3, 0, run%effects%frame > 0)
                frame = sum(run%more(:, row_frame + m - 1, :) * run%power(:, :run%order), dim=2)
                energy = energy - frame * (self%half_inertia(:, m) * frame + self%rotor(:, m) + run%now%t * self%drive(:, m))
            end do
            work = sum(self%done, dim=2)
            energy = self%at_start + (energy - self%at_start - work) / max(1.0_dp, sum(abs(self%done), dim=2))
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

    !> Adds the work over the last step, the integral of the moments times omega. `more` has the rows of effects.
    pure subroutine add_work(self, order, has, power, c, more)
        class(energy_lanes_t), intent(inout) :: self
        integer, intent(in) :: order
        type(motion_kinds_t), intent(in) :: has
        real(dp), intent(in) :: power(lanes, 0:order), c(lanes, rows, 0:order), more(lanes, more_rows, 0:order)
        real(dp), dimension(lanes, 0:max_series_order + further) :: w, a ! of known size, on the stack
        real(dp) :: work(lanes, works), turn(lanes)
        integer :: m, n, next, last, d, i

        n = order - 1
        do m = 1, 3
            next = 1 + mod(m, 3)
            last = 1 + mod(next, 3)
            work = 0
            call take_row(n, rows, m, c, power, w)
            if (any(self%damping(:, m) > 0)) then
                call square(n + further, w, a)
                work(:, by_damping) = -self%damping(:, m) * mean(n + further, a)
            end if
            do d = 1, most_drags
                if (.not. btest(has%drags, d - 1)) cycle
                call take_row(n, more_rows, row_drags + rows_of_drag * (d - 1) + row_moment + m - 1, more, power, a)
                work(:, by_drag) = work(:, by_drag) - self%drag(:, m, d) * integral(n, a, w)
            end do
            if (has%push > 0) then
                do i = 0, n
                    a(:, i) = (self%arm(:, last) * more(:, row_push + next - 1, i) &
                               - self%arm(:, next) * more(:, row_push + last - 1, i)) * power(:, i)
                end do
                a(:, n + 1:n + further) = 0
                work(:, by_vibration) = integral(n, a, w)
            end if
            if (has%torque > 0) then
                call take_row(n, more_rows, row_torque + m - 1, more, power, a)
                work(:, by_torque) = self%per_scale * integral(n, a, w)
            end if
            if (has%rotor > 0) then
                turn = mean(n, w)
                work(:, by_torque) = work(:, by_torque) + self%torque(:, m) * turn
                ! The drive of the rotor meets the motion of the frame, too.
                if (has%frame > 0) then
                    call take_row(n, more_rows, row_frame + m - 1, more, power, a)
                    turn = turn + mean(n, a)
                end if
                work(:, by_rotor) = -self%drive(:, m) * turn
            end if
            do i = 1, works
                self%done(:, i) = self%done(:, i) + power(:, 1) * work(:, i)
            end do
        end do
    end subroutine add_work

    !> The integral over the unit interval of the product of two series of this degree, behind which zeros follow.
    pure function integral(degree, x, y)
        integer, intent(in) :: degree
        real(dp), dimension(lanes, 0:max_series_order + further), intent(in) :: x, y
        real(dp) :: integral(lanes), terms(lanes, 0:max_series_order + further)
        call multiply(degree + further, x, y, terms)
        integral = mean(degree + further, terms)
    end function integral

    !> The integral of a series over the unit interval.
    pure function mean(degree, x)
        integer, intent(in) :: degree
        real(dp), intent(in) :: x(lanes, 0:max_series_order + further)
        real(dp) :: mean(lanes)
        integer :: i, n
        mean = 0
        do n = 0, degree
            !$omp simd
            do i = 1, lanes
                mean(i) = mean(i) + of_power(n) * x(i, n)
            end do
        end do
    end function mean

    !> A row of a series over the step as the unit interval, with zeros behind it.
    pure subroutine take_row(degree, all, row, c, power, x)
        integer, intent(in) :: degree, all, row
        real(dp), intent(in) :: c(lanes, all, 0:degree), power(lanes, 0:degree)
        real(dp), intent(out) :: x(lanes, 0:max_series_order + further)
        integer :: i, n
        do n = 0, degree
            !$omp simd
            do i = 1, lanes
                x(i, n) = c(i, row, n) * power(i, n)
            end do
        end do
        x(:, degree + 1:degree + further) = 0
    end subroutine take_row

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, last, found)
        class(energy_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(motion_t), intent(in) :: last !! the motion at the end
        type(measures_t), intent(inout) :: found !! what is measured of the case
        found%energy_error = self%largest(lane)
    end subroutine finish

end module spintop_energy_lanes
