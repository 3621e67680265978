!> Measurements of a motion: times, and readings of columns of trajectories, from a CSV table. The name of a column may end in a
!> unit, as `theta_deg` does, which then is that of its readings, their standard deviations and residuals. Sensors
!> have instants, axes, an offset and a scale. Each run of the body has a table.
module spintop_fit_data
    use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
    use spintop_attitude, only: rotation_minus_one, to_space
    use spintop_kinds, only: dp, is_finite
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: path_from
    use spintop_logger_table, only: base_of, column_named, is_time, logger_table_t, read_logger_table, sigma_mark
    use spintop_parameters, only: is_set
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: fit_scene_t
    use spintop_study_column, only: find_column, needs_effects, needs_exact, needs_work, place_of, proof_group, study_column_t
    use spintop_text, only: abbreviate, escaped, join, string_t, to_text
    use spintop_trajectory_columns, only: trajectory_columns
    use spintop_units, only: convert_unit
    implicit none
    private
    public :: measurements_t, read_measurements, columns_of_motion, read_sensors, gauss_nodes

    character(*), parameter :: turn = 'turn'

    !> The measurements of a run, row by row.
    type :: measurements_t
        !> What precedes the names of its columns in messages: `run 2, FILE: `; empty if there is one run.
        character(:), allocatable :: label
        !> The measured columns, and the angle by whose multiples their readings are not known; 0 for none.
        type(study_column_t), allocatable :: columns(:)
        real(dp), allocatable :: turn(:)
        !> The number of the group &sensor that describes each column; 0 for none.
        integer, allocatable :: sensor(:)
        !> Times, s, increasing, and the readings: columns, times.
        real(dp), allocatable :: t(:), values(:, :)
        !> The column of the times, and its cells, in its unit.
        type(study_column_t) :: time
        real(dp), allocatable :: given_times(:)
        !> Which of the readings there are.
        logical, allocatable :: is_there(:, :)
        !> Their standard deviations, which are 1 where they are not known.
        real(dp), allocatable :: sigma(:, :)
        logical :: knows_sigma = .false.
        !> What was understood: the columns, and the clock.
        type(string_t) :: notes(2)
    contains
        procedure :: size => count_readings
        procedure :: differences
    end type measurements_t

    !> Nodes and weights of a mean over an interval, of half width 1: those of Gauss and Legendre.
    real(dp), parameter :: gauss_nodes(5) = [-0.9061798459386640_dp, -0.5384693101056831_dp, 0.0_dp, 0.5384693101056831_dp, &
                                             0.9061798459386640_dp]
    real(dp), parameter :: gauss_weights(5) = [0.1184634425280945_dp, 0.2393143352496832_dp, 0.2844444444444444_dp, &
                                               0.2393143352496832_dp, 0.1184634425280945_dp]

contains

    !> Number of readings.
    elemental integer function count_readings(self) result(n)
        class(measurements_t), intent(in) :: self
        n = count(self%is_there)
    end function count_readings

    !> The readings less others, those of wrapped angles to the nearest turn; 0 where there is no reading.
    pure function differences(self, readings)
        class(measurements_t), intent(in) :: self
        real(dp), intent(in) :: readings(:, :) !! columns, leading rows
        real(dp) :: differences(size(readings, 1), size(readings, 2))
        integer :: i
        associate (rows => size(readings, 2))
            differences = merge(self%values(:, :rows) - readings, 0.0_dp, self%is_there(:, :rows))
            do i = 1, size(readings, 1)
                associate (turn => self%turn(i))
                    if (turn > 0) differences(i, :) = modulo(differences(i, :) + turn / 2, turn) - turn / 2
                end associate
            end do
        end associate
    end function differences

    !> Reads the measurements of all runs of a scene; what is wrong with them is a problem.
    subroutine read_measurements(input, scene, measured, problems)
        character(*), intent(in) :: input !! path of the input: those of the tables are relative to it
        type(fit_scene_t), intent(in) :: scene !! the group of the input
        type(measurements_t), allocatable, intent(out) :: measured(:) !! each run; without columns if there is a problem
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(problems_t) :: of_run
        character(:), allocatable :: file
        integer :: i

        allocate (measured(count(scene%data /= '')))
        if (size(measured) == 0) call problems%add('fit', 'there are no measurements', "give data = 'FILE.csv'")
        do i = 1, size(measured)
            file = trim(scene%data(i))
            measured(i)%label = ''
            if (size(measured) > 1) measured(i)%label = 'run ' // to_text(i) // ', ' // &
                                                        escaped(file(index(file, '/', back=.true.) + 1:)) // ': '
            of_run = problems_t()
            call read_run(path_from(input, file), 'fit.data(' // to_text(i) // ')', scene, measured(i), of_run)
            if (any(scene%data(:i - 1) == scene%data(i))) then
                call of_run%add('fit.data(' // to_text(i) // ')', 'the table is named twice', 'each run counts once')
            end if
            call problems%add_all(of_run, measured(i)%label)
        end do
        if (.not. problems%any()) call check_names(scene, measured, problems)
    end subroutine read_measurements

    !> Checks that the groups &sensor and `wrapped` name columns of some run, and that deviations are known of all or of none.
    subroutine check_names(scene, measured, problems)
        type(fit_scene_t), intent(in) :: scene
        type(measurements_t), intent(in) :: measured(:)
        type(problems_t), intent(inout) :: problems
        integer :: i, run

        do i = 1, size(scene%sensors%column)
            if (scene%sensors%column(i) == '' .or. any([(any(measured(run)%sensor == i), run=1, size(measured))])) cycle
            call problems%add('sensor.column(' // to_text(i) // ')', trim(scene%sensors%column(i)) // ' is not measured', &
                              'name a column as the table does: ' // join(measured(1)%columns%name, ', '))
        end do
        do i = 1, size(scene%wrapped)
            if (scene%wrapped(i) == '' .or. any([(place_of_wrapped(measured(run)%columns, scene%wrapped(i)) > 0, &
                                                  run=1, size(measured))])) cycle
            call problems%add('fit.wrapped(' // to_text(i) // ')', trim(scene%wrapped(i)) // ' is not a measured angle', &
                              'name phi, psi or theta, if it is measured')
        end do
        if (any(measured%knows_sigma) .and. .not. all(measured%knows_sigma)) then
            run = findloc(measured%knows_sigma, .false., dim=1)
            call problems%add('fit', 'the standard deviations of run ' // to_text(run) // ' are not known', &
                              'give sigma for all runs, or for none')
        end if
    end subroutine check_names

    !> Reads the measurements of a run.
    subroutine read_run(path, key, scene, measured, problems)
        character(*), intent(in) :: path
        character(*), intent(in) :: key !! the element of the input that names the table
        type(fit_scene_t), intent(in) :: scene
        type(measurements_t), intent(inout) :: measured !! without columns if there is a problem
        type(problems_t), intent(inout) :: problems
        type(study_column_t), allocatable :: columns(:)
        type(error_t), allocatable :: error
        type(logger_table_t) :: table
        real(dp), allocatable :: values(:)
        integer :: i

        call read_logger_table(path, key, scene%columns, table, problems)
        if (problems%any()) return
        measured%time = column_named(table%names(table%clock)%text)
        call table%read_column(trim(measured%time%name), measured%given_times, error)
        if (allocated(error)) then
            call problems%add(key, error%message, 'a row has a time: omit others')
            return
        end if
        measured%t = measured%given_times * measured%time%size
        call check_times(escaped(path), key, scene, measured%t, problems)
        if (problems%any()) return
        call choose_columns(key, table, columns, problems)
        if (problems%any()) return
        allocate (measured%values(size(columns), size(measured%t)))
        do i = 1, size(columns)
            call table%read_column(trim(columns(i)%name), values, error, takes_empty=.true.)
            if (.not. allocated(error)) then
                measured%values(i, :) = values
                if (any(is_finite(values)) .and. all(is_finite(values) .or. ieee_is_nan(values))) cycle
                error = input_error(escaped(path) // ': column ' // trim(columns(i)%name) // ' has an infinite reading')
                if (.not. any(is_finite(values))) error%message = escaped(path) // ': column ' // trim(columns(i)%name) // &
                                                                  ' has no reading'
            end if
            call problems%add(key, error%message, 'leave the cell empty or nan where there is no reading')
            return
        end do
        allocate (measured%is_there, source=is_finite(measured%values))
        call find_sensors(scene, columns, measured, problems)
        if (.not. problems%any()) call find_deviations(key, scene, table, columns, measured, problems)
        if (.not. problems%any()) call check_sizes(key, measured, problems)
        if (problems%any()) return
        call table%describe(columns%name, measured%t, measured%notes)
        call move_alloc(columns, measured%columns)
    end subroutine read_run

    !> Checks the times of the rows.
    subroutine check_times(path, key, scene, t, problems)
        character(*), intent(in) :: path, key
        type(fit_scene_t), intent(in) :: scene
        real(dp), intent(in) :: t(:)
        type(problems_t), intent(inout) :: problems
        real(dp), parameter :: slack = 1.01_dp
        real(dp) :: steps(size(t) - 1), start
        integer :: i

        if (.not. all(is_finite(t))) then
            call problems%add(key, path // ': a time is not a number', 'omit the row')
            return
        end if
        steps = t(2:) - t(:size(t) - 1)
        start = t(1) + scene%time_offset
        i = findloc(steps > 0, .false., dim=1)
        if (start < 0) then
            call problems%add(key, path // ': a time is before the start of the motion at 0', 'shift the times, or give &
                &fit.time_offset')
        else if (i > 0) then
            call problems%add(key, path // ': the times do not increase: ' // to_text(t(i + 1)) // ' s is after ' // &
                              to_text(t(i)) // ' s', 'sort the rows, one per time')
        else if (scene%averaged / slack > minval(steps)) then
            call problems%add('fit.averaged', 'the intervals of averages overlap', 'average over the time between rows at most')
        else if (start - scene%averaged / 2 < 0) then
            call problems%add('fit.averaged', 'the first average begins before the start of the motion at 0', &
                              'average over less, shift the times, or give fit.time_offset')
        end if
    end subroutine check_times

    !> The measured columns: those named, or all but the time and standard deviations.
    subroutine choose_columns(key, table, columns, problems)
        character(*), intent(in) :: key
        type(logger_table_t), intent(in) :: table
        type(study_column_t), allocatable, intent(out) :: columns(:)
        type(problems_t), intent(inout) :: problems
        integer :: i

        allocate (columns(0))
        if (any([(table%wanted(i)%text /= '', i=1, size(table%wanted))])) then
            do i = 1, size(table%wanted)
                if (table%wanted(i)%text /= '') call add_column(table%wanted(i)%text, 'fit.columns(' // to_text(i) // ')')
            end do
        else
            do i = 1, size(table%names)
                if (table%names(i)%text == '') cycle
                if (is_time(column_named(table%names(i)%text)) .or. is_deviation(table%names(i)%text)) cycle
                call add_column(table%names(i)%text, key)
            end do
            if (size(table%names) < 2) call problems%add(key, 'the table has no column of measurements', &
                                                         'give columns of trajectories, such as theta, beside t')
        end if

    contains

        !> Adds a column of that name.
        subroutine add_column(name, key)
            character(*), intent(in) :: name, key
            type(study_column_t) :: found
            character(:), allocatable :: problem, hint

            call find_column(trajectory_columns, name, found, problem, hint)
            if (found%place == 0) then
                if (hint == '') hint = table%mapping
            else
                if (found%group == proof_group .or. found%is(needs_exact + needs_work + needs_effects)) then
                    hint = 'errors, bounds and the work of effects are not measured'
                end if
            end if
            if (hint /= '') then
                call problems%add(key, abbreviate(name) // ' is not a measurable column', hint)
            else if (any(columns%place == found%place)) then
                call problems%add(key, "column '" // name // "' is named twice", 'name it once, in one unit')
            else
                columns = [columns, found]
            end if
        end subroutine add_column

        !> Whether a column has the standard deviations of another one, which has to be there.
        logical function is_deviation(name)
            character(*), intent(in) :: name
            character(:), allocatable :: of
            type(study_column_t) :: found
            integer :: k
            of = base_of(name)
            found = column_named(of)
            is_deviation = of /= name .and. found%place > 0
            if (.not. is_deviation .or. any([(table%names(k)%text == of, k=1, size(table%names))])) return
            call problems%add(key, 'the table has ' // name // ', but no column ' // of, &
                              'the standard deviations of a column are in its unit: give both the same name before _sigma')
        end function is_deviation

    end subroutine choose_columns

    !> The groups &sensor of the columns, and the turns by which wrapped angles are not known.
    subroutine find_sensors(scene, columns, measured, problems)
        type(fit_scene_t), intent(in) :: scene
        type(study_column_t), intent(in) :: columns(:)
        type(measurements_t), intent(inout) :: measured
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: problem
        integer :: i, k

        allocate (measured%sensor(size(columns)), source=0)
        allocate (measured%turn(size(columns)), source=0.0_dp)
        do i = 1, size(scene%sensors%column)
            k = place_of(columns, scene%sensors%column(i))
            if (k == 0) cycle
            if (measured%sensor(k) > 0) then
                call problems%add('sensor.column(' // to_text(i) // ')', "column '" // trim(scene%sensors%column(i)) // &
                                  "' is named twice", 'give one group per column')
            else
                measured%sensor(k) = i
            end if
        end do
        do i = 1, size(scene%wrapped)
            k = place_of_wrapped(columns, scene%wrapped(i))
            if (k == 0) cycle
            call convert_unit(turn, trim(columns(k)%unit), measured%turn(k), problem)
            if (measured%sensor(k) > 0) measured%turn(k) = measured%turn(k) * abs(scene%sensors%scale(measured%sensor(k)))
        end do
    end subroutine find_sensors

    !> The measured angle of a name; 0 if there is none.
    integer function place_of_wrapped(columns, name) result(k)
        type(study_column_t), intent(in) :: columns(:)
        character(*), intent(in) :: name
        character(:), allocatable :: problem
        real(dp) :: factor
        k = findloc(columns%name == name .or. columns%quantity() == name, .true., dim=1)
        if (k == 0) return
        call convert_unit(turn, trim(columns(k)%unit), factor, problem)
        if (problem /= '') k = 0
    end function place_of_wrapped

    !> The standard deviations of the readings: of each row, if the table has them, or of columns.
    subroutine find_deviations(key, scene, table, columns, measured, problems)
        character(*), intent(in) :: key
        type(fit_scene_t), intent(in) :: scene
        type(logger_table_t), intent(in) :: table
        type(study_column_t), intent(in) :: columns(:)
        type(measurements_t), intent(inout) :: measured
        type(problems_t), intent(inout) :: problems
        type(error_t), allocatable :: error
        real(dp), allocatable :: sigma(:)
        logical :: is_known(size(columns))
        integer :: given, i, k

        given = count(is_set(scene%sigma))
        allocate (measured%sigma(size(columns), size(measured%t)), source=1.0_dp)
        is_known = given > 0
        if (given == 1) then
            measured%sigma = scene%sigma(1)
        else if (given == size(columns)) then
            measured%sigma = spread(scene%sigma(:given), 2, size(measured%t))
        else if (given > 0) then
            call problems%add('fit.sigma', to_text(given) // ' standard deviations for ' // to_text(size(columns)) // &
                              ' columns', 'give one, or one per column; decimals follow a point, as in 0.5')
            return
        end if
        do i = 1, size(columns)
            if (measured%sensor(i) > 0) then
                if (is_set(scene%sensors%sigma(measured%sensor(i)))) then
                    measured%sigma(i, :) = scene%sensors%sigma(measured%sensor(i))
                    is_known(i) = .true.
                end if
            end if
            if (.not. any([(table%names(k)%text == trim(columns(i)%name) // sigma_mark, k=1, size(table%names))])) cycle
            call table%read_column(trim(columns(i)%name) // sigma_mark, sigma, error, takes_empty=.true.)
            if (.not. allocated(error)) then
                measured%is_there(i, :) = measured%is_there(i, :) .and. .not. ieee_is_nan(sigma)
                measured%sigma(i, :) = merge(sigma, 1.0_dp, measured%is_there(i, :))
                is_known(i) = .true.
                if (.not. any(measured%is_there(i, :))) then
                    error = input_error('column ' // trim(columns(i)%name) // ' has no reading with a standard deviation')
                else if (all(measured%sigma(i, :) > 0 .and. is_finite(measured%sigma(i, :)))) then
                    cycle
                else
                    error = input_error('column ' // trim(columns(i)%name) // sigma_mark // ' has a cell that is not above 0')
                end if
            end if
            call problems%add(key, error%message, 'leave it empty or nan where the reading does not count')
            return
        end do
        measured%knows_sigma = all(is_known)
        if (any(is_known) .and. .not. all(is_known)) then
            call problems%add('fit', 'the standard deviation of ' // trim(columns(findloc(is_known, .false., dim=1))%name) // &
                              ' is not known', 'give sigma for all columns, or for none')
        end if
    end subroutine find_deviations

    !> Checks that squares of the readings over their standard deviations, and of small parts of them, are numbers.
    subroutine check_sizes(key, measured, problems)
        character(*), intent(in) :: key
        type(measurements_t), intent(in) :: measured
        type(problems_t), intent(inout) :: problems
        real(dp), parameter :: most = 1.0e100_dp
        character(:), allocatable :: of
        real(dp) :: largest, least_sigma, most_sigma
        integer :: i

        of = key
        if (measured%knows_sigma) of = 'fit.sigma'
        do i = 1, size(measured%sigma, 1)
            largest = maxval(abs(measured%values(i, :)), mask=measured%is_there(i, :))
            least_sigma = minval(measured%sigma(i, :))
            most_sigma = maxval(measured%sigma(i, :))
            if (largest / most <= least_sigma .and. most_sigma <= most * max(largest, 1 / most)) cycle
            call problems%add(of, 'the largest measurement, ' // to_text(largest) // ', is not comparable with a standard &
                &deviation of ' // to_text(least_sigma), 'use the unit of the column')
            return
        end do
    end subroutine check_sizes

    !> The columns of the motion, in their own units: those that are measured, and if a sensor of a vector is mounted at an angle,
    !> all components of the vector.
    subroutine columns_of_motion(measured, mounting, seeks_mounting, columns, turned)
        type(study_column_t), intent(in) :: measured(:) !! the measured columns
        real(dp), intent(in) :: mounting(3) !! rotation vector of the sensor, rad
        logical, intent(in) :: seeks_mounting(:) !! which of the sought numbers are of a mounting
        type(study_column_t), allocatable, intent(out) :: columns(:) !! the measured ones come first
        integer, allocatable, intent(out) :: turned(:, :) !! places of the components of each vector that is turned
        character(*), parameter :: vectors(2) = [character(13) :: 'omega', 'accelerometer']
        character(:), allocatable :: name
        integer :: places(3), i, k

        columns = trajectory_columns([(place_of(trajectory_columns, measured(i)%quantity()), i=1, size(measured))])
        allocate (turned(3, 0))
        if (.not. (any(seeks_mounting) .or. norm2(mounting) > 0)) return
        do i = 1, size(vectors)
            if (.not. any([(any(measured%quantity() == trim(vectors(i)) // to_text(k)), k=1, 3)])) cycle
            do k = 1, 3
                name = trim(vectors(i)) // to_text(k)
                places(k) = place_of(columns, name)
                if (places(k) > 0) cycle
                columns = [columns, trajectory_columns(place_of(trajectory_columns, name))]
                places(k) = size(columns)
            end do
            turned = reshape([turned, places], [3, size(turned, 2) + 1])
        end do
    end subroutine columns_of_motion

    !> The readings of the sensors.
    subroutine read_sensors(settings, sensor, sizes, turned, quantities, readings)
        type(fit_scene_t), intent(in) :: settings !! the group of the input
        integer, intent(in) :: sensor(:) !! the number of the group &sensor of each measured column; 0 for none
        real(dp), intent(in) :: sizes(:) !! of the unit of each measured column, in that of the quantity
        integer, intent(in) :: turned(:, :) !! places of the components of each vector that is turned
        real(dp), intent(inout) :: quantities(:, :) !! columns of the motion, instants; vectors are turned
        real(dp), intent(out) :: readings(:, :) !! measured columns, rows
        real(dp) :: to_sensor(4)
        integer :: i, k, nodes

        to_sensor = rotation_minus_one(-settings%mounting) + [1, 0, 0, 0]
        do i = 1, size(turned, 2)
            do k = 1, size(quantities, 2)
                quantities(turned(:, i), k) = to_space(to_sensor, quantities(turned(:, i), k))
            end do
        end do
        nodes = size(quantities, 2) / size(readings, 2)
        do i = 1, size(readings, 1)
            readings(i, :) = quantities(i, ::nodes)
            if (nodes > 1) readings(i, :) = matmul(gauss_weights, reshape(quantities(i, :), [nodes, size(readings, 2)]))
            readings(i, :) = readings(i, :) / sizes(i)
            if (sensor(i) == 0) cycle
            readings(i, :) = settings%sensors%offset(sensor(i)) + settings%sensors%scale(sensor(i)) * readings(i, :)
        end do
    end subroutine read_sensors

end module spintop_fit_data
