!> A table of a sweep whose rows are gathered as well, or gathered and not written. Each thread finds the bins of its
!> rows; one after the other the blocks are added in the order of the cases. What was gathered is written with an
!> entry of the journal, to one of two files in turn, of which the entry names the one that belongs to its rows: a
!> later run resumes there. Such a file is also the result of a part of a sweep, by which parts are merged. It begins with the
!> header of the result as a table has it, so that it is identified by program, build, input and part:
!>
!>     # part 1 of 3: ...
!>     # title: ...
!>     bin,cases,...
!>     spintop statistics 3
!>     (the plan, then the accumulators, as they are in memory)
!>     (their checksum, from the line above)
module spintop_statistics_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t
    use spintop_checksum, only: checksum_text, checksum_width
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: file_size, input_file_t, sync_file
    use spintop_kinds, only: dp
    use spintop_netcdf_table, only: netcdf_table_t
    use spintop_process, only: seconds
    use spintop_row_block, only: row_block_t
    use spintop_row_table, only: refusal, row_table_t
    use spintop_state_stream, only: state_stream_t
    use spintop_statistics_output, only: check_statistics_tables, columns_before, write_statistics_tables
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_status, only: is_good_end, status_bad_input, status_ok
    use spintop_journaled_table, only: journal_entry_t, state_of
    use spintop_table_head, only: read_head
    implicit none
    private
    public :: statistics_table_t, read_statistics, is_statistics

    character, parameter :: nl = new_line('a')
    !> The line after the header of a file of accumulators.
    character(*), parameter :: first_line = 'spintop statistics 3' // nl

    !> Cells that are gathered of a row before the values: bin, number of the case, its status.
    integer, parameter :: bin_cell = 1, number_cell = 2, status_cell = 3, cells_before = 3
    !> Bytes of a snapshot that are written per second, at least, on any disk that is in use; and the share of the
    !> time that the first snapshot takes, as those after it.
    real(dp), parameter :: slowest_disk = 1.0e8_dp, times_pause = 20, least_pause = 0.05_dp

    !> Rows, which may not be kept, and what is gathered of them.
    type, extends(row_table_t) :: statistics_table_t
        type(statistics_plan_t) :: plan
        !> Path of the result, and its header.
        character(:), allocatable :: result_path, result_head
        !> Whether this is a part of a sweep.
        logical :: is_part = .false.
        type(accumulators_t), private :: accumulators
        !> The checksum of the last snapshot, and whether no entry names it yet.
        character(checksum_width), private :: checksum = ''
        logical, private :: is_new = .false.
    contains
        procedure :: start
        procedure :: format => extract_statistics_cells
        procedure :: append
        procedure :: make_entry_if_due
        procedure :: keep_entry
        procedure :: finish
    end type statistics_table_t

contains

    !> Starts the table of the rows, or resumes it, and with it what is gathered.
    subroutine start(self, path, head, resume, restart, error)
        class(statistics_table_t), intent(inout) :: self
        character(*), intent(in) :: path, head !! path of the table of the rows, and its header
        logical, intent(in) :: resume, restart !! whether to resume, or to discard, an interrupted run
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(:), allocatable :: problem
        call self%row_table_t%start(path, head, resume, restart, error)
        if (allocated(error)) return
        if (self%is_complete) then
            problem = ''
            if (.not. self%is_part) call check_statistics_tables(self%result_path, self%plan, problem)
            if (problem /= '') error = refusal(self%result_path, problem)
            if (sum(self%counts) == 0 .and. .not. allocated(error)) call recall_counts(self, error)
            return
        end if
        call self%plan%start(self%accumulators)
        if (self%rows() > 0) call restore(self, error)
        if (allocated(error)) then
            call self%abandon(error)
        else
            self%due = seconds() + max(least_pause, times_pause * self%plan%bytes_of_bins() / slowest_disk)
        end if
    end subroutine start

    !> Restores what was gathered of the rows that are kept.
    subroutine restore(self, error)
        class(statistics_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        type(statistics_plan_t) :: plan
        character(checksum_width) :: checksum
        character(:), allocatable :: state

        associate (entry => self%resumed)
            if (entry%state == 0) then
                error = input_error('the journal names no statistics of the kept rows')
            else
                state = state_of(self%table%path, entry%state)
                call read_statistics(state, plan, self%accumulators, checksum, error)
                if (.not. allocated(error) .and. checksum /= entry%state_checksum) then
                    error = input_error(state // ' was changed after it was written')
                end if
            end if
        end associate
        if (allocated(error)) error = refusal(self%result_path, error%message)
    end subroutine restore

    !> Reads the number of cases that failed from a complete result. Their reasons are not in it: they count as bad input.
    subroutine recall_counts(self, error)
        class(statistics_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        type(accumulators_t) :: accumulators
        type(statistics_plan_t) :: plan
        type(input_file_t) :: file
        character(checksum_width) :: checksum
        character(:), allocatable :: text
        type(netcdf_table_t) :: netcdf
        real(dp), allocatable :: cells(:), rows(:, :)
        integer, parameter :: longest_row = 1024
        integer :: length, status

        allocate (cells(columns_before(self%plan) + 2), source=0.0_dp)
        if (self%is_part) then
            call read_statistics(self%result_path, plan, accumulators, checksum, error)
            if (allocated(error)) return
            cells = [real(sum(accumulators%cases), dp), real(sum(accumulators%failed), dp)]
        else if (self%plan%is_netcdf) then
            call netcdf%open(self%result_path, error)
            if (allocated(error)) return
            if (netcdf%next_rows(rows, error)) cells = rows(:size(cells), 1)
            call netcdf%close()
        else
            allocate (character(len(self%result_head) + longest_row) :: text)
            call file%open(self%result_path, error)
            if (.not. allocated(error)) call file%read(text, length, error)
            call file%close()
            if (allocated(error)) return
            read (text(len(self%result_head) + 1:length), *, iostat=status) cells
            if (status /= 0) error = refusal(self%result_path, 'it has no row of all cases')
        end if
        associate (last => cells(size(cells) - 1:))
            self%counts(status_bad_input) = nint(last(2), int64)
            self%counts(status_ok) = nint(last(1) - last(2), int64)
        end associate
    end subroutine recall_counts

    !> Finds the bins of rows and what is gathered of them, then formats them for the table of the rows.
    subroutine extract_statistics_cells(self, block)
        class(statistics_table_t), intent(in) :: self
        type(row_block_t), intent(inout) :: block !! its cells may become text
        real(dp) :: bins
        integer :: i, k, n, place, words

        associate (plan => self%plan, rows => block%rows)
            n = size(plan%numbers)
            call block%reserve_statistics_cells(cells_before + n + size(plan%categories), rows)
            associate (cells => block%cells, gathered => block%statistics_cells)
                ! The bins of the first quantity count fastest; after the last come the cases that are in none.
                gathered(:, bin_cell) = 1
                bins = 1
                do i = 1, size(plan%over)
                    associate (over => plan%over(i))
                        place = 0
                        do k = 1, rows
                            ! On a grid most cases are in the bin of the last one.
                            place = over%bins%place(cells(over%cell, k), place)
                            gathered(k, bin_cell) = gathered(k, bin_cell) + merge((place - 1) * bins, -huge(bins), place > 0)
                        end do
                        bins = bins * size(over%bins%value)
                    end associate
                end do
                where (gathered(:, bin_cell) < 0) gathered(:, bin_cell) = bins + 1
                gathered(:, number_cell) = cells(1, :rows)
                gathered(:, status_cell) = cells(plan%status_cell, :rows)
                do i = 1, n
                    gathered(:, cells_before + i) = cells(plan%cells_of_numbers(i), :rows)
                end do
                words = 1
                do i = 1, size(plan%categories)
                    gathered(:, cells_before + n + i) = words + cells(plan%cells_of_categories(i), :rows)
                    words = words + size(plan%categories(i)%words)
                end do
            end associate
        end associate
        call self%row_table_t%format(block)
    end subroutine extract_statistics_cells

    !> Adds rows, and writes a snapshot if an entry of the journal is due.
    subroutine append(self, block, error)
        class(statistics_table_t), intent(inout) :: self
        type(row_block_t), intent(in) :: block !! rows in their order
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer(int64), dimension(block%statistics_rows) :: bins, numbers
        logical :: is_ok(block%statistics_rows)
        integer :: words(block%statistics_rows, size(self%plan%categories))
        integer :: first, last, n, rows

        n = cells_before + size(self%plan%numbers)
        rows = block%statistics_rows
        associate (gathered => block%statistics_cells)
            bins = int(gathered(:rows, bin_cell), int64)
            numbers = int(gathered(:rows, number_cell), int64)
            is_ok = is_good_end(nint(gathered(:rows, status_cell)))
            words = int(gathered(:rows, n + 1:))
            if (count(bins(2:) /= bins(:rows - 1)) > rows / 2) call self%accumulators%fetch(bins)
            first = 1
            do while (first <= rows)
                last = first
                do while (last < rows)
                    if (bins(last + 1) /= bins(first)) exit
                    last = last + 1
                end do
                call self%accumulators%add(numbers(first:last), is_ok(first:last), bins(first), &
                                           gathered(first:last, cells_before + 1:n), words(first:last, :))
                first = last + 1
            end do
        end associate
        ! A snapshot that no entry names yet is older than these rows.
        self%is_new = .false.
        call self%row_table_t%append(block, error)
        if (allocated(error) .or. self%in_entry .or. seconds() < self%due) return
        call save_snapshot(self, error)
    end subroutine append

    !> Writes a snapshot to the file that the last entry of the journal does not name.
    subroutine save_snapshot(self, error)
        type(statistics_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        if (.not. self%entry_began > 0) self%entry_began = seconds()
        self%last_state = 3 - max(self%last_state, 1)
        call write_state(state_of(self%table%path, self%last_state), self%result_head, self%plan, self%accumulators, &
                         .false., self%checksum, error)
        self%is_new = .not. allocated(error)
    end subroutine save_snapshot

    !> Makes an entry that names the snapshot, if there is a new one.
    subroutine make_entry_if_due(self, entry, due, error)
        class(statistics_table_t), intent(inout) :: self
        type(journal_entry_t), intent(inout) :: entry !! the current size of the table, if an entry is due
        logical, intent(out) :: due !! whether an entry is due
        type(error_t), allocatable, intent(inout) :: error !! not changed if it is allocated on entry
        due = .false.
        if (allocated(error) .or. self%in_entry) return
        if (self%entry_wanted .and. .not. self%is_new) call save_snapshot(self, error)
        if (.not. self%is_new) return
        self%is_new = .false.
        call self%row_table_t%make_entry_if_due(entry, due, error)
        entry%state = self%last_state
        entry%state_checksum = self%checksum
    end subroutine make_entry_if_due

    !> Waits until rows and snapshot of an entry are on the disk, and then writes the entry.
    subroutine keep_entry(self, entry, error)
        class(statistics_table_t), intent(in) :: self
        type(journal_entry_t), intent(in) :: entry !! entry of the journal
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call sync_file(state_of(self%table%path, entry%state), error)
        if (.not. allocated(error)) call self%row_table_t%keep_entry(entry, error)
    end subroutine keep_entry

    !> Writes the result, that of a part or tables, and finishes the table of the rows.
    subroutine finish(self, error)
        class(statistics_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        associate (path => self%result_path, head => self%result_head)
            if (self%is_part) then
                call write_state(path, head, self%plan, self%accumulators, .true., self%checksum, error)
            else
                call write_statistics_tables(path, head, self%plan, self%accumulators, error)
            end if
        end associate
        if (.not. allocated(error)) call self%row_table_t%finish(error)
    end subroutine finish

    !> Writes accumulators to a file. That of a part of a sweep has another name until it is on the disk, which a snapshot is
    !> not yet.
    subroutine write_state(path, head, plan, accumulators, is_part, checksum, error)
        character(*), intent(in) :: path !! path of the file
        character(*), intent(in) :: head !! header of the result
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(accumulators_t), intent(inout) :: accumulators !! the statistics, which do not change
        logical, intent(in) :: is_part !! whether it is the result of a part
        character(checksum_width), intent(out) :: checksum !! of all after the header
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(state_stream_t) :: stream
        type(statistics_plan_t) :: copy
        type(error_t), allocatable :: problem
        character(len(first_line)) :: line

        line = first_line
        copy = plan
        call stream%output%create(path // trim(merge('.new', '    ', is_part)), stream%error)
        if (.not. allocated(stream%error)) call stream%output%write(head, stream%error)
        call stream%carry_text(line)
        call copy%carry(stream)
        call accumulators%store_or_restore(stream)
        checksum = checksum_text(stream%checksum)
        if (.not. allocated(stream%error)) call stream%output%write(checksum // nl, stream%error)
        call move_alloc(stream%error, error)
        if (is_part) then
            if (.not. allocated(error)) call stream%output%finish_as(path, -1_int64, error)
            call stream%output%discard()
        else
            call stream%output%close(problem)
            if (.not. allocated(error)) call move_alloc(problem, error)
        end if
    end subroutine write_state

    !> Whether a file is one of these; false as well if it cannot be read.
    logical function is_statistics(path)
        character(*), intent(in) :: path !! path of the file
        type(state_stream_t) :: stream
        call open_state(stream, path)
        is_statistics = .not. allocated(stream%error)
        call stream%input%close()
    end function is_statistics

    !> Opens a file, and reads it to the end of the first line of the statistics. An error if there is none.
    subroutine open_state(stream, path)
        type(state_stream_t), intent(inout) :: stream
        character(*), intent(in) :: path
        character(:), allocatable :: head
        character(len(first_line)) :: line
        integer :: length
        call read_head(path, head, stream%error)
        if (allocated(stream%error)) return
        stream%is_read = .true.
        call stream%input%open(path, stream%error)
        if (.not. allocated(stream%error)) call stream%input%read(head, length, stream%error)
        call stream%carry_text(line)
        if (line /= first_line) call stream%refuse()
    end subroutine open_state

    !> Reads a file. An error if it is not whole.
    subroutine read_statistics(path, plan, accumulators, checksum, error)
        character(*), intent(in) :: path !! path of the file
        type(statistics_plan_t), intent(out) :: plan !! what is gathered, without the cells of a row
        type(accumulators_t), intent(out) :: accumulators !! the statistics
        character(checksum_width), intent(out) :: checksum !! of all after the header
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(state_stream_t) :: stream
        character(checksum_width + len(nl)) :: last

        checksum = ''
        call open_state(stream, path)
        if (.not. allocated(stream%error)) call plan%carry(stream)
        if (.not. allocated(stream%error)) then
            ! A damaged number of bins must not ask for memory without end.
            if (plan%bytes_of_bins() > file_size(path)) call stream%refuse()
        end if
        if (.not. allocated(stream%error)) then
            call plan%start(accumulators)
            call accumulators%store_or_restore(stream)
            checksum = checksum_text(stream%checksum)
            call stream%carry_text(last)
            if (last /= checksum // nl) call stream%refuse()
        end if
        call stream%input%close()
        call move_alloc(stream%error, error)
    end subroutine read_statistics

end module spintop_statistics_table
