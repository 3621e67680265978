!> Products of power series, one pair in each lane.
module spintop_lane_products
    use spintop_kinds, only: dp
    use spintop_formulation, only: max_series_order
    use spintop_lane_series, only: lanes
    implicit none
    private
    public :: multiply, square, multiply_slopes

    !> Index in the table below.
    integer :: i
    !> Whole numbers as doubles.
    real(dp), parameter :: whole(0:max_series_order) = [(real(i, dp), i=0, max_series_order)]

contains

    !> The product of two series.
    pure subroutine multiply(degree, x, y, product)
        integer, intent(in) :: degree !! last term of the product
        real(dp), intent(in) :: x(lanes, 0:degree), y(lanes, 0:degree) !! coefficients of the series
        real(dp), intent(out) :: product(lanes, 0:degree) !! those of the product
        real(dp) :: total
        integer :: i, j, k
        do k = 0, degree
            !$omp simd private(total, j)
            do i = 1, lanes
                total = 0
                ! No loop becomes vectors that may have no trip.
                do j = 0, max(k, 0)
                    total = total + x(i, j) * y(i, k - j)
                end do
                product(i, k) = total
            end do
        end do
    end subroutine multiply

    !> The square of a series.
    pure subroutine square(degree, x, product)
        integer, intent(in) :: degree !! last term of the square
        real(dp), intent(in) :: x(lanes, 0:degree) !! coefficients of the series
        real(dp), intent(out) :: product(lanes, 0:degree) !! those of the square
        real(dp) :: total
        integer :: i, j, k
        product(:, 0) = x(:, 0)**2
        do k = 1, degree
            !$omp simd private(total, j)
            do i = 1, lanes
                total = 0
                do j = 0, max((k - 1) / 2, 0)
                    total = total + x(i, j) * x(i, k - j)
                end do
                product(i, k) = 2 * total
            end do
            if (mod(k, 2) == 0) product(:, k) = product(:, k) + x(:, k / 2)**2
        end do
    end subroutine square

    !> The series of x' y - x y': its term k is the sum over i + j = k + 1 of (i - j) x_i y_j.
    pure subroutine multiply_slopes(degree, x, y, product)
        integer, intent(in) :: degree !! last term of the product
        real(dp), intent(in) :: x(lanes, 0:degree + 1), y(lanes, 0:degree + 1) !! coefficients of the series
        real(dp), intent(out) :: product(lanes, 0:degree) !! those of the product
        real(dp) :: total
        integer :: i, j, k
        do k = 0, degree
            !$omp simd private(total, j)
            do i = 1, lanes
                total = 0
                do j = 0, max(k / 2, 0)
                    total = total + whole(k + 1 - 2 * j) * (x(i, k + 1 - j) * y(i, j) - x(i, j) * y(i, k + 1 - j))
                end do
                product(i, k) = total
            end do
        end do
    end subroutine multiply_slopes

end module spintop_lane_products
