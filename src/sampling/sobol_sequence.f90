!> Sobol' sequences: points that fill the unit cube more evenly than random ones, with the direction numbers of Joe
!> and Kuo. Each point follows from its number alone.
!>
!> The order is that of the Gray code (I. A. Antonov and V. M. Saleev, USSR Computational Mathematics and Mathematical
!> Physics 19, 1979, 252-256). With a seed other than 0 the points are scrambled by random lower triangular matrices
!> and a digital shift (J. Matousek, Journal of Complexity 14, 1998, 527-556), which keeps the net of the points and
!> makes each of them uniform, so that means over them are unbiased.
!>
!>     call sequence%start(dimensions=3, seed=0_int64)
!>     call sequence%find_point(number, fractions)      ! from 1
module spintop_sobol_sequence
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_random, only: random_words
    use spintop_sobol_numbers, only: initial_numbers, most_dimensions, polynomials
    implicit none
    private
    public :: sobol_sequence_t, most_sobol_dimensions, most_sobol_points

    !> Binary digits of a coordinate.
    integer, parameter :: digits_of_point = 52
    !> Maximum number of dimensions, and of points.
    integer, parameter :: most_sobol_dimensions = most_dimensions
    integer(int64), parameter :: most_sobol_points = 2_int64**digits_of_point
    integer(int64), parameter :: all_digits = most_sobol_points - 1

    !> A sequence in some dimensions.
    type :: sobol_sequence_t
        !> Direction number j of dimension d, as an integer of so many binary digits: `directions(j, d)`.
        integer(int64), allocatable, private :: directions(:, :)
        !> The digital shift of each dimension.
        integer(int64), allocatable, private :: shift(:)
    contains
        procedure :: start
        procedure :: find_point
    end type sobol_sequence_t

contains

    !> Prepares a sequence of at most `most_sobol_dimensions` dimensions.
    pure subroutine start(self, dimensions, seed)
        class(sobol_sequence_t), intent(inout) :: self
        integer, intent(in) :: dimensions !! number of dimensions
        integer(int64), intent(in) :: seed !! of the scrambling; 0 for the sequence itself
        integer :: d
        if (allocated(self%directions)) deallocate (self%directions, self%shift)
        allocate (self%directions(digits_of_point, dimensions), self%shift(dimensions))
        do d = 1, dimensions
            self%directions(:, d) = directions_of(d)
            self%shift(d) = 0
            if (seed /= 0) call scramble(self%directions(:, d), self%shift(d), seed, d)
        end do
    end subroutine start

    !> The direction numbers of a dimension, from its polynomial and its initial numbers.
    pure function directions_of(dimension) result(directions)
        integer, intent(in) :: dimension
        integer(int64) :: directions(digits_of_point)
        integer(int64) :: numbers(digits_of_point)
        integer :: degree, j, k

        numbers = 1
        if (dimension > 1) then
            associate (polynomial => polynomials(dimension))
                degree = bit_size(polynomial) - 1 - leadz(polynomial)
                numbers(:degree) = initial_numbers(:degree, dimension)
                do j = degree + 1, digits_of_point
                    numbers(j) = ieor(shiftl(numbers(j - degree), degree), numbers(j - degree))
                    do k = 1, degree - 1
                        if (btest(polynomial, degree - k)) numbers(j) = ieor(numbers(j), shiftl(numbers(j - k), k))
                    end do
                end do
            end associate
        end if
        directions = shiftl(numbers, [(digits_of_point - j, j=1, digits_of_point)])
    end function directions_of

    !> Multiplies direction numbers by a random lower triangular matrix with a diagonal of ones, and draws a shift.
    !> Row i of the matrix gives digit i of a number from its digits 1 to i; digit 1 is the most significant.
    pure subroutine scramble(directions, shift, seed, dimension)
        integer(int64), intent(inout) :: directions(digits_of_point)
        integer(int64), intent(out) :: shift
        integer(int64), intent(in) :: seed
        integer, intent(in) :: dimension
        integer(int64) :: scrambled(digits_of_point), row
        integer :: i, j, place

        scrambled = 0
        do i = 1, digits_of_point
            place = digits_of_point - i
            row = random_digits(seed, int(i, int64), dimension)
            row = ibset(shiftl(shiftr(row, place + 1), place + 1), place)
            do j = 1, digits_of_point
                if (poppar(iand(row, directions(j))) == 1) scrambled(j) = ibset(scrambled(j), place)
            end do
        end do
        directions = scrambled
        shift = random_digits(seed, 0_int64, dimension)
    end subroutine scramble

    !> Random binary digits, as many as a coordinate has.
    pure integer(int64) function random_digits(seed, number, dimension)
        integer(int64), intent(in) :: seed, number
        integer, intent(in) :: dimension
        integer(int64) :: words(4)
        words = random_words(seed, number, int(dimension, int64))
        random_digits = iand(ior(shiftl(words(1), 32), iand(words(2), int(z'FFFFFFFF', int64))), all_digits)
    end function random_digits

    !> Coordinates of a point, in (0, 1): each is the middle of the smallest interval that its digits distinguish, so
    !> that none is 0 or 1.
    pure subroutine find_point(self, number, fractions)
        class(sobol_sequence_t), intent(in) :: self
        integer(int64), intent(in) :: number !! number of the point, from 1
        real(dp), intent(out) :: fractions(:) !! one coordinate for each dimension
        integer(int64) :: code, digits(size(fractions))
        integer :: j

        code = ieor(number - 1, shiftr(number - 1, 1))
        digits = self%shift
        do while (code /= 0)
            j = trailz(code) + 1
            digits = ieor(digits, self%directions(j, :))
            code = iand(code, code - 1)
        end do
        fractions = scale(real(digits, dp) + 0.5_dp, -digits_of_point)
    end subroutine find_point

end module spintop_sobol_sequence
