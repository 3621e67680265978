!> Cases of a sweep that are integrated together, in vector lanes: bodies without a closed form, of which the table
!> contains the end of the span, or what the monitors in lanes measure.
module spintop_sweep_lanes
    use spintop_kinds, only: dp, is_equal, is_finite, is_zero
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_effects, only: kernel_effects
    use spintop_formulation, only: formulation_info_t
    use spintop_integration, only: outcome_t
    use spintop_measures, only: measures_t, quantities
    use spintop_motion, only: motion_t
    use spintop_pole_passages, only: through_pole
    use spintop_poles, only: nearly_plane, swings_over_poles
    use spintop_projection, only: project_nothing
    use spintop_status, only: is_good_end, status_non_finite, status_step_too_small
    use spintop_stepper, only: controls_t
    use spintop_sweep_engine, only: engine_t, lacks_motion, slot_t, task_t
    use spintop_sweep_quantities, only: compute_stability, find_free_constants, set_azimuth, set_end, set_fast_top, set_measured, &
        watched_for
    use spintop_sweep_result, only: at_evaluations, kinds_of_work, note_no_stop, of_class, of_fast_top, of_fastest, of_force, &
        of_lyapunov, of_measured, of_nutation_rate, of_period, of_range, of_singular, of_turns, of_vertical_force
    use spintop_sweep_monitors, only: create_monitors
    use spintop_sweep_stop, only: ends_in_lanes
    use spintop_taylor_lanes, only: integrate_many, monitor_slot_t
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
            measures(i)%ends = [slots(list(i))%case%start%angle(2), ends(i)%angle(2)]
            call set_quantities(ends(i), outcomes(i), measures(i), task, alone, slots(list(i)))
        end do
    end subroutine compute

    !> Stores the quantities of a case. A motion with effects that came to a point where it has no series is left to others.
    subroutine set_quantities(last, outcome, found, task, alone, slot)
        type(motion_t), intent(in) :: last
        type(outcome_t), intent(in) :: outcome
        type(measures_t), intent(in) :: found
        type(task_t), intent(in) :: task
        logical, intent(in) :: alone(kinds_of_work)
        type(slot_t), intent(inout) :: slot

        if (allocated(slot%case%body%effects) .and. any(outcome%status == [status_non_finite, status_step_too_small])) then
            slot%lacks = lacks_motion
            return
        end if
        slot%status = outcome%status
        associate (wanted => task%wanted)
            if (is_good_end(slot%status)) call compute_stability(slot, last%t, alone)
            if (wanted(of_fast_top)) call set_fast_top(slot)
            slot%result%of(at_evaluations) = real(outcome%counts%evaluations, dp)
            if (.not. is_good_end(slot%status)) then
                call slot%fail(slot%status)
                return
            end if
            call set_end(slot, last, found%energy_error)
            call slot%explain_turns(outcome%doubtful_passages, wanted)
            if (size(task%events) == 0) call slot%store_growth(found%growth, wanted)
            if (wanted(of_period)) call set_azimuth(slot, is_finite(found%azimuth), found%azimuth)
            if (size(task%events) > 0 .and. .not. found%event_occurred) call slot%note%add(note_no_stop)
            call set_measured(slot, found, wanted)
            call find_free_constants(slot, wanted)
        end associate
    end subroutine set_quantities

end module spintop_sweep_lanes
