!> Measurements of a motion: times, and values of columns of trajectories, from a CSV table.
module spintop_fit_data
    use spintop_compare, only: is_finite
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: path_from
    use spintop_kinds, only: dp
    use spintop_loaded_table, only: read_table, table_t
    use spintop_parameters, only: is_set
    use spintop_plain_text, only: escaped
    use spintop_problems, only: problems_t
    use spintop_scene_fit, only: fit_scene_t
    use spintop_study_column, only: place_of, proof_group
    use spintop_text, only: abbreviate, did_you_mean, to_text
    use spintop_trajectory_columns, only: trajectory_column_t, trajectory_columns
    implicit none
    private
    public :: measurements_t, read_measurements

    !> Measurements, row by row.
    type :: measurements_t
        !> The columns, and their standard deviations, which are 1 where they are not known.
        type(trajectory_column_t), allocatable :: columns(:)
        real(dp), allocatable :: sigma(:)
        logical :: knows_sigma = .false.
        !> Times, s, increasing from 0 or later, and the values: columns, times.
        real(dp), allocatable :: t(:), values(:, :)
    end type measurements_t

contains

    !> Reads the measurements of a scene; what is wrong with them is a problem.
    subroutine read_measurements(input, scene, measured, problems)
        character(*), intent(in) :: input !! path of the input: that of the table is relative to it
        type(fit_scene_t), intent(in) :: scene !! the group of the input
        type(measurements_t), intent(out) :: measured !! the measurements; without columns if there is a problem
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        character(*), parameter :: key = 'fit.data'
        type(trajectory_column_t), allocatable :: columns(:)
        type(error_t), allocatable :: error
        type(table_t) :: table
        character(:), allocatable :: path
        real(dp), allocatable :: values(:)
        integer :: i

        if (scene%data == '') then
            call problems%add('fit', 'there are no measurements', "give data = 'FILE.csv'")
            return
        end if
        path = path_from(input, scene%data)
        call read_table(path, table, error)
        if (.not. allocated(error)) call table%read_column('t', measured%t, error)
        if (allocated(error)) then
            call problems%add(key, error%message, 'its path is relative to the folder of the input')
            return
        end if
        if (size(measured%t) == 0) then
            call problems%add(key, escaped(path) // ': the table has no rows', 'give measurements')
            return
        end if
        if (.not. all(is_finite(measured%t)) .or. measured%t(1) < 0) then
            call problems%add(key, escaped(path) // ': a time is before the start of the motion at 0, or not a number', &
                              'shift the times')
            return
        end if
        do i = 2, size(measured%t)
            if (measured%t(i) > measured%t(i - 1)) cycle
            call problems%add(key, escaped(path) // ': the times do not increase: ' // to_text(measured%t(i)) // ' s is after ' &
                              // to_text(measured%t(i - 1)) // ' s', 'sort the rows, one per time')
            return
        end do
        call choose_columns(scene, table, columns, problems)
        if (problems%any()) return
        allocate (measured%values(size(columns), size(measured%t)))
        do i = 1, size(columns)
            call table%read_column(trim(columns(i)%name), values, error)
            if (.not. allocated(error)) then
                if (all(is_finite(values))) then
                    measured%values(i, :) = values
                    cycle
                end if
                error = input_error(escaped(path) // ': column ' // trim(columns(i)%name) // ' has cells without a number')
            end if
            call problems%add(key, error%message, 'omit the rows without a measurement, or the column')
            return
        end do
        call take_deviations(scene, columns, measured, problems)
        if (.not. problems%any()) call check_sizes(measured, problems)
        if (.not. problems%any()) call move_alloc(columns, measured%columns)
    end subroutine read_measurements

    !> The measured columns: those named, or all but the time.
    subroutine choose_columns(scene, table, columns, problems)
        type(fit_scene_t), intent(in) :: scene
        type(table_t), intent(in) :: table
        type(trajectory_column_t), allocatable, intent(out) :: columns(:)
        type(problems_t), intent(inout) :: problems
        integer, allocatable :: places(:)
        integer :: i

        allocate (places(0))
        if (any(scene%columns /= '')) then
            do i = 1, size(scene%columns)
                if (scene%columns(i) == '') cycle
                call take_column(trim(scene%columns(i)), 'fit.columns(' // to_text(i) // ')')
            end do
        else
            do i = 1, size(table%names)
                if (table%names(i)%text /= 't') call take_column(table%names(i)%text, 'fit.data')
            end do
            if (size(table%names) < 2) call problems%add('fit.data', 'the table has no column of measurements', &
                                                         'give columns of trajectories, such as theta, beside t')
        end if
        columns = trajectory_columns(places)

    contains

        !> Adds a column of that name.
        subroutine take_column(name, key)
            character(*), intent(in) :: name, key
            character(:), allocatable :: hint
            integer :: place

            place = place_of(trajectory_columns, name)
            hint = ''
            if (place == 0) then
                hint = did_you_mean(name, trajectory_columns%name)
                if (hint == '') hint = '`spintop list columns` shows those of trajectories'
            else
                associate (column => trajectory_columns(place))
                    if (column%group == proof_group .or. column%needs_exact_motion .or. column%needs_work &
                        .or. column%needs_effects) hint = 'errors, bounds and the work of effects are not measured'
                end associate
            end if
            if (hint /= '') then
                call problems%add(key, abbreviate(name) // ' is not a measurable column', hint)
            else if (any(places == place)) then
                call problems%add(key, "column '" // name // "' is named twice", 'name it once')
            else
                places = [places, place]
            end if
        end subroutine take_column

    end subroutine choose_columns

    !> The standard deviations of the columns.
    subroutine take_deviations(scene, columns, measured, problems)
        type(fit_scene_t), intent(in) :: scene
        type(trajectory_column_t), intent(in) :: columns(:)
        type(measurements_t), intent(inout) :: measured
        type(problems_t), intent(inout) :: problems
        integer :: given

        given = count(is_set(scene%sigma))
        allocate (measured%sigma(size(columns)), source=1.0_dp)
        if (given == 0) return
        measured%knows_sigma = .true.
        if (given == 1) then
            measured%sigma = scene%sigma(1)
        else if (given == size(columns)) then
            measured%sigma = scene%sigma(:given)
        else
            call problems%add('fit.sigma', to_text(given) // ' standard deviations for ' // to_text(size(columns)) // ' columns', &
                              'give one, or one per column')
        end if
    end subroutine take_deviations

    !> Checks that squares of the measurements over their standard deviations, and of small parts of them, are numbers.
    subroutine check_sizes(measured, problems)
        type(measurements_t), intent(in) :: measured
        type(problems_t), intent(inout) :: problems
        real(dp), parameter :: most = 1.0e100_dp
        real(dp) :: largest
        integer :: i

        do i = 1, size(measured%sigma)
            largest = maxval(abs(measured%values(i, :)))
            if (largest / most <= measured%sigma(i) .and. measured%sigma(i) <= most * max(largest, 1 / most)) cycle
            call problems%add(merge('fit.sigma', 'fit.data ', measured%knows_sigma), 'the largest measurement, ' // &
                              to_text(largest) // ', is not comparable with a standard deviation of ' // &
                              to_text(measured%sigma(i)), 'use the unit of the column')
            return
        end do
    end subroutine check_sizes

end module spintop_fit_data
