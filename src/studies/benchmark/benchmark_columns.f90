!> The columns of a table of benchmarks, and its rows. The help and the header derive from the list of columns.
module spintop_benchmark_columns
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, no_number
    use spintop_study_column, only: listed_column_t
    use spintop_text_buffer, only: text_buffer_t
    implicit none
    private
    public :: benchmark_row_t, benchmark_columns, add_row

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

    !> All columns, in the order of the table.
    type(listed_column_t), parameter :: benchmark_columns(*) = [ &
        listed_column_t('benchmark', '', 'benchmark of the catalogue', 'benchmark', words=.true.), &
        listed_column_t('quantity', '', 'column of trajectories at the end of the span', 'benchmark', words=.true.), &
        listed_column_t('t', 's', 'end of the span', 'benchmark'), &
        listed_column_t('truth', '', 'true value, in the unit of that column', 'truth'), &
        listed_column_t('truth_error', '', 'difference of two computations of it', 'truth'), &
        listed_column_t('reference', '', 'how it was computed', 'truth', words=.true.), &
        listed_column_t('published', '', 'published figure (nan: none)', 'published'), &
        listed_column_t('published_error', '', 'its difference from the true value', 'published'), &
        listed_column_t('published_method', '', 'who published it, with which method', 'published', words=.true.), &
        listed_column_t('goal', '', 'a hundredth of that difference, over max(1, true value); 1e-10 without a figure', 'best'), &
        listed_column_t('method', '', 'fastest method whose errors are within the goal', 'best', words=.true.), &
        listed_column_t('formulation', '', 'its formulation', 'best', words=.true.), &
        listed_column_t('setting', '', 'its setting', 'best', words=.true.), &
        listed_column_t('value', '', 'its value', 'best'), &
        listed_column_t('error', '', 'its largest error of all quantities of the benchmark, over max(1, true value)', &
                        'best'), &
        listed_column_t('evaluations', '', 'its RHS evaluations', 'best'), &
        listed_column_t('time_s', 's', 'its computing time', 'best'), &
        listed_column_t('source', '', 'where the benchmark was published', 'benchmark', words=.true.)]

contains

    !> Adds a row, a cell per column.
    subroutine add_row(row, cells)
        type(benchmark_row_t), intent(in) :: row !! the row
        type(text_buffer_t), intent(inout) :: cells !! the row is appended
        call cells%add_text(row%benchmark)
        call cells%add_text(row%quantity)
        call cells%add_reals([row%t, row%truth, row%truth_error])
        call cells%add_text(row%reference)
        call cells%add_reals([row%published, abs(row%published - row%truth)])
        call cells%add_text(row%published_method)
        call cells%add_reals([row%goal])
        call cells%add_text(row%method)
        call cells%add_text(row%formulation)
        call cells%add_text(row%setting)
        call cells%add_reals([row%value, row%error])
        call cells%add_integer(row%evaluations)
        call cells%add_reals([row%time])
        call cells%add_text(row%source)
        call cells%end_row()
    end subroutine add_row

end module spintop_benchmark_columns
