!> The events that a scene asks for.
module spintop_event_choice
    use spintop_case, only: case_t
    use spintop_columns, only: trajectory_columns, needs_exact_motion
    use spintop_event_text, only: column_event_t, read_event
    use spintop_parameters, only: unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: choose_events

contains

    !> The events of the table, and those that end the motion; one that does both stands there once.
    subroutine choose_events(scene, case, events, problems)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(column_event_t), allocatable, intent(out) :: events(:)
        type(problems_t), intent(inout) :: problems
        type(column_event_t), allocatable :: some(:)
        character(*), parameter :: stop_key = 'span.stop_at'
        character(:), allocatable :: key
        integer :: i, k

        allocate (events(0))
        if (scene%kind /= 'trajectory' .and. any(scene%events /= '')) then
            call problems%add('output.events', 'only a trajectory has a table of events', &
                              "leave it out, or set study.kind = 'trajectory'")
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
            if (problem == '' .and. any(needs_exact_motion(trajectory_columns(some%column)))) then
                if (scene%kind == 'sweep' .or. .not. (problems%any() .or. case%body%is_lagrange())) then
                    problem = 'this event compares with the exact motion, and '
                    if (scene%kind == 'sweep') problem = problem // 'a sweep keeps none'
                    if (scene%kind /= 'sweep') problem = problem // 'this body has none'
                    hint = 'take another column'
                end if
            end if
            if (problem /= '') call problems%add(name, problem, hint)
        end subroutine read_text

    end subroutine choose_events

end module spintop_event_choice
