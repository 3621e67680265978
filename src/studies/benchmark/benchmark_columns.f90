!> The columns of a table of benchmarks: a line of the registry and a procedure each. The help, the units in the header
!> and the cells derive from it.
module spintop_benchmark_columns
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, no_number
    use spintop_study_column, only: study_column_t
    use spintop_text_buffer, only: text_buffer_t
    implicit none
    private
    public :: benchmark_column_t, benchmark_row_t, benchmark_columns, put_row

    !> A quantity of a benchmark: what the cells of a row are made of.
    type :: benchmark_row_t
        character(24) :: benchmark = '', quantity = '', reference = ''
        character(192) :: source = ''
        character(112) :: published_method = ''
        !> The end of the span, s.
        real(dp) :: t = no_number
        real(dp) :: published = no_number
        !> The true value, and the difference of two computations of it.
        real(dp) :: truth = no_number, truth_error = no_number
        !> The error that is allowed for, and the cheapest setting that satisfies it.
        real(dp) :: goal = no_number
        character(20) :: method = ''
        character(16) :: formulation = ''
        character(24) :: setting = ''
        !> Its value and its largest error among the quantities of the benchmark, its evaluations and its time, s.
        real(dp) :: value = no_number, error = no_number
        integer(int64) :: evaluations = 0
        real(dp) :: time = no_number
    end type benchmark_row_t

    !> A column of a table of benchmarks.
    type, extends(study_column_t) :: benchmark_column_t
        !> Adds the cell of the column to those of a row.
        procedure(put_i), pointer, nopass :: put => null()
        !> Its cells are words, not numbers.
        logical :: words = .false.
    end type benchmark_column_t

    abstract interface
        !> Adds a cell of a row.
        subroutine put_i(row, cells)
            import :: benchmark_row_t, text_buffer_t
            implicit none
            type(benchmark_row_t), intent(in) :: row
            type(text_buffer_t), intent(inout) :: cells
        end subroutine put_i
    end interface

contains

    !> All columns, in the order of the table.
    function benchmark_columns() result(columns)
        type(benchmark_column_t), allocatable :: columns(:)
        columns = [ &
            benchmark_column_t('benchmark', '', 'benchmark of the catalogue', 'benchmark', put_benchmark, words=.true.), &
            benchmark_column_t('quantity', '', 'column of trajectories at the end of the span', &
                               'benchmark', put_quantity, words=.true.), &
            benchmark_column_t('t', 's', 'end of the span', 'benchmark', put_t), &
            benchmark_column_t('truth', '', 'true value, in the unit of that column', 'truth', put_truth), &
            benchmark_column_t('truth_error', '', 'difference of two computations of it', 'truth', put_truth_error), &
            benchmark_column_t('reference', '', 'how it was computed', 'truth', put_reference, words=.true.), &
            benchmark_column_t('published', '', 'published figure (nan: none)', 'published', put_published), &
            benchmark_column_t('published_error', '', 'its difference from the true value', 'published', put_published_error), &
            benchmark_column_t('published_method', '', 'who published it, with which method', &
                               'published', put_published_method, words=.true.), &
            benchmark_column_t('goal', '', 'a hundredth of that difference; 1e-10 without a figure', 'best', put_goal), &
            benchmark_column_t('method', '', 'fastest method whose errors are within the goal', 'best', put_method, words=.true.), &
            benchmark_column_t('formulation', '', 'its formulation', 'best', put_formulation, words=.true.), &
            benchmark_column_t('setting', '', 'its setting', 'best', put_setting, words=.true.), &
            benchmark_column_t('value', '', 'its value', 'best', put_value), &
            benchmark_column_t('error', '', 'its largest error of all quantities of the benchmark, over max(1, true value)', &
                               'best', put_error), &
            benchmark_column_t('evaluations', '', 'its RHS evaluations', 'best', put_evaluations), &
            benchmark_column_t('time_s', 's', 'its computing time', 'best', put_time_s), &
            benchmark_column_t('source', '', 'where the benchmark was published', 'benchmark', put_source, words=.true.)]
    end function benchmark_columns

    !> Adds a row of all columns.
    subroutine put_row(row, cells)
        type(benchmark_row_t), intent(in) :: row !! the row
        type(text_buffer_t), intent(inout) :: cells !! the row is appended
        type(benchmark_column_t), allocatable :: columns(:)
        integer :: i
        allocate (columns, source=benchmark_columns())
        do i = 1, size(columns)
            call columns(i)%put(row, cells)
        end do
        call cells%end_row()
    end subroutine put_row

    subroutine put_benchmark(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%benchmark)
    end subroutine put_benchmark

    subroutine put_quantity(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%quantity)
    end subroutine put_quantity

    subroutine put_t(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%t])
    end subroutine put_t

    subroutine put_truth(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%truth])
    end subroutine put_truth

    subroutine put_truth_error(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%truth_error])
    end subroutine put_truth_error

    subroutine put_reference(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%reference)
    end subroutine put_reference

    subroutine put_published(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%published])
    end subroutine put_published

    subroutine put_published_error(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([abs(row%published - row%truth)])
    end subroutine put_published_error

    subroutine put_published_method(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%published_method)
    end subroutine put_published_method

    subroutine put_goal(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%goal])
    end subroutine put_goal

    subroutine put_method(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%method)
    end subroutine put_method

    subroutine put_formulation(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%formulation)
    end subroutine put_formulation

    subroutine put_setting(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%setting)
    end subroutine put_setting

    subroutine put_value(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%value])
    end subroutine put_value

    subroutine put_error(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%error])
    end subroutine put_error

    subroutine put_evaluations(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_integer(row%evaluations)
    end subroutine put_evaluations

    subroutine put_time_s(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_reals([row%time])
    end subroutine put_time_s

    subroutine put_source(row, cells)
        type(benchmark_row_t), intent(in) :: row
        type(text_buffer_t), intent(inout) :: cells
        call cells%put_text(row%source)
    end subroutine put_source

end module spintop_benchmark_columns
