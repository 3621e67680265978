!> The sensitivities of a sweep. The nodes of a key are cases of a sweep of their own, for each case; they are made and
!> computed by a worker as all others are, and their quantities give the derivatives.
module spintop_sweep_sensitivities
    use, intrinsic :: iso_c_binding, only: c_loc
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_differences, only: node_count, nodes_t
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, no_number
    use spintop_row_block, only: row_block_t
    use spintop_scene_words, only: combine_zip
    use spintop_status, only: is_good_end
    use spintop_sweep_notes, only: note_no_derivative, note_t
    use spintop_sweep_worker, only: size_of_block, sweep_worker_t
    implicit none
    private
    public :: sweep_sensitivities_t

    !> Data of a thread; it must stay where it was prepared, and be a target there.
    type :: sweep_sensitivities_t
        !> The sweep over the nodes of a case: the axes of the sweep, then the other keys.
        type(job_t), private :: job
        type(sweep_worker_t), private :: worker
        type(row_block_t), private :: rows
        !> The axis of each key.
        integer, allocatable, private :: axis(:)
        !> Cells of a row of the table before the derivatives, and of a row of the nodes before the quantities.
        integer, private :: cells_before = 0, node_cells_before = 0
        !> The cell of each derivative's quantity among the quantities of the nodes.
        integer, allocatable, private :: place(:)
        !> Quantities at the nodes of the keys, and the nodes.
        real(dp), allocatable, private :: values(:, :, :)
        type(nodes_t), allocatable, private :: nodes(:)
    contains
        procedure :: prepare
        procedure :: fill
    end type sweep_sensitivities_t

contains

    !> Takes the sensitivities of a job; there may be none.
    subroutine prepare(self, job)
        class(sweep_sensitivities_t), target, intent(inout) :: self
        type(job_t), target, intent(in) :: job !! the job
        integer :: i, n

        if (job%sensitivities%count == 0) return
        associate (wanted => job%sensitivities, own => self%job)
            own%scene = job%scene
            own%scene%certified = .false.
            own%case = job%case
            own%plan = job%plan
            own%events = job%events
            own%stop_after = job%stop_after
            own%columns = wanted%columns()
            self%place = [(findloc(own%columns, wanted%list(i)%column, dim=1), i=1, wanted%count)]
            n = size(job%axes%axis)
            self%axis = wanted%keys%axis
            do i = 1, size(self%axis)
                if (self%axis(i) > 0) cycle
                n = n + 1
                self%axis(i) = n
            end do
            allocate (own%axes%axis(n))
            do i = 1, size(job%axes%axis)
                own%axes%axis(i)%name = job%axes%axis(i)%name
                own%axes%axis(i)%whole = job%axes%axis(i)%whole
                own%axes%axis(i)%slot = job%axes%axis(i)%slot%in_copy(c_loc(job%scene), c_loc(own%scene), storage_size(own%scene))
            end do
            do i = 1, size(self%axis)
                associate (axis => own%axes%axis(self%axis(i)), key => wanted%keys(i))
                    axis%name = key%name
                    axis%slot = key%slot%in_copy(c_loc(job%scene), c_loc(own%scene), storage_size(own%scene))
                end associate
            end do
            own%axes%combination = combine_zip
            own%axes%cases = size(self%axis) * node_count
            do i = 1, n
                own%axes%axis(i)%count = int(own%axes%cases)
                allocate (own%axes%axis(i)%listed(own%axes%axis(i)%count), source=0.0_dp)
            end do
            self%cells_before = size(job%axes%axis) + 2 + size(job%columns)
            self%node_cells_before = n + 2
            allocate (self%nodes(size(self%axis)))
            allocate (self%values(size(own%columns), node_count, size(self%axis)))
        end associate
        call self%worker%prepare(self%job)
    end subroutine prepare

    !> Fills the cells of the sensitivities in the rows of some cases. What has no derivative is NaN, with a note.
    subroutine fill(self, job, rows)
        class(sweep_sensitivities_t), target, intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        type(row_block_t), intent(inout) :: rows !! the rows, otherwise complete
        integer :: i, k, cell

        if (job%sensitivities%count == 0) return
        do k = 1, rows%rows
            rows%cells(self%cells_before + 1:self%cells_before + 2 * job%sensitivities%count, k) = no_number
            if (.not. is_good_end(nint(rows%cells(size(job%axes%axis) + 2, k)))) cycle
            call compute_nodes(self, job, rows%cells(2:size(job%axes%axis) + 1, k))
            do i = 1, job%sensitivities%count
                cell = self%cells_before + 2 * i - 1
                associate (key => job%sensitivities%list(i)%key)
                    call self%nodes(key)%differentiate(self%values(self%place(i), :, key), rows%cells(cell, k), &
                                                       rows%cells(cell + 1, k))
                end associate
                if (.not. abs(rows%cells(cell, k)) <= huge(1.0_dp)) call note_missing(rows, k)
            end do
        end do
    end subroutine fill

    !> Computes the quantities of a case at all its nodes.
    subroutine compute_nodes(self, job, parameters)
        class(sweep_sensitivities_t), target, intent(inout) :: self
        type(job_t), intent(in) :: job
        real(dp), intent(in) :: parameters(:) !! the values of the axes of the sweep in that case
        integer(int64) :: first, last
        integer :: i, row, place, key

        associate (axes => self%job%axes, keys => job%sensitivities%keys)
            do i = 1, size(parameters)
                axes%axis(i)%listed = parameters(i)
            end do
            do i = 1, size(keys)
                associate (listed => axes%axis(self%axis(i))%listed)
                    if (keys(i)%axis == 0) listed = keys(i)%slot%get()
                    self%nodes(i) = keys(i)%nodes(listed(1))
                end associate
            end do
            do i = 1, size(keys)
                axes%axis(self%axis(i))%listed((i - 1) * node_count + 1:i * node_count) = self%nodes(i)%x
            end do
            first = 1
            do while (first <= axes%cases)
                last = min(first + size_of_block(self%job) - 1, axes%cases)
                call self%worker%compute_rows(self%job, first, last, self%rows)
                do row = 1, self%rows%rows
                    place = int(first) + row - 2
                    key = place / node_count + 1
                    self%values(:, mod(place, node_count) + 1, key) = &
                        self%rows%cells(self%node_cells_before + 1:self%node_cells_before + size(self%values, 1), row)
                    if (is_good_end(nint(self%rows%cells(self%node_cells_before, row)))) cycle
                    self%values(:, mod(place, node_count) + 1, key) = no_number
                end do
                first = last + 1
            end do
        end associate
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

end module spintop_sweep_sensitivities
