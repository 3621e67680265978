!> The study of published benchmarks as a kind of study.
module spintop_benchmark_study
    use spintop_benchmark, only: run_benchmarks
    use spintop_benchmark_cases, only: benchmarks
    use spintop_benchmark_columns, only: benchmark_columns
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t, exit_failed, exit_ok
    use spintop_job, only: job_t
    use spintop_method_choice, only: refuse_name
    use spintop_options, only: options_t
    use spintop_problems, only: problems_t
    use spintop_scene_words, only: kind_benchmark, study_kinds
    use spintop_study, only: study_info_t, study_t
    use spintop_study_column, only: listed_column_t
    use spintop_summary, only: summary_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: benchmark_study_t

    !> Published benchmarks and their figures.
    type, extends(study_t) :: benchmark_study_t
        private
        !> Indices in the catalogue.
        integer, allocatable :: chosen(:)
    contains
        procedure, nopass :: info
        procedure, nopass :: columns
        procedure :: cases
        procedure :: check
        procedure :: explain
        procedure :: run
    end type benchmark_study_t

contains

    !> Properties of studies of benchmarks.
    function info()
        type(study_info_t) :: info
        info = study_info_t(trim(study_kinds(kind_benchmark)), 'a study of benchmarks', 'studies of benchmarks', '', &
                            'published benchmark tops: true values, and the errors of the published figures', &
                            has_parts=.true., has_case=.false.)
    end function info

    !> All columns.
    function columns()
        type(listed_column_t), allocatable :: columns(:)
        allocate (columns, source=benchmark_columns())
    end function columns

    !> Number of benchmarks.
    integer(int64) function cases(self, job)
        class(benchmark_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        associate (unused => job)
        end associate
        cases = size(self%chosen)
    end function cases

    !> Finds the benchmarks.
    subroutine check(self, job, problems, diagnostics)
        class(benchmark_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        integer :: i, place

        associate (unused => diagnostics, names => job%scene%benchmark_cases)
            self%chosen = [(i, i=1, size(benchmarks))]
            if (all(names == '')) return
            self%chosen = [integer ::]
            do i = 1, size(names)
                if (names(i) == '') cycle
                place = findloc(benchmarks%name == names(i), .true., dim=1)
                if (place == 0) then
                    call refuse_name('benchmark.cases(' // to_text(i) // ')', 'benchmark', trim(names(i)), &
                                     benchmarks%name, problems)
                end if
                self%chosen = [self%chosen, place]
            end do
        end associate
    end subroutine check

    !> Number of benchmarks.
    function explain(self, job) result(phrase)
        class(benchmark_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: phrase
        associate (unused => job)
        end associate
        phrase = 'the figures of ' // to_text(size(self%chosen)) // ' published benchmarks'
    end function explain

    !> Runs all benchmarks; the study fails if one has no reference.
    subroutine run(self, job, options, summary, code, error)
        class(benchmark_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer :: failures

        call run_benchmarks(job, self%chosen, options, summary, failures, error)
        code = merge(exit_failed, exit_ok, failures > 0)
    end subroutine run

end module spintop_benchmark_study
