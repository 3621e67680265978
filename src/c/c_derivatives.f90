!> The derivatives of the columns of a motion at any times: the motion is asked with other values of a key, which are
!> prepared in advance, so that threads may share them.
module spintop_c_derivatives
    use spintop_c_motion, only: asked_motion_t
    use spintop_case, only: case_t
    use spintop_differences, only: node_count, nodes_t
    use spintop_errors, only: error_t, input_error
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, no_number
    use spintop_plain_text, only: escaped
    use spintop_sensitivity, only: other_accuracies, sensitive_key_t
    use spintop_plan, only: plan_t
    use spintop_scene_keys, only: scene_t
    use spintop_trajectory_columns, only: trajectory_column_t, trajectory_columns_at
    implicit none
    private
    public :: asked_derivatives_t

    !> The motions with other values of a key, and the same with other accuracies. A class is copied and freed by a procedure of
    !> its own; for a type gfortran writes out all that is in it at each place.
    type :: varied_key_t
        type(nodes_t) :: nodes
        class(asked_motion_t), allocatable :: motion(:), other(:, :)
        logical :: has_other(node_count, other_accuracies) = .false.
    end type varied_key_t

    !> The derivatives, two columns for each: `count` of them, of some columns with respect to some keys.
    type :: asked_derivatives_t
        integer :: count = 0
        integer, allocatable, private :: column(:), key(:)
        type(varied_key_t), allocatable, private :: keys(:)
    contains
        procedure :: prepare
        procedure :: find
    end type asked_derivatives_t

contains

    !> Prepares the derivatives of a job.
    subroutine prepare(self, job, error)
        class(asked_derivatives_t), target, intent(inout) :: self
        type(job_t), target, intent(in) :: job !! the job
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer :: i

        associate (wanted => job%sensitivities)
            self%count = wanted%count
            if (self%count == 0) return
            self%key = wanted%list%key
            self%column = wanted%list%column
            allocate (self%keys(size(wanted%keys)))
            do i = 1, size(wanted%keys)
                call prepare_key(self%keys(i), job, wanted%keys(i), trajectory_columns_at(wanted%columns()), error)
                if (allocated(error)) return
            end do
        end associate
    end subroutine prepare

    !> Prepares the motions with other values of a key. The values that no motion has are left out; there must be others.
    subroutine prepare_key(self, job, key, columns, error)
        type(varied_key_t), target, intent(inout) :: self
        type(job_t), target, intent(in) :: job
        type(sensitive_key_t), intent(in) :: key
        type(trajectory_column_t), intent(in) :: columns(:)
        type(error_t), allocatable, intent(out) :: error
        logical :: exists(node_count)
        integer :: i, k

        if (key%name(:index(key%name, '.')) == 'span.') then
            error = input_error(escaped(job%input%path) // ': output.columns: the times of a top are given, so nothing depends &
                                &on ' // key%name // '; the derivatives with respect to time are columns, as theta_rate')
            return
        end if
        self%nodes = key%nodes(key%slot%get())
        exists = self%nodes%is_valid
        allocate (self%motion(node_count))
        do i = 2, node_count
            if (exists(i)) call prepare_motion(self%motion(i), job, key, self%nodes%x(i), columns, exists(i))
        end do
        call self%nodes%limit_to(exists)
        allocate (self%other(node_count, other_accuracies))
        do i = 1, node_count
            if (.not. self%nodes%is_valid(i)) cycle
            do k = 1, other_accuracies
                call prepare_motion(self%other(i, k), job, key, self%nodes%x(i), columns, self%has_other(i, k), accuracy=k)
            end do
        end do
        if (any(self%nodes%is_valid(2:))) return
        error = input_error(escaped(job%input%path) // ': output.columns: with another ' // key%name // ' there is no motion by &
                            &this method, and so no derivative; integrate by a method and formulation for any body')
    end subroutine prepare_key

    !> Prepares the motion with another value of a key, if there is one.
    subroutine prepare_motion(motion, job, key, value, columns, exists, accuracy)
        type(asked_motion_t), intent(inout) :: motion
        type(job_t), target, intent(in) :: job
        type(sensitive_key_t), intent(in) :: key
        real(dp), intent(in) :: value
        type(trajectory_column_t), intent(in) :: columns(:)
        logical, intent(out) :: exists
        integer, intent(in), optional :: accuracy !! the number of another accuracy
        type(scene_t), allocatable, target :: scene
        type(case_t) :: case
        type(plan_t) :: plan

        call key%plan_at(job%input%scene, value, scene, case, plan, exists, job%plan, accuracy)
        if (.not. exists) return
        case%t_end = job%case%t_end ! steps of fixed size stay where they are
        call motion%prepare(case, plan, columns)
    end subroutine prepare_motion

    !> Finds the derivatives at some times, each followed by the estimate of its error.
    subroutine find(self, t, base, cells, lacks_memory)
        class(asked_derivatives_t), intent(in) :: self
        real(dp), intent(in) :: t(:) !! the times, s
        real(dp), intent(in) :: base(:, :) !! the columns of which there are derivatives: a row for each time
        real(dp), intent(out) :: cells(:, :) !! two for each derivative; NaN where there is none
        logical, intent(out) :: lacks_memory !! whether the memory is too small for so many times
        real(dp), allocatable :: values(:, :, :), others(:, :, :, :)
        integer, allocatable :: best(:, :)
        real(dp) :: t_reached
        logical :: is_needed(node_count)
        integer :: key, i, k, row, status

        cells = no_number
        lacks_memory = .true.
        allocate (values(size(base, 1), size(base, 2), node_count), stat=status)
        if (status /= 0) return
        allocate (others(size(base, 1), size(base, 2), node_count, other_accuracies), stat=status)
        if (status /= 0) return
        allocate (best(size(t), self%count), stat=status)
        if (status /= 0) return
        lacks_memory = .false.
        do key = 1, size(self%keys)
            values = no_number
            values(:, :, 1) = base
            do i = 2, node_count
                if (self%keys(key)%nodes%is_valid(i)) then
                    call self%keys(key)%motion(i)%find(t, values(:, :, i), status, t_reached)
                end if
            end do
            associate (nodes => self%keys(key)%nodes)
                is_needed = .false.
                do i = 1, self%count
                    if (self%key(i) /= key) cycle
                    do row = 1, size(t)
                        call nodes%differentiate(values(row, self%column(i), :), cells(row, 2 * i - 1), cells(row, 2 * i), &
                                                 best(row, i))
                        if (best(row, i) > 0) is_needed(nodes%ends(best(row, i))) = .true.
                    end do
                end do
                ! The error of the method shows at other accuracies.
                others = no_number
                do k = 1, other_accuracies
                    do i = 1, node_count
                        if (.not. (is_needed(i) .and. self%keys(key)%has_other(i, k))) cycle
                        call self%keys(key)%other(i, k)%find(t, others(:, :, i, k), status, t_reached)
                    end do
                end do
                do i = 1, self%count
                    if (self%key(i) /= key) cycle
                    do row = 1, size(t)
                        call nodes%add_change(best(row, i), values(row, self%column(i), :), others(row, self%column(i), :, :), &
                                              cells(row, 2 * i - 1), cells(row, 2 * i))
                    end do
                end do
            end associate
        end do
    end subroutine find

end module spintop_c_derivatives
