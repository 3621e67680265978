!> The numbers that a fit seeks: real numbers of the input, and those of sensors.
module spintop_fit_unknown
    use spintop_fit_data, only: measurements_t
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: sensors_t
    use spintop_sensitivity, only: sensitive_key_t, sensitivities_t
    use spintop_study_column, only: place_of
    use spintop_text, only: to_text
    use spintop_parameters, only: is_set
    implicit none
    private
    public :: find_unknown, key_of

contains

    !> Finds the sought numbers.
    subroutine find_unknown(job, measured, sought, problems)
        type(job_t), target, intent(inout) :: job !! the job
        type(measurements_t), intent(inout) :: measured !! the measurements; the sensors of the numbers are named
        type(sensitivities_t), intent(inout) :: sought !! the numbers are added
        type(problems_t), intent(inout) :: problems !! problems of the names are added
        character(:), allocatable :: problem, hint
        integer :: i, key, found

        found = 0
        associate (fit => job%input%scene%fit)
            do i = 1, size(fit%unknown)
                if (fit%unknown(i) == '') cycle
                if (is_of_sensor(fit%unknown(i))) then
                    call find_sensor_number(trim(fit%unknown(i)), job, measured, sought, key, problem, hint)
                else
                    call sought%find_key(trim(fit%unknown(i)), job%input%table, job%axes, key, problem, hint)
                end if
                if (problem == '' .and. key <= found) then
                    problem = trim(fit%unknown(i)) // ' is named twice'
                    hint = 'name it once'
                end if
                if (problem == '') call check_range(fit%from(i), fit%to(i), sought%keys(key)%slot%get(), problem, hint)
                if (problem /= '') call problems%add('fit.unknown(' // to_text(i) // ')', problem, hint)
                found = max(found, key)
            end do
            if (all(fit%unknown == '')) call problems%add('fit', 'nothing is sought', "give unknown = 'top.inertia(3)' and the &
                &like")
        end associate
    end subroutine find_unknown

    !> Whether a name is that of a number of a sensor.
    pure logical function is_of_sensor(name)
        character(*), intent(in) :: name
        is_of_sensor = any([index(name, 'offset.'), index(name, 'scale.'), index(name, 'mounting(')] == 1)
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
    subroutine find_sensor_number(name, job, measured, sought, key, problem, hint)
        character(*), intent(in) :: name
        type(job_t), target, intent(inout) :: job
        type(measurements_t), intent(inout) :: measured
        type(sensitivities_t), intent(inout) :: sought
        integer, intent(out) :: key !! its index
        character(:), allocatable, intent(out) :: problem, hint
        type(sensitive_key_t) :: found
        character(:), allocatable :: column
        integer :: k

        key = 0
        hint = 'name a measured column, as in offset.theta'
        found%name = name
        found%unit = ''
        if (index(name, 'mounting(') == 1) then
            found%unit = 'rad'
        else if (name == 'offset.t') then
            found%unit = 's'
        else
            column = name(index(name, '.') + 1:)
            problem = column // ' is not measured'
            k = 0
            if (allocated(measured%columns)) k = place_of(measured%columns, column)
            if (k == 0) return
            if (index(name, 'offset.') == 1) then
                found%unit = trim(measured%columns(k)%unit)
            else if (measured%turn(k) > 0) then
                problem = 'the turns of ' // column // ' are not known, and tell its scale'
                hint = 'give sensor.scale: the readings of a turn over the turn'
                return
            end if
            measured%sensor(k) = job%input%scene%fit%sensors%place_of(column)
        end if
        call job%input%table%find_number(key_of(name, job%input%scene%fit%sensors), found%slot, problem)
        if (problem /= '') return
        if (.not. allocated(sought%keys)) allocate (sought%keys(0))
        do key = 1, size(sought%keys)
            if (sought%keys(key)%slot%is_same(found%slot)) return
        end do
        sought%keys = [sought%keys, found]
    end subroutine find_sensor_number

    !> Checks the range of a sought number.
    subroutine check_range(from, to, value, problem, hint)
        real(dp), intent(in) :: from, to, value
        character(:), allocatable, intent(inout) :: problem, hint
        if (is_set(from) .neqv. is_set(to)) then
            problem = 'the range has one end only'
            hint = 'give both from and to'
        else if (is_set(from) .and. .not. (from <= value .and. value <= to)) then
            problem = 'the value where the search begins is not in its range'
            hint = 'give a value from ' // to_text(from) // ' to ' // to_text(to)
        end if
    end subroutine check_range

end module spintop_fit_unknown
