!> Jobs for suites: inputs of the folder `input`, with overrides, prepared as the program prepares them, and the rows of their
!> cases; or run as studies, whose tables are read back.
module prepared_jobs
    use texts_and_tables
    use spintop_job, only: job_t
    use spintop_loaded_table, only: read_table, table_t
    use spintop_study, only: options_t
    use spintop_study_column, only: place_of, study_column_t
    use spintop_preparation, only: prepare_jobs, prepared_t
    use spintop_summary, only: summary_t
    use spintop_sweep_worker, only: describe_table, sweep_worker_t
    implicit none
    private
    public :: prepare, quiet_options, compute_rows, prepare_rows, cell, differ, scratch_folder
    public :: study_result_t, run_input, cell_in

    character(*), parameter :: scratch_folder = 'build/scratch/studies'

    !> The result of a study.
    type :: study_result_t
        !> The error message of the input, the run or the table, or ''.
        character(:), allocatable :: message
        !> The exit code of the run, or that of the error.
        integer :: code = -1
        type(table_t) :: table
        !> The lines of the summary, and the bytes of the table, each as one text.
        character(:), allocatable :: summary, text
    contains
        procedure :: numbers
        procedure :: word
        procedure :: rows
    end type study_result_t

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

    !> Runs input/NAME.nml.
    subroutine run_input(name, overrides, result)
        character(*), intent(in) :: name
        character(*), intent(in) :: overrides !! `group.key=value`, separated by semicolons
        type(study_result_t), intent(out) :: result
        type(prepared_t), allocatable, target :: prepared(:)
        type(options_t) :: options
        type(summary_t) :: summary
        type(error_t), allocatable :: error
        integer :: i

        result%summary = ''
        result%text = ''
        call quiet_options(options)
        call make_folder(scratch_folder, error)
        call prepare(name, overrides, prepared, result%message)
        if (result%message /= '') return
        call prepared(1)%study%run(prepared(1)%job, options, summary, result%code, error)
        if (.not. allocated(error)) call read_table(prepared(1)%job%files%table, result%table, error)
        if (.not. allocated(error)) call read_file(prepared(1)%job%files%table, 2**30, result%text, error)
        if (allocated(error)) then
            result%message = error%message
            result%code = error%code
        end if
        if (.not. allocated(summary%lines)) return
        do i = 1, size(summary%lines)
            result%summary = result%summary // summary%lines(i)%text // new_line('a')
        end do
    end subroutine run_input

    !> The cell of a column in a line of a table, which has a cell for each; '(no row)' otherwise.
    function cell_in(line, columns, name) result(cell)
        character(*), intent(in) :: line, name
        type(study_column_t), intent(in) :: columns(:)
        character(:), allocatable :: cell
        integer :: i
        cell = '(no row)'
        if (count([(line(i:i) == ',', i=1, len(line))]) /= size(columns) - 1) return
        cell = line
        do i = 2, place_of(columns, name)
            cell = cell(index(cell, ',') + 1:)
        end do
        cell = cell(:scan(cell, ',' // new_line('a')) - 1)
    end function cell_in

    !> The numbers of a column.
    function numbers(self, column) result(values)
        class(study_result_t), intent(in) :: self
        character(*), intent(in) :: column
        real(dp), allocatable :: values(:)
        type(error_t), allocatable :: error
        call self%table%read_column(column, values, error)
        if (allocated(error)) values = -huge(1.0_dp)
    end function numbers

    !> A cell of a row as text.
    function word(self, column, row) result(text)
        class(study_result_t), intent(in) :: self
        character(*), intent(in) :: column
        integer, intent(in) :: row
        character(:), allocatable :: text
        type(string_t), allocatable :: cells(:)
        allocate (cells, source=self%table%words(column))
        text = '(no such cell)'
        if (row >= 1 .and. row <= size(cells)) text = cells(row)%text
    end function word

    !> The number of rows.
    pure integer function rows(self)
        class(study_result_t), intent(in) :: self
        rows = self%table%rows
    end function rows

end module prepared_jobs
