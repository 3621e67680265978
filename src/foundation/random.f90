!> Counter-based random numbers. Each is a function of a seed, a number and a stream, so numbers can be
!> computed in any order, on any thread or machine, and there is no state.
!>
!> The arithmetic is that of unsigned 32-bit words, stored in 64-bit integers so that products do not
!> overflow.
module spintop_random
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    implicit none
    private
    public :: philox, mix, uniform, uniforms, random_words

    !> A word with all bits set.
    integer(int64), parameter :: word = int(z'FFFFFFFF', int64)

    !> Rounds of Philox.
    integer, parameter :: rounds = 10
    !> 2^32 times the fractional parts of the golden ratio and of sqrt(3), which the keys of the rounds differ by.
    integer(int64), parameter :: golden = int(z'9E3779B9', int64), root3 = int(z'BB67AE85', int64)
    !> Numbers that are computed together in vector registers.
    integer, parameter :: strip = 64

contains

    !> Philox4x32-10, the block function of four words under a key of two (Salmon, Moraes, Dror and
    !> Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11, 2011). All words are in [0, 2^32).
    pure function philox(counter, key) result(words)
        integer(int64), intent(in) :: counter(4), key(2) !! 32-bit words, in [0, 2^32)
        integer(int64) :: words(4)
        integer(int64) :: w1, w2, w3, w4, key1, key2
        integer :: round

        ! Scalars stay in registers; a version with arrays takes twice as long.
        w1 = counter(1)
        w2 = counter(2)
        w3 = counter(3)
        w4 = counter(4)
        key1 = key(1)
        key2 = key(2)
        do round = 1, rounds
            call mix_words(w1, w2, w3, w4, key1, key2)
            key1 = iand(key1 + golden, word)
            key2 = iand(key2 + root3, word)
        end do
        words = [w1, w2, w3, w4]
    end function philox

    !> A round of Philox.
    elemental subroutine mix_words(w1, w2, w3, w4, key1, key2)
        integer(int64), intent(inout) :: w1, w2, w3, w4
        integer(int64), intent(in) :: key1, key2
        integer(int64), parameter :: factor1 = int(z'D2511F53', int64), factor2 = int(z'CD9E8D57', int64)
        integer(int64) :: high1, low1, high2, low2
        call multiply(factor1, w1, high1, low1)
        call multiply(factor2, w3, high2, low2)
        w1 = ieor(ieor(high2, w2), key1)
        w2 = low2
        w3 = ieor(ieor(high1, w4), key2)
        w4 = low1
    end subroutine mix_words

    !> A bijection of words in which a change of one bit changes each other bit with a probability close to
    !> one half (the last step of MurmurHash3, A. Appleby 2011).
    elemental integer(int64) function mix(x)
        integer(int64), intent(in) :: x !! in [0, 2^32)
        integer(int64) :: high, low
        call multiply(int(z'85EBCA6B', int64), ieor(x, shiftr(x, 16)), high, low)
        mix = ieor(low, shiftr(low, 13))
        call multiply(int(z'C2B2AE35', int64), mix, high, low)
        mix = ieor(low, shiftr(low, 16))
    end function mix

    !> Four random words, of either sign, for a seed, a number and a stream.
    pure function random_words(seed, number, stream) result(words)
        integer(int64), intent(in) :: seed, number, stream !! seed; index of the words; independent stream
        integer(int64) :: words(4)
        words = philox([halves(number), halves(stream)], halves(seed))
    end function random_words

    !> A number uniform in (0, 1), both ends excluded, in steps of 2^-52.
    pure real(dp) function uniform(seed, number, stream)
        integer(int64), intent(in) :: seed, number, stream !! seed; index of the random number; independent stream
        integer(int64) :: words(4)
        words = random_words(seed, number, stream)
        uniform = fraction_of(words(1), words(2))
    end function uniform

    !> Consecutive numbers of a stream, as `uniform` gives them, in vector registers.
    pure subroutine uniforms(seed, first, stream, values)
        integer(int64), intent(in) :: seed, first, stream !! seed; index of the first number; independent stream
        real(dp), intent(out) :: values(:) !! the numbers
        integer(int64), dimension(strip) :: w1, w2, w3, w4
        integer(int64) :: key(2)
        integer :: begin, n, i, round

        do begin = 0, size(values) - 1, strip
            n = min(strip, size(values) - begin)
            do i = 1, strip
                w1(i) = iand(first + (begin + i - 1), word)
                w2(i) = shiftr(first + (begin + i - 1), 32)
            end do
            w3 = iand(stream, word)
            w4 = shiftr(stream, 32)
            key = halves(seed)
            do round = 1, rounds
                !$omp simd
                do i = 1, strip
                    call mix_words(w1(i), w2(i), w3(i), w4(i), key(1), key(2))
                end do
                key = iand(key + [golden, root3], word)
            end do
            values(begin + 1:begin + n) = fraction_of(w1(:n), w2(:n))
        end do
    end subroutine uniforms

    !> The number in (0, 1) of two words.
    elemental real(dp) function fraction_of(word1, word2)
        integer(int64), intent(in) :: word1, word2
        fraction_of = (real(shiftl(word1, 20) + shiftr(word2, 12), dp) + 0.5_dp) * 2.0_dp**(-52)
    end function fraction_of

    !> The low and the high 32-bit word of a 64-bit integer.
    pure function halves(x)
        integer(int64), intent(in) :: x
        integer(int64) :: halves(2)
        halves = [iand(x, word), shiftr(x, 32)]
    end function halves

    !> Product of two words, as two words. If the upper bit of b is set, b - 2^32 is multiplied instead,
    !> because that product fits into a 64-bit integer.
    elemental subroutine multiply(a, b, high, low)
        integer(int64), intent(in) :: a, b
        integer(int64), intent(out) :: high, low
        integer(int64) :: product, upper
        upper = shiftr(b, 31)
        product = a * (b - shiftl(upper, 32))
        high = shifta(product, 32) + a * upper
        low = iand(product, word)
    end subroutine multiply

end module spintop_random
