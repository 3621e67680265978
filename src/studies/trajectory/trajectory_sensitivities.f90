!> The sensitivities of a trajectory: the motion is computed at all nodes of a key, and the rows of these motions, which
!> belong together by their numbers, give the derivatives.
module spintop_trajectory_sensitivities
    use spintop_case, only: case_t
    use spintop_differences, only: nodes_t
    use spintop_errors, only: error_t
    use spintop_exit_codes, only: exit_internal
    use spintop_event_recorder, only: event_recorder_t
    use spintop_integration, only: outcome_t
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, no_number
    use spintop_motion_rows, only: compute_motion, writer_t
    use spintop_plan, only: plan_t, sample_time
    use spintop_scene_keys, only: scene_t
    use spintop_sensitivity, only: varied_motions_t
    use spintop_text, only: escaped
    use spintop_trajectory_columns, only: trajectory_column_t
    implicit none
    private
    public :: find_sensitivities

    !> The motions of a job with other values of its keys.
    type, extends(varied_motions_t) :: trajectories_t
        type(job_t), pointer :: job => null()
        type(trajectory_column_t), allocatable :: columns(:)
    contains
        procedure :: find
    end type trajectories_t

contains

    !> The derivatives and their errors in each row.
    subroutine find_sensitivities(job, columns, base, cells, error)
        type(job_t), target, intent(in) :: job !! the job
        type(trajectory_column_t), intent(in) :: columns(:) !! the columns of which there are derivatives
        real(dp), intent(in) :: base(:, :) !! their values in each row of the motion itself
        real(dp), intent(out) :: cells(:, :) !! two for each derivative in each row; NaN where it does not exist
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(trajectories_t) :: motions
        integer :: i, status

        motions%job => job
        motions%columns = columns
        associate (wanted => job%sensitivities)
            call wanted%find_derivatives([(wanted%keys(i)%nodes(wanted%keys(i)%slot%get()), i=1, size(wanted%keys))], &
                                         motions, base, cells, status)
        end associate
        if (status /= 0) error = error_t(exit_internal, escaped(job%input%path) // ': not enough memory for the derivatives &
                                         &in all rows; use fewer span.samples')
    end subroutine find_sensitivities

    !> The rows of the motion with another value of a key. Rows that it does not have stay as they are.
    subroutine find(self, key, nodes, i, values, accuracy)
        class(trajectories_t), intent(in) :: self
        integer, intent(in) :: key, i !! index of the key, and that of the node
        type(nodes_t), intent(in) :: nodes !! the values of the key
        real(dp), intent(inout) :: values(:, :) !! the columns (rows) in each row of the table
        integer, intent(in), optional :: accuracy !! the number of another accuracy
        type(scene_t), allocatable, target :: scene
        type(event_recorder_t), allocatable :: recorder
        type(writer_t), allocatable :: writer
        type(outcome_t) :: outcome
        type(case_t) :: case
        type(plan_t) :: plan
        real(dp), allocatable :: times(:)
        logical :: exists
        integer :: row, stride

        associate (job => self%job)
            call job%sensitivities%keys(key)%plan_at(job%input%scene, nodes%x(i), scene, case, plan, exists, job%plan, accuracy)
            if (.not. exists) return
            ! Where each step is a row, smaller steps are more rows.
            stride = max(1, (plan%samples - 1) / (job%plan%samples - 1))
            if (plan%samples - 1 /= stride * (job%plan%samples - 1) .or. stride > 1 .and. .not. present(accuracy)) return
            if (scene%stop_at /= '') then
                allocate (recorder)
                call recorder%set(job%events, job%stop_after, case)
            end if
        end associate
        allocate (writer)
        call writer%set_columns(self%columns, case, scene)
        allocate (writer%kept(size(self%columns), plan%samples), source=no_number)
        times = [(sample_time(case%t_end, plan%samples, row), row=1, merge(0, plan%samples, plan%exact))]
        call compute_motion(case, plan, times, writer, outcome, recorder, scene)
        do row = 1, size(values, 2)
            if (1 + stride * (row - 1) <= writer%rows) values(:, row) = writer%kept(:, 1 + stride * (row - 1))
        end do
        ! The last row is that of the event which ends the motion.
        if (stride > 1 .and. allocated(recorder) .and. writer%rows > 0) values(:, size(values, 2)) = writer%kept(:, writer%rows)
        call writer%columns%close()
    end subroutine find

end module spintop_trajectory_sensitivities
