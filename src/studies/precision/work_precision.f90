!> The work-precision study: what each method costs at each accuracy, on one's own case and machine.
!>
!> Every method runs the case with each of its settings; the motion is compared with a reference at
!> equally spaced times, and the run to the end of the span is timed without those comparisons. Rows are
!> sorted by time. Swept parameters make many problems of one input.
module spintop_work_precision
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t, make_case
    use spintop_clock, only: seconds
    use spintop_errors, only: error_t
    use spintop_formulation, only: structure_quadruple
    use spintop_job, only: job_t, options_t
    use spintop_kinds, only: dp
    use spintop_number_slot, only: number_slot_t
    use spintop_parameter_print, only: print_namelist
    use spintop_parameters, only: parameter_table_t
    use spintop_plan, only: plan_t, make_plan
    use spintop_precision_plan, only: set_setting
    use spintop_precision_summary, only: auto_tally_t, summarize_problem
    use spintop_precision_table, only: mark_front, precision_columns, precision_row_t, put_row, sort_rows
    use spintop_problems, only: problems_t
    use spintop_progress, only: progress_t
    use spintop_provenance, only: describe_provenance, fact_count, fact_t, gather_facts
    use spintop_reference_motion, only: check_reference, find_reference, reference_t
    use spintop_scene, only: scene_t, describe_scene
    use spintop_status, only: status_meaning, status_ok
    use spintop_summary, only: summary_t, rounded
    use spintop_sweep_axes, only: put_values
    use spintop_table_file, only: table_file_t
    use spintop_table_head, only: table_head
    use spintop_text, only: string_t, to_text
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trial, only: run_trial
    use spintop_trial_time, only: time_trial
    implicit none
    private
    public :: run_work_precision

    !> Problems of one input that the summary tells about one by one; and of which it tells what went wrong.
    integer, parameter :: most_told = 4

contains

    !> Runs the study and writes its table; `failures` tells how many problems have no rows.
    subroutine run_work_precision(job, options, summary, failures, error)
        type(job_t), target, intent(inout) :: job
        type(options_t), intent(in) :: options
        type(summary_t), intent(out) :: summary
        integer, intent(out) :: failures
        type(error_t), allocatable, intent(out) :: error
        type(scene_t), allocatable, target :: scene
        type(parameter_table_t) :: table
        type(number_slot_t), allocatable :: slots(:)
        type(table_file_t) :: file
        type(progress_t) :: progress
        type(auto_tally_t) :: tally
        real(dp), allocatable :: values(:)
        real(dp) :: began
        integer(int64) :: k, trials
        integer :: rows

        began = seconds()
        failures = 0
        rows = 0
        call begin_table(job, file, error)
        if (allocated(error)) return
        allocate (scene, source=job%scene)
        call describe_scene(scene, table)
        allocate (slots, source=job%axes%slots_in(table))
        allocate (values(size(slots)))
        trials = sum(job%precision%settings(job%precision%choices))
        call progress%start(job%name, 'trials', trials * max(1_int64, job%axes%cases), options%quiet, options%progress)
        call summary%headline('')
        do k = 1, max(1_int64, job%axes%cases)
            if (size(slots) > 0) values = job%axes%values_of(k)
            call put_values(slots, values)
            call run_problem(job, scene, name_of_problem(job, k), values, trials * (k - 1), file, progress, rows, &
                             failures, tally, summary, error)
            if (allocated(error)) exit
        end do
        call progress%finish()
        call tally%summarize(summary)
        if (.not. allocated(error)) call file%finish(in_words(summary), error)
        if (allocated(error)) then
            call file%discard()
            deallocate (summary%lines)
            return
        end if
        summary%lines(1)%text = job%input // ': work-precision study, ' // to_text(rows) // ' rows -> ' // job%output
        call summary%add('time', rounded(seconds() - began) // ' s')
    end subroutine run_work_precision

    !> The lines of a summary below its headline, for the end of the table.
    function in_words(summary) result(lines)
        type(summary_t), intent(in) :: summary
        type(string_t), allocatable :: lines(:)
        integer :: i
        allocate (lines(size(summary%lines) - 1))
        do i = 1, size(lines)
            lines(i)%text = 'in words: ' // summary%sentence(i + 1)
        end do
    end function in_words

    !> Starts the table.
    subroutine begin_table(job, file, error)
        type(job_t), intent(in) :: job
        type(table_file_t), intent(inout) :: file
        type(error_t), allocatable, intent(out) :: error
        type(fact_t) :: facts(fact_count)
        type(string_t), allocatable :: input(:), header(:)
        character(64), allocatable :: names(:)
        character(16), allocatable :: units(:)
        character(160), allocatable :: meanings(:)
        integer :: i

        allocate (names, source=[character(64) :: precision_columns%name])
        allocate (units, source=[character(16) :: precision_columns%unit])
        allocate (meanings, source=[character(160) :: precision_columns%what])
        do i = 1, size(job%axes%axis)
            associate (parameter => job%table%parameters(job%axes%place_of(i, job%table)))
                names = [character(64) :: names, job%axes%axis(i)%name]
                units = [character(16) :: units, parameter%unit]
                meanings = [character(160) :: meanings, parameter%what]
            end associate
        end do
        call print_namelist(job%table, input)
        call gather_facts(job%scene%title, 'those of the column formulation', 'those of the column method', &
                          dated=.true., facts=facts)
        call describe_provenance(facts, input, names, units, meanings, header)
        call file%create(job%output, table_head(header, names), error)
    end subroutine begin_table

    !> The input, and the number of its case where there are more.
    function name_of_problem(job, k) result(name)
        type(job_t), intent(in) :: job
        integer(int64), intent(in) :: k
        character(:), allocatable :: name
        name = job%name
        if (job%axes%cases > 0) name = name // '.' // to_text(k)
    end function name_of_problem

    !> All methods on the problem of a scene.
    subroutine run_problem(job, scene, name, values, done, file, progress, rows, failures, tally, &
                           summary, error)
        type(job_t), intent(in) :: job
        type(scene_t), intent(in) :: scene
        character(*), intent(in) :: name
        real(dp), intent(in) :: values(:) !! of the swept parameters
        integer(int64), intent(in) :: done !! trials before
        type(table_file_t), intent(inout) :: file
        type(progress_t), intent(inout) :: progress
        integer, intent(inout) :: rows, failures
        type(auto_tally_t), intent(inout) :: tally
        type(summary_t), intent(inout) :: summary
        type(error_t), allocatable, intent(out) :: error
        type(case_t) :: case
        type(reference_t) :: reference
        type(precision_row_t), allocatable :: results(:)
        type(problems_t) :: problems
        type(text_buffer_t) :: text
        integer :: i, status

        call make_case(scene, case, problems)
        if (problems%any()) then
            call give_up('is left out: ' // problems%first())
            return
        end if
        call take_reference(job, scene, case, reference, status)
        if (status /= status_ok) then
            call give_up('has no reference: ' // status_meaning(status))
            return
        end if
        call run_methods(job, scene, case, reference, done, progress, results, summary)
        if (size(results) == 0) then
            call give_up('has no rows: every method is left out')
            return
        end if
        call sort_rows(results)
        call mark_front(results)
        do i = 1, size(results)
            call put_row(name, results(i), reference, values, text)
        end do
        call file%put(text%contents(), error)
        rows = rows + size(results)
        call tally%compare(name, results)
        if (job%axes%cases <= most_told) call summarize_problem(name, results, reference, summary)

    contains

        !> The problem has no rows.
        subroutine give_up(why)
            character(*), intent(in) :: why
            failures = failures + 1
            if (failures <= most_told) call summary%add('problem', name // ' ' // why)
        end subroutine give_up

    end subroutine run_problem

    !> What the motions of a case are compared with.
    subroutine take_reference(job, scene, case, reference, status)
        type(job_t), intent(in) :: job
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(reference_t), intent(out) :: reference
        integer, intent(out) :: status
        if (allocated(job%precision%stored)) then
            reference = job%precision%stored
            status = status_ok
        else
            call find_reference(case, job%precision%samples, job%precision%reference, &
                                int(scene%max_steps, int64), reference, status)
        end if
        if (status == status_ok) call check_reference(case, int(scene%max_steps, int64), reference)
    end subroutine take_reference

    !> A row for each method and setting.
    subroutine run_methods(job, scene, case, reference, done, progress, rows, summary)
        type(job_t), intent(in) :: job
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(reference_t), intent(in) :: reference
        integer(int64), intent(in) :: done
        type(progress_t), intent(inout) :: progress
        type(precision_row_t), allocatable, intent(out) :: rows(:)
        type(summary_t), intent(inout) :: summary
        character(40) :: tried(size(job%precision%choices))
        type(precision_row_t) :: row
        character(:), allocatable :: refusal, last_refusal
        integer(int64) :: tries
        integer :: i, k, n

        associate (plan => job%precision)
            allocate (rows(sum(plan%settings(plan%choices))))
            n = 0
            tries = 0
            tried = ''
            do i = 1, size(plan%choices)
                last_refusal = ''
                do k = 1, plan%settings(plan%choices(i))
                    tries = tries + 1
                    call run_setting(job, scene, case, reference, i, k, tried, row, refusal)
                    if (refusal == '') then
                        n = n + 1
                        rows(n) = row
                    else if (refusal /= last_refusal .and. done == 0) then
                        call summary%add('left out', refusal)
                    end if
                    last_refusal = refusal
                    call progress%update(done + tries)
                end do
            end do
        end associate
        rows = rows(:n)
    end subroutine run_methods

    !> One method with one setting, or why there is no such row.
    subroutine run_setting(job, scene, case, reference, i, k, tried, row, refusal)
        type(job_t), intent(in) :: job
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(reference_t), intent(in) :: reference
        integer, intent(in) :: i, k !! numbers of the method and of its setting
        character(*), intent(inout) :: tried(:) !! methods with their formulations
        type(precision_row_t), intent(out) :: row
        character(:), allocatable, intent(out) :: refusal
        type(scene_t), allocatable :: trial_scene
        type(problems_t) :: problems
        type(plan_t) :: plan

        refusal = ''
        allocate (trial_scene, source=scene)
        associate (choice => job%precision%choices(i))
            call set_setting(job%precision, choice, k, trial_scene)
            call make_plan(trial_scene, case, plan, problems)
            row%method = choice%method%name
            row%formulation = choice%formulation
            row%is_stepped = .not. plan%exact
            if (plan%exact) row%formulation = 'closed_form'
            if (allocated(plan%formulation)) row%formulation = plan%model(:index(plan%model, ':') - 1)
            tried(i) = trim(row%method) // '/' // row%formulation
            if (problems%any()) then
                refusal = trim(tried(i)) // ': ' // problems%first()
            else if (any(tried(:i - 1) == tried(i))) then
                refusal = trim(tried(i)) // ': is there already'
            else if (reference%is_computed .and. choice%method%needs == structure_quadruple) then
                refusal = trim(tried(i)) // ': is the reference'
            else if (plan%exact .and. reference%source == 'exact motion') then
                refusal = trim(tried(i)) // ": is the reference; reference = 'quadruple' measures it"
            end if
            if (refusal /= '') return
            row%setting = job%precision%setting_text(choice, k)
            row%is_auto = is_auto(trial_scene, case, plan, job%precision%formulation())
        end associate
        call run_trial(case, plan, reference, row%trial)
        row%time = row%trial%time
        ! Without the dense output for comparisons, in what is counted as in what is timed.
        if (row%trial%status == status_ok) call time_trial(case, plan, row%trial%time, job%precision%repeats, row%time, &
                                                           row%trial%counts)
    end subroutine run_setting

    !> Whether a plan is what would be chosen for the tolerance of a scene under a formulation (or auto).
    logical function is_auto(scene, case, plan, formulation)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(plan_t), intent(in) :: plan
        character(*), intent(in) :: formulation
        type(scene_t), allocatable :: free_scene
        type(plan_t) :: free_plan
        type(problems_t) :: problems

        is_auto = plan%is_adaptive()
        if (.not. is_auto) return
        allocate (free_scene, source=scene)
        free_scene%method = 'auto'
        free_scene%formulation = formulation
        call make_plan(free_scene, case, free_plan, problems)
        is_auto = free_plan%model == plan%model
        if (is_auto .and. allocated(plan%stepper)) is_auto = free_plan%stepper%info%name == plan%stepper%info%name
    end function is_auto

end module spintop_work_precision
