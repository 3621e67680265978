!> Where the cases of a sample lie: a point of the unit cube for each case, which follows from the number of the case
!> alone. Distributions make values of its coordinates.
!>
!>     call design%start(design_sobol, cases, seed, dimensions)
!>     call design%find_block(first, fractions)      ! for consecutive cases, from 1
module spintop_sample_design
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_random, only: mix, random_words, uniform, uniforms
    use spintop_sobol_sequence, only: sobol_sequence_t
    implicit none
    private
    public :: sample_design_t, saltelli_place_t, place_in_saltelli, permutation_t, make_permutation
    public :: design_random, design_latin_hypercube, design_sobol, design_saltelli

    !> Independent points; a Latin hypercube (M. D. McKay, R. J. Beckman and W. J. Conover, Technometrics 21, 1979); the
    !> points of a Sobol' sequence; the design of A. Saltelli for sensitivity indices. Values of dimension i are of stream 2 i
    !> of random numbers, strata of stream 2 i + 1.
    integer, parameter :: design_random = 1, design_latin_hypercube = 2, design_sobol = 3, design_saltelli = 4

    !> Rounds of the network; even. With fewer rounds, short permutations do not look random.
    integer, parameter :: rounds = 8
    integer, parameter :: words_a_draw = 4

    !> A random permutation of 0, ..., length - 1, evaluated element by element, without a table.
    !>
    !> A number below a*b is written with two digits, to the bases a and b. A Feistel network adds a keyed hash of
    !> one digit to the other, in turn; this is invertible, so it permutes the numbers below a*b. A result that is
    !> not below the length is permuted again (J. Black and P. Rogaway, "Ciphers with arbitrary finite domains",
    !> CT-RSA 2002: generalized Feistel network with cycle walking). This is rare, because a and b are close to
    !> the square root of the length.
    type :: permutation_t
        integer(int64), private :: length = 1
        integer(int64), private :: bases(2) = 1
        integer(int64), private :: keys(rounds) = 0
    contains
        procedure :: place
    end type permutation_t

    !> A sample. In the design of Saltelli (A. Saltelli and others, Computer Physics Communications 181, 2010, 259-270) a
    !> group of k + 2 consecutive cases belongs to one base point of 2 n coordinates: case A has the first n of them,
    !> case B the last n, and case i of the other k is A with the coordinates of factor i from B.
    type :: sample_design_t
        integer :: kind = design_random
        integer :: dimensions = 0
        integer(int64) :: cases = 0, seed = 1
        !> The factor to which each dimension belongs, and the number of factors.
        integer, allocatable :: factor(:)
        integer :: factors = 0
        !> The strata of a Latin hypercube in the order of the cases; and, for a dimension of which every value of a
        !> list has its share of the strata, the place in each of them, so that the numbers of occurrences of the
        !> values differ by at most one.
        type(permutation_t), allocatable, private :: strata(:)
        real(dp), allocatable, private :: place_in_stratum(:)
        type(sobol_sequence_t), private :: sequence
    contains
        procedure :: start
        procedure :: find_block
    end type sample_design_t

    !> The place of a case in the design of Saltelli.
    type :: saltelli_place_t
        !> Number of the base point, from 1.
        integer(int64) :: base = 1
        !> 1 for A, 2 for B, 2 + i for A with factor i from B.
        integer :: role = 1
    end type saltelli_place_t

contains

    !> Prepares a sample. `whole` names the dimensions of lists and whole numbers, `factor` the factor of each
    !> dimension, from 1 and without gaps.
    pure subroutine start(self, kind, cases, seed, whole, factor)
        class(sample_design_t), intent(inout) :: self
        integer, intent(in) :: kind !! one of the constants above
        integer(int64), intent(in) :: cases, seed !! number of cases; seed
        logical, intent(in) :: whole(:) !! for each dimension
        integer, intent(in) :: factor(:) !! for each dimension
        integer(int64) :: i

        self%kind = kind
        self%cases = cases
        self%seed = seed
        self%dimensions = size(whole)
        self%factor = factor
        self%factors = maxval([0, factor])
        select case (kind)
        case (design_latin_hypercube)
            self%strata = [(make_permutation(cases, seed, 2 * i + 1), i=1, self%dimensions)]
            allocate (self%place_in_stratum(self%dimensions))
            do i = 1, self%dimensions
                self%place_in_stratum(i) = -1
                if (whole(i)) self%place_in_stratum(i) = uniform(seed, 0_int64, 2 * i)
            end do
        case (design_sobol)
            call self%sequence%start(self%dimensions, seed)
        case (design_saltelli)
            call self%sequence%start(2 * self%dimensions, seed)
        end select
    end subroutine start

    !> The points of consecutive cases, inside the unit cube.
    pure subroutine find_block(self, first, fractions)
        class(sample_design_t), intent(in) :: self
        integer(int64), intent(in) :: first !! number of the first case, from 1
        real(dp), intent(out) :: fractions(:, :) !! of each case: one coordinate for each dimension
        type(saltelli_place_t) :: place_in_design
        real(dp) :: base(2 * self%dimensions)
        integer(int64) :: i
        integer :: k

        select case (self%kind)
        case (design_sobol)
            do k = 1, size(fractions, 2)
                call self%sequence%find_point(first + k - 1, fractions(:, k))
            end do
        case (design_saltelli)
            do k = 1, size(fractions, 2)
                place_in_design = place_in_saltelli(first + k - 1, self%factors)
                call self%sequence%find_point(place_in_design%base, base)
                associate (is_of_second => place_in_design%role == 2 .or. self%factor == place_in_design%role - 2)
                    fractions(:, k) = merge(base(self%dimensions + 1:), base(:self%dimensions), is_of_second)
                end associate
            end do
        case default
            do i = 1, self%dimensions
                call uniforms(self%seed, first, 2 * i, fractions(i, :))
                if (self%kind == design_random) cycle
                ! The number of a random point is the place in its stratum, unless all have the same.
                if (self%place_in_stratum(i) >= 0) fractions(i, :) = self%place_in_stratum(i)
                do k = 1, size(fractions, 2)
                    fractions(i, k) = (self%strata(i)%place(first + k - 2) + fractions(i, k)) / self%cases
                end do
            end do
        end select
    end subroutine find_block

    !> The place of a case in the design of Saltelli.
    elemental type(saltelli_place_t) function place_in_saltelli(number, factors) result(place)
        integer(int64), intent(in) :: number !! number of the case, from 1
        integer, intent(in) :: factors !! number of factors
        place%base = (number - 1) / (factors + 2) + 1
        place%role = int(mod(number - 1, factors + 2_int64)) + 1
    end function place_in_saltelli

    !> The permutation of 0, ..., length - 1 for a seed and a stream; length >= 1.
    pure type(permutation_t) function make_permutation(length, seed, stream) result(permutation)
        integer(int64), intent(in) :: length, seed, stream !! number of elements, at least 1; seed; independent stream
        integer :: i
        permutation%length = length
        permutation%bases(1) = max(1_int64, ceiling(sqrt(real(length, dp)), int64))
        permutation%bases(2) = (length - 1) / permutation%bases(1) + 1
        do i = 1, rounds, words_a_draw
            permutation%keys(i:i + words_a_draw - 1) = random_words(seed, int(i, int64), stream)
        end do
    end function make_permutation

    !> Image of a number; both are in 0, ..., length - 1.
    elemental integer(int64) function place(self, number)
        class(permutation_t), intent(in) :: self
        integer(int64), intent(in) :: number !! in 0, ..., length - 1
        integer(int64) :: first, second
        integer :: round

        place = number
        do
            first = place / self%bases(2)
            second = place - first * self%bases(2)
            do round = 1, rounds, 2
                call shift(first, second, self%bases(1), self%keys(round))
                call shift(second, first, self%bases(2), self%keys(round + 1))
            end do
            place = first * self%bases(2) + second
            if (place < self%length) exit
        end do
    end function place

    !> Adds a hash of one digit to the other, modulo its base.
    elemental subroutine shift(digit, other, base, key)
        integer(int64), intent(inout) :: digit
        integer(int64), intent(in) :: other, base, key
        ! A random word times the base, over 2^32, is uniform in [0, base) to within base/2^32.
        digit = digit + shiftr(mix(ieor(other, key)) * base, 32)
        if (digit >= base) digit = digit - base
    end subroutine shift

end module spintop_sample_design
