!> The axes of a sweep from a CSV table: parameters as columns, a case in each row.
!>
!>     # drawn elsewhere
!>     initial.spin_ratio, "top.inertia(2)"
!>     0.5,                0.875
module spintop_axes_of_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_axes_of_scene, only: count_axes, find_swept
    use spintop_checksum, only: checksum_t, checksum_text, add_to_checksum
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t, unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t
    use spintop_sweep_axes, only: axes_t, combination_names, combine_grid, combine_zip
    use spintop_table_walk, only: table_cursor_t, table_walk_t
    implicit none
    private
    public :: read_axes

contains

    !> Reads the table of a scene. What is wrong in it goes to the diagnostics, what is wrong with the
    !> scene to the problems; the axes then have no cases. A checksum that the scene has not is put in.
    subroutine read_axes(input, scene, table, axes, problems, diagnostics)
        character(*), intent(in) :: input !! path of the input: the table's is relative to it
        type(scene_t), intent(inout) :: scene
        type(parameter_table_t), intent(in) :: table
        type(axes_t), intent(out) :: axes
        type(problems_t), intent(inout) :: problems
        type(diagnostics_t), intent(inout) :: diagnostics
        type(table_walk_t) :: walk
        type(number_slot_t), allocatable :: slots(:)
        type(error_t), allocatable :: error
        type(checksum_t) :: sum
        logical :: has_lines, refused

        call check_scene(scene, problems)
        call walk%open(input, scene%sweep_table, diagnostics, has_lines, error)
        if (allocated(error)) then
            call problems%add('sweep.table', error%message, 'its path is relative to the folder of the input')
            return
        end if
        call add_to_checksum(sum, walk%text)
        if (scene%sweep_table_checksum == '') then
            scene%sweep_table_checksum = checksum_text(sum)
        else if (scene%sweep_table_checksum /= checksum_text(sum)) then
            call problems%add('sweep.table_checksum', 'the table is another one: its checksum is ' &
                              // checksum_text(sum), 'leave the checksum out to have any table')
        end if
        if (.not. has_lines) return
        call read_head(walk, table, axes, slots, diagnostics, refused)
        call read_rows(walk, slots, axes, diagnostics, refused)
        if (refused .or. problems%any()) return
        call axes%combine(combine_zip, int(axes%axis(1)%count, int64), int(scene%seed, int64))
    end subroutine read_axes

    !> Nothing else may say what the cases are.
    subroutine check_scene(scene, problems)
        type(scene_t), intent(in) :: scene
        type(problems_t), intent(inout) :: problems
        if (count_axes(scene) > 0) then
            call problems%add('sweep.table', 'the cases are given twice', 'give either axes or a table')
        else if (scene%combine /= combination_names(combine_grid)) then
            call problems%add('sweep.combine', 'a table has its cases in its rows', 'leave it out')
        else if (scene%cases /= unset_integer) then
            call problems%add('sweep.cases', 'a table has its cases in its rows', 'leave it out')
        end if
    end subroutine check_scene

    !> Reads the line of names: an axis and a slot for each.
    subroutine read_head(walk, table, axes, slots, diagnostics, refused)
        type(table_walk_t), intent(inout) :: walk
        type(parameter_table_t), intent(in) :: table
        type(axes_t), intent(inout) :: axes
        type(number_slot_t), allocatable, intent(out) :: slots(:)
        type(diagnostics_t), intent(inout) :: diagnostics
        logical, intent(out) :: refused
        type(table_cursor_t) :: head
        character(:), allocatable :: problem, hint
        integer :: i, k, columns

        head = walk%at
        columns = 0
        do while (walk%has_cell())
            call walk%next_cell()
            columns = columns + 1
        end do
        walk%at = head
        allocate (axes%axis(columns), slots(columns))
        refused = .false.
        do i = 1, columns
            call walk%next_cell()
            axes%axis(i)%name = walk%cell()
            call find_swept(axes%axis(i)%name, table, slots(i), problem, hint)
            axes%axis(i)%whole = slots(i)%is_whole()
            if (any([(slots(k)%is_same(slots(i)), k=1, i - 1)])) then
                problem = axes%axis(i)%name // ' has two columns'
                hint = 'give it one'
            end if
            if (problem == '') cycle
            if (axes%axis(i)%name == '') problem = 'a column has no name'
            call walk%refuse(diagnostics, problem, hint)
            refused = .true.
        end do
    end subroutine read_head

    !> Reads the rows into the axes. Values of columns that were refused are not judged.
    subroutine read_rows(walk, slots, axes, diagnostics, refused)
        type(table_walk_t), intent(inout) :: walk
        type(number_slot_t), intent(in) :: slots(:)
        type(axes_t), intent(inout) :: axes
        type(diagnostics_t), intent(inout) :: diagnostics
        logical, intent(inout) :: refused
        character(*), parameter :: one_a_column = 'a row has a cell for each column'
        type(table_cursor_t) :: head
        character(:), allocatable :: problem, hint
        real(dp) :: value
        integer :: rows, row, i

        head = walk%at
        rows = 0
        do while (walk%next_line())
            rows = rows + 1
        end do
        if (rows == 0) then
            walk%at = head
            call walk%refuse(diagnostics, 'the table has no rows', 'each is a case')
            refused = .true.
            return
        end if
        do i = 1, size(slots)
            allocate (axes%axis(i)%listed(rows))
            axes%axis(i)%count = rows
        end do
        walk%at = head
        do row = 1, rows
            if (.not. walk%next_line()) exit
            do i = 1, size(slots)
                if (.not. walk%has_cell()) then
                    call fail('the row ends before ' // axes%axis(i)%name, one_a_column)
                    exit
                end if
                call walk%next_cell()
                call walk%read_number(axes%axis(i)%name, value, problem, hint)
                ! A column that was refused has no rule.
                if (problem == '' .and. allocated(slots(i)%rule)) then
                    problem = slots(i)%refusal(value)
                    if (problem /= '') problem = axes%axis(i)%name // ' ' // problem
                end if
                if (problem /= '') call fail(problem, hint)
                axes%axis(i)%listed(row) = value
            end do
            if (i > size(slots) .and. walk%has_cell()) then
                call walk%next_cell()
                call fail('the row has more cells than the table has columns', one_a_column)
            end if
        end do

    contains

        subroutine fail(message, hint)
            character(*), intent(in) :: message, hint
            call walk%refuse(diagnostics, message, hint)
            refused = .true.
        end subroutine fail

    end subroutine read_rows

end module spintop_axes_of_table
