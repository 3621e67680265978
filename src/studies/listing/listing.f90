!> What `spintop list` shows: the registries themselves, as aligned text or as JSON.
module spintop_listing
    use spintop_errors, only: error_t, input_error
    use spintop_json, only: json_t
    use spintop_listed_json, only: tell_benchmarks, tell_cases, tell_columns, tell_events, tell_exit_codes, &
        tell_formulations, tell_methods, tell_parameters, tell_parts, tell_shapes, tell_statuses, tell_studies
    use spintop_listed_text, only: show_benchmarks, show_cases, show_columns, show_events, show_exit_codes, &
        show_formulations, show_methods, show_parameters, show_parts, show_shapes, show_statuses, show_studies
    use spintop_provenance, only: program_version
    use spintop_terminal, only: output_width
    use spintop_text, only: string_t, did_you_mean, join
    use spintop_wrapping, only: wrapped
    implicit none
    private
    public :: list_topic, list_as_json, topic_names

    !> Number of the layout of the JSON. A member that is new does not change it.
    integer, parameter :: json_format = 1

    !> What can be listed: its name, and the procedures that write it.
    type :: topic_t
        character(12) :: name
        character(56) :: what
        procedure(show_i), pointer, nopass :: show
        procedure(tell_i), pointer, nopass :: tell
    end type topic_t

    abstract interface
        !> Gives the lines of a topic.
        subroutine show_i(lines)
            import :: string_t
            implicit none
            type(string_t), allocatable, intent(out) :: lines(:)
        end subroutine show_i

        !> Adds the list of a topic to the document.
        subroutine tell_i(json)
            import :: json_t
            implicit none
            type(json_t), intent(inout) :: json
        end subroutine tell_i
    end interface

contains

    !> All topics, in the order of the help text.
    function topics()
        type(topic_t), allocatable :: topics(:)
        topics = [topic_t('methods', 'methods of integration, and the exact solution', show_methods, tell_methods), &
                  topic_t('formulations', 'equations of motion', show_formulations, tell_formulations), &
                  topic_t('columns', 'columns of the tables, with their units', show_columns, tell_columns), &
                  topic_t('events', 'events that a motion can be searched for', show_events, tell_events), &
                  topic_t('shapes', 'shapes of bodies, and their dimensions', show_shapes, tell_shapes), &
                  topic_t('parts', 'parts of bodies, and their dimensions', show_parts, tell_parts), &
                  topic_t('parameters', 'keys of the input, with ranges and default values', show_parameters, tell_parameters), &
                  topic_t('cases', 'hard cases of the stability study', show_cases, tell_cases), &
                  topic_t('benchmarks', 'published benchmarks', show_benchmarks, tell_benchmarks), &
                  topic_t('studies', 'kinds of studies', show_studies, tell_studies), &
                  topic_t('statuses', 'how a motion can end', show_statuses, tell_statuses), &
                  topic_t('exit_codes', 'exit codes of the program', show_exit_codes, tell_exit_codes)]
    end function topics

    !> The names of all topics, with a separator between them.
    function topic_names(separator) result(names)
        character(*), intent(in) :: separator !! text between two parts
        character(:), allocatable :: names
        type(topic_t), allocatable :: known(:)
        allocate (known, source=topics())
        names = join(known%name, separator)
    end function topic_names

    !> The lines of a topic, as wide as the terminal; without a topic, the topics.
    subroutine list_topic(topic, lines, error)
        character(*), intent(in) :: topic !! one of `topics`, or ''
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(error_t), allocatable, intent(out) :: error !! there is no such topic
        type(topic_t), allocatable :: known(:)
        integer :: place

        allocate (known, source=topics())
        if (topic == '') then
            call show_topics(known, lines)
        else
            call find_topic(known, topic, place, error)
            if (allocated(error)) return
            call known(place)%show(lines)
        end if
        call fit_lines(output_width(), lines)
    end subroutine list_topic

    !> The topics with what each of them lists.
    subroutine show_topics(known, lines)
        type(topic_t), intent(in) :: known(:)
        type(string_t), allocatable, intent(out) :: lines(:)
        integer :: i
        allocate (lines(size(known) + 2))
        lines(1)%text = 'spintop list TOPIC lists one of these; with --json for scripts, without a topic all of them'
        lines(2)%text = ''
        do i = 1, size(known)
            lines(i + 2)%text = '  ' // known(i)%name // '  ' // trim(known(i)%what)
        end do
    end subroutine show_topics

    !> A topic, or all of them, as a JSON document.
    subroutine list_as_json(topic, lines, error)
        character(*), intent(in) :: topic !! '' for all
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(error_t), allocatable, intent(out) :: error !! there is no such topic
        type(topic_t), allocatable :: known(:)
        type(json_t) :: json
        integer :: i, place

        allocate (known, source=topics())
        place = 0
        if (topic /= '') call find_topic(known, topic, place, error)
        if (allocated(error)) return
        call json%begin()
        call json%add('format', json_format)
        call json%add('version', program_version)
        do i = 1, size(known)
            if (place == 0 .or. place == i) call known(i)%tell(json)
        end do
        call json%finish(lines)
    end subroutine list_as_json

    !> Place of a topic among the known ones, or an error that names the nearest.
    subroutine find_topic(known, topic, place, error)
        type(topic_t), intent(in) :: known(:)
        character(*), intent(in) :: topic
        integer, intent(out) :: place
        type(error_t), allocatable, intent(inout) :: error
        character(:), allocatable :: hint

        place = findloc(known%name == topic, .true., dim=1)
        if (place > 0) return
        hint = did_you_mean(topic, known%name)
        if (hint /= '') hint = '; ' // hint
        error = input_error("spintop: cannot list '" // topic // "'" // hint // &
                            ' (there are ' // join(known%name, ', ') // ')')
    end subroutine find_topic

    !> Breaks lines that are longer than the width of the terminal; continuation lines are below their own
    !> column.
    subroutine fit_lines(width, lines)
        integer, intent(in) :: width
        type(string_t), intent(inout) :: lines(:)
        integer :: i, last_column
        do i = 1, size(lines)
            associate (text => lines(i)%text)
                if (len_trim(text) <= width) cycle
                last_column = index(text, '  ', back=.true.)
                lines(i)%text = wrapped(text, 0, width, indent=max(4, last_column + 1))
            end associate
        end do
    end subroutine fit_lines

end module spintop_listing
