!> Sums that do not depend on the order of their terms.
!>
!> A term is cut at the multiples of 28 bits of the binary point, and its pieces are added, as integers,
!> to the limbs of the sum. Integers add exactly, so that any order of the terms, and any way to
!> divide them among partial sums, gives the same limbs. Four limbs are kept, those from the highest that
!> any term has reached: what is below is cut off each term alike, which changes the sum by less than
!> 2^-84 of the largest term for each term. No limb overflows before 2^35 terms.
!>
!> The idea is that of Kulisch's long accumulator and of the binned sums of J. Demmel and H. D. Nguyen,
!> "Parallel reproducible summation", IEEE Trans. Comput. 64 (2015).
module spintop_exact_sum
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, qp
    implicit none
    private
    public :: exact_sum_t, add_powers

    !> Bits of a limb, and limbs that are kept.
    integer, parameter :: width = 28, limbs = 4
    integer(int64), parameter :: limb_mask = 2_int64**width - 1
    !> The layout of a double: explicit bits of its significand, and the exponent of the last of them
    !> where the biased exponent is 0.
    integer, parameter :: significand_bits = 52, lowest_exponent = -1074
    integer(int64), parameter :: significand_mask = 2_int64**significand_bits - 1
    integer(int64), parameter :: hidden_bit = 2_int64**significand_bits
    !> A significand is cut in two for its square: the low part has so many bits.
    integer, parameter :: low_bits = 26
    integer(int64), parameter :: low_mask = 2_int64**low_bits - 1

    !> A sum of doubles, or of their squares.
    type :: exact_sum_t
        private
        !> Limb i counts multiples of 2**(width (top - i + 1)).
        integer(int64) :: limb(limbs) = 0
        integer :: top = -1000000
        !> Fills the memory, all of which is written to files.
        integer :: filler = 0
    contains
        procedure :: add
        procedure :: add_square
        procedure :: merge_with
        procedure :: total
        procedure, private :: add_integer
        procedure, private :: raise
    end type exact_sum_t

    !> Sums of the pieces of terms whose lowest pieces lie in the same limb, and which of them were not zero.
    type :: pieces_t
        integer :: lowest = huge(1)
        integer(int64) :: low = 0, middle = 0, high = 0, seen_middle = 0, seen_high = 0
    end type pieces_t

contains

    !> Adds finite terms to a sum, and their squares to another: the same as one after the other, but what terms of
    !> about the same size have in common is done once.
    pure subroutine add_powers(terms, values, squares)
        real(dp), intent(in) :: terms(:) !! any finite numbers, fewer than 2**30
        type(exact_sum_t), intent(inout) :: values, squares !! the sums
        type(pieces_t) :: of_value, of_high, of_low
        integer(int64) :: significand, high, low, twice
        integer :: i, exponent

        do i = 1, size(terms)
            call take_apart(terms(i), significand, exponent)
            if (significand == 0) cycle
            high = shiftr(significand, low_bits)
            low = iand(significand, low_mask)
            ! The square has 106 bits, in two integers.
            twice = 2 * high * low
            high = high * high + shiftr(twice, low_bits)
            low = shiftl(iand(twice, low_mask), low_bits) + low * low
            call gather(of_value, values, significand, exponent, merge(-1_int64, 1_int64, terms(i) < 0))
            call gather(of_high, squares, high, 2 * (exponent + low_bits), 1_int64)
            call gather(of_low, squares, low, 2 * exponent, 1_int64)
        end do
        call flush_pieces(of_value, values)
        call flush_pieces(of_high, squares)
        call flush_pieces(of_low, squares)
    end subroutine add_powers

    !> Adds n 2**exponent, 0 <= n < 2**56, with a sign, to sums of pieces, or begins others.
    pure subroutine gather(pieces, sum, n, exponent, sign)
        type(pieces_t), intent(inout) :: pieces
        type(exact_sum_t), intent(inout) :: sum
        integer(int64), intent(in) :: n, sign
        integer, intent(in) :: exponent
        integer(int64) :: rest, middle, high
        integer :: lowest, shift

        if (n == 0) return
        lowest = floor_of_quotient(exponent)
        shift = exponent - width * lowest
        if (lowest /= pieces%lowest) then
            call flush_pieces(pieces, sum)
            pieces%lowest = lowest
        end if
        rest = shiftr(n, width - shift)
        middle = iand(rest, limb_mask)
        high = shiftr(rest, width)
        pieces%low = pieces%low + sign * shiftl(iand(n, shiftl(1_int64, width - shift) - 1), shift)
        pieces%middle = pieces%middle + sign * middle
        pieces%high = pieces%high + sign * high
        pieces%seen_middle = ior(pieces%seen_middle, ior(middle, high))
        pieces%seen_high = ior(pieces%seen_high, high)
    end subroutine gather

    !> Adds sums of pieces to the limbs of a sum; none are left.
    pure subroutine flush_pieces(pieces, sum)
        type(pieces_t), intent(inout) :: pieces
        type(exact_sum_t), intent(inout) :: sum
        integer :: i, highest

        if (pieces%lowest == huge(1)) return
        highest = pieces%lowest + merge(1, 0, pieces%seen_middle /= 0) + merge(1, 0, pieces%seen_high /= 0)
        if (highest > sum%top) call sum%raise(highest)
        i = sum%top - pieces%lowest + 1
        if (i <= limbs) sum%limb(i) = sum%limb(i) + pieces%low
        if (i > 1 .and. i <= limbs + 1) sum%limb(i - 1) = sum%limb(i - 1) + pieces%middle
        if (i > 2 .and. i <= limbs + 2) sum%limb(i - 2) = sum%limb(i - 2) + pieces%high
        pieces = pieces_t()
    end subroutine flush_pieces

    !> Adds a finite term.
    pure subroutine add(self, term)
        class(exact_sum_t), intent(inout) :: self
        real(dp), intent(in) :: term !! any finite number
        integer(int64) :: significand
        integer :: exponent
        call take_apart(term, significand, exponent)
        if (significand /= 0) call self%add_integer(significand, exponent, term < 0)
    end subroutine add

    !> Adds the square of a finite term, without rounding it.
    pure subroutine add_square(self, term)
        class(exact_sum_t), intent(inout) :: self
        real(dp), intent(in) :: term !! any finite number
        integer(int64) :: significand, high, low, twice
        integer :: exponent
        call take_apart(term, significand, exponent)
        if (significand == 0) return
        high = shiftr(significand, low_bits)
        low = iand(significand, low_mask)
        ! 106 bits, in two integers.
        twice = 2 * high * low
        call self%add_integer(high * high + shiftr(twice, low_bits), 2 * (exponent + low_bits), .false.)
        low = shiftl(iand(twice, low_mask), low_bits) + low * low
        if (low /= 0) call self%add_integer(low, 2 * exponent, .false.)
    end subroutine add_square

    !> Adds the terms of another sum.
    pure subroutine merge_with(self, other)
        class(exact_sum_t), intent(inout) :: self
        type(exact_sum_t), intent(in) :: other !! the other object of this type
        integer :: shift
        if (other%top > self%top) call self%raise(other%top)
        shift = self%top - other%top
        if (shift >= limbs) return
        self%limb(shift + 1:) = self%limb(shift + 1:) + other%limb(:limbs - shift)
    end subroutine merge_with

    !> The sum. It is a function of the terms alone, to 2^-84 of the largest for each of them.
    pure real(qp) function total(self)
        class(exact_sum_t), intent(in) :: self
        integer :: i
        total = 0
        do i = limbs, 1, -1
            if (self%limb(i) /= 0) total = total + scale(real(self%limb(i), qp), width * (self%top - i + 1))
        end do
    end function total

    !> A finite double as |x| = significand 2**exponent.
    pure subroutine take_apart(x, significand, exponent)
        real(dp), intent(in) :: x
        integer(int64), intent(out) :: significand
        integer, intent(out) :: exponent
        integer(int64) :: bits
        integer :: biased
        bits = transfer(x, bits)
        significand = iand(bits, significand_mask)
        biased = int(iand(shiftr(bits, significand_bits), 2047_int64))
        if (biased > 0) significand = ior(significand, hidden_bit)
        exponent = lowest_exponent + max(biased, 1) - 1
    end subroutine take_apart

    !> Adds or subtracts n 2**exponent, 0 < n < 2**56.
    pure subroutine add_integer(self, n, exponent, is_negative)
        class(exact_sum_t), intent(inout) :: self
        integer(int64), intent(in) :: n
        integer, intent(in) :: exponent
        logical, intent(in) :: is_negative
        integer(int64) :: low, middle, high, rest
        integer :: lowest, shift, highest, i

        lowest = floor_of_quotient(exponent)
        shift = exponent - width * lowest
        low = shiftl(iand(n, shiftl(1_int64, width - shift) - 1), shift)
        rest = shiftr(n, width - shift)
        middle = iand(rest, limb_mask)
        high = shiftr(rest, width)
        highest = lowest + merge(merge(2, 1, high /= 0), 0, rest /= 0)
        if (highest > self%top) call self%raise(highest)
        if (is_negative) then
            low = -low
            middle = -middle
            high = -high
        end if
        ! The limb of the lowest piece. What is not kept of it are pieces that are zero above the highest limb,
        ! and those below the lowest.
        i = self%top - lowest + 1
        if (i > 2 .and. i <= limbs) then
            self%limb(i) = self%limb(i) + low
            self%limb(i - 1) = self%limb(i - 1) + middle
            self%limb(i - 2) = self%limb(i - 2) + high
        else
            if (i <= limbs) self%limb(i) = self%limb(i) + low
            if (i > 1 .and. i <= limbs + 1) self%limb(i - 1) = self%limb(i - 1) + middle
            if (i > 2 .and. i <= limbs + 2) self%limb(i - 2) = self%limb(i - 2) + high
        end if
    end subroutine add_integer

    !> The limb in which a power of two lies: the exponent over the width, rounded down.
    pure integer function floor_of_quotient(exponent)
        integer, intent(in) :: exponent
        ! Of a positive number the quotient is rounded down by itself.
        integer, parameter :: offset = 1000
        floor_of_quotient = (exponent + offset * width) / width - offset
    end function floor_of_quotient

    !> Raises the highest limb; the limbs that are then too low are dropped.
    pure subroutine raise(self, top)
        class(exact_sum_t), intent(inout) :: self
        integer, intent(in) :: top
        integer :: shift
        shift = min(top - self%top, limbs)
        self%limb = eoshift(self%limb, -shift)
        self%top = top
    end subroutine raise

end module spintop_exact_sum
