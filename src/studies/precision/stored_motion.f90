!> A reference motion from a CSV table, such as a trajectory that was computed before or by another program:
!> the columns t, q0 to q3 and omega1 to omega3, at equally spaced times from 0 to the end of the span.
module spintop_stored_motion
    use spintop_case, only: case_t
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_kinds, only: dp, no_number
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_plan, only: sample_time
    use spintop_problems, only: problems_t
    use spintop_reference_motion, only: reference_t
    use spintop_table_walk, only: table_cursor_t, table_walk_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: read_motion

    character(*), parameter :: columns(*) = [character(6) :: &
        't', 'q0', 'q1', 'q2', 'q3', 'omega1', 'omega2', 'omega3']
    !> Tolerance of times relative to the span, and of norms of quaternions.
    real(dp), parameter :: time_slack = 1.0e-12_dp, unit_slack = 1.0e-9_dp

contains

    !> Reads the reference motion of a case. Errors in the table are added to the diagnostics, errors of its
    !> name to the problems.
    subroutine read_motion(input, key, path, case, reference, problems, diagnostics)
        character(*), intent(in) :: input !! path of the input: the table's is relative to it
        character(*), intent(in) :: key !! parameter that holds the path
        character(*), intent(in) :: path !! path of the table, relative to the folder of `input`
        type(case_t), intent(in) :: case !! the case: the motion must have its start, its span and its axes
        type(reference_t), intent(out) :: reference !! the stored motion
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(table_walk_t) :: walk
        type(error_t), allocatable :: error
        real(dp), allocatable :: cells(:, :)
        logical :: has_lines

        call walk%open(input, path, diagnostics, has_lines, error)
        if (allocated(error)) then
            call problems%add(key, error%message, 'its path is relative to the folder of the input')
            return
        end if
        if (.not. has_lines) return
        call read_cells(walk, cells, diagnostics)
        if (.not. allocated(cells)) return
        call check_motion(cells, key, case, problems)
        if (problems%any()) return
        reference%source = path(index(path, '/', back=.true.) + 1:)
        call read_motions(cells, case, reference)
    end subroutine read_motion

    !> Reads the required columns: column i of `cells` is a row of the table. Not allocated if there is an
    !> error.
    subroutine read_cells(walk, cells, diagnostics)
        type(table_walk_t), intent(inout) :: walk
        real(dp), allocatable, intent(out) :: cells(:, :)
        type(diagnostics_t), intent(inout) :: diagnostics
        type(table_cursor_t) :: head
        character(:), allocatable :: problem, hint
        integer :: place(size(columns)), i, k, row, rows

        place = 0
        k = 0
        do while (walk%has_cell())
            call walk%next_cell()
            k = k + 1
            where (columns == walk%cell()) place = k
        end do
        if (any(place == 0)) then
            call walk%refuse(diagnostics, 'the table has no column ' // trim(columns(findloc(place, 0, dim=1))), &
                             'a reference motion has t, q0 to q3 and omega1 to omega3')
            return
        end if
        head = walk%at
        rows = 0
        do while (walk%next_line())
            rows = rows + 1
        end do
        walk%at = head
        allocate (cells(size(columns), rows))
        do row = 1, rows
            if (.not. walk%next_line()) exit
            problem = ''
            do k = 1, maxval(place)
                i = findloc(place, k, dim=1)
                if (.not. walk%has_cell()) then
                    problem = 'the row ends after ' // to_text(k - 1) // ' cells'
                    hint = 'a row has a cell for each column'
                else
                    call walk%next_cell()
                    if (i > 0) call walk%read_number(trim(columns(i)), cells(i, row), problem, hint)
                end if
                if (problem == '') cycle
                call walk%refuse(diagnostics, problem, hint)
                deallocate (cells)
                return
            end do
        end do
    end subroutine read_cells

    !> Checks that the motion belongs to the case.
    subroutine check_motion(cells, key, case, problems)
        real(dp), intent(in) :: cells(:, :)
        character(*), intent(in) :: key
        type(case_t), intent(in) :: case
        type(problems_t), intent(inout) :: problems
        real(dp) :: start(4)
        integer :: i, rows

        rows = size(cells, 2)
        if (rows < 2) then
            call problems%add(key, 'the table has ' // to_text(rows) // ' rows', 'it needs at least the start and the end')
            return
        end if
        do i = 1, rows
            if (abs(cells(1, i) - sample_time(case%t_end, rows, i)) > time_slack * case%t_end) then
                call problems%add(key, 'row ' // to_text(i) // ' of the table is for t = ' // to_text(cells(1, i)) &
                                  // ', not ' // to_text(sample_time(case%t_end, rows, i)), &
                                  'its rows are equally spaced from 0 to the end of the span')
                return
            end if
        end do
        start = cells(2:5, 1) * sign(1.0_dp, dot_product(cells(2:5, 1), case%given_start%quaternion))
        if (any(abs(norm2(cells(2:5, :), dim=1) - 1) > unit_slack)) then
            call problems%add(key, 'the table has quaternions whose norm is not 1', 'an attitude is a unit quaternion')
        else if (norm2(start - case%given_start%quaternion) > unit_slack .or. &
                 norm2(cells(6:8, 1) - case%given_start%omega) > unit_slack * (1 + norm2(case%given_start%omega))) then
            call problems%add(key, 'the motion in the table has another start', 'use a table of this case')
        end if
    end subroutine check_motion

    !> The motions of the rows, in the axes of the computation. Their accuracy is unknown.
    subroutine read_motions(cells, case, reference)
        real(dp), intent(in) :: cells(:, :)
        type(case_t), intent(in) :: case
        type(reference_t), intent(inout) :: reference
        type(motion_t) :: motion
        integer :: i

        allocate (reference%motions(size(cells, 2)), reference%floor(size(cells, 2)))
        reference%floor = no_number
        reference%uncertainty = no_number
        motion = case%given_start
        do i = 1, size(cells, 2)
            motion = motion_from_quaternion(cells(1, i), cells(2:5, i) / norm2(cells(2:5, i)), cells(6:8, i), motion%angle)
            reference%motions(i) = case%turn%turned_motion(motion)
        end do
    end subroutine read_motions

end module spintop_stored_motion
