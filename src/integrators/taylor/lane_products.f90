!> Products of power series, one pair in each lane.
module spintop_lane_products
    use spintop_kinds, only: dp
    use spintop_formulation, only: max_series_order
    use spintop_lane_series, only: lanes
    implicit none
    private
    public :: multiply, square, add_squares, multiply_slopes

    !> Index in the table below.
    integer :: i
    !> Whole numbers as doubles.
    real(dp), parameter :: whole(0:max_series_order) = [(real(i, dp), i=0, max_series_order)]

contains

    !> The product of two series. Here and below two terms are computed at once, which have most operands in common; the
    !> last may be left over. No loop becomes vectors that may have no trip.
    pure subroutine multiply(degree, x, y, product)
        integer, intent(in) :: degree !! last term of the product
        real(dp), intent(in) :: x(lanes, 0:degree), y(lanes, 0:degree) !! coefficients of the series
        real(dp), intent(out) :: product(lanes, 0:degree) !! those of the product
        real(dp) :: even, odd
        integer :: i, j, half
        do half = 0, (degree - 1) / 2
            !$omp simd private(even, odd, j)
            do i = 1, lanes
                even = 0
                odd = x(i, 2 * half + 1) * y(i, 0)
                do j = 0, max(2 * half, 0)
                    even = even + x(i, j) * y(i, 2 * half - j)
                    odd = odd + x(i, j) * y(i, 2 * half + 1 - j)
                end do
                product(i, 2 * half) = even
                product(i, 2 * half + 1) = odd
            end do
        end do
        if (mod(degree, 2) == 1) return
        !$omp simd private(even, j)
        do i = 1, lanes
            even = 0
            do j = 0, max(degree, 0)
                even = even + x(i, j) * y(i, degree - j)
            end do
            product(i, degree) = even
        end do
    end subroutine multiply

    !> The square of a series: its products are equal in pairs.
    pure subroutine square(degree, x, product)
        integer, intent(in) :: degree !! last term of the square
        real(dp), intent(in) :: x(lanes, 0:degree) !! coefficients of the series
        real(dp), intent(out) :: product(lanes, 0:degree) !! those of the square
        real(dp) :: even, odd
        integer :: i, j, half
        product(:, 0) = x(:, 0)**2
        do half = 1, degree / 2
            !$omp simd private(even, odd, j)
            do i = 1, lanes
                even = 0
                odd = 0
                do j = 0, max(half - 1, 0)
                    odd = odd + x(i, j) * x(i, 2 * half - 1 - j)
                    even = even + x(i, j) * x(i, 2 * half - j)
                end do
                product(i, 2 * half - 1) = 2 * odd
                product(i, 2 * half) = 2 * even + x(i, half)**2
            end do
        end do
        if (mod(degree, 2) == 0) return
        !$omp simd private(odd, j)
        do i = 1, lanes
            odd = 0
            do j = 0, max((degree - 1) / 2, 0)
                odd = odd + x(i, j) * x(i, degree - j)
            end do
            product(i, degree) = 2 * odd
        end do
    end subroutine square

    !> The sum of the squares of two series.
    pure subroutine add_squares(degree, x, y, product)
        integer, intent(in) :: degree !! last term of the sum
        real(dp), intent(in) :: x(lanes, 0:degree), y(lanes, 0:degree) !! coefficients of the series
        real(dp), intent(out) :: product(lanes, 0:degree) !! those of the sum
        real(dp) :: even, odd
        integer :: i, j, half
        product(:, 0) = x(:, 0)**2 + y(:, 0)**2
        do half = 1, degree / 2
            !$omp simd private(even, odd, j)
            do i = 1, lanes
                even = 0
                odd = 0
                do j = 0, max(half - 1, 0)
                    odd = odd + (x(i, j) * x(i, 2 * half - 1 - j) + y(i, j) * y(i, 2 * half - 1 - j))
                    even = even + (x(i, j) * x(i, 2 * half - j) + y(i, j) * y(i, 2 * half - j))
                end do
                product(i, 2 * half - 1) = 2 * odd
                product(i, 2 * half) = 2 * even + (x(i, half)**2 + y(i, half)**2)
            end do
        end do
        if (mod(degree, 2) == 0) return
        !$omp simd private(odd, j)
        do i = 1, lanes
            odd = 0
            do j = 0, max((degree - 1) / 2, 0)
                odd = odd + (x(i, j) * x(i, degree - j) + y(i, j) * y(i, degree - j))
            end do
            product(i, degree) = 2 * odd
        end do
    end subroutine add_squares

    !> The series of x' y - x y': its term k is the sum over i + j = k + 1 of (i - j) x_i y_j.
    pure subroutine multiply_slopes(degree, x, y, product)
        integer, intent(in) :: degree !! last term of the product
        real(dp), intent(in) :: x(lanes, 0:degree + 1), y(lanes, 0:degree + 1) !! coefficients of the series
        real(dp), intent(out) :: product(lanes, 0:degree) !! those of the product
        real(dp) :: even, odd
        integer :: i, j, half, next
        do half = 0, (degree - 1) / 2
            !$omp simd private(even, odd, j)
            do i = 1, lanes
                even = 0
                odd = 0
                do j = 0, max(half, 0)
                    even = even + whole(2 * (half - j) + 1) &
                        * (x(i, 2 * half + 1 - j) * y(i, j) - x(i, j) * y(i, 2 * half + 1 - j))
                    odd = odd + whole(2 * (half - j) + 2) &
                        * (x(i, 2 * half + 2 - j) * y(i, j) - x(i, j) * y(i, 2 * half + 2 - j))
                end do
                product(i, 2 * half) = even
                product(i, 2 * half + 1) = odd
            end do
        end do
        if (mod(degree, 2) == 1) return
        product(:, degree) = 0
        do j = 0, degree / 2
            next = degree + 1 - j
            product(:, degree) = product(:, degree) + (next - j) * (x(:, next) * y(:, j) - x(:, j) * y(:, next))
        end do
    end subroutine multiply_slopes

end module spintop_lane_products
