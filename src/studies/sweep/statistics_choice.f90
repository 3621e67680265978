!> Makes the plan of the statistics of a sweep from the names and numbers in a scene, and reports the problems of
!> these.
module spintop_statistics_choice
    use spintop_accumulators, only: bins_around, bins_t, even_bins
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, is_finite
    use spintop_parameters, only: is_set, unset_integer
    use spintop_problems, only: problems_t
    use spintop_process, only: physical_memory
    use spintop_scene_keys, only: max_over, combine_saltelli
    use spintop_statistics_plan, only: binned_t, statistics_plan_t
    use spintop_study_column, only: find_column, study_column_t
    use spintop_summary, only: rounded
    use spintop_sweep_axes, only: axis_t
    use spintop_sweep_result, only: sweep_columns
    use spintop_sweep_worker, only: describe_columns
    use spintop_table_column, only: column_length, column_of_notes, column_of_words, status_column, table_column_t
    use spintop_text, only: did_you_mean, to_text
    implicit none
    private
    public :: choose_statistics

    !> Number of bins if it is not given; and values of an axis up to which each has a bin of its own.
    integer, parameter :: usual_bins = 50, most_values = 1000
    !> The quantiles if none are given.
    real(dp), parameter :: usual_quantiles(5) = [0.05_dp, 0.25_dp, 0.5_dp, 0.75_dp, 0.95_dp]

    !> What a scene says of one quantity that is binned, and what its axis says where the scene does not.
    type :: range_of_bins_t
        integer :: number = 0
        real(dp) :: from = 0, to = 0
        integer :: count = usual_bins
        logical :: is_log = .false.
    contains
        procedure :: key
    end type range_of_bins_t

contains

    !> Plans the statistics of a sweep whose columns are chosen. Where its rows are not written, only the columns
    !> that the statistics need remain.
    subroutine choose_statistics(job, problems)
        type(job_t), intent(inout) :: job !! the job; columns and statistics are set
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(table_column_t), allocatable :: cells(:)
        type(statistics_plan_t) :: plan
        type(study_column_t), allocatable :: found(:)
        integer, allocatable :: numbers(:), categories(:)
        character(:), allocatable :: key, problem, hint
        integer :: i, place

        if (.not. job%names_statistics()) then
            if (.not. job%keeps_rows()) call problems%add('output.rows', &
                'nothing would be written: there are no statistics', "give statistics.columns, or set rows = 'all'")
            return
        end if
        if (all(job%input%scene%statistics_columns == '')) then
            call problems%add('statistics', 'there are no columns of which statistics are computed', &
                              "give for example columns = 'theta_max', 'status'")
            return
        end if
        if (.not. job%keeps_rows()) then
            if (any(job%input%scene%columns /= '')) then
                call problems%add('output.columns', "there are no rows to have columns, by output.rows = 'none'", &
                                  'omit it; statistics.columns are computed')
            end if
            associate (names => [character(column_length) :: job%input%scene%statistics_columns, job%input%scene%over])
                allocate (found(size(names)))
                do i = 1, size(names)
                    call find_column(sweep_columns, trim(names(i)), found(i), problem, hint)
                    if (any(found(:i - 1)%name == found(i)%name)) found(i)%place = 0
                end do
            end associate
            job%columns = [(pack(found, found%place == i), i=1, size(sweep_columns))]
        end if
        if (job%axes%cases == 0) return
        call describe_columns(job, cells)
        plan%is_wanted = .true.
        plan%is_netcdf = job%input%scene%format == 'netcdf'
        plan%by_bin = job%input%scene%quantiles_of == 'bins'
        plan%status_cell = findloc(cells%name, status_column, dim=1)
        allocate (numbers(0), categories(0))
        associate (named => job%input%scene%statistics_columns)
            do i = 1, size(named)
                if (named(i) == '') cycle
                key = 'statistics.columns(' // to_text(i) // ')'
                place = find_cell(job, cells, trim(named(i)), key, problems)
                if (place == 0) cycle
                if (any([numbers, categories] == place)) then
                    call problems%add(key, "column '" // trim(named(i)) // "' is named twice", 'name it once')
                else if (cells(place)%kind == column_of_words) then
                    categories = [categories, place]
                else
                    numbers = [numbers, place]
                end if
            end do
        end associate
        plan%cells_of_numbers = numbers
        plan%cells_of_categories = categories
        plan%numbers = cells(numbers)
        plan%categories = cells(categories)
        associate (quantiles => job%input%scene%quantiles)
            allocate (plan%shares, source=pack(quantiles, is_set(quantiles)))
        end associate
        if (size(plan%shares) == 0) plan%shares = usual_quantiles
        i = findloc(plan%shares(2:) > plan%shares(:size(plan%shares) - 1), .false., dim=1)
        if (i > 0) call problems%add('statistics.quantiles', 'the quantiles do not increase: ' // to_text(plan%shares(i + 1)) // &
                                     ' is after ' // to_text(plan%shares(i)), 'give increasing quantiles')
        call choose_bins(job, cells, plan, problems)
        call choose_indices(job, plan, problems)
        job%statistics = plan
    end subroutine choose_statistics

    !> The cell of a column or a swept parameter; 0, and a problem, if there is none.
    integer function find_cell(job, cells, name, key, problems) result(place)
        type(job_t), intent(in) :: job
        type(table_column_t), intent(in) :: cells(:)
        character(*), intent(in) :: name, key
        type(problems_t), intent(inout) :: problems
        type(study_column_t) :: found
        character(:), allocatable :: problem, hint
        integer :: i

        place = findloc(cells%name, name, dim=1)
        if (place > 1) then ! not the number of the case
            if (cells(place)%kind /= column_of_notes) return
        end if
        call find_column(sweep_columns, name, found, problem, hint)
        if (place > 0) then
            call problems%add(key, "column '" // name // "' has no statistics", 'name a quantity, a swept parameter or status')
        else if (found%place > 0) then
            call problems%add(key, "the table has no column '" // name // "'", &
                              "add it to output.columns, or set output.rows = 'none'")
        else if (job%input%table%find(name(:index(name // '(', '(') - 1)) > 0) then
            call problems%add(key, name // ' is not swept', 'name a parameter of an axis, or a column')
        else
            if (hint == '' .or. index(hint, 'did you mean') == 1) hint = did_you_mean(name, [character(column_length) :: &
                sweep_columns%name, (job%axes%axis(i)%name, i=1, size(job%axes%axis))])
            if (hint == '') hint = '`spintop list columns` shows them all'
            call problems%add(key, problem, hint)
        end if
        place = 0
    end function find_cell

    !> The factors of Sobol' indices: each axis, or all components of a vector together.
    subroutine choose_indices(job, plan, problems)
        type(job_t), intent(in) :: job
        type(statistics_plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: named_key = 'statistics.indices'
        integer :: i, factors, group

        if (job%input%scene%indices == '') return
        factors = count(job%axes%axis%component == 1)
        group = factors + 2
        if (job%axes%combination /= combine_saltelli) then
            call problems%add(named_key, "Sobol' indices need the cases of Saltelli's design", &
                              "give sweep.combine = 'saltelli', and sweep.cases a multiple of " // to_text(group) &
                              // ' (the number of axes and 2)')
        else if (size(plan%numbers) == 0) then
            call problems%add(named_key, 'there is no column of numbers that could have indices', &
                              'name a quantity in statistics.columns')
        else
            plan%groups = job%axes%cases / group
            allocate (plan%factors(factors))
            factors = 0
            do i = 1, size(job%axes%axis)
                associate (axis => job%axes%axis(i))
                    if (axis%component > 1) cycle
                    factors = factors + 1
                    plan%factors(factors)%name = axis%name
                    if (axis%components > 1) plan%factors(factors)%name = axis%name(:index(axis%name, '(', back=.true.) - 1)
                end associate
            end do
        end if
    end subroutine choose_indices

    !> The bins.
    subroutine choose_bins(job, cells, plan, problems)
        type(job_t), intent(in) :: job
        type(table_column_t), intent(in) :: cells(:)
        type(statistics_plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems
        integer :: i, n

        n = count(job%input%scene%over /= '')
        do i = n + 1, max_over
            if (job%input%scene%bins(i) /= unset_integer .or. job%input%scene%bins_spacing(i) /= '' .or. &
                any(is_set([job%input%scene%bins_from(i), job%input%scene%bins_to(i)]))) then
                call problems%add('statistics', 'bins ' // to_text(i) // ' are described, but not what they are over', &
                                  'give over(' // to_text(i) // '), or omit its bins, from, to and spacing')
                return
            end if
        end do
        if (plan%by_bin .and. n == 0) then
            call problems%add('statistics.quantiles_of', 'there are no bins', "give over, or quantiles_of = 'all'")
        end if
        allocate (plan%over(n))
        do i = 1, n
            call choose_bins_of(job, cells, i, plan%over(i), problems)
            if (.not. allocated(plan%over(i)%bins%value)) return
        end do
        if (n == max_over) then
            if (plan%over(1)%cell == plan%over(2)%cell) then
                call problems%add('statistics.over(2)', 'both quantities are the same', 'give two, or one')
            end if
        end if
        if (plan%bytes() > real(physical_memory(), dp)) then
            call problems%add('statistics.bins', to_text(plan%bin_count()) // ' bins need about ' &
                              // rounded(plan%bytes() / 1.0e9_dp, 3) // ' GB, more than this machine has', 'use fewer bins' &
                              // trim(merge(", or quantiles_of = 'all'", '                         ', plan%by_bin)))
        end if
    end subroutine choose_bins

    !> The bins of one quantity; without bins if there are problems.
    subroutine choose_bins_of(job, cells, number, over, problems)
        type(job_t), intent(in) :: job
        type(table_column_t), intent(in) :: cells(:)
        integer, intent(in) :: number
        type(binned_t), intent(inout) :: over
        type(problems_t), intent(inout) :: problems
        type(range_of_bins_t) :: range
        type(bins_t) :: made
        integer, parameter :: bytes_of_ends = 16
        real(dp), allocatable :: values(:)
        character(:), allocatable :: name
        integer :: axis
        logical :: has_range, is_given

        range%number = number
        name = trim(job%input%scene%over(number))
        over%cell = find_cell(job, cells, name, range%key('over'), problems)
        if (over%cell == 0) return
        over%column = cells(over%cell)
        if (over%column%kind == column_of_words) then
            call problems%add(range%key('over'), "column '" // name // "' has words, and no numbers", &
                              'name it in statistics.columns, to count its words')
            return
        end if
        has_range = .false.
        associate (scene => job%input%scene)
            is_given = scene%bins(number) /= unset_integer .or. scene%bins_spacing(number) /= '' .or. &
                       any(is_set([scene%bins_from(number), scene%bins_to(number)]))
            do axis = 1, size(job%axes%axis)
                if (job%axes%axis(axis)%name /= name) cycle
                call find_axis_values(job%axes%axis(axis), values, range)
                has_range = .true.
                if (is_given .or. size(values) == 0 .or. size(values) > most_values) exit
                over%bins = bins_around(values)
                return
            end do
            if (is_set(scene%bins_from(number))) range%from = scene%bins_from(number)
            if (is_set(scene%bins_to(number))) range%to = scene%bins_to(number)
            has_range = has_range .or. all(is_set([scene%bins_from(number), scene%bins_to(number)]))
            if (scene%bins(number) /= unset_integer) range%count = scene%bins(number)
            if (scene%bins_spacing(number) /= '') range%is_log = scene%bins_spacing(number) == 'log'
        end associate
        if (.not. has_range) then
            call problems%add(range%key('over'), "the range of '" // name // "' is not known before it is computed", &
                              'give ' // range%key('from') // ' and ' // range%key('to'))
            return
        end if
        if (.not. range%from < range%to) then
            call problems%add(range%key('to'), 'the bins would end at ' // to_text(range%to) // ', which is not above ' &
                              // to_text(range%from) // ', where they begin', 'give from < to')
        else if (range%is_log .and. .not. range%from > 0) then
            call problems%add(range%key('spacing'), 'logarithmic spacing needs positive ends, not ' // to_text(range%from), &
                              "use spacing = 'linear' or another " // range%key('from'))
        else if (.not. is_finite(range%to - range%from)) then
            call problems%add(range%key('to'), 'the ends of the bins are too far apart', 'use other ends')
        else if (real(range%count, dp) * bytes_of_ends > real(physical_memory(), dp)) then
            call problems%add(range%key('bins'), to_text(range%count) // ' bins need more memory than this machine has', &
                              'use fewer bins')
        else
            made = even_bins(range%from, range%to, range%count, range%is_log)
            if (all(made%edge(2:) > made%edge(:range%count))) then
                over%bins = made
            else
                call problems%add(range%key('bins'), to_text(range%count) // ' bins are narrower than the spacing of the &
                                  &numbers between ' // to_text(range%from) // ' and ' // to_text(range%to), 'use fewer bins')
            end if
        end if
    end subroutine choose_bins_of

    !> The values of an axis, increasing, each once (none if it has an interval), and its range.
    subroutine find_axis_values(axis, values, range)
        type(axis_t), intent(in) :: axis
        real(dp), allocatable, intent(out) :: values(:)
        type(range_of_bins_t), intent(inout) :: range
        real(dp) :: smallest, found
        integer :: i, n

        range%is_log = axis%logarithmic
        if (allocated(axis%listed)) then
            range%from = minval(axis%listed)
            range%to = maxval(axis%listed)
        else
            range%from = min(axis%from, axis%to)
            range%to = max(axis%from, axis%to)
        end if
        allocate (values(0))
        n = axis%count
        if (allocated(axis%listed)) n = size(axis%listed)
        if (n > most_values) return
        found = -huge(found)
        do
            smallest = huge(smallest)
            do i = 1, n
                if (axis%value(i) > found) smallest = min(smallest, axis%value(i))
            end do
            if (.not. smallest < huge(smallest)) exit
            values = [values, smallest]
            found = smallest
        end do
    end subroutine find_axis_values

    !> A key of the binned quantity: `statistics.from(2)`.
    function key(self, name)
        class(range_of_bins_t), intent(in) :: self
        character(*), intent(in) :: name
        character(:), allocatable :: key
        key = 'statistics.' // name // '(' // to_text(self%number) // ')'
    end function key

end module spintop_statistics_choice
