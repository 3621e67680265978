!> Values of the axes of a sweep from points of the unit cube: normal, log-normal and joint normal values, attitudes and
!> directions.
module spintop_distributions
    use spintop_kinds, only: degree, dp, pi
    use spintop_lapack, only: dpotrf
    use spintop_normal_quantile, only: normal_quantile
    implicit none
    private
    public :: law_names, law_uniform, law_normal, law_lognormal, law_sphere
    public :: sphere_attitude, sphere_direction, sphere_inclination, sphere_turn
    public :: normal_value, attitude_at, direction_at, inclination_at, turn_at, factor_covariance

    !> Laws of the values of an axis, by their places in `law_names`.
    integer, parameter :: law_uniform = 1, law_normal = 2, law_lognormal = 3, law_sphere = 4
    !> The words for these in an input (sweep.distribution).
    character(*), parameter :: law_names(4) = [character(9) :: 'uniform', 'normal', 'lognormal', 'sphere']

    !> What is uniform on a sphere: an attitude (four components of a quaternion), a vector (three), the angle between
    !> the vertical and a direction, an angle about the vertical.
    integer, parameter :: sphere_attitude = 1, sphere_direction = 2, sphere_inclination = 3, sphere_turn = 4

contains

    !> The standard normal value at a fraction; a fraction that was rounded to 0 or 1 counts as the nearest inside.
    elemental real(dp) function normal_value(fraction)
        real(dp), intent(in) :: fraction !! in [0, 1]
        real(dp), parameter :: least = 0.25_dp * epsilon(1.0_dp)
        normal_value = normal_quantile(min(max(fraction, least), 1 - 2 * least))
    end function normal_value

    !> An attitude: unit quaternions that are uniform on the group of rotations for uniform fractions (K. Shoemake,
    !> "Uniform random rotations", Graphics Gems III, 1992).
    pure function attitude_at(fractions) result(quaternion)
        real(dp), intent(in) :: fractions(3) !! a point of the unit cube
        real(dp) :: quaternion(4)
        associate (one => 2 * pi * fractions(2), two => 2 * pi * fractions(3))
            quaternion = [sqrt(1 - fractions(1)) * [sin(one), cos(one)], sqrt(fractions(1)) * [sin(two), cos(two)]]
        end associate
    end function attitude_at

    !> A unit vector, uniform on the sphere for uniform fractions.
    pure function direction_at(fractions) result(direction)
        real(dp), intent(in) :: fractions(2) !! a point of the unit square
        real(dp) :: direction(3)
        associate (radius => 2 * sqrt(fractions(1) * (1 - fractions(1))), turn => 2 * pi * fractions(2))
            direction = [radius * cos(turn), radius * sin(turn), 1 - 2 * fractions(1)]
        end associate
    end function direction_at

    !> The angle from the vertical of such a direction, in radians or degrees.
    elemental real(dp) function inclination_at(fraction, in_degrees)
        real(dp), intent(in) :: fraction !! in [0, 1]
        logical, intent(in) :: in_degrees !! whether the angle is in degrees
        inclination_at = 2 * asin(min(1.0_dp, sqrt(fraction)))
        if (in_degrees) inclination_at = min(inclination_at / degree, 180.0_dp)
    end function inclination_at

    !> A full turn, in radians or degrees.
    elemental real(dp) function turn_at(fraction, in_degrees)
        real(dp), intent(in) :: fraction !! in [0, 1]
        logical, intent(in) :: in_degrees !! whether the angle is in degrees
        turn_at = merge(360.0_dp, 2 * pi, in_degrees) * fraction
    end function turn_at

    !> The lower triangular factor L of a covariance matrix, L L^T, by the factor of its matrix of correlations, which
    !> does not depend on the units of the variables; `positive` is false if the matrix is not positive definite.
    subroutine factor_covariance(covariance, factor, positive)
        real(dp), intent(in) :: covariance(:, :) !! a symmetric matrix
        real(dp), intent(out) :: factor(:, :) !! the factor; 0 above the diagonal
        logical, intent(out) :: positive !! whether there is one
        real(dp) :: deviation(size(covariance, 1))
        integer :: i, j, n, info

        n = size(covariance, 1)
        factor = 0
        positive = all([(covariance(i, i) > 0, i=1, n)])
        if (.not. positive) return
        deviation = [(sqrt(covariance(i, i)), i=1, n)]
        do j = 1, n
            factor(j, j) = 1
            do i = j + 1, n
                factor(i, j) = covariance(i, j) / deviation(i) / deviation(j)
            end do
        end do
        call dpotrf('L', n, factor, n, info)
        positive = info == 0
        do j = 1, n
            factor(j:, j) = deviation(j:) * factor(j:, j)
        end do
    end subroutine factor_covariance

end module spintop_distributions
