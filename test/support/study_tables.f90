!> Studies for suites: an input of the folder `input` is run with overrides, and its table is read back.
module study_tables
    use spintop_errors, only: error_t
    use spintop_files, only: make_folder, read_file
    use spintop_kinds, only: dp
    use spintop_loaded_table, only: read_table, table_t
    use spintop_study, only: options_t
    use spintop_study_column, only: place_of, study_column_t
    use spintop_preparation, only: prepared_t
    use spintop_summary, only: summary_t
    use spintop_text, only: string_t
    use prepared_jobs, only: prepare, quiet_options, scratch_folder
    implicit none
    private
    public :: study_result_t, run_input, cell_in

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

end module study_tables
