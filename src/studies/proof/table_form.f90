!> Whether the rows of a table are those that its input asks for: their number, order, times and parameters, and whether
!> its bounds say the same as its column `proof`.
module spintop_table_form
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_compare, only: is_finite
    use spintop_errors, only: error_t
    use spintop_files, only: read_file
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_loaded_table, only: table_t
    use spintop_plan, only: sample_time
    use spintop_shard, only: read_shard_line, shard_t
    use spintop_table_head, only: first_line_of
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: findings_t, check_times, check_cases, check_values, check_proof_cells, is_nan

    !> What is wrong in a table.
    type :: findings_t
        integer(int64) :: count = 0
        !> The first, as text; not allocated if nothing is wrong.
        character(:), allocatable :: first
    contains
        procedure :: add
    end type findings_t

    character, parameter :: nl = new_line('a')
    integer, parameter :: largest_table = 2**30 - 1
    !> Relative difference of numbers that were computed from the same input by other versions of the program.
    real(dp), parameter :: same = 4 * epsilon(1.0_dp)

contains

    !> Counts what is wrong, and keeps the first.
    subroutine add(self, what)
        class(findings_t), intent(inout) :: self
        character(*), intent(in) :: what !! what is wrong
        if (self%count == 0) self%first = what
        self%count = self%count + 1
    end subroutine add

    !> Whether a number is none.
    elemental logical function is_nan(value)
        real(dp), intent(in) :: value !! any number
        is_nan = .not. (value > 0 .or. value <= 0)
    end function is_nan

    !> The rows of a trajectory: all of them, at their times. Of a motion that ended early only their order is known.
    subroutine check_times(job, times, wrong, error)
        type(job_t), intent(in) :: job !! the job of the table
        real(dp), intent(in) :: times(:) !! its column t
        type(findings_t), intent(inout) :: wrong !! what is wrong is added
        type(error_t), allocatable, intent(out) :: error !! the table cannot be read
        character(:), allocatable :: text
        logical :: is_whole
        integer :: row

        call read_file(job%input%path, largest_table, text, error, is_text=.true.)
        if (allocated(error)) return
        if (index(text, nl // '# status: ') == 0) call wrong%add('the table is cut short: it has no status')
        is_whole = index(text, nl // '# status: ok' // nl) > 0 .and. job%input%scene%stop_at == ''
        if (size(times) == 0 .or. (is_whole .and. size(times) /= job%plan%samples)) then
            call wrong%add(to_text(size(times)) // ' rows, where the input asks for ' // to_text(job%plan%samples))
        end if
        do row = 2, size(times)
            if (.not. times(row) > times(row - 1)) call wrong%add('row ' // to_text(row) // ', t = ' // to_text(times(row)) &
                                                                  // ': not after the row before')
        end do
        if (.not. is_whole .or. size(times) /= job%plan%samples) return
        do row = 1, size(times)
            if (abs(times(row) - sample_time(job%case%t_end, job%plan%samples, row)) <= 1.0e-12_dp * job%case%t_end) cycle
            call wrong%add('row ' // to_text(row) // ', t = ' // to_text(times(row)) // ': not a time of its input')
        end do
    end subroutine check_times

    !> The rows of a sweep, or of a part of it: one for each case, in order.
    subroutine check_cases(job, cases, wrong, error)
        type(job_t), intent(in) :: job !! the job of the table
        real(dp), intent(in) :: cases(:) !! its column case
        type(findings_t), intent(inout) :: wrong !! what is wrong is added
        type(error_t), allocatable, intent(out) :: error !! the table cannot be read
        type(shard_t) :: part
        character(:), allocatable :: text
        integer(int64) :: whole, first, expected
        logical :: is_part
        integer :: row

        call read_file(job%input%path, largest_table, text, error, is_text=.true.)
        if (allocated(error)) return
        call read_shard_line(first_line_of(text(:index(text, nl))), part, whole, is_part)
        if (.not. is_part) part = shard_t()
        first = part%first(job%axes%cases)
        expected = part%last(job%axes%cases) - first + 1
        if (size(cases) /= expected) call wrong%add(to_text(size(cases)) // ' rows, where the input has ' // &
                                                    to_text(expected) // ' cases')
        do row = 1, size(cases)
            if (abs(cases(row) - real(first + row - 1, dp)) <= 0) cycle
            call wrong%add('row ' // to_text(row) // ', case = ' // to_text(cases(row)) // ': not the case ' &
                           // to_text(first + row - 1))
        end do
    end subroutine check_cases

    !> The parameters of a row of a sweep.
    subroutine check_values(job, row, printed, values, wrong)
        type(job_t), intent(in) :: job !! the job of the table
        integer, intent(in) :: row !! number of the row
        real(dp), intent(in) :: printed(:), values(:) !! those in the table, and those of the case
        type(findings_t), intent(inout) :: wrong !! what is wrong is added
        integer :: i
        do i = 1, size(values)
            if (abs(printed(i) - values(i)) <= same * abs(values(i))) cycle
            call wrong%add('row ' // to_text(row) // ', ' // job%axes%axis(i)%name // ' = ' // to_text(printed(i)) &
                           // ': the case has ' // to_text(values(i)))
        end do
    end subroutine check_values

    !> The column `proof` of a table with bounds: `proved` where all bounds of the row are finite, `unproved` where one is
    !> infinite. What a case does not have has no bound. Certified numbers without a bound count, too: then a row may be
    !> unproved though its bounds are finite.
    subroutine check_proof_cells(table, certified, wrong)
        type(table_t), intent(in) :: table !! the table
        logical, intent(in) :: certified !! whether proved numbers replace the computed ones
        type(findings_t), intent(inout) :: wrong !! what is wrong is added
        type(string_t), allocatable :: words(:)
        real(dp), allocatable :: numbers(:), largest(:)
        character(:), allocatable :: name
        integer :: i, row

        allocate (words, source=table%words('proof'))
        allocate (largest(size(words)), source=-1.0_dp)
        do i = 1, size(table%names)
            name = table%names(i)%text
            if (len(name) <= len('_bound') .or. size(words) == 0) cycle
            if (name(len(name) - len('_bound') + 1:) /= '_bound') cycle
            numbers = table%column(name)
            where (numbers > largest) largest = numbers
        end do
        do row = 1, size(words)
            if (largest(row) < 0) cycle
            name = words(row)%text
            if (name == 'proved' .and. is_finite(largest(row))) cycle
            if (name == 'unproved' .and. (certified .or. .not. is_finite(largest(row)))) cycle
            call wrong%add('row ' // to_text(row) // ', proof = ' // name // ': its bounds say otherwise')
        end do
    end subroutine check_proof_cells

end module spintop_table_form
