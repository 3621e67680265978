!> What a sweep will need: the size of its table, memory and time, from a sample of its cases that is computed.
module spintop_sweep_forecast
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_clock, only: processor_seconds, seconds
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_options, only: options_t
    use spintop_process, only: peak_memory
    use spintop_resumable_table, only: resumable_table_t
    use spintop_row_block, only: row_block_t
    use spintop_row_table, only: row_table_t
    use spintop_statistics_result, only: bytes_of_result
    use spintop_summary, only: rounded, summary_t
    use spintop_study_column, only: chosen_column_t
    use spintop_sweep_columns, only: sweep_column_t, columns_at
    use spintop_sweep_table, only: cells_of_row, describe_columns, describe_table
    use spintop_sweep_rows, only: sweep_rows_t
    use spintop_sweep_worker, only: size_of_block
    use spintop_table_column, only: column_of_integers, column_of_notes, column_of_words
    use spintop_thread_team, only: blocks_ahead
    use spintop_text, only: join, string_t, to_text
    !$ use omp_lib, only: omp_get_max_threads
    implicit none
    private
    public :: forecast_sweep

    !> The first sample: places in the range of the cases, and consecutive cases at each. Where whole blocks at so many places
    !> are fast, they are the sample: a case of a whole block costs less.
    integer, parameter :: few_places = 8, cases_at_place = 25, many_places = 64
    !> After this time no more places are computed, s.
    real(dp), parameter :: long_enough = 1
    !> Columns that make a case at least so many times as long are named.
    real(dp), parameter :: expensive = 1.5_dp

    !> What a sample has shown.
    type :: sample_t
        integer(int64) :: cases = 0, bytes = 0
        real(dp) :: time = 0
        !> Time of the processor, which other programs do not disturb, s.
        real(dp) :: work = 0
    end type sample_t

contains

    !> Adds lines on the table, the memory and the time. At least one place of the sample is computed, however long that
    !> takes.
    subroutine forecast_sweep(job, options, summary)
        type(job_t), target, intent(inout) :: job !! the job; unchanged at the end
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(inout) :: summary !! lines are added
        class(row_table_t), allocatable :: table
        type(sample_t) :: sample
        character(:), allocatable :: head
        integer(int64) :: first, cases
        integer :: threads
        real(dp) :: bytes, memory

        first = options%shard%first(job%axes%cases)
        cases = options%shard%last(job%axes%cases) - first + 1
        if (cases < 1) return
        call describe_table(job, options%shard, table, head)
        call compute_sample(job, first, cases, table, long_enough, sample)
        threads = options%threads
        !$ if (threads == 0) threads = omp_get_max_threads()
        threads = max(1, threads)
        bytes = real(sample%bytes, dp) / sample%cases
        memory = peak_memory() + real(blocks_ahead * threads, dp) * size_of_block(job) * (bytes + 8 * cells_of_row(job))
        if (job%statistics%is_wanted) memory = memory + job%statistics%bytes()
        if (job%keeps_rows()) then
            call summary%add('table', 'about ' // amount(len(head) + bytes * cases, 'B') // ', ' // rounded(bytes, 3) // &
                             ' bytes per case')
        end if
        if (job%statistics%is_wanted) then
            bytes = bytes_of_result(job%statistics)
            if (options%shard%is_part()) bytes = job%statistics%bytes()
            call summary%add('statistics', 'about ' // amount(len(head) + bytes, 'B') // ' at most')
        end if
        call summary%add('memory', 'about ' // amount(memory, 'B'))
        call summary%add('time', 'about ' // duration(each(sample) * cases / threads) // ' on ' // &
                         to_text(threads) // ' threads, from ' // to_text(sample%cases) // ' cases in ' // &
                         duration(sample%time))
        if (job%sensitivities%count == 0) call name_expensive(job, first, cases, sample, summary)
    end subroutine forecast_sweep

    !> Computing time of a case, s.
    pure real(dp) function each(self)
        class(sample_t), intent(in) :: self
        each = self%time / self%cases
    end function each

    !> Adds a line on the columns that make the sweep expensive. Columns that need the same work are a group. A sample is computed
    !> with each group alone; where they differ, the slower half on a logarithmic scale is expensive, and a sample is computed
    !> without it.
    subroutine name_expensive(job, first, cases, all, summary)
        type(job_t), target, intent(inout) :: job
        integer(int64), intent(in) :: first, cases
        type(sample_t), intent(in) :: all !! the sample with all columns
        type(summary_t), intent(inout) :: summary
        type(sweep_column_t) :: columns(size(job%columns))
        type(string_t), allocatable :: names(:)
        type(chosen_column_t) :: chosen(size(job%columns))
        integer :: i, k
        real(dp) :: time(size(job%columns)), ratio

        chosen = job%columns
        columns = columns_at(chosen)
        do i = 1, size(chosen)
            do k = 1, i - 1
                if (all_equal(columns(k)%needs, columns(i)%needs)) exit
            end do
            if (k < i) then
                time(i) = time(k)
            else
                time(i) = time_with(pack(chosen, [(all_equal(columns(k)%needs, columns(i)%needs), k=1, size(chosen))]))
            end if
        end do
        if (maxval(time) < expensive * minval(time)) return
        associate (is_cheap => time < sqrt(minval(time) * maxval(time)))
            ratio = all%work / all%cases / time_with(pack(chosen, is_cheap))
            names = [(string_t(trim(columns(i)%name)), i=1, size(chosen))]
            if (ratio > expensive) call summary%add('columns', 'with ' // join(pack(names, .not. is_cheap), ', ') // &
                                                    ' a case takes ' // rounded(ratio, 2) // ' times as long as without')
        end associate

    contains

        !> Whether logical values are the same.
        pure logical function all_equal(a, b)
            logical, intent(in) :: a(:), b(:)
            all_equal = .not. any(a .neqv. b)
        end function all_equal

        !> Time of the processor for a case with these columns, s.
        real(dp) function time_with(some)
            type(chosen_column_t), intent(in) :: some(:)
            type(resumable_table_t) :: table
            type(sample_t) :: sample
            job%columns = some
            call describe_columns(job, table%columns)
            call compute_sample(job, first, cases, table, long_enough / size(chosen), sample)
            job%columns = chosen
            time_with = sample%work / sample%cases
        end function time_with

    end subroutine name_expensive

    !> Computes a sample from the whole range of the cases.
    subroutine compute_sample(job, first, cases, table, enough, sample)
        type(job_t), target, intent(in) :: job
        integer(int64), intent(in) :: first, cases
        class(row_table_t), intent(in) :: table
        real(dp), intent(in) :: enough !! after this time no more places are computed, s
        type(sample_t), intent(out) :: sample
        type(sweep_rows_t), allocatable, target :: thread
        integer :: block

        allocate (thread)
        call thread%prepare(job)
        block = size_of_block(job)
        call compute_places(few_places, min(cases_at_place, block))
        if (each(sample) * block * many_places < enough) call compute_places(many_places, block)

    contains

        !> Computes consecutive cases in the middles of equal parts of the range.
        subroutine compute_places(places, wanted)
            integer, intent(in) :: places, wanted
            type(row_block_t) :: rows
            integer(int64) :: begin
            integer :: place, last_place, width
            real(dp) :: began, work_before
            sample = sample_t()
            width = int(min(cases, int(wanted, int64)))
            last_place = int(min(int(places, int64), cases / width))
            ! The first time also pays for what later ones find done.
            do place = 0, last_place
                begin = first + int(real(cases - width, dp) * (max(place, 1) - 0.5_dp) / last_place, int64)
                began = seconds()
                work_before = processor_seconds()
                call thread%compute_rows(begin, begin + width - 1, rows)
                if (place == 0 .and. seconds() - began < enough / few_places) cycle
                sample%bytes = sample%bytes + bytes_of(rows, table)
                sample%time = sample%time + (seconds() - began)
                sample%work = sample%work + (processor_seconds() - work_before)
                sample%cases = sample%cases + width
                if (sample%time > enough) exit
            end do
        end subroutine compute_places

    end subroutine compute_sample

    !> Bytes of rows in the table, by its format.
    integer(int64) function bytes_of(rows, table) result(bytes)
        type(row_block_t), intent(inout) :: rows
        class(row_table_t), intent(in) :: table
        integer, parameter :: bytes_of_double = 8, bytes_of_integer = 4
        integer :: i, each
        call table%format(rows)
        bytes = rows%text%length
        if (bytes > 0) return
        do i = 1, size(table%columns)
            select case (table%columns(i)%kind)
            case (column_of_integers, column_of_notes)
                each = bytes_of_integer
            case (column_of_words)
                each = 1
            case default
                each = bytes_of_double
                if (table%columns(i)%axis > 0) each = 0
            end select
            bytes = bytes + each * rows%rows
        end do
    end function bytes_of

    !> A large number with the prefix of its unit.
    function amount(value, unit) result(text)
        real(dp), intent(in) :: value
        character(*), intent(in) :: unit
        character(:), allocatable :: text
        character, parameter :: prefixes(0:6) = [' ', 'k', 'M', 'G', 'T', 'P', 'E']
        integer :: step
        step = min(ubound(prefixes, 1), max(0, int(log10(max(value, 1.0_dp)) / 3)))
        text = rounded(value / 1000.0_dp**step, 3) // ' ' // trim(prefixes(step)) // unit
    end function amount

    !> A time in the unit that suits it.
    function duration(time) result(text)
        real(dp), intent(in) :: time !! the time, s
        character(:), allocatable :: text
        real(dp), parameter :: minute = 60, hour = 3600, day = 86400
        if (time < 1) then
            text = rounded(1000 * time, 2) // ' ms'
        else if (time < 3 * minute) then
            text = rounded(time, 2) // ' s'
        else if (time < 3 * hour) then
            text = rounded(time / minute, 2) // ' minutes'
        else if (time < 3 * day) then
            text = rounded(time / hour, 2) // ' hours'
        else
            text = rounded(time / day, 2) // ' days'
        end if
    end function duration

end module spintop_sweep_forecast
