!> Products of power series, one pair in each lane. lane_products.h computes them.
module spintop_lane_products
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kinds, only: dp
    use spintop_lane_series, only: lanes
    implicit none
    private
    public :: multiply, square, multiply_slopes

    interface
        pure subroutine c_multiply(degree, x, y, product) bind(C, name='spintop_multiply_lanes')
            import :: c_double, c_int
            integer(c_int), value :: degree
            real(c_double), intent(in) :: x(*), y(*)
            real(c_double), intent(inout) :: product(*)
        end subroutine c_multiply

        pure subroutine c_multiply_slopes(degree, x, y, product) bind(C, name='spintop_multiply_slopes')
            import :: c_double, c_int
            integer(c_int), value :: degree
            real(c_double), intent(in) :: x(*), y(*)
            real(c_double), intent(inout) :: product(*)
        end subroutine c_multiply_slopes

        pure subroutine c_square(degree, x, product) bind(C, name='spintop_square_lanes')
            import :: c_double, c_int
            integer(c_int), value :: degree
            real(c_double), intent(in) :: x(*)
            real(c_double), intent(inout) :: product(*)
        end subroutine c_square
    end interface

contains

    !> The product of two series.
    pure subroutine multiply(degree, x, y, product)
        integer, intent(in) :: degree !! last term of the product
        real(dp), intent(in) :: x(lanes, 0:degree), y(lanes, 0:degree) !! coefficients of the series
        real(dp), intent(out) :: product(lanes, 0:degree) !! those of the product
        call c_multiply(int(degree, c_int), x, y, product)
    end subroutine multiply

    !> The square of a series.
    pure subroutine square(degree, x, product)
        integer, intent(in) :: degree !! last term of the square
        real(dp), intent(in) :: x(lanes, 0:degree) !! coefficients of the series
        real(dp), intent(out) :: product(lanes, 0:degree) !! those of the square
        call c_square(int(degree, c_int), x, product)
    end subroutine square

    !> The series of x' y - x y'.
    pure subroutine multiply_slopes(degree, x, y, product)
        integer, intent(in) :: degree !! last term of the product
        real(dp), intent(in) :: x(lanes, 0:degree + 1), y(lanes, 0:degree + 1) !! coefficients of the series
        real(dp), intent(out) :: product(lanes, 0:degree) !! those of the product
        call c_multiply_slopes(int(degree, c_int), x, y, product)
    end subroutine multiply_slopes

end module spintop_lane_products
