!> What sensors make of a motion: the instants of their readings, their axes, offset and scale.
module spintop_fit_sensors
    use spintop_attitude, only: rotation_minus_one, to_space
    use spintop_kinds, only: dp
    use spintop_scene_keys, only: fit_scene_t
    use spintop_study_column, only: place_of
    use spintop_text, only: to_text
    use spintop_trajectory_columns, only: trajectory_column_t, trajectory_columns
    implicit none
    private
    public :: columns_of_motion, find_instants, read_sensors

    !> Nodes and weights of a mean over an interval, of half width 1: those of Gauss and Legendre.
    real(dp), parameter :: gauss_nodes(5) = [-0.9061798459386640_dp, -0.5384693101056831_dp, 0.0_dp, 0.5384693101056831_dp, &
                                             0.9061798459386640_dp]
    real(dp), parameter :: gauss_weights(5) = [0.1184634425280945_dp, 0.2393143352496832_dp, 0.2844444444444444_dp, &
                                               0.2393143352496832_dp, 0.1184634425280945_dp]

contains

    !> The columns of the motion, in their own units: those that are measured, and if a sensor of a vector is mounted at an angle,
    !> all components of the vector.
    subroutine columns_of_motion(measured, mounting, seeks_mounting, columns, turned)
        type(trajectory_column_t), intent(in) :: measured(:) !! the measured columns
        real(dp), intent(in) :: mounting(3) !! rotation vector of the sensor, rad
        logical, intent(in) :: seeks_mounting(:) !! which of the sought numbers are of a mounting
        type(trajectory_column_t), allocatable, intent(out) :: columns(:) !! the measured ones come first
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

    !> The instants of the motion at which the readings of some rows are those of the motion, or over which they are averaged.
    pure subroutine find_instants(settings, t, instants)
        type(fit_scene_t), intent(in) :: settings !! the group of the input
        real(dp), intent(in) :: t(:) !! times of the rows, s
        real(dp), allocatable, intent(out) :: instants(:) !! as many for each row, s
        integer :: i
        if (settings%averaged > 0) then
            instants = [(settings%time_offset + t(i) + settings%averaged / 2 * gauss_nodes, i=1, size(t))]
        else
            instants = settings%time_offset + t
        end if
    end subroutine find_instants

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

end module spintop_fit_sensors
