!> Final states of many motions together: cases are assigned to the lanes of Taylor's method.
!>
!>     call integrate_many(controls, bodies, starts, t_end, ends, outcomes)
!>     if (is_ok(outcomes(i)%status)) then; ... = ends(i)%quaternion
module spintop_many_bodies
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_caller, only: stop_is_wanted
    use spintop_compare, only: is_finite
    use spintop_effects, only: kernel_effects
    use spintop_euler_poisson, only: euler_poisson_rate
    use spintop_integration, only: outcome_t
    use spintop_kernel_types, only: motion_kinds_t
    use spintop_body_numbers, only: kinds_of
    use spintop_taylor_lanes, only: monitor_slot_t, taylor_lanes_t, lanes
    use spintop_motion, only: motion_t
    use spintop_quantities, only: angular_acceleration
    use spintop_status, only: is_ok, status_bad_input, status_bad_span, status_unsuitable
    use spintop_stepper, only: controls_t
    use spintop_suitability, only: controls_status
    use spintop_taylor, only: taylor_info
    use spintop_validity, only: body_status, motion_status
    implicit none
    private
    public :: integrate_many

    !> Cases that are not integrated, and bodies without effects.
    integer, parameter :: refused = 0, plain = 1

contains

    !> Integrates each body from its start over its span, and returns the motions at the ends and their
    !> outcomes. phi and psi count all their turns. `controls` contains the tolerances and the maximum number
    !> of steps per case. Any body is possible, damped or undamped, in any attitude, and with effects but dry friction and
    !> tables of torques (`status_unsuitable`). The result of a case does not depend on the others. A case that fails
    !> returns the last motion that it reached, also where a drag has no series because a speed is zero, or nearly so while the
    !> body reverses (`status_non_finite`, `status_step_too_small`); a case that is refused (`status_non_finite`, `status_bad_body`,
    !> `status_bad_start`, `status_bad_span`) returns its start. All cases are refused if the settings are not valid, or if
    !> the sizes of the arrays differ.
    recursive subroutine integrate_many(controls, bodies, starts, t_end, ends, outcomes, monitors)
        type(controls_t), intent(in) :: controls !! settings of the method
        type(body_t), intent(in) :: bodies(:) !! mass properties, one for each case
        type(motion_t), intent(in) :: starts(:) !! starts, one for each case
        real(dp), intent(in) :: t_end(:) !! ends of the spans, one for each case, s
        type(motion_t), intent(out) :: ends(:) !! motions at the end of the span, one for each case
        type(outcome_t), intent(out) :: outcomes(:) !! status, time reached and cost of each case
        type(monitor_slot_t), intent(inout), optional :: monitors(:) !! measure quantities along the motions
        type(monitor_slot_t) :: nobody(0)
        integer :: kind(size(bodies)), i

        if (.not. present(monitors)) then
            call integrate_many(controls, bodies, starts, t_end, ends, outcomes, nobody)
            return
        end if
        outcomes%status = controls_status(taylor_info, controls)
        if (any([size(starts), size(t_end), size(ends), size(outcomes)] /= size(bodies))) then
            outcomes%status = status_bad_input
            return
        end if
        if (any(.not. is_ok(outcomes%status))) return
        do i = 1, size(monitors)
            call monitors(i)%monitor%prepare(size(bodies))
        end do
        do i = 1, size(bodies)
            outcomes(i)%status = case_status(bodies(i), starts(i), t_end(i))
            kind(i) = kind_of(bodies(i))
            if (is_ok(outcomes(i)%status)) cycle
            kind(i) = refused
            ends(i) = starts(i)
        end do
        do while (any(kind /= refused))
            i = maxval(kind)
            call integrate_kind(controls, pack([(i, i=1, size(kind))], kind == i), bodies, starts, t_end, ends, &
                                outcomes, monitors)
            where (kind == i) kind = refused
        end do
    end subroutine integrate_many

    !> Whether the equations hold for a case.
    pure integer function case_status(body, start, t_end) result(status)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: t_end
        status = body_status(body)
        if (is_ok(status) .and. allocated(body%effects)) then
            if (.not. body%effects%only(kernel_effects)) status = status_unsuitable
        end if
        if (is_ok(status)) status = motion_status(start, body)
        if (is_ok(status) .and. .not. (t_end >= 0 .and. is_finite(t_end))) status = status_bad_span
    end function case_status

    !> A number of the effects on a body: `plain` without any, and the same for bodies with the same effects. Those are
    !> integrated together, so that no sum of a body depends on the effects on others.
    pure integer function kind_of(body) result(kind)
        type(body_t), intent(in) :: body
        type(motion_kinds_t) :: kinds
        kind = plain
        if (.not. allocated(body%effects)) return
        kinds = kinds_of(body)
        kind = plain + 1 + kinds%frame + 3 * (kinds%torque + 3 * (kinds%push + 3 * (kinds%rotor + 2 * kinds%drags)))
    end function kind_of

    !> Integrates the cases with the same effects.
    subroutine integrate_kind(controls, cases, bodies, starts, t_end, ends, outcomes, monitors)
        type(controls_t), intent(in) :: controls
        integer, intent(in) :: cases(:) !! their numbers
        type(body_t), intent(in) :: bodies(:)
        type(motion_t), intent(in) :: starts(:)
        real(dp), intent(in) :: t_end(:)
        type(motion_t), intent(inout) :: ends(:)
        type(outcome_t), intent(inout) :: outcomes(:)
        type(monitor_slot_t), intent(inout) :: monitors(:)
        type(taylor_lanes_t), target :: run
        integer :: case_in(lanes), next, lane, i

        if (allocated(bodies(cases(1))%effects)) then
            call run%set(controls, kinds_of(bodies(cases(1))))
        else
            call run%set(controls)
        end if
        case_in = 0
        next = 1
        do
            do lane = 1, lanes
                do while (.not. run%now%t(lane) < run%now%t_end(lane))
                    if (case_in(lane) > 0) then
                        call unload(run, lane, bodies(case_in(lane)), ends(case_in(lane)), outcomes(case_in(lane)))
                        do i = 1, size(monitors)
                            call monitors(i)%monitor%finish(run, lane, case_in(lane))
                        end do
                    end if
                    case_in(lane) = 0
                    if (next > size(cases)) exit
                    associate (case => cases(next))
                        call run%load(lane, bodies(case), starts(case), t_end(case))
                        do i = 1, size(monitors)
                            call monitors(i)%monitor%begin(run, lane, bodies(case), starts(case))
                        end do
                        case_in(lane) = case
                    end associate
                    next = next + 1
                end do
            end do
            if (all(case_in == 0)) exit
            if (stop_is_wanted()) then
                run%now%t_end = run%now%t
                cycle
            end if
            call run%advance()
            if (size(monitors) > 0) call run%find_powers()
            do i = 1, size(monitors)
                call monitors(i)%monitor%observe(run)
            end do
        end do
    end subroutine integrate_kind

    !> The motion in a lane, and its outcome.
    subroutine unload(run, lane, body, motion, outcome)
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: lane
        type(body_t), intent(in) :: body
        type(motion_t), intent(out) :: motion
        type(outcome_t), intent(out) :: outcome
        real(dp) :: rate(6)

        outcome%status = run%status(lane)
        outcome%t = run%now%t(lane)
        outcome%counts%steps = run%steps(lane)
        outcome%counts%evaluations = run%order * run%steps(lane)
        outcome%doubtful_passages = run%passed(lane)%doubtful
        motion = run%motion(lane)
        if (allocated(body%effects)) then
            motion%omega_rate = angular_acceleration(body, motion)
            return
        end if
        rate = euler_poisson_rate(body, [run%now%state(lane, 4:6), body%inertia * motion%omega])
        motion%omega_rate = rate(4:6) / body%inertia
    end subroutine unload

end module spintop_many_bodies
