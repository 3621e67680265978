!> Residuals as a function of parameters: what is fitted.
module spintop_residuals
    use spintop_kinds, only: dp
    use spintop_losses, only: loss_t
    implicit none
    private
    public :: residuals_t

    !> Residuals as a function of parameters.
    type, abstract :: residuals_t
        !> Relative error of what the residuals are differences of, where it is above rounding: that of an integration.
        real(dp) :: precision = 0
        !> What the residuals are differences from, in their unit: the measurements. Not allocated where that is unknown.
        real(dp), allocatable :: data(:)
        !> Their loss, of which the sum is made as small as possible.
        type(loss_t) :: loss
        !> How much of the work is done, from 0 to 1.
        real(dp) :: share = 0
    contains
        procedure(evaluate_i), deferred :: evaluate
        procedure(scale_i), deferred :: step_scale
        procedure :: limited
        procedure :: ends
        procedure :: coarsen
        procedure :: size_of_data
    end type residuals_t

    abstract interface
        !> The residuals at some parameters; `is_valid` is false where they do not exist.
        subroutine evaluate_i(self, x, residuals, is_valid)
            import :: residuals_t, dp
            implicit none
            class(residuals_t), intent(inout) :: self
            real(dp), intent(in) :: x(:) !! the parameters
            real(dp), intent(out) :: residuals(:) !! the residuals
            logical, intent(out) :: is_valid !! whether they exist
        end subroutine evaluate_i

        !> A change of a parameter that matters.
        pure real(dp) function scale_i(self, i, x)
            import :: residuals_t, dp
            implicit none
            class(residuals_t), intent(in) :: self
            integer, intent(in) :: i !! number of the parameter
            real(dp), intent(in) :: x !! its value, in its unit
        end function scale_i
    end interface

contains

    !> The value in the range of a parameter that is nearest to another; beyond an open end that value itself. Here all values
    !> are in the range.
    pure real(dp) function limited(self, i, x)
        class(residuals_t), intent(in) :: self
        integer, intent(in) :: i !! number of the parameter
        real(dp), intent(in) :: x !! any value of the parameter, in its unit
        limited = x
    end function limited

    !> The ends of the range of a parameter, open or not; -huge and huge where it has none, as here.
    pure function ends(self, i)
        class(residuals_t), intent(in) :: self
        integer, intent(in) :: i !! number of the parameter
        real(dp) :: ends(2)
        ends = [-huge(ends), huge(ends)]
    end function ends

    !> Makes the error of an integration larger by a factor, by a larger tolerance; 1 restores it. Here there is none.
    subroutine coarsen(self, factor)
        class(residuals_t), intent(inout) :: self
        real(dp), intent(in) :: factor !! at least 1
    end subroutine coarsen

    !> Norm of what the residuals are differences from; 0 if that is unknown.
    pure real(dp) function size_of_data(self)
        class(residuals_t), intent(in) :: self
        size_of_data = 0
        if (allocated(self%data)) size_of_data = norm2(self%data)
    end function size_of_data

end module spintop_residuals
