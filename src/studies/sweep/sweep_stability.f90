!> The quantities of a sweep table that tell of the stability of a motion. Those that perturbations tell are left to an engine
!> of their own, `perturbations_t`.
module spintop_sweep_stability
    use spintop_kinds, only: dp
    use spintop_floquet, only: find_multipliers
    use spintop_relative_equilibrium, only: find_equilibrium_eigenvalues
    use spintop_tangent_flow, only: drive_period
    use spintop_steady_motion, only: critical_omega3
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_status, only: is_ok, status_meanings, status_unsuitable
    use spintop_sweep_engine, only: lacks_perturbations, slot_t
    use spintop_sweep_result, only: at_critical_omega3, at_sleeping_ratio, at_growth_rate, at_upright_multiplier, &
        note_no_growth, note_no_lyapunov, note_no_multiplier, note_no_singular, &
        only_without_effects, kinds_of_work, of_growth, of_lyapunov, of_multiplier, of_singular
    implicit none
    private
    public :: compute_stability, set_threshold

    real(dp), parameter :: no_angles(3) = 0

contains

    !> The growth rate at a relative equilibrium, and the largest multiplier over a period of the vibration. The Lyapunov exponent
    !> and the largest singular value up to the end of the motion are left to `perturbations_t`.
    subroutine compute_stability(slot, t_end, wanted)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        real(dp), intent(in) :: t_end !! end of the motion, s
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        complex(dp) :: eigenvalues(6)
        integer :: how

        if (wanted(of_growth)) then
            call find_equilibrium_eigenvalues(slot%case%body, slot%case%start, eigenvalues, how)
            if (is_ok(how)) then
                slot%result%of(at_growth_rate) = maxval(real(eigenvalues, dp))
            else if (how == status_unsuitable) then
                call slot%note%add(note_no_growth, 'the start is not at rest, sleeping or steady')
            else
                call slot%note%add(note_no_growth, trim(status_meanings(how)))
            end if
        end if
        if (wanted(of_lyapunov) .or. wanted(of_singular)) then
            if (.not. allocated(slot%case%body%effects)) then
                slot%growth_until = t_end
                slot%lacks = lacks_perturbations
            else
                if (wanted(of_lyapunov)) call slot%note%add(note_no_lyapunov, only_without_effects)
                if (wanted(of_singular)) call slot%note%add(note_no_singular, only_without_effects)
            end if
        end if
        if (wanted(of_multiplier)) call compute_multiplier(slot)
    end subroutine compute_stability

    !> The threshold spin of the sleeping top, and the spin at the start over it. Without a torque of gravity the threshold is
    !> zero, and nothing is over it.
    subroutine set_threshold(slot)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        real(dp) :: omega3
        associate (body => slot%case%body, values => slot%result)
            if (.not. body%is_symmetric()) return
            values%of(at_critical_omega3) = critical_omega3(body)
            if (.not. values%of(at_critical_omega3) > 0) return
            omega3 = slot%case%start%omega(3)
            if (allocated(body%effects)) omega3 = omega3 + body%effects%rotor_momentum(3) / body%inertia(3)
            values%of(at_sleeping_ratio) = abs(omega3) / values%of(at_critical_omega3)
        end associate
    end subroutine set_threshold

    !> The largest multiplier of the upright body, over a period of the vibration: its centre of mass is above the pivot,
    !> and it rotates about the vertical with the angular velocity that the start has about that axis of the body.
    subroutine compute_multiplier(slot)
        type(slot_t), intent(inout) :: slot
        complex(dp) :: multipliers(6)
        type(motion_t) :: upright
        integer :: how
        associate (body => slot%case%body)
            if (.not. drive_period(body) > 0) then
                call slot%note%add(note_no_multiplier, 'the only effect must be a vertical vibration, or that and a rotor')
                return
            end if
            upright = upright_motion(body%centre_of_mass, slot%case%start%omega)
            call find_multipliers(body, upright, drive_period(body), multipliers, how)
        end associate
        if (is_ok(how)) then
            slot%result%of(at_upright_multiplier) = maxval(abs(multipliers))
        else if (how == status_unsuitable) then
            call slot%note%add(note_no_multiplier, 'the body cannot rotate steadily about the axis through its centre of mass')
        else
            call slot%note%add(note_no_multiplier, trim(status_meanings(how)))
        end if
    end subroutine compute_multiplier

    !> The rotation about the vertical of a body whose centre of mass is above the pivot.
    pure type(motion_t) function upright_motion(centre_of_mass, omega) result(upright)
        real(dp), intent(in) :: centre_of_mass(3), omega(3)
        real(dp) :: axis(3), quaternion(4)
        axis = [0.0_dp, 0.0_dp, 1.0_dp]
        if (norm2(centre_of_mass) > 0) axis = centre_of_mass / norm2(centre_of_mass)
        ! The smallest rotation that brings the axis upright; from below about body x.
        quaternion = [1 + axis(3), axis(2), -axis(1), 0.0_dp]
        if (.not. norm2(quaternion) > 0) quaternion = [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp]
        upright = motion_from_quaternion(0.0_dp, quaternion / norm2(quaternion), dot_product(omega, axis) * axis, no_angles)
    end function upright_motion

end module spintop_sweep_stability
