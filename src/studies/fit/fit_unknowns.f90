!> What a fit seeks: real numbers of the input, and those of sensors. All runs have some in common, and each has its own of others.
module spintop_fit_unknowns
    use spintop_fit_data, only: measurements_t
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_parameters, only: is_set
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: fit_scene_t, sensors_t
    use spintop_sensitivity, only: sensitive_key_t, sensitivities_t
    use spintop_study_column, only: place_of
    use spintop_sweep_axes, only: base_of
    use spintop_text, only: did_you_mean, string_t, to_text
    implicit none
    private
    public :: unknowns_t, find_unknowns, key_of

    !> Keys of &fit that sensors of vectors have.
    character(*), parameter :: vectors_of_sensors(2) = [character(9) :: 'mounting', 'lever_arm']

    !> The sought numbers, in the order of their vector: those that are common, those of the first run, of the second ...
    type :: unknowns_t
        !> The keys of the input, of which so many leading ones have common numbers, and the place in the vector of that of each key
        !> (first index) in each run.
        type(sensitive_key_t), allocatable :: keys(:)
        integer :: common = 0
        integer, allocatable :: places(:, :)
        !> The key of each number, its name, as `top.mass` or `initial.omega3[2]`, and its value where the search begins.
        integer, allocatable :: key(:)
        type(string_t), allocatable :: names(:)
        real(dp), allocatable :: start(:)
    end type unknowns_t

contains

    !> Finds the sought numbers.
    subroutine find_unknowns(job, measured, unknowns, problems)
        type(job_t), target, intent(inout) :: job !! the job
        type(measurements_t), intent(inout) :: measured(:) !! the runs; the sensors of the numbers are named
        type(unknowns_t), intent(out) :: unknowns !! the numbers
        type(problems_t), intent(inout) :: problems !! problems of the names are added
        type(sensitivities_t) :: sought
        character(:), allocatable :: problem, hint
        integer :: i, key, common

        allocate (sought%keys(0))
        associate (fit => job%input%scene%fit)
            do i = 1, size(fit%unknown)
                if (fit%unknown(i) == '') call refuse_given([fit%from(i), fit%to(i)], 'fit.from', 'fit.unknown(')
                if (fit%unknown(i) == '') cycle
                call find_one(trim(fit%unknown(i)), any_run=.true.)
                if (problem == '') call check_range(fit, i, sought%keys(key)%slot%get(), problem, hint)
                if (problem /= '') call problems%add('fit.unknown(' // to_text(i) // ')', problem, hint)
            end do
            common = size(sought%keys)
            do i = 1, size(fit%unknown_each)
                if (fit%unknown_each(i) == '') call refuse_given(fit%start_each(i, :), 'fit.start_each', 'fit.unknown_each(')
                if (fit%unknown_each(i) == '') cycle
                call find_one(trim(fit%unknown_each(i)), any_run=.false.)
                if (problem == '' .and. index(fit%unknown_each(i), 'initial.') /= 1 .and. &
                    index(fit%unknown_each(i), 'offset.') /= 1) then
                    problem = trim(fit%unknown_each(i)) // ' is one number for all runs'
                    hint = 'name it in fit.unknown; each run has its own initial.* and offset.*'
                end if
                if (problem == '') call check_starts(fit%start_each(i, :), size(measured), sought%keys(key), problem, hint)
                if (problem /= '') call problems%add('fit.unknown_each(' // to_text(i) // ')', problem, hint)
            end do
            if (all(fit%unknown == '') .and. all(fit%unknown_each == '')) then
                call problems%add('fit', 'nothing is sought', "give unknown = 'top.inertia(3)' and the like")
            end if
            if (.not. problems%any()) call make_vector(fit, sought%keys, common, size(measured), unknowns)
        end associate

    contains

        !> Refuses values of what is not sought.
        subroutine refuse_given(values, key, of)
            real(dp), intent(in) :: values(:)
            character(*), intent(in) :: key, of
            if (any(is_set(values))) call problems%add(key, 'there is no ' // of // to_text(i) // ')', &
                                                       'name what is sought, or omit the values')
        end subroutine refuse_given

        !> Finds the key of a number, which has to be a new one.
        subroutine find_one(name, any_run)
            character(*), intent(in) :: name
            logical, intent(in) :: any_run !! whether it is enough that one of the runs has its sensor
            character(:), allocatable :: nearest
            integer :: known
            known = size(sought%keys)
            if (is_of_sensor(name)) then
                call find_sensor_number(name, any_run, job, measured, sought, key, problem, hint)
            else
                call sought%find_key(name, job%input%table, job%axes, key, problem, hint)
                nearest = did_you_mean(name(:index(name // '(', '(') - 1), vectors_of_sensors)
                if (problem /= '' .and. nearest /= '') hint = nearest
            end if
            if (problem /= '' .or. key > known) return
            problem = name // ' is named twice'
            hint = 'name it once'
        end subroutine find_one

    end subroutine find_unknowns

    !> Checks the range in which a number is sought.
    subroutine check_range(fit, i, value, problem, hint)
        type(fit_scene_t), intent(in) :: fit
        integer, intent(in) :: i
        real(dp), intent(in) :: value
        character(:), allocatable, intent(inout) :: problem, hint
        if (is_set(fit%from(i)) .neqv. is_set(fit%to(i))) then
            problem = 'the range has one end only'
            hint = 'give both from and to'
        else if (is_set(fit%from(i)) .and. .not. (fit%from(i) <= value .and. value <= fit%to(i))) then
            problem = 'the value where the search begins is not in its range'
            hint = 'give a value from ' // to_text(fit%from(i)) // ' to ' // to_text(fit%to(i))
        end if
    end subroutine check_range

    !> Checks the values of the runs where the search begins, which may all be missing.
    subroutine check_starts(starts, runs, key, problem, hint)
        real(dp), intent(in) :: starts(:)
        integer, intent(in) :: runs
        type(sensitive_key_t), intent(in) :: key
        character(:), allocatable, intent(inout) :: problem, hint
        integer :: i, given
        given = count(is_set(starts))
        if (given == 0) return
        if (given /= runs) then
            problem = to_text(given) // ' values of start_each for ' // to_text(runs) // ' runs'
            hint = 'give one per file of fit.data'
            return
        end if
        i = findloc(key%slot%accepts(starts(:runs)), .false., dim=1)
        if (i == 0) return
        problem = 'start_each: ' // key%name // ' ' // key%slot%refusal(starts(i))
        hint = 'give another value for run ' // to_text(i)
    end subroutine check_starts

    !> Arranges the numbers in their vector.
    subroutine make_vector(fit, keys, common, runs, unknowns)
        type(fit_scene_t), intent(in) :: fit
        type(sensitive_key_t), intent(in) :: keys(:)
        integer, intent(in) :: common, runs
        type(unknowns_t), intent(out) :: unknowns
        integer, allocatable :: places(:)
        integer :: i, k, run, n

        unknowns%keys = keys
        unknowns%common = common
        n = common + runs * (size(keys) - common)
        allocate (unknowns%places(size(keys), runs), unknowns%key(n), unknowns%names(n), unknowns%start(n))
        allocate (places, source=pack([(i, i=1, size(fit%unknown_each))], fit%unknown_each /= ''))
        do run = 1, runs
            do k = 1, size(keys)
                i = k
                if (k > common) i = k + (run - 1) * (size(keys) - common)
                unknowns%places(k, run) = i
                unknowns%key(i) = k
                unknowns%names(i)%text = keys(k)%name
                unknowns%start(i) = keys(k)%slot%get()
                if (k <= common) cycle
                unknowns%names(i)%text = keys(k)%name // '[' // to_text(run) // ']'
                associate (start => fit%start_each(places(k - common), run))
                    if (is_set(start)) unknowns%start(i) = start
                end associate
            end do
        end do
    end subroutine make_vector

    !> Whether a name is that of a number of a sensor.
    pure logical function is_of_sensor(name)
        character(*), intent(in) :: name
        is_of_sensor = any([index(name, 'offset.'), index(name, 'scale.')] == 1) .or. &
                       any(vectors_of_sensors == name(:index(name // '(', '(') - 1))
    end function is_of_sensor

    !> The key of the input that contains a sought number: that of a group of a sensor has a short name.
    function key_of(name, sensors) result(key)
        character(*), intent(in) :: name !! the sought number, as `offset.theta` or `top.mass`
        type(sensors_t), intent(inout) :: sensors !! the groups; one is taken for a column that has none
        character(:), allocatable :: key
        integer :: dot
        key = name
        if (.not. is_of_sensor(name)) return
        dot = index(name, '.')
        if (dot == 0) then
            key = 'fit.' // name
        else if (name == 'offset.t') then
            key = 'fit.time_offset'
        else
            key = 'sensor.' // name(:dot - 1) // '(' // to_text(sensors%place_of(name(dot + 1:))) // ')'
        end if
    end function key_of

    !> Adds a number of a sensor to those that are sought: `offset.theta`, `scale.theta`, `offset.t`, `mounting(1)`.
    subroutine find_sensor_number(name, any_run, job, measured, sought, key, problem, hint)
        character(*), intent(in) :: name
        logical, intent(in) :: any_run
        type(job_t), target, intent(inout) :: job
        type(measurements_t), intent(inout) :: measured(:)
        type(sensitivities_t), intent(inout) :: sought
        integer, intent(out) :: key !! its index
        character(:), allocatable, intent(out) :: problem, hint
        type(sensitive_key_t) :: found
        character(:), allocatable :: column, own
        integer :: k, run
        logical :: is_measured(size(measured))

        key = 0
        hint = 'name a measured column, as in offset.theta'
        found%name = name
        found%unit = ''
        if (index(name, '.') > 0 .and. name /= 'offset.t') then
            column = name(index(name, '.') + 1:)
            is_measured = .true. ! a run that cannot be read was refused
            do run = 1, size(measured)
                if (.not. allocated(measured(run)%columns)) cycle
                associate (columns => measured(run)%columns)
                    k = place_of(columns, column)
                    is_measured(run) = k > 0
                    if (k == 0) k = findloc(columns%quantity() == column, .true., dim=1)
                    if (k == 0 .and. did_you_mean(column, columns%name) /= '') hint = did_you_mean(column, columns%name)
                    if (.not. is_measured(run) .and. k > 0) hint = 'write ' // name(:index(name, '.')) // trim(columns(k)%name)
                    if (.not. is_measured(run)) cycle
                    if (index(name, 'offset.') == 1) found%unit = trim(columns(k)%unit)
                end associate
                if (index(name, 'scale.') == 1 .and. measured(run)%turn(k) > 0) then
                    problem = 'the turns of ' // column // ' are not known, and tell its scale'
                    hint = 'give sensor.scale: the readings of a turn over the turn'
                    return
                end if
                measured(run)%sensor(k) = job%input%scene%fit%sensors%place_of(column)
            end do
            problem = column // ' is not measured'
            if (.not. any(is_measured)) return
            if (.not. (any_run .or. all(is_measured))) then
                problem = problem // ' in run ' // to_text(findloc(is_measured, .false., dim=1))
                return
            end if
        end if
        own = key_of(name, job%input%scene%fit%sensors)
        call job%input%table%find_number(own, found%slot, problem)
        if (problem /= '') return
        if (found%unit == '') found%unit = job%input%table%parameters(job%input%table%find(base_of(own)))%unit
        key = findloc(sought%keys%slot%is_same(found%slot), .true., dim=1)
        if (key > 0) return
        sought%keys = [sought%keys, found]
        key = size(sought%keys)
    end subroutine find_sensor_number

end module spintop_fit_unknowns
