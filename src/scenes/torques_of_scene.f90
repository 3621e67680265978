!> Reads the tables that the effects of a scene name: of torques over time, and of friction over the angular velocity.
module spintop_torques_of_scene
    use spintop_compare, only: is_equal, is_finite
    use spintop_errors, only: error_t
    use spintop_files, only: path_from
    use spintop_kinds, only: dp
    use spintop_loaded_table, only: read_table, table_t
    use spintop_problems, only: problems_t
    use spintop_effects_keys, only: effects_scene_t, interpolation_of
    use spintop_text, only: join, to_text
    use spintop_torque_table, only: driving_row, fewest_rows, last_of_piece
    implicit none
    private
    public :: read_torques, read_friction_table

    character(*), parameter :: key_of_torques = 'effects.torque_table', key_of_friction = 'effects.friction_table'
    character(*), parameter :: columns_of_torques(4) = [character(2) :: 't', 'm1', 'm2', 'm3']
    character(*), parameter :: columns_of_friction(2) = [character(15) :: 'omega3', 'friction_torque']

contains

    !> Reads and checks the table of torques; problems are reported, and then the scene has none.
    subroutine read_torques(input, scene, problems)
        character(*), intent(in) :: input !! path of the input: the table's is relative to it
        type(effects_scene_t), intent(inout) :: scene !! times and torques are set
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(table_t) :: table
        real(dp), allocatable :: values(:, :)

        if (scene%torque_table == '') return
        call read_columns(path_from(input, scene%torque_table), key_of_torques, columns_of_torques, &
                          fewest_rows(interpolation_of(scene%torque_interpolation)), table, values, problems)
        if (problems%any()) return
        call check_times(values(:, 1), fewest_rows(interpolation_of(scene%torque_interpolation)), problems)
        if (problems%any()) return
        scene%table_times = values(:, 1)
        scene%table_torques = transpose(values(:, 2:))
    end subroutine read_torques

    !> Reads and checks the table of friction; problems are reported, and then the scene has none.
    subroutine read_friction_table(input, scene, problems)
        character(*), intent(in) :: input !! path of the input: the table's is relative to it
        type(effects_scene_t), intent(inout) :: scene !! angular velocities and friction are set
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(table_t) :: table
        real(dp), allocatable :: values(:, :)
        integer :: interpolation

        if (scene%friction_table == '') return
        interpolation = interpolation_of(scene%friction_interpolation)
        call read_columns(path_from(input, scene%friction_table), key_of_friction, columns_of_friction, &
                          fewest_rows(interpolation), table, values, problems)
        if (problems%any()) return
        call check_friction(table, values(:, 1), values(:, 2), interpolation, problems)
        if (problems%any()) return
        scene%friction_rates = values(:, 1)
        scene%friction_torques = values(:, 2)
    end subroutine read_friction_table

    !> Reads the columns of a table, with finite numbers in enough rows.
    subroutine read_columns(path, key, names, fewest, table, values, problems)
        character(*), intent(in) :: path, key, names(:) !! of the file, of the input, of the columns
        integer, intent(in) :: fewest !! rows that the interpolation needs
        type(table_t), intent(out) :: table
        real(dp), allocatable, intent(out) :: values(:, :) !! rows, columns
        type(problems_t), intent(inout) :: problems
        type(error_t), allocatable :: error
        real(dp), allocatable :: column(:)
        integer :: i

        call read_table(path, table, error)
        do i = 1, size(names)
            if (.not. allocated(error)) call table%read_column(trim(names(i)), column, error)
            if (allocated(error)) then
                call problems%add(key, error%message, 'its columns are ' // join(names, ', ') // '; its path is relative to the &
                    &folder of the input')
                return
            end if
            if (i == 1) allocate (values(size(column), size(names)))
            values(:, i) = column
        end do
        if (size(column) < fewest) then
            call problems%add(key, 'the table has ' // to_text(size(column)) // ' rows, too few for this interpolation', &
                              'it needs ' // to_text(fewest) // ' at least')
            return
        end if
        do i = 1, size(column)
            if (all(is_finite(values(i, :)))) cycle
            call problems%add(key, table%place_of_row(i) // ': row ' // to_text(i) // ' has a value that is not finite', &
                              'give finite numbers')
            return
        end do
    end subroutine read_columns

    !> Checks that the times are in increasing order from the start or before; two of one time are a jump, with enough rows on
    !> each side.
    subroutine check_times(t, fewest, problems)
        real(dp), intent(in) :: t(:)
        integer, intent(in) :: fewest !! rows that the interpolation needs
        type(problems_t), intent(inout) :: problems
        integer :: i, last

        do i = 2, size(t)
            if (t(i) > t(i - 1) .or. (is_equal(t(i), t(i - 1)) .and. .not. is_equal(t(i), t(max(1, i - 2))))) cycle
            call problems%add(key_of_torques, 'the times of the table do not increase: t = ' // to_text(t(i)) // ' in row ' // &
                              to_text(i), 'sort the rows by t, each time once, or twice where the torque jumps')
            return
        end do
        i = 1
        do while (i <= size(t))
            last = last_of_piece(t, i)
            if (last - i + 1 < fewest) then
                call problems%add(key_of_torques, 'the piece of the table from t = ' // to_text(t(i)) // ' to ' // &
                                  to_text(t(last)) // ', up to a jump, has ' // to_text(last - i + 1) // &
                                  ' rows, too few for this interpolation', 'it needs ' // to_text(fewest) // ' at least')
                return
            end if
            i = last + 1
        end do
        if (t(1) > 0) call problems%add(key_of_torques, 'the table begins at t = ' // to_text(t(1)) // ', after the start', &
                                        'its first row is at t = 0 or before')
    end subroutine check_times

    !> Checks that the angular velocities increase from zero, and that friction nowhere drives the body.
    subroutine check_friction(table, omega, friction, interpolation, problems)
        type(table_t), intent(in) :: table !! for places in the file
        real(dp), intent(in) :: omega(:), friction(:)
        integer, intent(in) :: interpolation
        type(problems_t), intent(inout) :: problems
        integer :: row

        if (omega(1) < 0 .or. omega(1) > 0) then
            call problems%add(key_of_friction, table%place_of_row(1) // ': the table begins at omega3 = ' // to_text(omega(1)), &
                              'its first row is at omega3 = 0, with the dry friction; negative ones follow by symmetry')
            return
        end if
        do row = 2, size(omega)
            if (omega(row) > omega(row - 1)) cycle
            call problems%add(key_of_friction, table%place_of_row(row) // ': omega3 = ' // to_text(omega(row)) // &
                              ' is not larger than in the row before', 'sort the rows by omega3, each once')
            return
        end do
        row = findloc(friction < 0, .true., dim=1)
        if (row > 0) then
            call problems%add(key_of_friction, table%place_of_row(row) // ': friction_torque = ' // to_text(friction(row)) // &
                              ' would drive the body', 'a moment against the rotation is positive')
            return
        end if
        row = driving_row(omega, friction, interpolation)
        if (row > 0) call problems%add(key_of_friction, table%place_of_row(row) // ': from this row to the next the spline is &
                                       &negative, which would drive the body', &
                                       'give more rows, or friction_interpolation = ''monotone''')
    end subroutine check_friction

end module spintop_torques_of_scene
