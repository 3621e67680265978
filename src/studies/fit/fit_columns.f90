!> The columns of the table of a fit.
module spintop_fit_columns
    use spintop_study_column, only: listed_column_t
    implicit none
    private
    public :: fit_columns

    !> The columns of the table of parameters, before those of the covariance.
    type(listed_column_t), parameter :: fit_columns(*) = [ &
        listed_column_t('parameter', '', 'sought parameter of the input', 'fit', words=.true.), &
        listed_column_t('unit', '', 'its unit, which is that of the next five columns', 'fit', words=.true.), &
        listed_column_t('estimate', '', 'value with the least sum of squares', 'fit'), &
        listed_column_t('standard_error', '', 'standard error of the estimate, by the linear model', 'fit'), &
        listed_column_t('lower', '', 'lower end of the 95 % profile interval', 'fit'), &
        listed_column_t('upper', '', 'upper end of the 95 % profile interval', 'fit'), &
        listed_column_t('start', '', 'value of the input, where the search began', 'fit'), &
        listed_column_t('singular_value', '', 'singular values of the scaled Jacobian, from the largest: one per row', &
                        'fit')]

end module spintop_fit_columns
