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
module spintop_order_free_sum
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
    integer(int64), parameter :: biased_mask = 2047
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
    end type exact_sum_t

    !> Terms whose pieces are added together, and fewer of them that are added one by one.
    integer, parameter :: strip = 64, fewest = 6
    !> Limbs in which the pieces of these terms lie: they begin one limb below that of the last bit of the largest.
    integer, parameter :: span = 4

contains

    !> Adds finite terms to a sum, and their squares to another: the same as one after the other, but terms of about
    !> the same size are added together in vector registers.
    pure subroutine add_powers(terms, values, squares)
        real(dp), intent(in) :: terms(:) !! any finite numbers
        type(exact_sum_t), intent(inout) :: values, squares !! the sums
        integer :: first, last, i

        do first = 1, size(terms), strip
            last = min(first + strip - 1, size(terms))
            if (last - first + 1 >= fewest) then
                call add_strip(last - first + 1, terms(first:last), values, squares)
                cycle
            end if
            do i = first, last
                call values%add(terms(i))
                call squares%add_square(terms(i))
            end do
        end do
    end subroutine add_powers

    !> The same for at most `strip` terms. The largest is added alone, by which the sums reach their highest limbs, and so
    !> are terms that are much smaller.
    pure subroutine add_strip(n, terms, values, squares)
        integer, intent(in) :: n
        real(dp), intent(in) :: terms(n)
        type(exact_sum_t), intent(inout) :: values, squares
        integer(int64), dimension(strip) :: positive, negative, exponent, high, low, is_with
        integer(int64) :: bits, significand, twice, least, any_negative
        integer :: i, largest

        largest = maxloc(abs(terms), dim=1)
        least = least_exponent(terms(largest))
        any_negative = 0
        !$omp simd private(bits, significand, twice) reduction(ior: any_negative)
        do i = 1, n
            bits = transfer(terms(i), bits)
            exponent(i) = iand(shiftr(bits, significand_bits), biased_mask)
            is_with(i) = merge(-1_int64, 0_int64, exponent(i) >= least .and. i /= largest)
            significand = iand(ior(iand(bits, significand_mask), hidden_bit), is_with(i))
            positive(i) = merge(significand, 0_int64, bits >= 0)
            negative(i) = significand - positive(i)
            any_negative = ior(any_negative, negative(i))
            high(i) = shiftr(significand, low_bits)
            low(i) = iand(significand, low_mask)
            ! The square has 106 bits, in two integers.
            twice = 2 * high(i) * low(i)
            high(i) = high(i) * high(i) + shiftr(twice, low_bits)
            low(i) = shiftl(iand(twice, low_mask), low_bits) + low(i) * low(i)
            exponent(i) = max(exponent(i), least) + (lowest_exponent - 1)
        end do
        do i = 1, n
            if (is_with(i) /= 0) cycle
            call values%add(terms(i))
            call squares%add_square(terms(i))
        end do
        i = int(exponent(largest))
        call add_pieces(n, positive, exponent, 1, limb_of(i) - 1, 1_int64, values)
        if (any_negative /= 0) call add_pieces(n, negative, exponent, 1, limb_of(i) - 1, -1_int64, values)
        call add_pieces(n, low, exponent, 2, limb_of(2 * i) - 1, 1_int64, squares)
        exponent(:n) = exponent(:n) + low_bits
        call add_pieces(n, high, exponent, 2, limb_of(2 * (i + low_bits)) - 1, 1_int64, squares)
    end subroutine add_strip

    !> The least biased exponent, at least 1, of terms whose pieces, and those of their squares, lie in `span` limbs with
    !> those of the largest term.
    pure integer function least_exponent(largest)
        real(dp), intent(in) :: largest
        integer(int64) :: significand
        integer :: exponent, ends(3)
        call decompose(largest, significand, exponent)
        ! The exponent where the limb begins, and its half (it is even) for twice the exponent.
        ends = width * ([limb_of(exponent), limb_of(2 * exponent), limb_of(2 * (exponent + low_bits))] - 1)
        least_exponent = max(ends(1), ends(2) / 2, ends(3) / 2 - low_bits, lowest_exponent) - lowest_exponent + 1
    end function least_exponent

    !> Adds the first of the terms sign n 2**(times exponent), 0 <= n < 2**56, whose pieces lie in `span` limbs from
    !> `first` upwards. The sum has the limbs that they reach.
    pure subroutine add_pieces(terms, n, exponent, times, first, sign, sum)
        integer, intent(in) :: terms
        integer(int64), intent(in) :: n(strip), exponent(strip), sign
        integer, intent(in) :: times, first
        type(exact_sum_t), intent(inout) :: sum
        integer(int64) :: shift, rest, low, middle, high, p1, p2, p3, p4, start, is_upper
        integer :: i

        start = first * width
        p1 = 0
        p2 = 0
        p3 = 0
        p4 = 0
        !$omp simd private(shift, rest, low, middle, high, is_upper) reduction(+: p1, p2, p3, p4)
        do i = 1, terms
            shift = times * exponent(i) - start
            ! All bits where the lowest piece lies in the second limb.
            is_upper = merge(-1_int64, 0_int64, shift >= width)
            ! That the shifts are less than 64 need not be checked.
            shift = iand(shift - iand(is_upper, int(width, int64)), 31_int64)
            low = iand(shiftl(n(i), shift), limb_mask)
            rest = shiftr(n(i), iand(width - shift, 31_int64))
            middle = iand(rest, limb_mask)
            high = shiftr(rest, width)
            p1 = p1 + iand(low, not(is_upper))
            p2 = p2 + merge(low, middle, is_upper /= 0)
            p3 = p3 + merge(middle, high, is_upper /= 0)
            p4 = p4 + iand(high, is_upper)
        end do
        call add_limb(sum, first, sign * p1)
        call add_limb(sum, first + 1, sign * p2)
        call add_limb(sum, first + 2, sign * p3)
        call add_limb(sum, first + 3, sign * p4)
    end subroutine add_pieces

    !> Adds to a limb, if it is one of those that are kept.
    pure subroutine add_limb(sum, place, number)
        type(exact_sum_t), intent(inout) :: sum
        integer, intent(in) :: place
        integer(int64), intent(in) :: number
        integer :: i
        i = sum%top - place + 1
        if (i >= 1 .and. i <= limbs) sum%limb(i) = sum%limb(i) + number
    end subroutine add_limb

    !> Adds a finite term.
    pure subroutine add(self, term)
        class(exact_sum_t), intent(inout) :: self
        real(dp), intent(in) :: term !! any finite number
        integer(int64) :: significand
        integer :: exponent
        call decompose(term, significand, exponent)
        if (significand /= 0) call add_integer(self, significand, exponent, term < 0)
    end subroutine add

    !> Adds the square of a finite term, without rounding it.
    pure subroutine add_square(self, term)
        class(exact_sum_t), intent(inout) :: self
        real(dp), intent(in) :: term !! any finite number
        integer(int64) :: significand, high, low, twice
        integer :: exponent
        call decompose(term, significand, exponent)
        if (significand == 0) return
        high = shiftr(significand, low_bits)
        low = iand(significand, low_mask)
        ! 106 bits, in two integers.
        twice = 2 * high * low
        call add_integer(self, high * high + shiftr(twice, low_bits), 2 * (exponent + low_bits), .false.)
        low = shiftl(iand(twice, low_mask), low_bits) + low * low
        if (low /= 0) call add_integer(self, low, 2 * exponent, .false.)
    end subroutine add_square

    !> Adds the terms of another sum.
    elemental subroutine merge_with(self, other)
        class(exact_sum_t), intent(inout) :: self
        type(exact_sum_t), intent(in) :: other !! the sum whose terms are added
        integer :: shift
        if (other%top > self%top) call raise(self, other%top)
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
    pure subroutine decompose(x, significand, exponent)
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
    end subroutine decompose

    !> Adds or subtracts n 2**exponent, 0 < n < 2**56.
    pure subroutine add_integer(self, n, exponent, is_negative)
        class(exact_sum_t), intent(inout) :: self
        integer(int64), intent(in) :: n
        integer, intent(in) :: exponent
        logical, intent(in) :: is_negative
        integer(int64) :: low, middle, high, rest, sign
        integer :: lowest, shift, highest

        lowest = limb_of(exponent)
        shift = exponent - width * lowest
        low = shiftl(iand(n, shiftl(1_int64, width - shift) - 1), shift)
        rest = shiftr(n, width - shift)
        middle = iand(rest, limb_mask)
        high = shiftr(rest, width)
        highest = lowest + merge(merge(2, 1, high /= 0), 0, rest /= 0)
        if (highest > self%top) call raise(self, highest)
        ! What is not kept are pieces that are zero above the highest limb, and those below the lowest.
        sign = merge(-1, 1, is_negative)
        call add_limb(self, lowest, sign * low)
        call add_limb(self, lowest + 1, sign * middle)
        call add_limb(self, lowest + 2, sign * high)
    end subroutine add_integer

    !> The limb in which a power of two lies: the exponent over the width, rounded down.
    pure integer function limb_of(exponent)
        integer, intent(in) :: exponent
        ! Of a positive number the quotient is rounded down by itself.
        integer, parameter :: offset = 1000
        limb_of = (exponent + offset * width) / width - offset
    end function limb_of

    !> Raises the highest limb; the limbs that are then too low are dropped.
    pure subroutine raise(self, top)
        class(exact_sum_t), intent(inout) :: self
        integer, intent(in) :: top
        integer :: shift
        shift = min(top - self%top, limbs)
        self%limb = eoshift(self%limb, -shift)
        self%top = top
    end subroutine raise

end module spintop_order_free_sum
