!> Selects the events of a motion from the texts in a scene.
module spintop_event_choice
    use spintop_case, only: case_t
    use spintop_event, only: occasion_knot, occasion_slip, occasion_stuck
    use spintop_event_text, only: column_event_t, read_event
    use spintop_parameters, only: unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t
    use spintop_study, only: study_info_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: choose_events

contains

    !> The events for the table, and those that end the motion. An event that is both occurs once.
    subroutine choose_events(study, scene, case, events, problems)
        type(study_info_t), intent(in) :: study !! the kind of study
        type(scene_t), intent(in) :: scene !! contents of the input
        type(case_t), intent(in) :: case !! the case: whether its body has effects decides which events it can have
        type(column_event_t), allocatable, intent(out) :: events(:) !! events to search for
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(column_event_t), allocatable :: some(:)
        character(*), parameter :: stop_key = 'span.stop_at'
        character(:), allocatable :: key
        integer :: i, k

        allocate (events(0))
        if ((.not. study%has_events) .and. any(scene%events /= '')) then
            call problems%add('output.events', 'only a trajectory has a table of events', &
                              "omit it, or set study.kind = 'trajectory'")
            return
        end if
        do i = 1, size(scene%events)
            if (scene%events(i) == '') cycle
            key = 'output.events(' // to_text(i) // ')'
            call read_text(key, scene%events(i))
            do k = 1, size(some)
                if (any(events%event%name == some(k)%event%name)) then
                    call problems%add(key, 'event ''' // trim(some(k)%event%name) // ''' is named twice', &
                                      'name it once')
                    exit
                end if
                some(k)%is_listed = .true.
                events = [events, some(k)]
            end do
        end do
        if (scene%stop_at == '') then
            if (scene%stop_after /= unset_integer) then
                call problems%add('span.stop_after', 'there is no event to stop at', 'give stop_at')
            end if
            return
        end if
        call read_text(stop_key, scene%stop_at)
        do k = 1, size(some)
            if (all(events%event%name /= some(k)%event%name)) events = [events, some(k)]
            where (events%event%name == some(k)%event%name) events%ends = .true.
        end do

    contains

        !> Reads the text of one parameter into `some`.
        subroutine read_text(name, text)
            character(*), intent(in) :: name, text
            character(:), allocatable :: problem, hint
            call read_event(text, some, problem, hint)
            if (problem == '' .and. any(some%column%needs_exact_motion)) then
                if (.not. study%keeps_exact_motion .or. .not. (problems%any() .or. case%body%has_closed_form())) then
                    problem = 'this event needs the exact solution, which '
                    if (study%keeps_exact_motion) then
                        problem = problem // 'this body does not have'
                    else
                        problem = problem // study%phrase // ' does not use'
                    end if
                    hint = 'use another column'
                end if
            end if
            if (problem == '' .and. .not. problems%any()) call check_work(case, some, problem, hint)
            if (problem == '' .and. .not. problems%any()) call check_occasion(case, some, problem, hint)
            if (problem /= '') call problems%add(name, problem, hint)
        end subroutine read_text

    end subroutine choose_events

    !> The work of effects is known in the rows of a motion, not where events are sought.
    subroutine check_work(case, some, problem, hint)
        type(case_t), intent(in) :: case
        type(column_event_t), intent(in) :: some(:)
        character(:), allocatable, intent(inout) :: problem, hint
        if (any(some%column%needs_effects) .and. .not. allocated(case%given_body%effects)) then
            problem = 'this event needs effects, and the body has none'
        else if (any(some%column%needs_work) .and. allocated(case%given_body%effects)) then
            problem = 'this event needs the work of effects, which is computed for the rows of a motion only'
        end if
        if (problem /= '') hint = 'use another column'
    end subroutine check_work

    !> Only dry friction by the exact law stops a body, and only a table has rows.
    subroutine check_occasion(case, some, problem, hint)
        type(case_t), intent(in) :: case
        type(column_event_t), intent(in) :: some(:)
        character(:), allocatable, intent(inout) :: problem, hint
        logical :: is_dry, has_table
        is_dry = .false.
        has_table = .false.
        if (allocated(case%given_body%effects)) then
            is_dry = case%given_body%effects%is_dry()
            has_table = allocated(case%given_body%effects%table)
        end if
        if (.not. is_dry .and. any(some%event%occasion == occasion_stuck .or. some%event%occasion == occasion_slip)) then
            problem = 'only a body with dry friction that is not smoothed sticks and slips'
            hint = 'give effects.friction_torque or friction_coefficient, without friction_smoothing'
        else if (.not. has_table .and. any(some%event%occasion == occasion_knot)) then
            problem = 'this event needs a table of torques'
            hint = 'give effects.torque_table'
        end if
    end subroutine check_occasion

end module spintop_event_choice
