!> Reads the table of torques that the effects of a scene name.
module spintop_torques_of_scene
    use spintop_compare, only: is_equal, is_finite
    use spintop_errors, only: error_t
    use spintop_files, only: path_from
    use spintop_kinds, only: dp
    use spintop_loaded_table, only: read_table, table_t
    use spintop_problems, only: problems_t
    use spintop_effects_keys, only: effects_scene_t, interpolation_of
    use spintop_text, only: to_text
    use spintop_torque_table, only: fewest_rows, last_of_piece
    implicit none
    private
    public :: read_torques

    character(*), parameter :: key = 'effects.torque_table'

contains

    !> Reads and checks the table; problems are reported, and then the scene has none.
    subroutine read_torques(input, scene, problems)
        character(*), intent(in) :: input !! path of the input: the table's is relative to it
        type(effects_scene_t), intent(inout) :: scene !! times and torques are set
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(table_t) :: table
        type(error_t), allocatable :: error
        character(:), allocatable :: path
        real(dp), allocatable :: t(:), torque(:, :), column(:)
        character(*), parameter :: names(3) = ['m1', 'm2', 'm3']
        integer :: axis

        if (scene%torque_table == '') return
        path = path_from(input, scene%torque_table)
        call read_table(path, table, error)
        if (.not. allocated(error)) call table%read_column('t', t, error)
        if (.not. allocated(error)) allocate (torque(3, size(t)))
        do axis = 1, 3
            if (allocated(error)) exit
            call table%read_column(names(axis), column, error)
            if (.not. allocated(error)) torque(axis, :) = column
        end do
        if (allocated(error)) then
            call problems%add(key, error%message, 'its columns are t, m1, m2 and m3; its path is relative to the folder &
                &of the input')
            return
        end if
        call check_rows(scene, t, torque, problems)
        if (problems%any()) return
        call move_alloc(t, scene%table_times)
        call move_alloc(torque, scene%table_torques)
    end subroutine read_torques

    !> Checks that the rows are finite, in increasing order of time from the start or before, and enough; two of one time are a
    !> jump, with enough rows on each side.
    subroutine check_rows(scene, t, torque, problems)
        type(effects_scene_t), intent(in) :: scene
        real(dp), intent(in) :: t(:), torque(:, :)
        type(problems_t), intent(inout) :: problems
        integer :: i, last, fewest

        fewest = fewest_rows(interpolation_of(scene))
        if (size(t) < fewest) then
            call problems%add(key, 'the table has ' // to_text(size(t)) // ' rows, too few for this interpolation', &
                              'it needs ' // to_text(fewest) // ' at least')
            return
        end if
        do i = 1, size(t)
            if (.not. (is_finite(t(i)) .and. all(is_finite(torque(:, i))))) then
                call problems%add(key, 'row ' // to_text(i) // ' has a value that is not finite', 'give finite numbers')
                return
            end if
        end do
        do i = 2, size(t)
            if (t(i) > t(i - 1) .or. (is_equal(t(i), t(i - 1)) .and. .not. is_equal(t(i), t(max(1, i - 2))))) cycle
            call problems%add(key, 'the times of the table do not increase: t = ' // to_text(t(i)) // ' in row ' // to_text(i), &
                              'sort the rows by t, each time once, or twice where the torque jumps')
            return
        end do
        i = 1
        do while (i <= size(t))
            last = last_of_piece(t, i)
            if (last - i + 1 < fewest) then
                call problems%add(key, 'the piece of the table from t = ' // to_text(t(i)) // ' to ' // to_text(t(last)) // &
                                  ', up to a jump, has ' // to_text(last - i + 1) // ' rows, too few for this interpolation', &
                                  'it needs ' // to_text(fewest) // ' at least')
                return
            end if
            i = last + 1
        end do
        if (t(1) > 0) call problems%add(key, 'the table begins at t = ' // to_text(t(1)) // ', after the start', &
                                        'its first row is at t = 0 or before')
    end subroutine check_rows

end module spintop_torques_of_scene
