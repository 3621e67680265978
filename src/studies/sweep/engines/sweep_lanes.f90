!> Cases of a sweep that are integrated together, in vector lanes: bodies without a closed form, of which the table
!> contains the end of the span, or what the monitors in lanes measure. What this engine cannot do, `takes` says.
module spintop_sweep_lanes
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_effects, only: kernel_effects
    use spintop_energy_lanes, only: energy_lanes_t
    use spintop_event_recorder, only: column_event_t
    use spintop_formulation, only: formulation_info_t
    use spintop_integration, only: outcome_t
    use spintop_kinds, only: dp, is_equal, is_finite, is_zero, no_number, pi
    use spintop_lane_watch, only: count_turns, keep_extremes, lane_watch_t, watched_t
    use spintop_lyapunov, only: growth_lanes_t
    use spintop_measures, only: measures_t, quantities, watch_nothing, watch_theta, watch_turning, watches
    use spintop_motion, only: motion_t
    use spintop_pole_passages, only: through_pole
    use spintop_poles, only: nearly_plane, swings_over_poles
    use spintop_status, only: is_good_end, status_non_finite, status_step_too_small
    use spintop_stepper, only: controls_t, project_nothing
    use spintop_sweep_quantities, only: engine_t, lacks_motion, slot_t, task_t, compute_stability, find_free_constants, &
        precession_period, set_azimuth, set_end, set_fast_top, set_measured, watched_for
    use spintop_sweep_result, only: at_evaluations, kinds_of_work, note_no_stop, of_class, of_energy, of_fast_top, of_fastest, &
        of_force, of_lyapunov, of_measured, of_nutation_rate, of_period, of_range, of_singular, of_turns, of_vertical_force
    use spintop_taylor_lanes, only: integrate_many, lane_monitor_t, lanes, monitor_slot_t, taylor_lanes_t
    implicit none
    private
    public :: sweep_lanes_t

    !> The engine for bodies without a closed form, with Taylor's method for the equations of any body, with effects that have
    !> series and without, and with no event before the end that the monitors in lanes do not find.
    type, extends(engine_t) :: sweep_lanes_t
        type(monitor_slot_t), allocatable, private :: monitors(:)
        !> The settings for which the monitors were made.
        type(controls_t), private :: monitored
    contains
        procedure, nopass :: takes
        procedure :: compute
        procedure, nopass :: shares_lanes
    end type sweep_lanes_t

    !> The end of a motion is the period if it is by no more than this, relatively, before it.
    real(dp), parameter :: rounding = 4 * epsilon(1.0_dp)

    !> Watches the azimuth.
    type, extends(lane_monitor_t) :: azimuth_lanes_t
        !> The period, s, of lanes that have not reached it; of others it is beyond all times. phi at the start, and its change
        !> in the period, rad.
        real(dp), dimension(lanes), private :: period = huge(1.0_dp), start = 0, azimuth = no_number
    contains
        procedure :: begin
        procedure :: observe
        procedure :: finish
    end type azimuth_lanes_t

    !> Least sine of an inclination whose passages are found by its cosine.
    real(dp), parameter :: least_sine = 1.0e-3_dp

contains

    !> Cases that lanes can compute: those of a body and a method that run in lanes, with events that lanes find.
    logical function takes(slot, task)
        type(slot_t), intent(in) :: slot !! the case
        type(task_t), intent(in) :: task !! what is asked of it
        type(formulation_info_t) :: form

        takes = .false.
        associate (case => slot%case, plan => slot%plan, wanted => task%wanted)
            if (plan%exact .or. case%body%is_lagrange()) return
            form = plan%formulation%info()
            if (.not. (plan%stepper%info%runs_in_lanes .and. form%runs_in_lanes)) return
            if (plan%stepper%controls%project /= project_nothing) return
            if (allocated(case%body%effects)) then
                if (needs_plain_body(wanted) .or. .not. case%body%effects%only(kernel_effects)) return
            end if
            ! Lanes count no turns in other axes, and measure nothing there.
            if (case%body%given%differ .and. (wanted(of_turns) .or. wanted(of_measured) .or. wanted(of_range))) return
            ! Nor do they find extremes in poles, or of a force that is constant.
            if (wanted(of_nutation_rate) .or. (wanted(of_fastest) .or. wanted(of_class))) then
                if (swings_over_poles(case%body, case%start, nearly_plane) .or. starts_beside_pole(case%start)) return
            end if
            if ((wanted(of_force) .or. wanted(of_vertical_force)) .and. all(is_zero(case%body%centre_of_mass))) return
            takes = ends_in_lanes(task%events, case)
        end associate
    end function takes

    !> Whether body z is so close to a pole that the extremes of its rates in passing it are lost in rounding errors of the
    !> polynomials. In a pole they are limits.
    pure logical function starts_beside_pole(start)
        type(motion_t), intent(in) :: start
        real(dp), parameter :: beside = 1.0e-6_dp
        real(dp) :: gamma(3), sine
        gamma = vertical_from_quaternion(start%quaternion)
        sine = norm2(gamma(1:2))
        starts_beside_pole = sine > through_pole .and. sine < beside
    end function starts_beside_pole

    !> Whether a monitor finds the events that end the motions: passages of one value of a column that is an angle or a
    !> form of the motion, or turning points, of a body in the axes in which it was given.
    pure logical function ends_in_lanes(events, case)
        type(column_event_t), intent(in) :: events(:) !! the events, each of which ends the motion
        type(case_t), intent(in) :: case !! the case: its axes and effects decide which columns are forms of the motion
        integer :: i
        ends_in_lanes = size(events) == 0
        if (ends_in_lanes .or. case%turn%is_turned()) return
        do i = 1, size(events)
            associate (event => events(i)%event)
                if (events(i)%column%name /= events(1)%column%name) return
                if (event%every_turn .neqv. events(1)%event%every_turn) return
                if (event%turn_by_turn .neqv. events(1)%event%turn_by_turn) return
                if (.not. is_equal(event%level, events(1)%event%level)) return
                select case (events(i)%column%passing)
                case (watch_nothing)
                    return
                case (watch_theta)
                    ! Near a pole cos(theta) does not determine theta.
                    if (.not. (event%level > 0 .and. event%level < pi .and. sin(event%level) > least_sine)) return
                case (watch_turning)
                    if (.not. is_zero(event%level)) return
                end select
                if (allocated(case%body%effects) .and. quantities(events(i)%column%passing)%needs_plain_body) return
            end associate
        end do
        ends_in_lanes = .true.
    end function ends_in_lanes

    !> Whether monitors in lanes would find a quantity by equations that hold without effects.
    pure logical function needs_plain_body(wanted)
        logical, intent(in) :: wanted(kinds_of_work)
        needs_plain_body = wanted(of_lyapunov) .or. wanted(of_singular) .or. any(quantities(watched_for(wanted))%needs_plain_body)
    end function needs_plain_body

    !> Cases with the same settings share lanes.
    logical function shares_lanes(a, b)
        type(slot_t), intent(in) :: a, b !! the cases
        shares_lanes = are_like(a%plan%stepper%controls, b%plan%stepper%controls)
    end function shares_lanes

    !> Whether the settings that concern lanes are the same.
    elemental logical function are_like(a, b)
        type(controls_t), intent(in) :: a, b
        are_like = is_equal(a%relative_tolerance, b%relative_tolerance) .and. a%max_steps == b%max_steps &
            .and. is_equal(a%absolute_tolerance, b%absolute_tolerance)
    end function are_like

    !> Computes the cases in lanes; those that lanes left are to be computed one by one.
    subroutine compute(self, slots, list, task)
        class(sweep_lanes_t), intent(inout) :: self
        type(slot_t), intent(inout) :: slots(:) !! the block
        integer, intent(in) :: list(:) !! the places of the cases
        type(task_t), intent(in) :: task !! what is asked of them
        logical, dimension(kinds_of_work) :: in_lanes, alone
        type(motion_t), allocatable :: ends(:)
        type(outcome_t), allocatable :: outcomes(:)
        type(measures_t), allocatable :: measures(:)
        logical :: is_new
        integer :: i

        in_lanes = task%wanted
        alone = task%wanted
        ! Perturbations are followed to the end of the motion: beside it only if no event ends it.
        if (size(task%events) > 0) then
            in_lanes([of_lyapunov, of_singular]) = .false.
        else
            alone([of_lyapunov, of_singular]) = .false.
        end if
        associate (controls => slots(list(1))%plan%stepper%controls)
            is_new = .not. allocated(self%monitors)
            if (.not. is_new) is_new = .not. are_like(self%monitored, controls)
            if (is_new) call create_monitors(in_lanes, controls, task%events, task%stop_after, self%monitors)
            self%monitored = controls
            allocate (ends(size(list)), outcomes(size(list)), measures(size(list)))
            call integrate_many(controls, slots(list)%case%body, slots(list)%case%start, slots(list)%case%t_end, ends, outcomes, &
                                self%monitors, measures)
        end associate
        do i = 1, size(list)
            associate (slot => slots(list(i)), last => ends(i), outcome => outcomes(i), found => measures(i), wanted => task%wanted)
                found%ends = [slot%case%start%angle(2), last%angle(2)]
                ! A motion with effects that came to a point where it has no series is left to others.
                if (allocated(slot%case%body%effects) .and. &
                    any(outcome%status == [status_non_finite, status_step_too_small])) then
                    slot%lacks = lacks_motion
                    cycle
                end if
                slot%status = outcome%status
                if (is_good_end(slot%status)) call compute_stability(slot, last%t, alone)
                if (wanted(of_fast_top)) call set_fast_top(slot)
                slot%result%of(at_evaluations) = real(outcome%counts%evaluations, dp)
                if (.not. is_good_end(slot%status)) then
                    call slot%fail(slot%status)
                    cycle
                end if
                call set_end(slot, last, found%energy_error)
                call slot%explain_turns(outcome%doubtful_passages, wanted)
                if (size(task%events) == 0) call slot%store_growth(found%growth, wanted)
                if (wanted(of_period)) call set_azimuth(slot, is_finite(found%azimuth), found%azimuth)
                if (size(task%events) > 0 .and. .not. found%event_occurred) call slot%note%add(note_no_stop)
                call set_measured(slot, found, wanted)
                call find_free_constants(slot, wanted)
            end associate
        end do
    end subroutine compute

    !> Creates the monitors for the work and for the events.
    subroutine create_monitors(wanted, controls, events, stop_after, slots)
        logical, intent(in) :: wanted(kinds_of_work) !! what is to be computed
        type(controls_t), intent(in) :: controls !! settings of the method
        type(column_event_t), intent(in) :: events(:) !! the events that end the motion, `ends_in_lanes`
        integer, intent(in) :: stop_after !! number of events after which the motion ends
        type(monitor_slot_t), allocatable, intent(out) :: slots(:) !! the monitors
        type(growth_lanes_t) :: growth
        integer :: n, k
        allocate (slots(4 + watches))
        n = 0
        ! First, so that the others see the motion up to its end.
        if (size(events) > 0) then
            associate (event => events(1)%event, column => events(1)%column)
                call append(lane_watch_t(of=watched_t(column%passing, column%component, event%level), wanted=stop_after, &
                                         rising=any(events%event%direction > 0), falling=any(events%event%direction < 0), &
                                         every_turn=event%every_turn, turn_by_turn=event%turn_by_turn))
            end associate
        end if
        if (wanted(of_period)) call append(azimuth_lanes_t())
        associate (of => watched_for(wanted))
            do k = 1, size(of)
                call append(lane_watch_t(watched_t(of(k)), merge(count_turns, keep_extremes, of(k) == watch_turning)))
            end do
        end associate
        if (wanted(of_energy)) call append(energy_lanes_t())
        if (wanted(of_lyapunov) .or. wanted(of_singular)) then
            call growth%set(controls, is_singular=wanted(of_singular), with_exponent=wanted(of_lyapunov))
            call append(growth)
        end if
        slots = slots(:n)

    contains

        !> Appends a monitor to the list.
        subroutine append(monitor)
            class(lane_monitor_t), intent(in) :: monitor
            n = n + 1
            allocate (slots(n)%monitor, source=monitor)
        end subroutine append

    end subroutine create_monitors

    !> A case begins in a lane.
    subroutine begin(self, run, lane, body, start)
        class(azimuth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: period
        period = precession_period(body, start)
        self%period(lane) = merge(period, huge(period), period > 0)
        self%start(lane) = start%angle(1)
        self%azimuth(lane) = no_number
    end subroutine begin

    !> Records the azimuth in lanes that reached the period in the last step.
    subroutine observe(self, run)
        class(azimuth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp) :: angles(2)
        integer :: lane
        associate (now => run%now)
            if (.not. any(now%t * (1 + rounding) >= self%period)) return
            do lane = 1, lanes
                if (.not. now%t(lane) * (1 + rounding) >= self%period(lane)) cycle
                ! What the next step begins with is more accurate there.
                if (self%period(lane) > now%t(lane) .and. now%t(lane) < now%t_end(lane)) cycle
                angles = run%angles_at(lane, min(self%period(lane), now%t(lane)))
                self%azimuth(lane) = angles(1) - self%start(lane)
                self%period(lane) = huge(1.0_dp)
            end do
        end associate
    end subroutine observe

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, last, found)
        class(azimuth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(motion_t), intent(in) :: last !! the motion at the end
        type(measures_t), intent(inout) :: found !! what is measured of the case
        found%azimuth = self%azimuth(lane)
        self%period(lane) = huge(1.0_dp)
    end subroutine finish

end module spintop_sweep_lanes
