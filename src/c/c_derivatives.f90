!> The derivatives of the columns of a motion at any times: the motion is asked with other values of a key, which are
!> prepared in advance, so that threads may share them.
module spintop_c_derivatives
    use spintop_c_motion, only: asked_motion_t
    use spintop_case, only: case_t
    use spintop_differences, only: node_count, nodes_t
    use spintop_errors, only: error_t, input_error
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_plan, only: plan_t
    use spintop_scene_keys, only: scene_t
    use spintop_sensitivity, only: other_accuracies, sensitive_key_t, sensitivities_t, varied_motions_t
    use spintop_study_column, only: study_column_t
    use spintop_text, only: escaped
    implicit none
    private
    public :: asked_derivatives_t

    !> The motions with other values of a key, and the same with other accuracies. A class is copied and freed by a procedure of
    !> its own; for a type gfortran writes out all that is in it at each place.
    type :: varied_key_t
        class(asked_motion_t), allocatable :: motion(:), other(:, :)
        logical :: has_other(node_count, other_accuracies) = .false.
    end type varied_key_t

    !> The motions with other values of all keys, and the times for which they are asked, s.
    type, extends(varied_motions_t) :: asked_motions_t
        type(varied_key_t), pointer :: keys(:) => null()
        real(dp), allocatable :: t(:)
    contains
        procedure :: find => find_varied
    end type asked_motions_t

    !> The derivatives, two columns for each: `count` of them, of some columns with respect to some keys.
    type :: asked_derivatives_t
        integer :: count = 0
        type(sensitivities_t), private :: wanted
        type(nodes_t), allocatable, private :: nodes(:)
        type(varied_key_t), allocatable, private :: keys(:)
    contains
        procedure :: prepare
        procedure :: find
    end type asked_derivatives_t

contains

    !> Prepares the derivatives of a job.
    subroutine prepare(self, job, error)
        class(asked_derivatives_t), intent(inout) :: self
        type(job_t), target, intent(in) :: job !! the job
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer :: i

        self%count = job%sensitivities%count
        if (self%count == 0) return
        self%wanted = job%sensitivities
        associate (keys => job%sensitivities%keys)
            allocate (self%nodes(size(keys)), self%keys(size(keys)))
            do i = 1, size(keys)
                call prepare_key(self%keys(i), self%nodes(i), job, keys(i), &
                                 job%sensitivities%columns(), error)
                if (allocated(error)) return
            end do
        end associate
    end subroutine prepare

    !> Prepares the motions with other values of a key. The values that no motion has are left out; there must be others.
    subroutine prepare_key(self, nodes, job, key, columns, error)
        type(varied_key_t), intent(inout) :: self
        type(nodes_t), intent(out) :: nodes
        type(job_t), target, intent(in) :: job
        type(sensitive_key_t), intent(in) :: key
        type(study_column_t), intent(in) :: columns(:)
        type(error_t), allocatable, intent(out) :: error
        logical :: exists(node_count)
        integer :: i, k

        if (key%name(:index(key%name, '.')) == 'span.') then
            error = input_error(escaped(job%input%path) // ': output.columns: the times of a top are given, so nothing depends &
                                &on ' // key%name // '; the derivatives with respect to time are columns, as theta_rate')
            return
        end if
        nodes = key%nodes(key%slot%get())
        exists = nodes%is_valid
        allocate (self%motion(node_count))
        do i = 2, node_count
            if (exists(i)) call prepare_motion(self%motion(i), job, key, nodes%x(i), columns, exists(i))
        end do
        call nodes%limit_to(exists)
        allocate (self%other(node_count, other_accuracies))
        do i = 1, node_count
            if (.not. nodes%is_valid(i)) cycle
            do k = 1, other_accuracies
                call prepare_motion(self%other(i, k), job, key, nodes%x(i), columns, self%has_other(i, k), accuracy=k)
            end do
        end do
        if (any(nodes%is_valid(2:))) return
        error = input_error(escaped(job%input%path) // ': output.columns: with another ' // key%name // ' there is no motion by &
                            &this method, and so no derivative; integrate by a method and formulation for any body')
    end subroutine prepare_key

    !> Prepares the motion with another value of a key, if there is one.
    subroutine prepare_motion(motion, job, key, value, columns, exists, accuracy)
        type(asked_motion_t), intent(inout) :: motion
        type(job_t), target, intent(in) :: job
        type(sensitive_key_t), intent(in) :: key
        real(dp), intent(in) :: value
        type(study_column_t), intent(in) :: columns(:)
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
        class(asked_derivatives_t), target, intent(in) :: self
        real(dp), intent(in) :: t(:) !! the times, s
        real(dp), intent(in) :: base(:, :) !! the columns (rows) of which there are derivatives at each time
        real(dp), intent(out) :: cells(:, :) !! for each time, two for each derivative; NaN where there is none
        logical, intent(out) :: lacks_memory !! whether the memory is too small for so many times
        type(asked_motions_t) :: motions
        real(dp), allocatable :: found(:, :)
        integer :: status
        motions%keys => self%keys
        motions%t = t
        allocate (found(size(cells, 2), size(t)), stat=status)
        if (status == 0) call self%wanted%find_derivatives(self%nodes, motions, base, found, status)
        lacks_memory = status /= 0
        if (.not. lacks_memory) cells = transpose(found)
    end subroutine find

    !> The columns of a motion with another value of a key.
    subroutine find_varied(self, key, nodes, i, values, accuracy)
        class(asked_motions_t), intent(in) :: self
        integer, intent(in) :: key, i !! index of the key, and that of the node
        type(nodes_t), intent(in) :: nodes !! the values of the key
        real(dp), intent(inout) :: values(:, :) !! the columns (rows) at each time
        integer, intent(in), optional :: accuracy !! the number of another accuracy
        real(dp) :: t_reached
        integer :: status
        associate (varied => self%keys(key))
            if (.not. present(accuracy)) then
                call varied%motion(i)%find(self%t, values, status, t_reached)
            else if (varied%has_other(i, accuracy)) then
                call varied%other(i, accuracy)%find(self%t, values, status, t_reached)
            end if
        end associate
    end subroutine find_varied

end module spintop_c_derivatives
