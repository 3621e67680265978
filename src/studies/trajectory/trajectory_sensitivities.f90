!> The sensitivities of a trajectory: the motion is computed at all nodes of a key, and the rows of these motions, which
!> belong together by their numbers, give the derivatives.
module spintop_trajectory_sensitivities
    use spintop_case, only: case_t
    use spintop_differences, only: node_count, nodes_t
    use spintop_errors, only: error_t
    use spintop_exit_codes, only: exit_internal
    use spintop_event_recorder, only: event_recorder_t
    use spintop_integration, only: outcome_t
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, no_number
    use spintop_motion_rows, only: compute_motion, writer_t
    use spintop_plain_text, only: escaped
    use spintop_sensitivity, only: other_accuracies, sensitive_key_t
    use spintop_plan, only: plan_t, sample_time
    use spintop_scene_keys, only: scene_t
    use spintop_trajectory_columns, only: trajectory_column_t
    implicit none
    private
    public :: find_sensitivities

contains

    !> The derivatives and their errors in each row.
    subroutine find_sensitivities(job, columns, base, cells, error)
        type(job_t), target, intent(in) :: job !! the job
        type(trajectory_column_t), intent(in) :: columns(:) !! the columns of which there are derivatives
        real(dp), intent(in) :: base(:, :) !! their values in each row of the motion itself
        real(dp), intent(out) :: cells(:, :) !! two for each derivative in each row; NaN where it does not exist
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        real(dp), allocatable :: values(:, :, :), others(:, :, :, :)
        type(nodes_t) :: nodes
        integer, allocatable :: place(:), best(:, :)
        logical :: is_needed(node_count)
        integer :: key, i, k, row, status

        cells = no_number
        allocate (best(job%sensitivities%count, size(base, 2)))
        allocate (values(size(base, 1), size(base, 2), node_count), stat=status)
        if (status == 0) allocate (others(size(base, 1), size(base, 2), node_count, other_accuracies), stat=status)
        if (status /= 0) then
            error = error_t(exit_internal, escaped(job%input%path) // ': not enough memory for the derivatives in all rows; &
                            &use fewer span.samples')
            return
        end if
        associate (wanted => job%sensitivities)
            allocate (place(size(wanted%list)))
            place = wanted%list%column
            do key = 1, size(wanted%keys)
                nodes = wanted%keys(key)%nodes(wanted%keys(key)%slot%get())
                values = no_number
                values(:, :, 1) = base
                do i = 2, node_count
                    if (nodes%is_valid(i)) call compute_node(job, columns, wanted%keys(key), nodes%x(i), values(:, :, i))
                end do
                is_needed = .false.
                do i = 1, wanted%count
                    if (wanted%list(i)%key /= key) cycle
                    do row = 1, size(base, 2)
                        call nodes%differentiate(values(place(i), row, :), cells(2 * i - 1, row), cells(2 * i, row), best(i, row))
                        if (best(i, row) > 0) is_needed(nodes%ends(best(i, row))) = .true.
                    end do
                end do
                ! The error of the method shows at other accuracies.
                others = no_number
                do k = 1, other_accuracies
                    do i = 1, node_count
                        if (is_needed(i)) call compute_node(job, columns, wanted%keys(key), nodes%x(i), others(:, :, i, k), k)
                    end do
                end do
                do i = 1, wanted%count
                    if (wanted%list(i)%key /= key) cycle
                    do row = 1, size(base, 2)
                        call nodes%add_change(best(i, row), values(place(i), row, :), others(place(i), row, :, :), &
                                              cells(2 * i - 1, row), cells(2 * i, row))
                    end do
                end do
            end do
        end associate
    end subroutine find_sensitivities

    !> The rows of the motion with another value of a key. Rows that it does not have stay as they are.
    subroutine compute_node(job, columns, key, value, rows, accuracy)
        type(job_t), target, intent(in) :: job
        type(trajectory_column_t), intent(in) :: columns(:)
        type(sensitive_key_t), intent(in) :: key
        real(dp), intent(in) :: value
        real(dp), intent(inout) :: rows(:, :)
        integer, intent(in), optional :: accuracy !! the number of another accuracy
        type(scene_t), allocatable, target :: scene
        type(event_recorder_t), allocatable :: recorder
        type(writer_t), allocatable :: writer
        type(outcome_t) :: outcome
        type(case_t) :: case
        type(plan_t) :: plan
        real(dp), allocatable :: times(:)
        logical :: exists
        integer :: i, stride

        call key%plan_at(job%input%scene, value, scene, case, plan, exists, job%plan, accuracy)
        if (.not. exists) return
        ! Where each step is a row, smaller steps are more rows.
        stride = max(1, (plan%samples - 1) / (job%plan%samples - 1))
        if (plan%samples - 1 /= stride * (job%plan%samples - 1) .or. stride > 1 .and. .not. present(accuracy)) return
        if (scene%stop_at /= '') then
            allocate (recorder)
            call recorder%set(job%events, job%stop_after, case)
        end if
        allocate (writer)
        call writer%set_columns(columns, case, scene)
        allocate (writer%kept(size(columns), plan%samples), source=no_number)
        times = [(sample_time(case%t_end, plan%samples, i), i=1, merge(0, plan%samples, plan%exact))]
        call compute_motion(scene, case, plan, times, writer, outcome, recorder)
        do i = 1, size(rows, 2)
            if (1 + stride * (i - 1) <= writer%rows) rows(:, i) = writer%kept(:, 1 + stride * (i - 1))
        end do
        ! The last row is that of the event which ends the motion.
        if (stride > 1 .and. allocated(recorder) .and. writer%rows > 0) rows(:, size(rows, 2)) = writer%kept(:, writer%rows)
        call writer%columns%close()
    end subroutine compute_node

end module spintop_trajectory_sensitivities
