!> The ends of many motions at once: cases queue for the lanes of Taylor's method.
!>
!>     call integrate_many(controls, bodies, starts, t_end, ends, outcomes)
!>     if (outcomes(i)%status == status_ok) then; ... = ends(i)%quaternion
module spintop_many_bodies
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_euler_poisson, only: euler_poisson_rate
    use spintop_integration, only: outcome_t
    use spintop_motion, only: motion_t
    use spintop_status, only: status_ok, status_bad_input, status_bad_span
    use spintop_stepper, only: controls_t, method_info_t
    use spintop_suitability, only: controls_status
    use spintop_taylor_lanes, only: taylor_lanes_t, lanes
    use spintop_validity, only: body_status, motion_status
    implicit none
    private
    public :: integrate_many

    !> What settings are checked against: steps are chosen by a tolerance.
    type(method_info_t), parameter :: lanes_info = method_info_t(name='taylor', adaptive=.true.)

contains

    !> Follows each of the bodies from its start over its span and gives the motions at the ends and
    !> how they were reached, phi and psi with all their turns. `controls` are the tolerances and the
    !> maximum number of steps per case. Any body is possible, damped or not, and any attitude. The result of
    !> a case does not depend on the others. A case that fails gives the last motion that it reached; one that is
    !> refused (`status_non_finite`, `status_bad_body`, `status_bad_start`, `status_bad_span`) its start.
    !> Settings that are not valid refuse all cases, as do arrays that are not of one size.
    subroutine integrate_many(controls, bodies, starts, t_end, ends, outcomes)
        type(controls_t), intent(in) :: controls
        type(body_t), intent(in) :: bodies(:)
        type(motion_t), intent(in) :: starts(:)
        real(dp), intent(in) :: t_end(:) !! s
        type(motion_t), intent(out) :: ends(:)
        type(outcome_t), intent(out) :: outcomes(:)
        type(taylor_lanes_t) :: run
        integer :: case_in(lanes), next, lane

        outcomes%status = controls_status(lanes_info, controls)
        if (any([size(starts), size(t_end), size(ends), size(outcomes)] /= size(bodies))) then
            outcomes%status = status_bad_input
            return
        end if
        if (any(outcomes%status /= status_ok)) return
        call run%set(controls)
        case_in = 0
        next = 1
        do
            do lane = 1, lanes
                do while (.not. run%t(lane) < run%t_end(lane))
                    if (case_in(lane) > 0) then
                        call unload(run, lane, bodies(case_in(lane)), ends(case_in(lane)), outcomes(case_in(lane)))
                    end if
                    case_in(lane) = 0
                    call skip_refused()
                    if (next > size(bodies)) exit
                    call run%load(lane, bodies(next), starts(next), t_end(next))
                    case_in(lane) = next
                    next = next + 1
                end do
            end do
            if (all(case_in == 0)) exit
            call run%advance()
        end do

    contains

        !> Moves to the next case that can be loaded.
        subroutine skip_refused()
            do while (next <= size(bodies))
                associate (status => outcomes(next)%status)
                    status = body_status(bodies(next))
                    if (status == status_ok) status = motion_status(starts(next))
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

    !> The motion in a lane, and how it was reached.
    subroutine unload(run, lane, body, motion, outcome)
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: lane
        type(body_t), intent(in) :: body
        type(motion_t), intent(out) :: motion
        type(outcome_t), intent(out) :: outcome
        real(dp) :: rate(6)

        outcome%status = run%status(lane)
        outcome%t = run%t(lane)
        outcome%counts%steps = run%steps(lane)
        outcome%counts%evaluations = run%order * run%steps(lane)
        motion = run%motion(lane)
        rate = euler_poisson_rate(body, [run%state(lane, 4:6), body%inertia * motion%omega])
        motion%omega_rate = rate(4:6) / body%inertia
    end subroutine unload

end module spintop_many_bodies
