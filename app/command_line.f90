!> The command line of `spintop`: reads the arguments into a request.
module spintop_command_line
    use spintop_errors, only: error_t, input_error, exit_codes
    use spintop_files, only: file_exists
    use spintop_listing, only: topic_names
    use spintop_study, only: most_threads, options_t, shell_word
    use spintop_table_head, only: most_shards, read_shard
    use spintop_text, only: append, append_wrapped, did_you_mean, line_width, string_t, to_text
    implicit none
    private
    public :: request_t, read_command_line, describe_usage

    !> The request of the user: inputs to run, a topic to list, parts to merge, or tables to verify.
    type :: request_t
        !> `run`, `check`, `list`, `merge`, `verify`, `help` or `version`.
        character(8) :: action = 'run'
        type(options_t) :: options
        !> Inputs to run, parts to merge, tables to verify, or the topic to list.
        type(string_t), allocatable :: inputs(:)
        !> What to list ('' for all topics), or the table to merge into.
        character(:), allocatable :: topic, merged
        !> The file for the names of written tables; '' without it.
        character(:), allocatable :: written
        !> List as JSON.
        logical :: as_json = .false.
    end type request_t

    !> An option: long name, short name, name of its value ('' if it takes none), and description.
    type :: option_t
        character(10) :: name
        character(2) :: short
        character(16) :: value
        character(72) :: what
    end type option_t

    !> All options.
    type(option_t), parameter :: known_options(*) = [ &
        option_t('--output', '-o', 'DIR', 'folder for results (default output/), made if missing'), &
        option_t('--set', '', 'GROUP.KEY=VALUE', 'override a value of the input (repeatable)'), &
        option_t('--threads', '', 'N', 'number of threads, of each rank under MPI (default: all cores)'), &
        option_t('--check', '', '', 'read, check and plan only; print the resolved input and the plan'), &
        option_t('--resume', '', '', 'resume an interrupted sweep, keep complete tables'), &
        option_t('--restart', '', '', 'discard an interrupted run and start anew'), &
        option_t('--shard', '', 'I/N', 'compute part I of N of a study; `spintop merge` joins the parts'), &
        option_t('--quiet', '', '', 'no progress display'), &
        option_t('--verbose', '-v', '', 'all that a run says: model, constants, cost, memory'), &
        option_t('--progress', '', '', 'progress even when standard error is no terminal'), &
        option_t('--written', '', 'FILE', 'names of the written tables to FILE, each with a null character behind'), &
        option_t('--help', '-h', '', 'this text'), &
        option_t('--version', '', '', 'version and revision of the program'), &
        option_t('--', '', '', 'end of options: the other arguments are inputs')]

    character(*), parameter :: usage(*) = [character(96) :: &
        'spintop: the motion of a heavy spinning top, in closed form or by integration', &
        '', &
        'usage: spintop [options] INPUT.nml [INPUT.nml ...]', &
        '       spintop merge FILE PART [PART ...]', &
        '       spintop verify TABLE.csv [TABLE.csv ...] [--strict]', &
        '       spintop list [TOPIC] [--json]', &
        '']

contains

    !> The help text.
    subroutine describe_usage(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(option_t) :: option
        character(24) :: name
        integer :: i

        do i = 1, size(usage)
            call append(lines, trim(usage(i)))
        end do
        call append_wrapped(lines, '', 'topics: ' // topic_names(', '), 0, line_width)
        call append(lines, new_line('a') // 'options')
        do i = 1, size(known_options)
            option = known_options(i)
            name = trim(option%name) // ' ' // option%value
            if (option%short /= '') name = trim(option%short // ' ' // option%value) // ', ' // name
            call append(lines, '  ' // name // trim(option%what))
        end do
        call append(lines, new_line('a') // 'exit codes')
        do i = 1, size(exit_codes)
            name = to_text(exit_codes(i)%code)
            call append(lines, '  ' // name // trim(exit_codes(i)%what))
        end do
        name = '128 + N'
        call append(lines, '  ' // name // 'ended by signal N')
    end subroutine describe_usage

    !> Reads the arguments of the program.
    subroutine read_command_line(request, error)
        type(request_t), intent(out) :: request !! the request
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(:), allocatable :: argument, hint
        character(6), parameter :: commands(3) = [character(6) :: 'list', 'merge', 'verify']
        logical :: only_inputs
        integer :: i

        request%options%output = 'output'
        request%written = ''
        request%options%command = shell_word(argument_at(0))
        allocate (request%options%overrides(0), request%inputs(0))
        only_inputs = .false.
        i = 0
        do while (i < command_argument_count())
            i = i + 1
            argument = argument_at(i)
            if (argument == '--' .and. .not. only_inputs) then
                only_inputs = .true.
            else if (only_inputs .or. index(argument, '-') /= 1) then
                if (size(request%inputs) == 0 .and. .not. only_inputs) then
                    hint = did_you_mean(argument, commands)
                    if (any(argument == commands)) then
                        call read_command(argument, i, request, error)
                        return
                    else if (hint /= '' .and. .not. file_exists(argument)) then
                        error = wrong("there is no input or command '" // argument // "'; " // hint)
                        return
                    end if
                end if
                call append(request%inputs, argument)
            else
                call read_option(i, request, error)
                if (allocated(error) .or. any(request%action == [character(7) :: 'help', 'version'])) return
            end if
        end do
        if (size(request%inputs) == 0) error = wrong('no input is given')
        if (request%options%resume .and. request%options%restart) error = wrong('--resume and --restart exclude each other')
    end subroutine read_command_line

    !> Reads the option at argument `i`, with its value. On return `i` is the last argument of the option.
    subroutine read_option(i, request, error)
        integer, intent(inout) :: i
        type(request_t), intent(inout) :: request
        type(error_t), allocatable, intent(inout) :: error
        character(:), allocatable :: argument, value, hint
        integer :: first, last, place, status, k
        logical :: valid

        argument = argument_at(i)
        last = len(argument)
        if (index(argument, '--') == 1 .and. index(argument, '=') > 0) last = index(argument, '=') - 1
        place = findloc(known_options%name == argument(:last) .or. known_options%short == argument(:last), .true., dim=1)
        if (place == 0) then
            hint = did_you_mean(argument(:last), known_options%name)
            if (hint /= '') hint = '; ' // hint
            error = wrong("unknown option '" // argument // "'" // hint)
            return
        end if
        value = argument(min(last + 2, len(argument) + 1):)
        first = i
        if (known_options(place)%value == '') then
            if (last < len(argument)) error = wrong(argument // ': this option takes no value')
        else if (last == len(argument)) then ! the next argument is the value
            i = i + 1
            if (i <= command_argument_count()) value = argument_at(i)
            if (i > command_argument_count()) error = wrong('option ' // argument // ' needs a value')
        end if
        if (allocated(error)) return
        select case (known_options(place)%name)
        case ('--help', '--version', '--check')
            request%action = known_options(place)%name(3:)
        case ('--output')
            request%options%output = value
            if (value == '') error = wrong('the name of the folder for results is empty')
        case ('--set')
            call append(request%options%overrides, value)
        case ('--threads')
            status = verify(value, '0123456789')
            if (status == 0) read (value, *, iostat=status) request%options%threads
            if (status /= 0 .or. request%options%threads < 1 .or. request%options%threads > most_threads) then
                error = wrong('--threads takes a whole number from 1 to ' // to_text(most_threads) // ", not '" // value // "'")
            end if
        case ('--resume')
            request%options%resume = .true.
        case ('--restart')
            request%options%restart = .true.
        case ('--shard')
            call read_shard(value, request%options%shard, valid)
            if (.not. valid) error = wrong('--shard takes I/N, part I of N, as in 2/3, with N up to ' // &
                                            to_text(most_shards) // ", not '" // value // "'")
        case ('--quiet')
            request%options%quiet = .true.
        case ('--verbose')
            request%options%verbose = .true.
        case ('--progress')
            request%options%progress = .true.
        case ('--written')
            request%written = value
            if (value == '') error = wrong('the name of the file for names of tables is empty')
        end select
        if (allocated(error)) return
        if (any(known_options(place)%name == [character(9) :: '--resume', '--restart', '--written'])) return
        ! All others are in the command that resumes the run.
        do k = first, i
            request%options%command = request%options%command // ' ' // shell_word(argument_at(k))
        end do
    end subroutine read_option

    !> Reads what follows a command, which is argument `i`: words, and the one option that it may take. `list` has a topic, or
    !> none for all of them, `merge` the table to merge into and its parts, `verify` tables.
    subroutine read_command(command, i, request, error)
        character(*), intent(in) :: command
        integer, intent(in) :: i
        type(request_t), intent(inout) :: request
        type(error_t), allocatable, intent(inout) :: error
        character(:), allocatable :: argument, option
        integer :: k
        request%action = command
        option = trim(merge('--json  ', '--strict', command == 'list'))
        do k = i + 1, command_argument_count()
            argument = argument_at(k)
            if (command == 'merge' .or. index(argument, '-') /= 1) then
                call append(request%inputs, argument)
            else if (argument /= option) then
                error = wrong(command // ' takes no option but ' // option)
            else
                request%as_json = command == 'list'
                request%options%strict = command == 'verify'
            end if
        end do
        k = size(request%inputs)
        select case (command)
        case ('list')
            request%topic = ''
            if (k > 1) error = wrong('list takes one topic')
            if (k == 1) request%topic = request%inputs(1)%text
        case ('merge')
            if (k < 2) error = wrong('merge takes a table to write and the parts to join')
            if (k < 2) return
            request%merged = request%inputs(1)%text
            request%inputs = request%inputs(2:)
        case ('verify')
            request%options%verifies = .true.
            if (k == 0) error = wrong('verify takes a table, which has its input in its header')
        end select
    end subroutine read_command

    !> A command-line argument of any length.
    function argument_at(i) result(argument)
        integer, intent(in) :: i
        character(:), allocatable :: argument
        integer :: length
        call get_command_argument(i, length=length)
        allocate (character(length) :: argument)
        call get_command_argument(i, argument)
    end function argument_at

    type(error_t) function wrong(message)
        character(*), intent(in) :: message
        wrong = input_error('spintop: ' // message // new_line('a') // 'see spintop --help')
    end function wrong

end module spintop_command_line
