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
    implicit none
    private
    public :: sobol_sequence_t, most_sobol_dimensions, most_sobol_points

    !> Binary digits of a coordinate.
    integer, parameter :: digits_of_point = 52
    !> Maximum number of dimensions, and of points.
    integer, parameter :: most_sobol_dimensions = 64
    integer(int64), parameter :: most_sobol_points = 2_int64**digits_of_point
    integer(int64), parameter :: all_digits = most_sobol_points - 1

    !> The numbers that define the sequences, by S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better
    !> two-dimensional projections", SIAM Journal on Scientific Computing 30, 2008, 2635-2654; the first dimensions of their
    !> file `new-joe-kuo-6.21201`. The polynomial of each dimension over the field of two elements: bit k is the coefficient
    !> of x^k. The first dimension has none.
    integer, parameter :: polynomials(most_sobol_dimensions) = [ &
        1, 3, 7, 11, 13, 19, 25, 37, 41, 47, 55, 59, 61, 67, 91, 97, &
        103, 109, 115, 131, 137, 143, 145, 157, 167, 171, 185, 191, 193, 203, 211, 213, &
        229, 239, 241, 247, 253, 285, 299, 301, 333, 351, 355, 357, 361, 369, 391, 397, &
        425, 451, 463, 487, 501, 529, 539, 545, 557, 563, 601, 607, 617, 623, 631, 637]

    !> The initial numbers m_1, m_2, ... of the dimensions from the second on, one after the other, as many of each as the
    !> degree of its polynomial; each degree begins a row.
    integer, parameter :: initial_numbers(436) = [ &
        1, &
        1, 3, &
        1, 3, 1, 1, 1, 1, &
        1, 1, 3, 3, 1, 3, 5, 13, &
        1, 1, 5, 5, 17, 1, 1, 5, 5, 5, 1, 1, 7, 11, 19, 1, 1, 5, 1, 1, 1, 1, 1, 3, 11, 1, 3, 5, 5, 31, &
        1, 3, 3, 9, 7, 49, 1, 1, 1, 15, 21, 21, 1, 3, 1, 13, 27, 49, 1, 1, 1, 15, 7, 5, &
        1, 3, 1, 15, 13, 25, 1, 1, 5, 5, 19, 61, &
        1, 3, 7, 11, 23, 15, 103, 1, 3, 7, 13, 13, 15, 69, 1, 1, 3, 13, 7, 35, 63, &
        1, 3, 5, 9, 1, 25, 53, 1, 3, 1, 13, 9, 35, 107, 1, 3, 1, 5, 27, 61, 31, 1, 1, 5, 11, 19, 41, 61, &
        1, 3, 5, 3, 3, 13, 69, 1, 1, 7, 13, 1, 19, 1, 1, 3, 7, 5, 13, 19, 59, 1, 1, 3, 9, 25, 29, 41, &
        1, 3, 5, 13, 23, 1, 55, 1, 3, 7, 3, 13, 59, 17, 1, 3, 1, 3, 5, 53, 69, 1, 1, 5, 5, 23, 33, 13, &
        1, 1, 7, 7, 1, 61, 123, 1, 1, 7, 9, 13, 61, 49, 1, 3, 3, 5, 3, 55, 33, &
        1, 3, 1, 15, 31, 13, 49, 245, 1, 3, 5, 15, 31, 59, 63, 97, 1, 3, 1, 11, 11, 11, 77, 249, &
        1, 3, 1, 11, 27, 43, 71, 9, 1, 1, 7, 15, 21, 11, 81, 45, 1, 3, 7, 3, 25, 31, 65, 79, &
        1, 3, 1, 1, 19, 11, 3, 205, 1, 1, 5, 9, 19, 21, 29, 157, 1, 3, 7, 11, 1, 33, 89, 185, &
        1, 3, 3, 3, 15, 9, 79, 71, 1, 3, 7, 11, 15, 39, 119, 27, 1, 1, 3, 1, 11, 31, 97, 225, &
        1, 1, 1, 3, 23, 43, 57, 177, 1, 3, 7, 7, 17, 17, 37, 71, 1, 3, 1, 5, 27, 63, 123, 213, &
        1, 1, 3, 5, 11, 43, 53, 133, &
        1, 3, 5, 5, 29, 17, 47, 173, 479, 1, 3, 3, 11, 3, 1, 109, 9, 69, 1, 1, 1, 5, 17, 39, 23, 5, 343, &
        1, 3, 1, 5, 25, 15, 31, 103, 499, 1, 1, 1, 11, 11, 17, 63, 105, 183, &
        1, 1, 5, 11, 9, 29, 97, 231, 363, 1, 1, 5, 15, 19, 45, 41, 7, 383, &
        1, 3, 7, 7, 31, 19, 83, 137, 221, 1, 1, 1, 3, 23, 15, 111, 223, 83, &
        1, 1, 5, 13, 31, 15, 55, 25, 161, 1, 1, 3, 13, 25, 47, 39, 87, 257]

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
        integer, parameter :: degrees(most_sobol_dimensions) = bit_size(polynomials) - 1 - leadz(polynomials)
        integer :: before, j, k

        numbers = 1
        if (dimension > 1) then
            associate (polynomial => polynomials(dimension), degree => degrees(dimension))
                before = sum(degrees(:dimension - 1))
                numbers(:degree) = initial_numbers(before + 1:before + degree)
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
