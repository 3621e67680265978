!> Random numbers one after the other, the same at every run.
module random_stream
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_random, only: uniform
    implicit none
    private
    public :: random_stream_t

    !> The numbers of a seed.
    type :: random_stream_t
        integer(int64) :: seed = 20121, number = 0
    contains
        procedure :: share
        procedure :: between
        procedure :: several
        procedure :: of_size
        procedure :: of_any_size
    end type random_stream_t

contains

    !> The next number, uniform in (0, 1).
    real(dp) function share(self)
        class(random_stream_t), intent(inout) :: self
        self%number = self%number + 1
        share = uniform(self%seed, self%number, 0_int64)
    end function share

    !> The next number, uniform between two.
    real(dp) function between(self, low, high)
        class(random_stream_t), intent(inout) :: self
        real(dp), intent(in) :: low, high
        between = low + (high - low) * self%share()
    end function between

    !> The next numbers, uniform between two.
    function several(self, n, low, high)
        class(random_stream_t), intent(inout) :: self
        integer, intent(in) :: n
        real(dp), intent(in) :: low, high
        real(dp) :: several(n)
        integer :: i
        do i = 1, n
            several(i) = self%between(low, high)
        end do
    end function several

    !> The next number between two positive ones, uniform in its logarithm.
    real(dp) function of_size(self, low, high)
        class(random_stream_t), intent(inout) :: self
        real(dp), intent(in) :: low, high
        of_size = low * (high / low)**self%share()
    end function of_size

    !> A number of either sign and of up to so many digits before or behind the point; one in 16 is zero,
    !> infinite or a NaN.
    real(dp) function of_any_size(self, digits) result(x)
        class(random_stream_t), intent(inout) :: self
        real(dp), intent(in) :: digits
        real(dp) :: kind
        kind = self%share()
        x = self%between(-1.0_dp, 1.0_dp) * 10.0_dp**self%between(-digits, digits)
        if (kind < 0.06_dp) x = 0
        if (kind < 0.04_dp) x = sign(huge(x), self%between(-1.0_dp, 1.0_dp)) * self%between(1.0_dp, 4.0_dp)
        if (kind < 0.02_dp) x = (x - x) / (x - x)
    end function of_any_size

end module random_stream
