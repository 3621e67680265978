!> Residuals as a function of parameters, which is what is fitted, and their loss: half the square of each, or a robust loss,
!> which bounds what wrong measurements can do (Huber and Ronchetti, Robust Statistics, 2nd edition, 2009). A search by least
!> squares takes any loss: it sums the squares of residuals that are *bent*, the square of a bent residual being twice its loss.
module spintop_residuals
    use spintop_kinds, only: dp
    implicit none
    private
    public :: residuals_t, loss_t, loss_names, loss_squares, loss_huber, loss_tukey

    !> Names of the losses, and their indices: least squares; Huber's, which is linear beyond a bound (1964); Tukey's biweight,
    !> which is constant there (Beaton and Tukey 1974), so that what lies beyond does not count at all.
    character(*), parameter :: loss_names(3) = [character(7) :: 'squares', 'huber', 'tukey']
    integer, parameter :: loss_squares = 1, loss_huber = 2, loss_tukey = 3

    !> Bounds in standard deviations, with which Gaussian residuals give estimates of 95 % efficiency.
    real(dp), parameter :: bounds(3) = [huge(1.0_dp), 1.345_dp, 4.685_dp]

    !> A loss, and the size of a residual beyond which it is another one, in the unit of the residuals.
    type :: loss_t
        integer :: kind = loss_squares
        real(dp) :: bound = huge(1.0_dp)
    contains
        procedure :: bend
        procedure :: bend_slope
        procedure :: influence
        procedure :: influence_slope
        procedure :: is_robust
    end type loss_t

    !> The loss of a kind for residuals of a standard deviation.
    interface loss_t
        module procedure new_loss
    end interface loss_t

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

    !> The loss of a kind for residuals of a standard deviation.
    elemental type(loss_t) function new_loss(kind, deviation) result(loss)
        integer, intent(in) :: kind !! one of `loss_squares` to `loss_tukey`
        real(dp), intent(in) :: deviation !! standard deviation of residuals that are not wrong
        loss%kind = kind
        if (kind /= loss_squares) loss%bound = bounds(kind) * deviation
    end function new_loss

    !> Whether it bounds what wrong measurements can do.
    elemental logical function is_robust(self)
        class(loss_t), intent(in) :: self
        is_robust = self%kind /= loss_squares
    end function is_robust

    !> The number whose square is twice the loss of a residual: the residual itself where the loss is that of least squares.
    elemental real(dp) function bend(self, residual)
        class(loss_t), intent(in) :: self
        real(dp), intent(in) :: residual !! the residual
        real(dp) :: u
        bend = residual
        if (self%kind == loss_tukey) then
            u = min(abs(residual) / self%bound, 1.0_dp)
            bend = sign(self%bound * u * sqrt(1 - u**2 * (1 - u**2 / 3)), residual)
        else if (abs(residual) > self%bound) then
            bend = sign(sqrt(self%bound) * sqrt(2 * abs(residual) - self%bound), residual)
        end if
    end function bend

    !> The derivative of `bend`.
    elemental real(dp) function bend_slope(self, residual)
        class(loss_t), intent(in) :: self
        real(dp), intent(in) :: residual !! the residual
        real(dp) :: u
        bend_slope = 1
        if (self%kind == loss_tukey) then
            u = min(abs(residual) / self%bound, 1.0_dp)
            bend_slope = (1 - u**2)**2 / sqrt(1 - u**2 * (1 - u**2 / 3))
        else if (abs(residual) > self%bound) then
            bend_slope = self%bound / abs(self%bend(residual))
        end if
    end function bend_slope

    !> The derivative of the loss: how much a residual moves an estimate.
    elemental real(dp) function influence(self, residual)
        class(loss_t), intent(in) :: self
        real(dp), intent(in) :: residual !! the residual
        influence = self%bend(residual) * self%bend_slope(residual)
    end function influence

    !> The second derivative of the loss.
    elemental real(dp) function influence_slope(self, residual)
        class(loss_t), intent(in) :: self
        real(dp), intent(in) :: residual !! the residual
        real(dp) :: u
        influence_slope = merge(0.0_dp, 1.0_dp, abs(residual) > self%bound)
        if (self%kind == loss_tukey) then
            u = min(abs(residual) / self%bound, 1.0_dp)
            influence_slope = (1 - u**2) * (1 - 5 * u**2)
        end if
    end function influence_slope

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

end module spintop_residuals
