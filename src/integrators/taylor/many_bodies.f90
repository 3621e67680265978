!> Final states of many motions together: cases are assigned to the lanes of Taylor's method.
!>
!>     call integrate_many(controls, bodies, starts, t_end, ends, outcomes)
!>     if (outcomes(i)%status == status_ok) then; ... = ends(i)%quaternion
module spintop_many_bodies
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_euler_poisson, only: euler_poisson_rate
    use spintop_integration, only: outcome_t
    use spintop_lane_watch, only: watch_slot_t
    use spintop_motion, only: motion_t
    use spintop_status, only: status_ok, status_bad_input, status_bad_span
    use spintop_stepper, only: controls_t, method_info_t
    use spintop_suitability, only: controls_status
    use spintop_taylor_lanes, only: taylor_lanes_t, lanes
    use spintop_validity, only: plain_body_status, motion_status
    implicit none
    private
    public :: integrate_many

    !> The method against which settings are checked: adaptive, with a tolerance.
    type(method_info_t), parameter :: lanes_info = method_info_t(name='taylor', adaptive=.true.)

contains

    !> Integrates each body from its start over its span, and returns the motions at the ends and their
    !> outcomes. phi and psi count all their turns. `controls` contains the tolerances and the maximum number
    !> of steps per case. Any body is possible, damped or undamped, in any attitude. The result of a case does
    !> not depend on the others. A case that fails returns the last motion that it reached; a case that is
    !> refused (`status_non_finite`, `status_bad_body`, `status_bad_start`, `status_bad_span`) returns its
    !> start. All cases are refused if the settings are not valid, or if the sizes of the arrays differ.
    subroutine integrate_many(controls, bodies, starts, t_end, ends, outcomes, watches)
        type(controls_t), intent(in) :: controls !! settings of the method
        type(body_t), intent(in) :: bodies(:) !! mass properties, one for each case
        type(motion_t), intent(in) :: starts(:) !! starts, one for each case
        real(dp), intent(in) :: t_end(:) !! s
        type(motion_t), intent(out) :: ends(:) !! motions at the end of the span, one for each case
        type(outcome_t), intent(out) :: outcomes(:) !! status, time reached and cost of each case
        type(watch_slot_t), intent(inout), optional :: watches(:) !! measure quantities along the motions
        type(taylor_lanes_t), target :: run
        integer :: case_in(lanes), next, lane, i, watching

        outcomes%status = controls_status(lanes_info, controls)
        if (any([size(starts), size(t_end), size(ends), size(outcomes)] /= size(bodies))) then
            outcomes%status = status_bad_input
            return
        end if
        if (any(outcomes%status /= status_ok)) return
        watching = 0
        if (present(watches)) watching = size(watches)
        do i = 1, watching
            call watches(i)%watch%prepare(size(bodies))
        end do
        call run%set(controls)
        case_in = 0
        next = 1
        do
            do lane = 1, lanes
                do while (.not. run%now%t(lane) < run%now%t_end(lane))
                    if (case_in(lane) > 0) then
                        call unload(run, lane, bodies(case_in(lane)), ends(case_in(lane)), outcomes(case_in(lane)))
                        do i = 1, watching
                            call watches(i)%watch%finish(run, lane, case_in(lane))
                        end do
                    end if
                    case_in(lane) = 0
                    call skip_refused()
                    if (next > size(bodies)) exit
                    call run%load(lane, bodies(next), starts(next), t_end(next))
                    do i = 1, watching
                        call watches(i)%watch%begin(run, lane, bodies(next), starts(next))
                    end do
                    case_in(lane) = next
                    next = next + 1
                end do
            end do
            if (all(case_in == 0)) exit
            call run%advance()
            do i = 1, watching
                call watches(i)%watch%look(run)
            end do
        end do

    contains

        !> Moves to the next case that can be loaded.
        subroutine skip_refused()
            do while (next <= size(bodies))
                associate (status => outcomes(next)%status)
                    status = plain_body_status(bodies(next))
                    if (status == status_ok) status = motion_status(starts(next), bodies(next))
                    if (status == status_ok) then
                        if (t_end(next) >= 0 .and. is_finite(t_end(next))) return
                        status = status_bad_span
                    end if
                end associate
                ends(next) = starts(next)
                next = next + 1
            end do
        end subroutine skip_refused

    end subroutine integrate_many

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
        motion = run%motion(lane)
        rate = euler_poisson_rate(body, [run%now%state(lane, 4:6), body%inertia * motion%omega])
        motion%omega_rate = rate(4:6) / body%inertia
    end subroutine unload

end module spintop_many_bodies
