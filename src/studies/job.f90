!> A job: an input that has been read, with its case, axes and plan.
module spintop_job
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_axes_of_scene, only: count_axes, describe_axes => make_axes
    use spintop_axes_of_table, only: given_axis_t, make_axes_of_arrays, read_axes
    use spintop_body, only: body_t
    use spintop_body_of_scene, only: make_body
    use spintop_case, only: case_t, make_case
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t, input_error
    use spintop_event_recorder, only: column_event_t
    use spintop_kinds, only: dp
    use spintop_parameter_print, only: given_groups, print_namelist
    use spintop_parameters, only: find_missing_beside, is_set, parameter_table_t, unset_integer
    use spintop_planning, only: make_plan, plan_t
    use spintop_problems, only: problems_t
    use spintop_provenance, only: header_of, fact_count, fact_t, gather_facts
    use spintop_ranks, only: ranks_t
    use spintop_scene_keys, only: scene_t
    use spintop_sensitivity, only: sensitivities_t
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_study_column, only: study_column_t
    use spintop_sweep_axes, only: case_scene_t, axes_t
    use spintop_table_column, only: column_t
    use spintop_table_head, only: compare_heads
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: job_t, compare_with_writer, study_head, print_input

    !> So many cases of a sweep are tried to find one that can be computed.
    integer(int64), parameter :: most_tried = 1000

    !> What was read. The parameter table points into the scene.
    type :: input_t
        !> Path of the input.
        character(:), allocatable :: path
        type(scene_t) :: scene
        type(parameter_table_t) :: table
    end type input_t

    !> Where the results of a job go.
    type :: output_files_t
        !> Path of the table, and of the summary that a sweep writes.
        character(:), allocatable :: table, log
        !> Path of the result of statistics; empty if there are none, or if they are the only table.
        character(:), allocatable :: statistics
        !> Path of the table of events; empty if there is none.
        character(:), allocatable :: events
    end type output_files_t

    !> A prepared input; it must not move in memory, as its input points into itself.
    type :: job_t
        type(input_t) :: input
        !> Name of the input without folder and extension, or that which it gives its files.
        character(:), allocatable :: name
        type(output_files_t) :: files
        !> What statistics are gathered.
        type(statistics_plan_t) :: statistics
        !> Whether the study computes the case of the input (`study_info_t`).
        logical :: has_case = .true.
        !> The case of the input; for a sweep the first case that can be computed, and its number.
        type(case_t) :: case
        integer(int64) :: first = 1
        type(plan_t) :: plan
        type(axes_t) :: axes
        !> Values of parameters, side by side, that a caller of the library gives in place of axes of the input; not
        !> allocated where it gives none.
        type(given_axis_t), allocatable :: given(:)
        !> The selected columns, with their names and units in the table.
        type(study_column_t), allocatable :: columns(:)
        !> Derivatives of columns, which follow those columns in the table.
        type(sensitivities_t) :: sensitivities
        !> Events to search for.
        type(column_event_t), allocatable :: events(:)
        !> Number of the event that ends the motion, among those that may end it.
        integer :: stop_after = 1
        !> Warnings of the input, ready to print; may be empty.
        character(:), allocatable :: warnings
        !> Warnings of the run itself; empty before it.
        character(:), allocatable :: late_warnings
    contains
        procedure :: names_axes
        procedure :: names_statistics
        procedure :: keeps_rows
        procedure :: make_axes
        procedure :: make_first_case
        procedure :: axis_column
        procedure :: warn_of_bodies
    end type job_t

    !> Groups that every study reads, and those of a case, given or not.
    character(*), parameter :: groups_of_all = 'study|integration|output', groups_of_a_case = 'top|initial|span'

contains

    !> Whether the input contains axes or names a table of cases.
    pure logical function names_axes(self)
        class(job_t), intent(in) :: self
        names_axes = count_axes(self%input%scene) > 0 .or. self%input%scene%sweep_table /= '' .or. allocated(self%given)
    end function names_axes

    !> Whether the input asks for statistics.
    pure logical function names_statistics(self)
        class(job_t), intent(in) :: self
        associate (scene => self%input%scene)
            names_statistics = any(scene%statistics_columns /= '') .or. any(scene%over /= '') &
                               .or. any(scene%bins /= unset_integer) .or. any(scene%bins_spacing /= '') &
                               .or. any(is_set([scene%bins_from, scene%bins_to])) .or. any(is_set(scene%quantiles)) &
                               .or. scene%quantiles_of /= '' .or. scene%indices /= ''
        end associate
    end function names_statistics

    !> Whether the rows of the cases are written.
    pure logical function keeps_rows(self)
        class(job_t), intent(in) :: self
        keeps_rows = self%input%scene%rows /= 'none'
    end function keeps_rows

    !> Makes the axes, which the input describes or has in a table; with problems they have no cases.
    subroutine make_axes(self, problems, diagnostics)
        class(job_t), target, intent(inout) :: self
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        character(:), allocatable :: missing
        type(string_t), allocatable :: names(:)
        integer :: i, given

        if (allocated(self%given)) then
            call make_axes_of_arrays(self%given, self%input%scene, self%input%table, self%axes, problems)
        else if (self%input%scene%sweep_table == '') then
            call describe_axes(self%input%scene, self%input%table, self%axes, problems)
        else
            call read_axes(self%input%path, self%input%scene, self%input%table, self%axes, problems, diagnostics)
        end if
        if (problems%any() .or. self%axes%cases == 0) return
        ! No element may be missing that those on the axes require: of a vector all vary or have values.
        allocate (names(size(self%axes%axis)))
        do i = 1, size(names)
            names(i)%text = self%axes%axis(i)%key
        end do
        call find_missing_beside(self%input%table, names, missing, given)
        if (missing /= '') call problems%add('sweep', missing // ' is missing', names(given)%text // &
                                             ' varies and requires it: give it a value, or vary it too')
    end subroutine make_axes

    !> Makes the case of the input, or the first of those of its axes that can be computed, and its plan if `planned`.
    !> `first` is the scene of that case. If none of the first cases can be computed, the problems are those of the first.
    subroutine make_first_case(self, first, problems, planned)
        class(job_t), target, intent(inout) :: self
        type(scene_t), allocatable, intent(out) :: first !! the scene of the first case; not allocated after a problem
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        logical, intent(in) :: planned !! whether the case is one to compute as planned
        type(case_scene_t), allocatable, target :: swept
        type(problems_t) :: of_first, of_case

        if (problems%any()) return
        allocate (swept)
        call swept%copy(self%input%scene, self%axes)
        self%first = 1
        call try_case(of_first)
        of_case = of_first
        do while (of_case%any() .and. self%first < min(self%axes%cases, most_tried))
            self%first = self%first + 1
            of_case = problems_t()
            call try_case(of_case)
        end do
        if (of_case%any()) then
            call problems%add_all(of_first)
        else
            call problems%add_all(of_case)
            allocate (first, source=swept%scene)
        end if

    contains

        !> Makes the case `self%first`.
        subroutine try_case(found)
            type(problems_t), intent(inout) :: found !! its problems
            type(case_t) :: empty
            real(dp) :: values(size(self%axes%axis))
            integer :: i
            if (self%axes%cases > 0) then
                values = self%axes%values_of(self%first)
                i = self%axes%out_of_range(values)
                if (i == 0) call swept%set_values(values)
                if (i > 0) call found%add('sweep.mean', 'none of the first ' // to_text(min(self%axes%cases, most_tried)) // &
                                          ' cases can be computed, the first because ' // self%axes%axis(i)%name // ' ' // &
                                          self%axes%axis(i)%slot%refusal(values(i)), 'use another mean or deviation')
                if (i > 0) return
            end if
            self%case = empty
            call make_case(swept%scene, self%case, found)
            if (planned .and. .not. found%any()) call make_plan(swept%scene, self%case, self%plan, found)
        end subroutine try_case

    end subroutine make_first_case

    !> The column of the values of an axis.
    type(column_t) function axis_column(self, i) result(column)
        class(job_t), intent(in) :: self
        integer, intent(in) :: i !! number of the axis
        associate (parameter => self%input%table%parameters(self%axes%place_of(i, self%input%table)))
            column = column_t(self%axes%axis(i)%name, self%axes%axis(i)%unit, parameter%what)
        end associate
    end function axis_column

    !> Adds a warning for the body of a later case, with the share of such cases: the first of all cases or, if there are very
    !> many, of a regular sample of them.
    subroutine warn_of_bodies(self, problems)
        class(job_t), target, intent(in) :: self
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        integer(int64), parameter :: most_looked_at = 1000000, most_counted = 1000
        type(case_scene_t), allocatable, target :: swept
        type(problems_t) :: of_case, of_other
        real(dp), parameter :: golden_section = (sqrt(5.0_dp) - 1) / 2
        integer(int64) :: number, i, counted, looked_at
        character(:), allocatable :: share

        if (.not. (self%axes%varies('top') .or. self%axes%varies('part'))) return
        allocate (swept)
        call swept%copy(self%input%scene, self%axes)
        do number = 1, self%axes%cases, max(1_int64, self%axes%cases / most_looked_at)
            call look_at(number, of_case)
            if (of_case%any_warning()) exit
        end do
        ! The warnings of the first case were reported when it was made.
        if (number > self%axes%cases .or. number == self%first) return
        counted = 0
        looked_at = min(self%axes%cases, most_counted)
        do i = 1, looked_at
            ! All cases, or a sample that no period of a grid can deceive.
            if (looked_at == self%axes%cases) then
                call look_at(i, of_other)
            else
                call look_at(1 + int(modulo(i * golden_section, 1.0_dp) * self%axes%cases, int64), of_other)
            end if
            if (of_other%any_warning()) counted = counted + 1
        end do
        share = to_text(counted) // ' of ' // to_text(looked_at)
        if (looked_at < self%axes%cases) share = 'about ' // to_text(nint(100 * real(counted, dp) / looked_at)) // ' % of the'
        call problems%add_warnings(of_case, 'case ' // to_text(number) // ': ', '; ' // share // ' cases')

    contains

        !> The problems of the body of a case; none if its values are out of range.
        subroutine look_at(number, found)
            integer(int64), intent(in) :: number
            type(problems_t), intent(out) :: found
            type(body_t) :: body
            associate (values => self%axes%values_of(number))
                if (self%axes%out_of_range(values) > 0) return
                call swept%set_values(values)
            end associate
            call make_body(swept%scene, body, found)
        end subroutine look_at

    end subroutine warn_of_bodies

    !> The header of a table of a job. A job with a plan has one model, method and body; otherwise each row has
    !> its own.
    function study_head(job, columns, remarks, part) result(head)
        type(job_t), intent(in) :: job !! the job
        class(column_t), intent(in) :: columns(:) !! columns of the table
        type(string_t), intent(in), optional :: remarks(:) !! lines after the columns
        character(*), intent(in), optional :: part !! first line of the table of a part; '' for the whole
        character(:), allocatable :: head, beginning, method, words
        type(fact_t) :: facts(fact_count)
        type(string_t), allocatable :: input(:)
        integer :: i

        beginning = ''
        if (present(part)) beginning = part
        if (allocated(job%plan%model) .and. job%axes%cases > 0) then
            method = job%plan%method
            do i = 1, size(job%axes%axis)
                associate (name => job%axes%axis(i)%name)
                    if (index(name, 'tolerance') > 0) method = method // ', in the first case; then that of the column ' // name
                end associate
            end do
            ! Nothing in the table of a sweep varies from run to run.
            call gather_facts(job%input%scene%title, job%plan%model, method, dated=.false., facts=facts)
        else if (allocated(job%plan%model)) then
            ! The mass properties in the axes in which they were given.
            associate (body => job%case%given_body)
                words = 'mass ' // to_text(body%mass) // ' kg; inertia ' // listed(body%inertia) // &
                        ' kg m^2 about the pivot; centre of mass ' // listed(body%centre_of_mass) // ' m'
                if (body%has_products()) words = words // '; elements 23, 31, 12 of the inertia tensor ' // &
                                                 listed(body%products) // ' kg m^2'
            end associate
            call gather_facts(job%input%scene%title, job%plan%model, job%plan%method, dated=.true., facts=facts, body=words)
        else
            call gather_facts(job%input%scene%title, 'those of the column formulation', 'those of the column method', &
                              dated=.true., facts=facts)
        end if
        call print_input(job, input)
        head = header_of(beginning, facts, input, columns, remarks)

    contains

        function listed(x) result(list)
            real(dp), intent(in) :: x(3)
            character(:), allocatable :: list
            list = to_text(x(1)) // ', ' // to_text(x(2)) // ', ' // to_text(x(3))
        end function listed

    end function study_head

    !> The resolved input, which can be run. Of the groups there are those that the kind of study reads, and those in which the
    !> input gives something.
    subroutine print_input(job, lines)
        type(job_t), intent(in) :: job !! the job
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        character(:), allocatable :: groups
        groups = given_groups(job%input%table) // '|' // groups_of_all // '|' // trim(job%input%scene%kind)
        if (job%has_case) groups = groups // '|' // groups_of_a_case
        call print_namelist(job%input%table, lines, groups)
    end subroutine print_input

    !> Checks that all ranks have the same build and input: their tables must have equal headers. All ranks call it.
    subroutine compare_with_writer(ranks, head, error)
        type(ranks_t), intent(in) :: ranks
        character(*), intent(in) :: head
        type(error_t), allocatable, intent(out) :: error
        character(:), allocatable :: head_of_writer, problem
        head_of_writer = head
        call ranks%broadcast(head_of_writer)
        problem = compare_heads(head_of_writer, 'rank 0', head, 'rank ' // to_text(ranks%number))
        if (problem /= '') error = input_error('the ranks have different builds or inputs' // problem)
        call ranks%agree(error)
    end subroutine compare_with_writer

end module spintop_job
