!> Compatibility of steppers, formulations and bodies.
!>
!> `can_run` is the one place that decides it, for `integrate`, for the plans of the program and for tests.
!> The single conditions are separate procedures, for detailed messages.
module spintop_suitability
    use spintop_kinds, only: dp, is_zero
    use spintop_arkode, only: arkode_table_t, find_arkode_table
    use spintop_body, only: body_t
    use spintop_formulation, only: formulation_t, formulation_info_t, structure_none
    use spintop_motion, only: motion_t
    use spintop_projection, only: project_nothing, project_unit, project_invariants
    use spintop_status, only: is_ok, status_bad_controls, status_bad_projection, status_bad_samples, status_bad_span, &
        status_no_steps, status_no_structure, status_ok, status_stuck_at_turn, status_unsuitable
    use spintop_stepper, only: controls_t, method_info_t, stepper_t
    use spintop_validity, only: body_status, start_status
    implicit none
    private
    public :: can_run, holds_for, has_structure, passes_turns, projection_status, controls_status, call_status

contains

    !> Whether a stepper, with its settings, can integrate a formulation for a body: `status_ok`, or the first
    !> of
    !>
    !> * `status_unsuitable`: the equations do not hold for the body;
    !> * `status_no_structure`: the method needs more of them than y' = f(t, y), and they do not offer it;
    !> * `status_stuck_at_turn`: the method would be caught at the first turning point of theta;
    !> * `status_bad_projection`: there is nothing to project on;
    !> * `status_no_steps`, `status_bad_controls`: the settings of the method are not valid.
    integer function can_run(stepper, formulation, body) result(status)
        class(stepper_t), intent(in) :: stepper !! the method with its settings
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(formulation_info_t) :: form
        form = formulation%info()
        if (.not. holds_for(form, body)) then
            status = status_unsuitable
        else if (.not. has_structure(form, stepper%info)) then
            status = status_no_structure
        else if (.not. passes_turns(form, stepper%info)) then
            status = status_stuck_at_turn
        else
            status = projection_status(stepper%controls%project, form, body)
            if (is_ok(status)) status = controls_status(stepper%info, stepper%controls)
        end if
    end function can_run

    !> Whether the equations hold for a body.
    pure logical function holds_for(form, body)
        type(formulation_info_t), intent(in) :: form !! properties of the formulation
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        if (form%symmetric_only) then
            holds_for = body%is_lagrange() .and. body%inertia(1) > 0
        else
            holds_for = all(body%inertia > 0)
        end if
        if (allocated(body%effects)) holds_for = holds_for .and. form%takes_effects
    end function holds_for

    !> Whether the equations offer the structure that a method needs.
    pure logical function has_structure(form, method)
        type(formulation_info_t), intent(in) :: form !! properties of the formulation
        type(method_info_t), intent(in) :: method !! properties of the method
        has_structure = method%needs == structure_none
        if (.not. has_structure) has_structure = form%offers(method%needs)
    end function has_structure

    !> Whether a method passes the turning points of theta with these equations.
    !>
    !> With theta' = v reset from the energy after each step, v^2 = 2 a d at a distance d from a turning point
    !> where theta'' = -a. A step of size h of a method with sum b_i c_i = c takes x = v/(a h) to
    !> sqrt((x - 1)^2 + 2 c - 1), with the sign of x - 1. For c = 1/2, every method of order 2 or more, this
    !> is |x - 1|: the turning point is passed. For c = 0 (explicit Euler) the root vanishes at once, and
    !> v = 0 does not move theta. For c = 1 (implicit Euler) x tends to 1 from above, where theta rests until
    !> rounding errors move it. In between (c = 2/3, `galerkin`) it is passed.
    pure logical function passes_turns(form, method)
        type(formulation_info_t), intent(in) :: form !! properties of the formulation
        type(method_info_t), intent(in) :: method !! properties of the method
        passes_turns = .not. (form%resets_speed .and. method%caught_by_reset)
    end function passes_turns

    !> `status_ok`, or `status_bad_projection` if there is nothing to project on: no quaternion, or no
    !> invariants. A damped body conserves only the norm of the quaternion.
    pure integer function projection_status(kind, form, body) result(status)
        integer, intent(in) :: kind !! as in `spintop_projection`
        type(formulation_info_t), intent(in) :: form !! properties of the formulation
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        logical :: possible
        select case (kind)
        case (project_nothing)
            possible = .true.
        case (project_unit)
            possible = form%quaternion > 0
        case (project_invariants)
            possible = form%invariants > 0 .and. all(is_zero(body%damping))
        case default
            possible = .false.
        end select
        status = merge(status_ok, status_bad_projection, possible)
    end function projection_status

    !> `status_ok`, or the status of settings that are not valid for a method: `status_no_steps` or
    !> `status_bad_controls`.
    pure integer function controls_status(method, controls) result(status)
        type(method_info_t), intent(in) :: method !! properties of the method
        type(controls_t), intent(in) :: controls !! settings of the method
        logical :: valid
        associate (relative => controls%relative_tolerance, absolute => controls%absolute_tolerance)
            valid = relative > 0 .and. relative <= huge(relative) .and. absolute > 0 .and. absolute <= huge(absolute) &
                .and. controls%steps >= 0 .and. controls%max_steps > 0
            if (controls%steps > 0) then
                valid = valid .and. method%fixed_step
            else if (method%adaptive) then
                valid = valid .and. relative >= method%finest_tolerance
            end if
        end associate
        if (valid .and. len_trim(controls%table) > 0) valid = has_table(method, controls%table)
        status = merge(status_ok, status_bad_controls, valid)
        if (valid .and. controls%steps == 0 .and. .not. method%adaptive) status = status_no_steps
    end function controls_status

    !> Whether a method has a Butcher table of that name.
    pure logical function has_table(method, name)
        type(method_info_t), intent(in) :: method
        character(*), intent(in) :: name
        type(arkode_table_t) :: table
        has_table = method%takes_table
        if (has_table) call find_arkode_table(name, method%implicit, table, has_table)
    end function has_table

    !> Status of a call of `integrate`: that of `can_run`, and of the body, the start, the end of the span and
    !> the sample times, which increase from 0 to that end at most.
    integer function call_status(stepper, formulation, body, start, t_end, samples) result(status)
        class(stepper_t), intent(in) :: stepper !! the method with its settings
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: t_end, samples(:) !! end of the span, and the sample times, s
        status = body_status(body)
        if (is_ok(status)) status = start_status(start, body)
        if (is_ok(status) .and. .not. (t_end >= 0 .and. t_end <= huge(t_end))) status = status_bad_span
        if (is_ok(status) .and. .not. rise_within(samples, t_end)) status = status_bad_samples
        if (is_ok(status)) status = can_run(stepper, formulation, body)
    end function call_status

    !> Whether times lie between 0 and `t_end`, in increasing order.
    pure logical function rise_within(times, t_end)
        real(dp), intent(in) :: times(:), t_end
        integer :: n
        n = size(times)
        rise_within = .true.
        if (n == 0) return
        rise_within = times(1) >= 0 .and. times(n) <= t_end .and. all(times(2:) >= times(:n - 1))
    end function rise_within

end module spintop_suitability
