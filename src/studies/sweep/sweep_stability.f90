!> The quantities of a sweep table that tell of the stability of a motion. Those that perturbations tell, Lyapunov exponents,
!> largest singular values and inherent errors, are found together in lanes for the cases of a block, however their motions
!> were computed.
module spintop_sweep_stability
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t
    use spintop_kinds, only: dp
    use spintop_driven_flow, only: drive_period
    use spintop_floquet, only: find_multipliers
    use spintop_lyapunov_lanes, only: find_growth, growth_t
    use spintop_inherent_lanes, only: find_inherent_errors
    use spintop_relative_equilibrium, only: find_equilibrium_eigenvalues
    use spintop_steady_motion, only: critical_omega3
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_status, only: is_ok, status_meanings, status_non_finite, status_step_limit, status_unsuitable
    use spintop_sweep_engine, only: engine_t, lacks_perturbations, slot_t, task_t
    use spintop_sweep_notes, only: note_no_growth, note_no_inherent, note_no_lyapunov, note_no_multiplier, &
        note_no_singular, note_no_threshold, note_t, only_without_effects
    use spintop_sweep_result, only: kinds_of_work, of_growth, of_inherent, of_lyapunov, of_multiplier, of_singular
    implicit none
    private
    public :: compute_stability, ask_for_inherent_error, set_threshold, explain_no_threshold, perturbations_t

    real(dp), parameter :: no_angles(3) = 0

    !> The engine for perturbations of motions that have been computed.
    type, extends(engine_t) :: perturbations_t
    contains
        procedure :: compute
        procedure, nopass :: shares_lanes
    end type perturbations_t

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
                slot%result%growth_rate = maxval(real(eigenvalues, dp))
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
            values%critical_omega3 = critical_omega3(body)
            if (.not. values%critical_omega3 > 0) return
            omega3 = slot%case%start%omega(3)
            if (allocated(body%effects)) omega3 = omega3 + body%effects%rotor_momentum(3) / body%inertia(3)
            values%sleeping_ratio = abs(omega3) / values%critical_omega3
        end associate
    end subroutine set_threshold

    !> Notes why a case has no threshold of a sleeping top, or no spin over it.
    subroutine explain_no_threshold(case, note)
        type(case_t), intent(in) :: case !! the case that lacks the quantity
        type(note_t), intent(inout) :: note !! notes on the case
        if (note%has(note_no_threshold)) return
        if (case%body%is_symmetric()) then
            call note%add(note_no_threshold, 'gravity exerts no torque')
        else
            call note%add(note_no_threshold, 'the body is not symmetric')
        end if
    end subroutine explain_no_threshold

    !> Leaves the inherent error of a motion to `perturbations_t`.
    subroutine ask_for_inherent_error(slot, t_end)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        real(dp), intent(in) :: t_end !! end of the motion, s
        if (allocated(slot%case%body%effects)) then
            call slot%note%add(note_no_inherent, only_without_effects)
        else
            slot%inherent_until = t_end
            slot%lacks = lacks_perturbations
        end if
    end subroutine ask_for_inherent_error

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
            slot%result%upright_multiplier = maxval(abs(multipliers))
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

    !> Cases of one limit of work share lanes.
    logical function shares_lanes(a, b)
        type(slot_t), intent(in) :: a, b !! the cases
        shares_lanes = a%max_steps == b%max_steps
    end function shares_lanes

    !> Computes what perturbations of the cases have to tell.
    subroutine compute(self, slots, list, task)
        class(perturbations_t), intent(inout) :: self
        type(slot_t), intent(inout) :: slots(:) !! the block
        integer, intent(in) :: list(:) !! the places of the cases
        type(task_t), intent(in) :: task !! what is asked of them
        call compute_inherent_errors(slots, pack(list, slots(list)%inherent_until > 0))
        call compute_growths(slots, pack(list, slots(list)%growth_until > 0), task%wanted)
    end subroutine compute

    !> The inherent errors of the cases of a list.
    subroutine compute_inherent_errors(slots, list)
        type(slot_t), intent(inout) :: slots(:)
        integer, intent(in) :: list(:)
        real(dp), allocatable :: errors(:)
        integer, allocatable :: how(:)
        integer :: i

        if (size(list) == 0) return
        allocate (errors(size(list)), how(size(list)))
        call find_inherent_errors(slots(list)%case%body, slots(list)%case%start, slots(list)%inherent_until, &
                                  max(slots(list(1))%max_steps, 1_int64), errors, how)
        do i = 1, size(list)
            if (is_ok(how(i))) then
                slots(list(i))%result%inherent_error = errors(i)
            else
                call slots(list(i))%note%add(note_no_inherent, trim(status_meanings(how(i))))
            end if
        end do
    end subroutine compute_inherent_errors

    !> The growth of perturbations of the cases of a list. A status reports work that was not finished, or overflow.
    subroutine compute_growths(slots, list, wanted)
        type(slot_t), intent(inout) :: slots(:)
        integer, intent(in) :: list(:)
        logical, intent(in) :: wanted(kinds_of_work)
        type(growth_t), allocatable :: growth(:)
        integer :: i

        if (size(list) == 0) return
        allocate (growth(size(list)))
        call find_growth(slots(list)%case%body, slots(list)%case%start, slots(list)%growth_until, &
                         wanted(of_lyapunov), wanted(of_singular), max(slots(list(1))%max_steps, 1_int64), growth)
        do i = 1, size(list)
            associate (found => growth(i), result => slots(list(i))%result)
                if (wanted(of_lyapunov)) call store_or_explain(found%exponent, found%exponent_status, &
                                                               result%lyapunov_exponent, note_no_lyapunov)
                if (wanted(of_singular)) call store_or_explain(found%singular, found%singular_status, &
                                                               result%largest_singular_value, note_no_singular)
            end associate
        end do

    contains

        !> Stores a value, or notes the reason why there is none.
        subroutine store_or_explain(value, how, quantity, reason)
            real(dp), intent(in) :: value
            integer, intent(in) :: how, reason
            real(dp), intent(inout) :: quantity
            if (is_ok(how)) then
                quantity = value
            else
                call slots(list(i))%note%add(reason, trim(status_meanings(how)))
                if (how == status_step_limit .or. how == status_non_finite) slots(list(i))%status = how
            end if
        end subroutine store_or_explain

    end subroutine compute_growths

end module spintop_sweep_stability
