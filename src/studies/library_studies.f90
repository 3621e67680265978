!> Studies from a Fortran program: an input is run to its table.
module spintop_library_studies
    use spintop_errors, only: error_t
    use spintop_execution, only: run_job
    use spintop_options, only: options_t
    use spintop_preparation, only: prepare_jobs, prepared_t, protect_interrupted
    use spintop_text, only: string_t
    implicit none
    private
    public :: run_study

contains

    !> Runs an input, as the program does. Its table is written to a folder, which is made if missing.
    subroutine run_study(input, folder, table, error, overrides)
        character(*), intent(in) :: input !! path of the namelist
        character(*), intent(in) :: folder !! for the results
        character(:), allocatable, intent(out) :: table !! path of the table
        type(error_t), allocatable, intent(out) :: error !! the input is wrong, or a case failed, or a file
        type(string_t), intent(in), optional :: overrides(:) !! `group.key=value`, as --set takes them
        type(prepared_t), allocatable, target :: prepared(:)
        type(options_t) :: options
        type(string_t), allocatable :: summary(:)
        type(string_t) :: inputs(1)
        integer :: code

        table = ''
        inputs(1)%text = input
        options%output = folder
        options%command = 'spintop'
        options%quiet = .true.
        allocate (options%overrides(0))
        if (present(overrides)) options%overrides = overrides
        call prepare_jobs(inputs, options, prepared, error)
        if (.not. allocated(error)) call protect_interrupted(prepared, options, error)
        if (allocated(error)) return
        call run_job(prepared(1)%study, prepared(1)%job, options, summary, code, error)
        if (allocated(error)) return
        table = prepared(1)%job%files%table
        if (code /= 0) error = error_t(code, input // ': some cases failed; their rows have the status')
    end subroutine run_study

end module spintop_library_studies
