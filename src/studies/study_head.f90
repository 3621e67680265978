!> The header of the dated table of a study: where it comes from, its input, and its columns.
module spintop_study_head
    use spintop_body, only: body_t
    use spintop_errors, only: error_t, input_error
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_parameter_print, only: given_groups, print_namelist
    use spintop_provenance, only: header_of, fact_count, fact_t, gather_facts
    use spintop_table_column, only: column_t
    use spintop_ranks, only: ranks_t
    use spintop_table_head, only: compare_heads
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: compare_with_writer, study_head, print_input

    !> Groups that every study reads, and those of a case, given or not.
    character(*), parameter :: groups_of_all = 'study|integration|output', groups_of_a_case = 'top|initial|span'

contains

    !> The header of a table of a job. A job with a plan has one model, method and body; otherwise each row has
    !> its own.
    function study_head(job, columns, remarks, part) result(head)
        type(job_t), intent(in) :: job !! the job
        class(column_t), intent(in) :: columns(:) !! columns of the table
        type(string_t), intent(in), optional :: remarks(:) !! lines after the columns
        character(*), intent(in), optional :: part !! first line of the table of a part; '' for the whole
        character(:), allocatable :: head, beginning
        type(fact_t) :: facts(fact_count)
        type(string_t), allocatable :: input(:)

        beginning = ''
        if (present(part)) beginning = part
        if (allocated(job%plan%model)) then
            call gather_facts(job%input%scene%title, job%plan%model, job%plan%method, dated=.true., facts=facts, &
                              body=body_in_words(job%case%given_body))
        else
            call gather_facts(job%input%scene%title, 'those of the column formulation', 'those of the column method', &
                              dated=.true., facts=facts)
        end if
        call print_input(job, input)
        head = header_of(beginning, facts, input, columns, remarks)
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

    !> The mass properties of a body, in the axes in which they were given.
    function body_in_words(body) result(text)
        type(body_t), intent(in) :: body
        character(:), allocatable :: text
        text = 'mass ' // to_text(body%mass) // ' kg; inertia ' // listed(body%inertia) // &
               ' kg m^2 about the pivot; centre of mass ' // listed(body%centre_of_mass) // ' m'
        if (body%has_products()) text = text // '; elements 23, 31, 12 of the inertia tensor ' // listed(body%products) // ' kg m^2'

    contains

        function listed(x) result(list)
            real(dp), intent(in) :: x(3)
            character(:), allocatable :: list
            list = to_text(x(1)) // ', ' // to_text(x(2)) // ', ' // to_text(x(3))
        end function listed

    end function body_in_words

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

end module spintop_study_head
