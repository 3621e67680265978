!> Inertia tensors: the term of Steiner, and the rotation to principal axes.
!>
!> A tensor is given by its diagonal and its `products`, the elements 23, 31 and 12.
module spintop_principal_axes
    use spintop_kinds, only: dp, epsilon_dp, xp
    implicit none
    private
    public :: steiner, find_principal_axes, clear_rounding

    !> Rounding errors of a sum over some parts, relative to its largest terms.
    real(dp), parameter :: rounding = 16 * epsilon_dp

contains

    !> The tensor of a mass at a place about the origin, kg m^2.
    pure subroutine steiner(mass, place, inertia, products)
        real(dp), intent(in) :: mass, place(3) !! kg, m
        real(dp), intent(out) :: inertia(3), products(3) !! diagonal and products, kg m^2
        inertia = mass * (sum(place**2) - place**2)
        products = -mass * cshift(place, 1) * cshift(place, 2)
    end subroutine steiner

    !> Sets to zero what is only the rounding error of a tensor and of a centre of mass, so that the symmetry of a body
    !> that is composed of parts, or was rotated, is exact: products; differences of moments; components of the centre.
    pure subroutine clear_rounding(inertia, products, centre)
        real(dp), intent(inout) :: inertia(3), products(3), centre(3) !! kg m^2, m
        real(dp) :: least
        integer :: i, j
        least = rounding * maxval(abs(inertia))
        where (abs(products) <= least) products = 0
        do i = 1, 3
            j = mod(i, 3) + 1
            if (abs(inertia(i) - inertia(j)) <= least) inertia([i, j]) = sum(inertia([i, j])) / 2
        end do
        where (abs(centre) <= rounding * norm2(centre)) centre = 0
    end subroutine clear_rounding

    !> Principal moments of a tensor, and the rotation to its principal axes: the vector v becomes p v conj(p), with a unit
    !> quaternion p. Axes that are principal ones already are kept, and the others are the nearest ones: the method is
    !> Jacobi's (Golub and Van Loan, Matrix Computations, section 8.5), in extended precision.
    pure subroutine find_principal_axes(inertia, products, moments, p)
        real(dp), intent(in) :: inertia(3), products(3) !! diagonal and products, kg m^2
        real(dp), intent(out) :: moments(3) !! principal moments, kg m^2
        real(dp), intent(out) :: p(4) !! unit quaternion of the rotation
        !> Jacobi's method converges quadratically: it takes five or six sweeps.
        integer, parameter :: most_sweeps = 30
        real(xp) :: a(3), b(3), ratio, t, c, s, between(2), turn(4), total(4)
        integer :: sweep, k, i, j

        a = inertia
        b = products
        total = [1, 0, 0, 0]
        do sweep = 1, most_sweeps
            if (maxval(abs(b)) <= epsilon(b) * tiny(1.0_dp) + epsilon(b) * epsilon(b) * maxval(abs(a))) exit
            do k = 1, 3
                if (.not. abs(b(k)) > 0) cycle
                i = mod(k, 3) + 1
                j = mod(i, 3) + 1
                ! A turn about axis k by the smaller angle for which element ij vanishes; t is its tangent.
                ratio = (a(j) - a(i)) / (2 * b(k))
                t = sign(1.0_xp, ratio) / (abs(ratio) + sqrt(1 + ratio**2))
                c = 1 / sqrt(1 + t**2)
                s = t * c
                a(i) = a(i) - t * b(k)
                a(j) = a(j) + t * b(k)
                between = [c * b(i) + s * b(j), c * b(j) - s * b(i)]
                b([i, j]) = between
                b(k) = 0
                turn = 0
                turn(1) = sqrt((1 + c) / 2)
                turn(1 + k) = s / (2 * turn(1))
                total = product_of(turn, total)
            end do
        end do
        moments = real(a, dp)
        p = real(total / norm2(total), dp)
    end subroutine find_principal_axes

    !> The product of two quaternions.
    pure function product_of(a, b) result(c)
        real(xp), intent(in) :: a(4), b(4)
        real(xp) :: c(4)
        c(1) = a(1) * b(1) - dot_product(a(2:4), b(2:4))
        c(2:4) = a(1) * b(2:4) + b(1) * a(2:4) &
                 + [a(3) * b(4) - a(4) * b(3), a(4) * b(2) - a(2) * b(4), a(2) * b(3) - a(3) * b(2)]
    end function product_of

end module spintop_principal_axes
