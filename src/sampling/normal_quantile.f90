!> The inverse of the normal distribution function.
module spintop_normal_quantile
    use spintop_kinds, only: dp
    implicit none
    private
    public :: normal_quantile

    !> Coefficients of the three rational approximations: near the middle, in the tails, and far in the tails.
    real(dp), parameter :: top_middle(8) = [ &
        3.3871328727963666080e0_dp, 1.3314166789178437745e2_dp, 1.9715909503065514427e3_dp, 1.3731693765509461125e4_dp, &
        4.5921953931549871457e4_dp, 6.7265770927008700853e4_dp, 3.3430575583588128105e4_dp, 2.5090809287301226727e3_dp]
    real(dp), parameter :: bottom_middle(8) = [ &
        1.0_dp, 4.2313330701600911252e1_dp, 6.8718700749205790830e2_dp, 5.3941960214247511077e3_dp, &
        2.1213794301586595867e4_dp, 3.9307895800092710610e4_dp, 2.8729085735721942674e4_dp, 5.2264952788528545610e3_dp]
    real(dp), parameter :: top_tail(8) = [ &
        1.42343711074968357734e0_dp, 4.63033784615654529590e0_dp, 5.76949722146069140550e0_dp, 3.64784832476320460504e0_dp, &
        1.27045825245236838258e0_dp, 2.41780725177450611770e-1_dp, 2.27238449892691845833e-2_dp, 7.74545014278341407640e-4_dp]
    real(dp), parameter :: bottom_tail(8) = [ &
        1.0_dp, 2.05319162663775882187e0_dp, 1.67638483018380384940e0_dp, 6.89767334985100004550e-1_dp, &
        1.48103976427480074590e-1_dp, 1.51986665636164571966e-2_dp, 5.47593808499534494600e-4_dp, 1.05075007164441684324e-9_dp]
    real(dp), parameter :: top_far(8) = [ &
        6.65790464350110377720e0_dp, 5.46378491116411436990e0_dp, 1.78482653991729133580e0_dp, 2.96560571828504891230e-1_dp, &
        2.65321895265761230930e-2_dp, 1.24266094738807843860e-3_dp, 2.71155556874348757815e-5_dp, 2.01033439929228813265e-7_dp]
    real(dp), parameter :: bottom_far(8) = [ &
        1.0_dp, 5.99832206555887937690e-1_dp, 1.36929880922735805310e-1_dp, 1.48753612908506148525e-2_dp, &
        7.86869131145613259100e-4_dp, 1.84631831751005468180e-5_dp, 1.42151175831644588870e-7_dp, 2.04426310338993978564e-15_dp]

contains

    !> The value below which a standard normal variable lies with probability `p`, accurate to about 1e-16, by algorithm
    !> AS 241 (M. J. Wichura, Applied Statistics 37, 1988, 477-484); -huge and huge for p <= 0 and p >= 1.
    elemental real(dp) function normal_quantile(p) result(x)
        real(dp), intent(in) :: p !! a probability
        real(dp) :: centred, r

        centred = p - 0.5_dp
        if (abs(centred) <= 0.425_dp) then
            r = 0.180625_dp - centred**2
            x = centred * polynomial(top_middle, r) / polynomial(bottom_middle, r)
            return
        end if
        r = min(p, 1 - p)
        if (.not. r > 0) then
            x = sign(huge(x), centred)
            return
        end if
        r = sqrt(-log(r))
        if (r <= 5) then
            x = polynomial(top_tail, r - 1.6_dp) / polynomial(bottom_tail, r - 1.6_dp)
        else
            x = polynomial(top_far, r - 5) / polynomial(bottom_far, r - 5)
        end if
        x = sign(x, centred)
    end function normal_quantile

    !> A polynomial of degree 7, from the constant term.
    pure real(dp) function polynomial(coefficients, x)
        real(dp), intent(in) :: coefficients(8), x
        integer :: i
        polynomial = coefficients(8)
        do i = 7, 1, -1
            polynomial = polynomial * x + coefficients(i)
        end do
    end function polynomial

end module spintop_normal_quantile
