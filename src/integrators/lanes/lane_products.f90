!> Products of power series, one pair in each lane, by lane_products.h. Series are arrays (lane, term from 0 on).
module spintop_lane_products
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    implicit none
    private
    public :: multiply, square, multiply_slopes

    interface
        !> The product of two series.
        pure subroutine multiply(degree, x, y, product) bind(C, name='spintop_multiply_lanes')
            import :: c_double, c_int
            integer(c_int), value :: degree !! last term of the product
            real(c_double), intent(in) :: x(*), y(*) !! coefficients of the series
            real(c_double), intent(inout) :: product(*) !! those of the product
        end subroutine multiply

        !> The square of a series.
        pure subroutine square(degree, x, product) bind(C, name='spintop_square_lanes')
            import :: c_double, c_int
            integer(c_int), value :: degree !! last term of the square
            real(c_double), intent(in) :: x(*) !! coefficients of the series
            real(c_double), intent(inout) :: product(*) !! those of the square
        end subroutine square

        !> The series of x' y - x y'.
        pure subroutine multiply_slopes(degree, x, y, product) bind(C, name='spintop_multiply_slopes')
            import :: c_double, c_int
            integer(c_int), value :: degree !! last term of the product
            real(c_double), intent(in) :: x(*), y(*) !! coefficients of the series, up to one more term
            real(c_double), intent(inout) :: product(*) !! those of the product
        end subroutine multiply_slopes
    end interface

end module spintop_lane_products
