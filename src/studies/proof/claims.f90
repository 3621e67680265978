!> What the program claims of the numbers of the exact solution: they are as good as the data allow.
module spintop_claims
    use spintop_case, only: case_t
    use spintop_certificate, only: proof_count, proof_of_omega1, proof_of_phi, proof_of_psi, proof_of_q3, &
        proof_of_theta
    use spintop_compare, only: is_finite
    use spintop_kinds, only: dp, no_number
    use spintop_principal_axes, only: find_principal_axes
    implicit none
    private
    public :: claim_of

    !> A number may differ from the true one by so many times the inherent error, and by this.
    real(dp), parameter :: allowed = 10, rounding = 1.0e-14_dp
    !> The same of a sweep, whose cases are computed in blocks.
    real(dp), parameter :: block_rounding = 5.0e-13_dp
    !> Relative size of b - a or b + a below which rounding decides on which side of a pole the axis passes.
    real(dp), parameter :: decided = 1.0e-13_dp

contains

    !> The largest error that a printed quantity should have; NaN where nothing is claimed: of phi and psi
    !> where rounding of the data decides them.
    pure real(dp) function claim_of(quantity, case, printed, inherent, in_block) result(claim)
        integer, intent(in) :: quantity !! number of the quantity (spintop_certificate)
        type(case_t), intent(in) :: case !! body and start
        real(dp), intent(in) :: printed(proof_count) !! the printed quantities, NaN for others
        real(dp), intent(in) :: inherent !! the inherent error of the attitude, rad; NaN if unknown
        logical, intent(in) :: in_block !! whether it is the number of a sweep
        real(dp) :: attitude, least

        claim = no_number
        attitude = allowed * inherent + rounding
        if (in_block) then
            attitude = allowed * inherent + block_rounding * max(1.0_dp, abs(printed(proof_of_phi)) + abs(printed(proof_of_psi)))
            if (.not. is_finite(attitude)) return ! both angles are needed
        end if
        if (quantity <= proof_of_q3) claim = attitude
        if (quantity >= proof_of_omega1) claim = attitude * speed_of(case)
        if (quantity == proof_of_theta) claim = attitude + spacing(printed(proof_of_theta))
        if (quantity /= proof_of_phi .and. quantity /= proof_of_psi) return
        least = min(sin(printed(proof_of_theta) / 2), cos(printed(proof_of_theta) / 2))
        if (.not. is_finite(least)) return
        if (attitude < 0.1_dp * least .and. is_decided(case)) claim = 2 * attitude / least + spacing(printed(quantity))
    end function claim_of

    !> At least the angular velocity of a motion, in body axes and in those of the momentum, rad/s.
    pure real(dp) function speed_of(case) result(speed)
        type(case_t), intent(in) :: case
        real(dp) :: moments(3), axes(4)
        associate (body => case%given_body, omega => case%given_start%omega)
            call find_principal_axes(body%inertia, body%products, moments, axes)
            speed = sqrt((dot_product(omega, body%momentum(omega)) &
                          + 4 * abs(body%mass * body%gravity) * norm2(body%centre_of_mass)) / minval(moments))
            if (allocated(body%effects)) speed = speed + norm2(body%effects%rotor_momentum) / minval(moments)
        end associate
    end function speed_of

    !> Whether the data say on which side the axis passes each pole: phi turns by nearly pi there, one way or the other,
    !> as the signs of b - a and b + a are.
    pure logical function is_decided(case)
        type(case_t), intent(in) :: case
        real(dp) :: u, a, turn, ratio, rotor
        associate (body => case%given_body, start => case%given_start)
            u = cos(start%angle(2))
            ratio = body%inertia(3) / body%inertia(1)
            rotor = 0
            if (allocated(body%effects)) rotor = body%effects%rotor_momentum(3) / body%inertia(1)
            a = ratio * start%omega(3) + rotor
            turn = start%rate(1)
            is_decided = min(abs((1 + u) * turn - a), abs((1 - u) * turn + a)) &
                         > decided * (abs(start%rate(3)) * ratio + abs(turn) + abs(rotor))
        end associate
    end function is_decided

end module spintop_claims
