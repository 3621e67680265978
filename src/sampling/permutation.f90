!> Random permutations of any length, evaluated element by element, without a table.
!>
!> A number below a*b is written with two digits, to the bases a and b. A Feistel network adds a keyed hash of
!> one digit to the other, in turn; this is invertible, so it permutes the numbers below a*b. A result that is
!> not below the length is permuted again (J. Black and P. Rogaway, "Ciphers with arbitrary finite domains",
!> CT-RSA 2002: generalized Feistel network with cycle walking). This is rare, because a and b are close to
!> the square root of the length.
module spintop_permutation
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_random, only: mix, random_words
    implicit none
    private
    public :: permutation_t, make_permutation

    !> Rounds of the network; even. With fewer rounds, short permutations do not look random.
    integer, parameter :: rounds = 8
    integer, parameter :: words_a_draw = 4

    !> A permutation of 0, ..., length - 1.
    type :: permutation_t
        integer(int64), private :: length = 1
        integer(int64), private :: bases(2) = 1
        integer(int64), private :: keys(rounds) = 0
    contains
        procedure :: place
    end type permutation_t

contains

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

end module spintop_permutation
