!> The quantities of the stability of a case in a sweep table.
module spintop_sweep_stability
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_case, only: case_t
    use spintop_driven_flow, only: drive_period
    use spintop_floquet, only: find_multipliers
    use spintop_growth_lanes, only: find_growth, growth_t
    use spintop_relative_equilibrium, only: find_equilibrium_eigenvalues
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_status, only: status_ok, status_non_finite, status_step_limit, status_unsuitable, status_meanings
    use spintop_sweep_notes, only: note_t, note_no_growth, note_no_lyapunov, note_no_multiplier, note_no_singular, &
        only_without_effects
    use spintop_sweep_result, only: sweep_result_t, sweep_work_t
    implicit none
    private
    public :: put_stability

    real(dp), parameter :: no_angles(3) = 0

contains

    !> The growth rate at a relative equilibrium, the Lyapunov exponent and the largest singular value up to the end of the
    !> motion, and the largest multiplier over a period of the vibration.
    !> `status` reports work that was not finished, or overflow.
    subroutine put_stability(case, t_end, wanted, max_steps, values, status, note)
        type(case_t), intent(in) :: case !! body, start and span
        real(dp), intent(in) :: t_end !! end of the motion, s
        type(sweep_work_t), intent(in) :: wanted !! selected groups of quantities
        integer(int64), intent(inout) :: max_steps !! remaining work of the case
        type(sweep_result_t), intent(inout) :: values !! the quantities of the case
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(note_t), intent(inout) :: note !! notes on the case
        complex(dp) :: eigenvalues(6)
        integer :: how

        status = status_ok
        if (wanted%growth) then
            call find_equilibrium_eigenvalues(case%body, case%start, eigenvalues, how)
            if (how == status_ok) then
                values%growth_rate = maxval(real(eigenvalues, dp))
            else if (how == status_unsuitable) then
                call note%add(note_no_growth, 'the start is not at rest, sleeping or steady')
            else
                call note%add(note_no_growth, trim(status_meanings(how)))
            end if
        end if
        if (wanted%lyapunov .or. wanted%singular) call put_growth()
        if (wanted%multiplier) call put_multiplier(case, values, note)

    contains

        !> The growth of perturbations, whose equations are those without effects.
        subroutine put_growth()
            type(growth_t) :: growth(1)
            if (allocated(case%body%effects)) then
                if (wanted%lyapunov) call note%add(note_no_lyapunov, only_without_effects)
                if (wanted%singular) call note%add(note_no_singular, only_without_effects)
                return
            end if
            call find_growth([case%body], [case%start], [t_end], wanted%lyapunov, wanted%singular, &
                             max(max_steps, 1_int64), growth)
            max_steps = max_steps - growth(1)%steps
            if (wanted%lyapunov) then
                call take(growth(1)%exponent, growth(1)%exponent_status, values%lyapunov_exponent, note_no_lyapunov)
            end if
            if (wanted%singular) then
                call take(growth(1)%singular, growth(1)%singular_status, values%largest_singular_value, note_no_singular)
            end if
        end subroutine put_growth

        !> Stores a value, or notes the reason why there is none.
        subroutine take(value, how, quantity, reason)
            real(dp), intent(in) :: value
            integer, intent(in) :: how, reason
            real(dp), intent(inout) :: quantity
            if (how == status_ok) then
                quantity = value
            else
                call note%add(reason, trim(status_meanings(how)))
                if (how == status_step_limit .or. how == status_non_finite) status = how
            end if
        end subroutine take

    end subroutine put_stability

    !> The largest multiplier of the upright body, over a period of the vibration: its centre of mass is above the pivot,
    !> and it rotates about the vertical with the angular velocity that the start has about that axis of the body.
    subroutine put_multiplier(case, values, note)
        type(case_t), intent(in) :: case
        type(sweep_result_t), intent(inout) :: values
        type(note_t), intent(inout) :: note
        complex(dp) :: multipliers(6)
        type(motion_t) :: upright
        integer :: how
        if (.not. drive_period(case%body) > 0) then
            call note%add(note_no_multiplier, 'the only effect must be a vertical vibration, or that and a rotor')
            return
        end if
        upright = upright_motion(case%body%centre_of_mass, case%start%omega)
        call find_multipliers(case%body, upright, drive_period(case%body), multipliers, how)
        if (how == status_ok) then
            values%upright_multiplier = maxval(abs(multipliers))
        else if (how == status_unsuitable) then
            call note%add(note_no_multiplier, 'the body cannot rotate steadily about the axis through its centre of mass')
        else
            call note%add(note_no_multiplier, trim(status_meanings(how)))
        end if
    end subroutine put_multiplier

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
