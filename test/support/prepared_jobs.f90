!> Jobs for suites: inputs of the folder `input`, with overrides, prepared as the program prepares them, and the rows of their
!> cases.
module prepared_jobs
    use texts_and_tables
    use spintop_job, only: job_t
    use spintop_study, only: options_t
    use spintop_preparation, only: prepare_jobs, prepared_t
    use spintop_sweep_worker, only: describe_table, sweep_worker_t
    implicit none
    private
    public :: prepare, quiet_options, compute_rows, prepare_rows, cell, differ, scratch_folder

    character(*), parameter :: scratch_folder = 'build/scratch/studies'

contains

    !> Options of a run that shows nothing, with its tables in the scratch folder.
    subroutine quiet_options(options)
        type(options_t), intent(out) :: options
        options%output = scratch_folder
        options%quiet = .true.
        allocate (options%overrides(0))
    end subroutine quiet_options

    !> Prepares input/NAME.nml; `message` is what is wrong, or ''. Without it nothing may be wrong.
    subroutine prepare(name, overrides, prepared, message)
        character(*), intent(in) :: name
        character(*), intent(in) :: overrides !! `group.key=value`, separated by semicolons
        type(prepared_t), allocatable, target, intent(inout) :: prepared(:)
        character(:), allocatable, intent(out), optional :: message
        type(options_t) :: options
        type(error_t), allocatable :: error

        if (allocated(prepared)) deallocate (prepared)
        call quiet_options(options)
        call split(overrides, ';', options%overrides)
        call prepare_jobs([string_of('input/' // name // '.nml')], options, prepared, error)
        if (present(message)) then
            message = ''
            if (allocated(error)) message = error%message
        else if (allocated(error)) then
            print '(a)', name // ' with ' // overrides // ': ' // error%message
            error stop 'prepared_jobs: an input that has to be without fault has one'
        end if

    contains

        function string_of(text) result(string)
            use spintop_text, only: string_t
            character(*), intent(in) :: text
            type(string_t) :: string
            string%text = text
        end function string_of

    end subroutine prepare

    !> Computes the cases of a job from `first` to `last`, if there are so many, in one block.
    subroutine compute_rows(job, first, last, rows)
        type(job_t), target, intent(in) :: job
        integer, intent(in) :: first, last
        type(row_block_t), intent(inout) :: rows
        type(sweep_worker_t), allocatable, target :: worker
        allocate (worker)
        call worker%prepare(job)
        call worker%compute_rows(job, int(first, int64), min(int(last, int64), job%axes%cases), rows)
    end subroutine compute_rows

    !> The same of an input, in which nothing may be wrong.
    subroutine prepare_rows(name, overrides, first, last, prepared, rows)
        character(*), intent(in) :: name, overrides
        integer, intent(in) :: first, last
        type(prepared_t), allocatable, target, intent(inout) :: prepared(:)
        type(row_block_t), intent(inout) :: rows
        call prepare(name, overrides, prepared)
        call compute_rows(prepared(1)%job, first, last, rows)
    end subroutine prepare_rows

    !> Whether two cells differ; what does not exist is not a number in both.
    elemental logical function differ(one, other)
        real(dp), intent(in) :: one, other
        differ = abs(one - other) > 0 .or. (ieee_is_nan(one) .neqv. ieee_is_nan(other))
    end function differ

    !> The cell of a column of the sweep of a job in the k-th row of a block.
    function cell(job, rows, column, k)
        type(job_t), intent(in) :: job
        type(row_block_t), intent(in) :: rows
        character(*), intent(in) :: column
        integer, intent(in) :: k
        real(dp) :: cell
        type(options_t) :: options
        class(row_table_t), allocatable :: table
        character(:), allocatable :: head
        integer :: i

        call quiet_options(options)
        call describe_table(job, options%shard, table, head)
        cell = huge(cell)
        do i = 1, size(table%columns)
            if (table%columns(i)%name == column) cell = rows%cells(i, k)
        end do
    end function cell

end module prepared_jobs
