!> Jobs for suites: inputs of the folder `input`, with overrides, prepared as the program prepares them.
module prepared_jobs
    use spintop_errors, only: error_t
    use spintop_kinds, only: dp
    use spintop_job, only: job_t
    use spintop_options, only: options_t
    use spintop_preparation, only: prepare_jobs, prepared_t
    use spintop_row_block, only: row_block_t
    use spintop_row_table, only: row_table_t
    use spintop_sweep_table, only: describe_table
    use spintop_text, only: split
    implicit none
    private
    public :: prepare, quiet_options, cell, scratch_folder

    character(*), parameter :: scratch_folder = 'build/scratch/studies'

contains

    !> Options of a run that shows nothing, with its tables in the scratch folder.
    subroutine quiet_options(options)
        type(options_t), intent(out) :: options
        options%output = scratch_folder
        options%quiet = .true.
        allocate (options%overrides(0))
    end subroutine quiet_options

    !> Prepares input/NAME.nml; `message` is what is wrong, or ''.
    subroutine prepare(name, overrides, prepared, message)
        character(*), intent(in) :: name
        character(*), intent(in) :: overrides !! `group.key=value`, separated by semicolons
        type(prepared_t), allocatable, target, intent(inout) :: prepared(:)
        character(:), allocatable, intent(out) :: message
        type(options_t) :: options
        type(error_t), allocatable :: error

        if (allocated(prepared)) deallocate (prepared)
        call quiet_options(options)
        call split(overrides, ';', options%overrides)
        call prepare_jobs([string_of('input/' // name // '.nml')], options, prepared, error)
        message = ''
        if (allocated(error)) message = error%message

    contains

        function string_of(text) result(string)
            use spintop_text, only: string_t
            character(*), intent(in) :: text
            type(string_t) :: string
            string%text = text
        end function string_of

    end subroutine prepare

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
