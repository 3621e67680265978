!> Energy errors along the motions in lanes, at the ends of the steps: of bodies with effects less their work.
!>
!> The power of an effect is the product of its moment and the angular velocity, so its integral over a step is that of a product
!> of two series.
module spintop_energy_lanes
    use spintop_body, only: body_t
    use spintop_formulation, only: max_series_order
    use spintop_kernel_types, only: more_rows
    use spintop_kinds, only: dp, no_number
    use spintop_lane_effects, only: lane_effects_t, row_drags, row_frame, row_moment, row_push, row_torque, rows_of_drag
    use spintop_lane_monitor, only: lane_monitor_t
    use spintop_lane_polynomials, only: multiply
    use spintop_lane_series, only: rows
    use spintop_motion, only: motion_t
    use spintop_quantities, only: energy_scale, kinetic_energy, potential_energy
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: energy_lanes_t

    !> Parts of the work: of what is linear in the angular velocity, of other drags, of the vibration, of torques, of the rotor.
    integer, parameter :: by_damping = 1, by_drag = 2, by_vibration = 3, by_torque = 4, by_rotor = 5, works = 5

    !> Watches the energy, of bodies with effects less their work; `error_max` is the largest relative error of each case.
    type, extends(lane_monitor_t) :: energy_lanes_t
        real(dp), allocatable :: error_max(:)
        !> Half the moments of inertia, and the torque of gravity, both over the scale of the energy; the energy at the start,
        !> likewise.
        real(dp), dimension(lanes, 3), private :: half_inertia = 0, moment = 0
        real(dp), dimension(lanes), private :: at_start = 0, largest = 0
        !> The work so far by its parts, likewise.
        real(dp), private :: done(lanes, works) = 0
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
        self%error_max = spread(no_number, 1, cases)
    end subroutine prepare

    !> A case begins in a lane.
    subroutine begin(self, run, lane, body, start)
        class(energy_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: energy(lanes), scale
        scale = energy_scale(body, start)
        self%half_inertia(lane, :) = body%inertia / 2 / scale
        self%moment(lane, :) = body%weight_moment() / scale
        self%done(lane, :) = 0
        self%largest(lane) = 0
        call find_energies(self, run, energy)
        self%at_start(lane) = energy(lane)
        ! That of the frame counts with effects.
        if (allocated(body%effects)) self%at_start(lane) = (kinetic_energy(body, start) + potential_energy(body, start)) / scale
    end subroutine begin

    !> Records the errors at the ends of the last step.
    subroutine observe(self, run)
        class(energy_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), dimension(lanes) :: energy, work
        integer :: i
        call find_energies(self, run, energy)
        if (allocated(run%effects)) then
            call add_work(self, run%order, run%effects, run%power, run%c, run%more)
            if (run%effects%kinds%turns > 0) call add_frame(self, run%order, run%effects, run%now%t, run%power, run%more, energy)
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

    !> Adds the work over the last step: that of what makes the angular acceleration a is the integral of I a.omega. `more` has the
    !> rows of effects.
    pure subroutine add_work(self, order, effects, power, c, more)
        class(energy_lanes_t), intent(inout) :: self
        integer, intent(in) :: order
        type(lane_effects_t), intent(in) :: effects
        real(dp), intent(in) :: power(lanes, 0:order), c(lanes, rows, 0:order), more(lanes, more_rows, 0:order)
        real(dp), dimension(lanes, 0:max_series_order) :: w, a ! of known size, on the stack
        real(dp) :: inertia(lanes, 3), work(lanes, works), drive(lanes)
        integer :: m, n, next, last, d, k

        n = order - 1
        inertia = 2 * self%half_inertia
        associate (of => effects%of, has => effects%kinds)
            do m = 1, 3
                next = 1 + mod(m, 3)
                last = 1 + mod(next, 3)
                work = 0
                w(:, :n) = c(:, m, :n) * power(:, :n)
                if (any(of%decay(:, m) > 0)) work(:, by_damping) = -of%decay(:, m) * inertia(:, m) * integral(n, w, w)
                do d = 1, has%drags
                    a(:, :n) = more(:, row_drags + rows_of_drag * (d - 1) + row_moment + m - 1, :n) * power(:, :n)
                    work(:, by_drag) = work(:, by_drag) - of%drag(d)%moment(:, m) * inertia(:, m) * integral(n, a, w)
                end do
                if (has%vibrates > 0) then
                    do k = 0, n
                        a(:, k) = (of%pull(:, m) * more(:, row_push + next - 1, k) &
                                   - of%swing(:, m) * more(:, row_push + last - 1, k)) * power(:, k)
                    end do
                    work(:, by_vibration) = inertia(:, m) * integral(n, a, w)
                end if
                if (has%twists > 0) then
                    a(:, :n) = more(:, row_torque + m - 1, :n) * power(:, :n)
                    work(:, by_torque) = of%inverse_inertia(:, m) * inertia(:, m) * integral(n, a, w)
                end if
                ! The constant torque is less that of the rotor, which the motion of the frame meets, too.
                drive = of%drive(:, last, 1) * inertia(:, last)
                work(:, by_torque) = work(:, by_torque) + (of%torque(:, m) * inertia(:, m) + drive) * mean(n, w)
                if (has%turns > 0) w(:, :n) = w(:, :n) + more(:, row_frame + m - 1, :n) * power(:, :n)
                work(:, by_rotor) = -drive * mean(n, w)
                self%done = self%done + spread(power(:, 1), 2, works) * work
            end do
        end associate
    end subroutine add_work

    !> The integral over the unit interval of the product of two series of this degree. A few terms of the product behind that
    !> count: what is left out is then less than what the series leave out.
    pure function integral(degree, x, y)
        integer, intent(in) :: degree
        real(dp), intent(in) :: x(lanes, 0:max_series_order), y(lanes, 0:max_series_order)
        integer, parameter :: further = 4
        real(dp), dimension(lanes, 0:max_series_order + further) :: a, b, terms
        real(dp) :: integral(lanes)
        a(:, :degree) = x(:, :degree)
        b(:, :degree) = y(:, :degree)
        a(:, degree + 1:degree + further) = 0
        b(:, degree + 1:degree + further) = 0
        call multiply(degree + further, a, b, terms)
        integral = mean(degree + further, terms)
    end function integral

    !> The integral of a series over the unit interval.
    pure function mean(degree, x)
        integer, intent(in) :: degree
        real(dp), intent(in) :: x(lanes, 0:degree)
        real(dp) :: mean(lanes)
        integer :: k
        mean = 0
        do k = degree, 0, -1
            mean = mean + x(:, k) / (k + 1)
        end do
    end function mean

    !> Adds the potential energies of the motion of the frame at the ends of the last step, -O.IO/2 - O.h.
    pure subroutine add_frame(self, order, effects, t, power, more, energy)
        class(energy_lanes_t), intent(in) :: self
        integer, intent(in) :: order
        type(lane_effects_t), intent(in) :: effects
        real(dp), intent(in) :: t(lanes), power(lanes, 0:order), more(lanes, more_rows, 0:order)
        real(dp), intent(inout) :: energy(lanes)
        real(dp) :: frame(lanes)
        integer :: m, last
        do m = 1, 3
            last = 1 + mod(m + 1, 3)
            frame = sum(more(:, row_frame + m - 1, :) * power, dim=2)
            associate (h => effects%of%rotor(:, last, 1), rate => effects%of%drive(:, last, 1))
                energy = energy - frame * (self%half_inertia(:, m) * frame + 2 * self%half_inertia(:, last) * (h + t * rate))
            end associate
        end do
    end subroutine add_frame

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, case)
        class(energy_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        self%error_max(case) = self%largest(lane)
    end subroutine finish

end module spintop_energy_lanes
