!> What a thread needs to compute the rows of a sweep: its cases, and their sensitivities. The nodes of a key are cases of a sweep
!> of their own, for each case; they are made and computed by a worker as all others are, and their quantities give the
!> derivatives.
module spintop_sweep_rows
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_clock, only: processor_seconds
    use spintop_differences, only: node_count, nodes_t
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, no_number
    use spintop_methods, only: exact_info
    use spintop_sensitivity, only: other_accuracies, other_value, set_other_accuracy
    use spintop_planning, only: make_plan
    use spintop_problems, only: problems_t
    use spintop_row_block, only: row_block_t
    use spintop_scene_words, only: combine_zip
    use spintop_status, only: is_good_end
    use spintop_sweep_result, only: note_no_derivative, note_t
    use spintop_sweep_worker, only: sweep_worker_t, size_of_block
    use spintop_thread_team, only: block_worker_t, work_of_computing
    implicit none
    private
    public :: sweep_rows_t, sweep_sensitivities_t

    !> The axis along which the tolerance of the method varies.
    character(*), parameter :: tolerance_key = 'integration.relative_tolerance'

    !> A sweep over nodes of a case: the axes of the sweep of the table, then the other keys. It must stay where it was prepared,
    !> and be a target there. A class is copied and freed by a procedure of its own; for a type gfortran writes out all that is
    !> in it at each place. But gfortran 14 has two jobs on the stack where one is allocated as a class.
    type :: node_sweep_t
        type(job_t), allocatable :: job
        class(sweep_worker_t), allocatable :: worker
        type(row_block_t) :: rows
        integer :: cases_of_block = 1
        !> Quantities at the nodes of the keys.
        real(dp), allocatable :: values(:, :, :)
    contains
        procedure :: prepare => prepare_nodes
        procedure :: compute => compute_nodes
    end type node_sweep_t

    !> Data of a thread; it must stay where it was prepared, and be a target there.
    type :: sweep_sensitivities_t
        !> The sweep over the nodes, and the same with other accuracies, in which the error of the method shows.
        class(node_sweep_t), allocatable, private :: own, other(:)
        !> The axis of each key in these sweeps.
        integer, allocatable, private :: axis(:)
        !> Cells of a row of the table before the derivatives.
        integer, private :: cells_before = 0
        !> The difference on which each derivative rests.
        integer, allocatable, private :: best(:)
        !> The nodes of the keys, and which of them are needed.
        type(nodes_t), allocatable, private :: nodes(:)
        logical, allocatable, private :: is_needed(:, :)
    contains
        procedure :: prepare => prepare_sensitivities
        procedure :: fill
    end type sweep_sensitivities_t

    !> Data of a thread; it must stay where it was prepared, and be a target there.
    type, extends(block_worker_t) :: sweep_rows_t
        type(job_t), pointer, private :: job => null()
        type(sweep_worker_t), private :: worker
        type(sweep_sensitivities_t), private :: sensitivities
    contains
        procedure :: prepare
        procedure :: compute_rows
    end type sweep_rows_t

contains

    !> Makes what the thread needs. It makes many texts, which only one thread at a time may do: see `status_names`.
    subroutine prepare(self, job)
        class(sweep_rows_t), target, intent(inout) :: self
        type(job_t), target, intent(in) :: job !! the job
        self%job => job
        call self%worker%prepare(job)
        call self%sensitivities%prepare(job)
    end subroutine prepare

    !> Computes the rows of some cases, block by block.
    subroutine compute_rows(self, first, last, rows)
        class(sweep_rows_t), target, intent(inout) :: self
        integer(int64), intent(in) :: first, last !! first and last case, at most those of a block
        type(row_block_t), intent(inout) :: rows !! their rows
        real(dp) :: began
        call self%worker%compute_rows(self%job, first, last, rows)
        began = processor_seconds()
        call self%sensitivities%fill(self%job, rows)
        self%costs = self%costs + self%worker%costs
        self%costs(work_of_computing) = self%costs(work_of_computing) + (processor_seconds() - began)
    end subroutine compute_rows

    !> Prepares the sensitivities of a job; there may be none.
    subroutine prepare_sensitivities(self, job)
        class(sweep_sensitivities_t), target, intent(inout) :: self
        type(job_t), target, intent(in) :: job !! the job
        integer :: i, n

        if (job%sensitivities%count == 0) return
        n = size(job%axes%axis)
        self%cells_before = n + 2 + size(job%columns)
        associate (wanted => job%sensitivities)
            self%axis = wanted%keys%axis
            do i = 1, size(self%axis)
                if (self%axis(i) > 0) cycle
                n = n + 1
                self%axis(i) = n
            end do
            allocate (self%best(wanted%count))
            allocate (self%nodes(size(self%axis)), self%is_needed(node_count, size(self%axis)))
        end associate
        allocate (self%own)
        call self%own%prepare(job, self%axis, n)
        if (job%input%scene%method == exact_info%name) return
        allocate (self%other(other_accuracies))
        do i = 1, other_accuracies
            call self%other(i)%prepare(job, self%axis, n, accuracy=i)
        end do
    end subroutine prepare_sensitivities

    !> Makes the sweep over the nodes.
    subroutine prepare_nodes(self, job, axis, axes, accuracy)
        class(node_sweep_t), target, intent(inout) :: self
        type(job_t), target, intent(in) :: job !! the job
        integer, intent(in) :: axis(:), axes !! the axis of each key, and the number of axes
        integer, intent(in), optional :: accuracy !! the number of another accuracy than that of the job
        type(problems_t) :: problems
        integer :: i

        allocate (self%job, self%worker)
        associate (own => self%job, wanted => job%sensitivities)
            own%input%scene = job%input%scene
            own%input%scene%certified = .false.
            own%case = job%case
            own%plan = job%plan
            if (present(accuracy)) then
                call set_other_accuracy(own%input%scene, job%plan, accuracy, keeps_rows=.false.)
                call make_plan(own%input%scene, own%case, own%plan, problems)
            end if
            own%events = job%events
            own%stop_after = job%stop_after
            own%columns = wanted%columns()
            allocate (own%axes%axis(axes))
            do i = 1, size(job%axes%axis)
                own%axes%axis(i)%name = job%axes%axis(i)%name
                own%axes%axis(i)%whole = job%axes%axis(i)%whole
                own%axes%axis(i)%slot = job%axes%axis(i)%slot
            end do
            do i = 1, size(axis)
                own%axes%axis(axis(i))%name = wanted%keys(i)%name
                own%axes%axis(axis(i))%slot = wanted%keys(i)%slot
            end do
            own%axes%combination = combine_zip
            own%axes%cases = size(axis) * node_count
            do i = 1, axes
                own%axes%axis(i)%count = int(own%axes%cases)
                allocate (own%axes%axis(i)%listed(own%axes%axis(i)%count), source=0.0_dp)
            end do
            allocate (self%values(size(own%columns), node_count, size(axis)))
        end associate
        call self%worker%prepare(self%job)
        self%cases_of_block = size_of_block(self%job)
    end subroutine prepare_nodes

    !> Fills the cells of the sensitivities in the rows of some cases. What has no derivative is NaN, with a note.
    subroutine fill(self, job, rows)
        class(sweep_sensitivities_t), target, intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        type(row_block_t), intent(inout) :: rows !! the rows, otherwise complete
        integer :: k

        if (job%sensitivities%count == 0) return
        do k = 1, rows%rows
            associate (cells => rows%cells(self%cells_before + 1:self%cells_before + 2 * job%sensitivities%count, k), &
                       parameters => rows%cells(2:size(job%axes%axis) + 1, k))
                cells = no_number
                if (.not. is_good_end(nint(rows%cells(size(job%axes%axis) + 2, k)))) cycle
                call find_derivatives(self, job, parameters, cells)
                if (.not. all(abs(cells(1::2)) <= huge(1.0_dp))) call note_missing(rows, k)
            end associate
        end do
    end subroutine fill

    !> Finds the derivatives of a case, each followed by the estimate of its error.
    subroutine find_derivatives(self, job, parameters, cells)
        class(sweep_sensitivities_t), target, intent(inout) :: self
        type(job_t), intent(in) :: job
        real(dp), intent(in) :: parameters(:) !! the values of the axes of the sweep in that case
        real(dp), intent(inout) :: cells(:)
        real(dp), allocatable :: others(:, :, :)
        integer :: i, k

        associate (wanted => job%sensitivities, keys => job%sensitivities%keys)
            do i = 1, size(keys)
                if (keys(i)%axis == 0) then
                    self%nodes(i) = keys(i)%nodes(keys(i)%slot%get())
                else
                    self%nodes(i) = keys(i)%nodes(parameters(keys(i)%axis))
                end if
                self%is_needed(:, i) = self%nodes(i)%is_valid
            end do
            call self%own%compute(self%nodes, self%is_needed, self%axis, parameters)
            self%is_needed = .false.
            do i = 1, size(keys)
                call wanted%differentiate(i, self%nodes(i), self%own%values(:, :, i), cells, self%best, self%is_needed(:, i))
            end do
            if (.not. (allocated(self%other) .and. any(self%best > 0))) return
            do k = 1, other_accuracies
                call self%other(k)%compute(self%nodes, self%is_needed, self%axis, in_other_accuracy(job, parameters, k))
            end do
            allocate (others(size(self%own%values, 1), node_count, other_accuracies))
            do i = 1, size(keys)
                do k = 1, other_accuracies
                    others(:, :, k) = self%other(k)%values(:, :, i)
                end do
                call wanted%add_changes(i, self%nodes(i), self%own%values(:, :, i), others, self%best, cells)
            end do
        end associate
    end subroutine find_derivatives

    !> The values of the axes with another accuracy.
    pure function in_other_accuracy(job, parameters, number) result(others)
        type(job_t), intent(in) :: job
        real(dp), intent(in) :: parameters(:) !! the values of the axes
        integer, intent(in) :: number !! of the accuracy
        real(dp) :: others(size(parameters)), relative
        integer :: i
        relative = 1
        if (allocated(job%plan%stepper)) relative = job%plan%stepper%controls%relative_tolerance
        do i = 1, size(others)
            if (job%axes%axis(i)%name == tolerance_key) relative = parameters(i)
        end do
        do i = 1, size(others)
            others(i) = other_value(job%axes%axis(i)%name, parameters(i), relative, number)
        end do
    end function in_other_accuracy

    !> Computes the quantities of a case at the nodes that are needed. They are NaN at the others.
    subroutine compute_nodes(self, nodes, is_needed, axis, parameters)
        class(node_sweep_t), target, intent(inout) :: self
        type(nodes_t), intent(in) :: nodes(:) !! of each key
        logical, intent(in) :: is_needed(:, :) !! which of them
        integer, intent(in) :: axis(:) !! the axis of each key
        real(dp), intent(in) :: parameters(:) !! the values of the axes of the sweep in that case
        integer :: place(2, size(is_needed)), i, n, first, last, row, cells_before

        self%values = no_number
        n = 0
        associate (axes => self%job%axes)
            do i = 1, size(axis)
                do row = 1, node_count
                    if (.not. is_needed(row, i)) cycle
                    n = n + 1
                    place(:, n) = [row, i]
                end do
            end do
            do i = 1, size(parameters)
                axes%axis(i)%listed(:n) = parameters(i)
            end do
            ! Every key has its value in the nodes of the others.
            do i = 1, size(axis)
                axes%axis(axis(i))%listed(:n) = nodes(i)%x(1)
            end do
            do i = 1, n
                axes%axis(axis(place(2, i)))%listed(i) = nodes(place(2, i))%x(place(1, i))
            end do
            cells_before = size(axes%axis) + 2
        end associate
        do first = 1, n, self%cases_of_block
            last = min(first + self%cases_of_block - 1, n)
            call self%worker%compute_rows(self%job, int(first, int64), int(last, int64), self%rows)
            do row = 1, self%rows%rows
                if (.not. is_good_end(nint(self%rows%cells(cells_before, row)))) cycle
                associate (to => place(:, first + row - 1))
                    self%values(:, to(1), to(2)) = self%rows%cells(cells_before + 1:cells_before + size(self%values, 1), row)
                end associate
            end do
        end do
    end subroutine compute_nodes

    !> Notes that a case lacks a derivative.
    subroutine note_missing(rows, k)
        type(row_block_t), intent(inout) :: rows
        integer, intent(in) :: k
        type(note_t) :: note

        associate (flags => rows%cells(size(rows%cells, 1), k))
            note%flags = nint(flags)
            if (note%has(note_no_derivative)) return
            if (allocated(rows%notes(k)%text)) note%text = rows%notes(k)%text
            call note%add(note_no_derivative)
            flags = note%flags
        end associate
        rows%notes(k)%text = note%text
    end subroutine note_missing

end module spintop_sweep_rows
