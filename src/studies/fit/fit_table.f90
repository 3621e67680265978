!> The tables of a fit: the sought parameters with their uncertainty, and the residuals.
module spintop_fit_table
    use spintop_compare, only: is_finite
    use spintop_errors, only: error_t
    use spintop_fit_data, only: measurements_t
    use spintop_intervals, only: estimate_t
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, no_number
    use spintop_sensitivity, only: sensitive_key_t
    use spintop_study_column, only: categorical, column => study_column_t
    use spintop_study_head, only: study_head
    use spintop_table_column, only: column_t
    use spintop_table_file, only: stem_of, table_file_t
    use spintop_text, only: append, string_t
    use spintop_text_buffer, only: text_buffer_t
    implicit none
    private
    public :: write_estimates, write_residuals, residual_path, fit_columns

    !> The columns of the table of parameters, before those of the covariance.
    type(column), parameter :: fit_columns(*) = [ &
        column('parameter', '', 'sought parameter of the input', 'fit', traits=categorical), &
        column('unit', '', 'its unit, which is that of the next five columns', 'fit', traits=categorical), &
        column('estimate', '', 'value with the least sum of squares', 'fit'), &
        column('standard_error', '', 'standard error of the estimate, by the linear model', 'fit'), &
        column('lower', '', 'lower end of the 95 % profile interval', 'fit'), &
        column('upper', '', 'upper end of the 95 % profile interval', 'fit'), &
        column('start', '', 'value of the input, where the search began', 'fit'), &
        column('singular_value', '', 'singular values of the scaled Jacobian, from the largest: one per row', &
                        'fit')]

contains

    !> Path of the table of residuals.
    function residual_path(path) result(other)
        character(*), intent(in) :: path !! path of the table of parameters
        character(:), allocatable :: other
        other = stem_of(path) // '.residuals.csv'
    end function residual_path

    !> Writes the table of the parameters.
    subroutine write_estimates(job, keys, start, estimate, warnings, ending, error)
        type(job_t), intent(in) :: job !! the job
        type(sensitive_key_t), intent(in) :: keys(:) !! the parameters
        real(dp), intent(in) :: start(:) !! their values in the input
        type(estimate_t), intent(in) :: estimate !! their values and uncertainty
        type(string_t), intent(in) :: warnings(:) !! what is odd about the fit
        character(*), intent(in) :: ending !! how the search ended
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(column_t), allocatable :: columns(:)
        type(table_file_t) :: file
        type(text_buffer_t) :: cells
        type(string_t), allocatable :: trailer(:)
        integer :: i, n

        n = size(fit_columns)
        allocate (columns(n + size(keys)))
        columns(:n) = fit_columns%column_t
        do i = 1, size(keys)
            columns(n + i) = column_t('covariance__' // keys(i)%name, '', 'covariance with ' // keys(i)%name)
        end do
        do i = 1, size(warnings)
            call append(trailer, 'warning: ' // warnings(i)%text)
        end do
        call append(trailer, 'status: ' // ending)
        call file%create(job%files%table, study_head(job, columns), error)
        if (allocated(error)) return
        do i = 1, size(keys)
            call cells%clear()
            call cells%add_name(keys(i)%name)
            call cells%add_text(keys(i)%unit)
            call cells%add_reals([estimate%x(i), estimate%standard_error(i), estimate%lower(i), estimate%upper(i), start(i), &
                                  estimate%singular_values(i), estimate%covariance(i, :)])
            call cells%end_row()
            call file%append(cells%contents(), error)
            if (allocated(error)) exit
        end do
        if (.not. allocated(error)) call file%finish(trailer, error)
        if (allocated(error)) call file%discard()
    end subroutine write_estimates

    !> Writes the table of residuals: the measurements, the values of the fitted motion, and their differences.
    subroutine write_residuals(job, measured, values, differences, ending, error)
        type(job_t), intent(in) :: job !! the job
        type(measurements_t), intent(in) :: measured !! the measurements
        real(dp), intent(in) :: values(:, :) !! the readings of the fitted motion
        real(dp), intent(in) :: differences(:, :) !! measured less fitted
        character(*), intent(in) :: ending !! how the search ended
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(column_t), allocatable :: columns(:)
        type(table_file_t) :: file
        type(string_t) :: trailer(1)
        integer :: i

        allocate (columns(1 + 3 * size(measured%columns)))
        columns(1) = column_t(measured%time%name, measured%time%unit, 'time')
        do i = 1, size(measured%columns)
            associate (own => measured%columns(i))
                columns(3 * i - 1) = column_t(own%name, own%unit, 'measured: ' // trim(own%what))
                columns(3 * i) = column_t(trim(own%name) // '_fit', own%unit, trim(own%name) // ' of the fitted motion')
                columns(3 * i + 1) = column_t(trim(own%name) // '_residual', own%unit, 'measured less fitted')
            end associate
        end do
        trailer(1)%text = 'status: ' // ending
        call file%create(residual_path(job%files%table), study_head(job, columns), error)
        if (allocated(error)) return
        do i = 1, size(measured%t)
            call file%add_row([measured%given_times(i), cells_of(measured%values(:, i), values(:, i), differences(:, i))], error)
            if (allocated(error)) exit
        end do
        if (.not. allocated(error)) call file%finish(trailer, error)
        if (allocated(error)) call file%discard()
    end subroutine write_residuals

    !> The cells of the columns at a time; where there is no reading there is no residual.
    pure function cells_of(measured, fitted, difference) result(cells)
        real(dp), intent(in) :: measured(:), fitted(:), difference(:)
        real(dp) :: cells(3 * size(measured))
        cells(1::3) = measured
        cells(2::3) = fitted
        cells(3::3) = merge(difference, no_number, is_finite(measured))
    end function cells_of

end module spintop_fit_table
