!> What `spintop list` shows: the registries themselves, as aligned text or as JSON.
module spintop_listing
    use spintop_errors, only: error_t, input_error
    use spintop_listed_items, only: listing_t
    use spintop_listed_topics, only: add_topic, topics
    use spintop_provenance, only: program_version
    use spintop_terminal, only: output_width
    use spintop_text, only: did_you_mean, join, string_t, wrapped
    implicit none
    private
    public :: list_topic, list_as_json, topic_names

    !> Number of the layout of the JSON. A member that is new does not change it.
    integer, parameter :: json_format = 1

contains

    !> The names of all topics, with a separator between them.
    function topic_names(separator) result(names)
        character(*), intent(in) :: separator !! text between two parts
        character(:), allocatable :: names
        names = join(topics%name, separator)
    end function topic_names

    !> The lines of a topic, as wide as the terminal; without a topic, the topics.
    subroutine list_topic(topic, lines, error)
        character(*), intent(in) :: topic !! one of `topics`, or ''
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(error_t), allocatable, intent(out) :: error !! there is no such topic
        type(listing_t) :: list

        if (topic == '') then
            call print_topics(lines)
        else
            call check_topic(topic, error)
            if (allocated(error)) return
            call list%json%begin()
            call add_topic(list, topic)
            call move_alloc(list%text, lines)
        end if
        call fit_lines(output_width(), lines)
    end subroutine list_topic

    !> The topics with what each of them lists.
    subroutine print_topics(lines)
        type(string_t), allocatable, intent(out) :: lines(:)
        integer :: i
        allocate (lines(size(topics) + 2))
        lines(1)%text = 'spintop list TOPIC lists one of these; with --json for scripts, without a topic all of them'
        lines(2)%text = ''
        do i = 1, size(topics)
            lines(i + 2)%text = '  ' // topics(i)%name // '  ' // trim(topics(i)%what)
        end do
    end subroutine print_topics

    !> A topic, or all of them, as a JSON document.
    subroutine list_as_json(topic, lines, error)
        character(*), intent(in) :: topic !! '' for all
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(error_t), allocatable, intent(out) :: error !! there is no such topic
        type(listing_t) :: list
        integer :: i

        if (topic /= '') call check_topic(topic, error)
        if (allocated(error)) return
        call list%json%begin()
        call list%json%add('format', json_format)
        call list%json%add('version', program_version)
        do i = 1, size(topics)
            if (topic == '' .or. topic == topics(i)%name) call add_topic(list, trim(topics(i)%name))
        end do
        call list%json%finish(lines)
    end subroutine list_as_json

    !> An error that names the nearest topic if there is none of a name.
    subroutine check_topic(topic, error)
        character(*), intent(in) :: topic
        type(error_t), allocatable, intent(inout) :: error
        character(:), allocatable :: hint

        if (any(topics%name == topic)) return
        hint = did_you_mean(topic, topics%name)
        if (hint /= '') hint = '; ' // hint
        error = input_error("spintop: cannot list '" // topic // "'" // hint // &
                            ' (there are ' // topic_names(', ') // ')')
    end subroutine check_topic

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
