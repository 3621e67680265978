!> The command line of `spintop`: arguments in, a request out.
module spintop_command_line
    use spintop_errors, only: error_t, input_error
    use spintop_job, only: options_t
    use spintop_text, only: string_t, nearest_word
    implicit none
    private
    public :: request_t, read_command_line, usage
    public :: action_run, action_check, action_list, action_help, action_version

    integer, parameter :: action_run = 1, action_check = 2, action_list = 3, action_help = 4, &
        action_version = 5

    !> What the user asks for.
    type :: request_t
        integer :: action = action_run
        type(options_t) :: options
        type(string_t), allocatable :: inputs(:)
        !> What to list.
        character(:), allocatable :: topic
    end type request_t

    !> The help text; the options it names are the options there are.
    character(*), parameter :: usage(*) = [character(96) :: &
        'spintop: the motion of a heavy spinning top, exact and by many integrators', &
        '', &
        'usage: spintop [options] INPUT.nml [INPUT.nml ...]', &
        '       spintop list methods|formulations|columns|events|shapes|parameters|cases', &
        '       spintop --help | --version', &
        '', &
        'options', &
        '  -o DIR, --output DIR   folder for results (default output/), made if missing', &
        '  --set GROUP.KEY=VALUE  override a value of the input (repeatable)', &
        '  --threads N            number of threads (default: all cores)', &
        '  --check                read, check and plan only; print the resolved input and the plan', &
        '  --quiet                no progress display', &
        '  --progress             progress even when standard error is no terminal', &
        '  --                     what follows are inputs', &
        '', &
        'exit codes: 0 all is well; 2 wrong usage or input, nothing was computed; 3 some cases', &
        'failed and are marked; 4 a result could not be written; 5 an internal error']

contains

    !> Reads the arguments of the program.
    subroutine read_command_line(request, error)
        type(request_t), intent(out) :: request
        type(error_t), allocatable, intent(out) :: error
        character(:), allocatable :: argument, value
        logical :: only_inputs
        integer :: i

        request%options%output = 'output'
        allocate (request%options%overrides(0), request%inputs(0))
        only_inputs = .false.
        i = 0
        do while (i < command_argument_count() .and. .not. allocated(error))
            i = i + 1
            argument = argument_at(i)
            if (only_inputs .or. index(argument, '-') /= 1) then
                if (argument == 'list' .and. size(request%inputs) == 0 .and. .not. only_inputs) then
                    call take_topic(i)
                    return
                end if
                request%inputs = [request%inputs, string_t(argument)]
                cycle
            end if
            select case (option_name(argument))
            case ('-h', '--help')
                request%action = action_help
                return
            case ('--version')
                request%action = action_version
                return
            case ('-o', '--output')
                call take_value(request%options%output)
                if (.not. allocated(error) .and. request%options%output == '') then
                    error = wrong('the name of the folder for results is empty')
                end if
            case ('--set')
                call take_value(value)
                request%options%overrides = [request%options%overrides, string_t(value)]
            case ('--threads')
                call take_value(value)
                call take_threads(value)
            case ('--check')
                request%action = action_check
            case ('--quiet')
                request%options%quiet = .true.
            case ('--progress')
                request%options%progress = .true.
            case ('--')
                only_inputs = .true.
            case default
                error = unknown_option(argument)
            end select
            if (allocated(error)) return
            if (index(argument, '=') > 0 .and. any(argument(:index(argument, '=') - 1) &
                == [character(10) :: '--check', '--quiet', '--progress'])) then
                error = wrong(argument // ': this option takes no value')
            end if
        end do
        if (.not. allocated(error) .and. size(request%inputs) == 0) then
            error = wrong('no input is named')
        end if

    contains

        !> The value of the option: behind its equals sign, or the next argument.
        subroutine take_value(value)
            character(:), allocatable, intent(inout) :: value
            value = ''
            if (option_name(argument) /= argument) then
                value = argument(index(argument, '=') + 1:)
            else if (i < command_argument_count()) then
                i = i + 1
                value = argument_at(i)
            else
                error = wrong('option ' // argument // ' needs a value')
            end if
        end subroutine take_value

        subroutine take_threads(text)
            character(*), intent(in) :: text
            integer :: status
            integer, parameter :: most_threads = 4096
            if (allocated(error)) return
            status = verify(text, '0123456789')
            if (status == 0) read (text, *, iostat=status) request%options%threads
            if (status /= 0 .or. request%options%threads < 1 .or. request%options%threads > most_threads) then
                error = wrong("--threads takes a whole number from 1 to 4096, not '" // text // "'")
            end if
        end subroutine take_threads

        subroutine take_topic(i)
            integer, intent(in) :: i
            request%action = action_list
            if (command_argument_count() /= i + 1) then
                error = wrong('list takes one word')
            else
                request%topic = argument_at(i + 1)
            end if
        end subroutine take_topic

    end subroutine read_command_line

    !> An option without the value behind an equals sign.
    pure function option_name(argument) result(name)
        character(*), intent(in) :: argument
        character(:), allocatable :: name
        name = argument
        if (index(argument, '--') == 1 .and. index(argument, '=') > 0) name = argument(:index(argument, '=') - 1)
    end function option_name

    !> A command-line argument in its own length.
    function argument_at(i) result(argument)
        integer, intent(in) :: i
        character(:), allocatable :: argument
        integer :: length
        call get_command_argument(i, length=length)
        allocate (character(length) :: argument)
        call get_command_argument(i, argument)
    end function argument_at

    type(error_t) function unknown_option(argument) result(error)
        character(*), intent(in) :: argument
        type(string_t) :: known(8)
        character(:), allocatable :: hint
        known = [string_t('--output'), string_t('--set'), string_t('--threads'), string_t('--check'), &
                 string_t('--quiet'), string_t('--progress'), string_t('--help'), string_t('--version')]
        hint = nearest_word(option_name(argument), known)
        if (hint /= '') hint = "; did you mean '" // hint // "'?"
        error = wrong("unknown option '" // argument // "'" // hint)
    end function unknown_option

    type(error_t) function wrong(message)
        character(*), intent(in) :: message
        wrong = input_error('spintop: ' // message // new_line('a') // 'see spintop --help')
    end function wrong

end module spintop_command_line
