!> The quantities of a sweep table that tell of the stability of a motion. Those that perturbations tell, Lyapunov exponents,
!> largest singular values and inherent errors, are found together in lanes for the cases of a block, however their motions
!> were computed.
module spintop_sweep_stability
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_case, only: case_t
    use spintop_driven_flow, only: drive_period
    use spintop_floquet, only: find_multipliers
    use spintop_growth_lanes, only: find_growth, growth_t
    use spintop_inherent_lanes, only: find_inherent_errors
    use spintop_relative_equilibrium, only: find_equilibrium_eigenvalues
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_status, only: is_good_end, status_meanings, status_non_finite, status_ok, status_step_limit, &
        status_unsuitable
    use spintop_sweep_notes, only: note_t, note_no_growth, note_no_inherent, note_no_lyapunov, note_no_multiplier, &
        note_no_singular, only_without_effects
    use spintop_sweep_result, only: kinds_of_work, of_growth, of_inherent, of_lyapunov, of_multiplier, of_singular, &
        sweep_result_t
    implicit none
    private
    public :: put_stability, put_perturbations

    real(dp), parameter :: no_angles(3) = 0

contains

    !> The growth rate at a relative equilibrium, and the largest multiplier over a period of the vibration. The Lyapunov exponent
    !> and the largest singular value up to the end of the motion are left to be found for a block of cases.
    subroutine put_stability(case, t_end, wanted, max_steps, values, note)
        type(case_t), intent(in) :: case !! body, start and span
        real(dp), intent(in) :: t_end !! end of the motion, s
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        integer(int64), intent(in) :: max_steps !! largest number of steps
        type(sweep_result_t), intent(inout) :: values !! the quantities of the case
        type(note_t), intent(inout) :: note !! notes on the case
        complex(dp) :: eigenvalues(6)
        integer :: how

        if (wanted(of_growth)) then
            call find_equilibrium_eigenvalues(case%body, case%start, eigenvalues, how)
            if (how == status_ok) then
                values%growth_rate = maxval(real(eigenvalues, dp))
            else if (how == status_unsuitable) then
                call note%add(note_no_growth, 'the start is not at rest, sleeping or steady')
            else
                call note%add(note_no_growth, trim(status_meanings(how)))
            end if
        end if
        if (allocated(case%body%effects)) then
            if (wanted(of_lyapunov)) call note%add(note_no_lyapunov, only_without_effects)
            if (wanted(of_singular)) call note%add(note_no_singular, only_without_effects)
        else if (wanted(of_lyapunov) .or. wanted(of_singular)) then
            values%growth_until = t_end
            values%most_steps = max(max_steps, 1_int64)
        end if
        if (wanted(of_multiplier)) call put_multiplier(case, values, note)
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

    !> Finds what is left to be found for the cases of a block. `status` reports work that was not finished, or overflow.
    subroutine put_perturbations(cases, wanted, values, status, note)
        type(case_t), intent(in) :: cases(:) !! body, start and span of each
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        type(sweep_result_t), intent(inout) :: values(:) !! the quantities of the cases
        integer, intent(inout) :: status(:) !! their statuses
        type(note_t), intent(inout) :: note(:) !! notes on the cases
        logical :: waits(size(cases)), is_like(size(cases))
        integer :: first, i

        if (.not. (wanted(of_lyapunov) .or. wanted(of_singular) .or. wanted(of_inherent))) return
        waits = is_good_end(status) .and. (values%growth_until > 0 .or. values%inherent_until > 0)
        do first = 1, size(cases)
            if (.not. waits(first)) cycle
            ! Cases of one limit of work share lanes.
            is_like = waits .and. values%most_steps == values(first)%most_steps
            associate (like => pack([(i, i=1, size(cases))], is_like))
                call put_inherent_errors(cases, pack(like, values(like)%inherent_until > 0), values, note)
                call put_growths(cases, pack(like, values(like)%growth_until > 0), wanted, values, status, note)
            end associate
            waits = waits .and. .not. is_like
        end do
    end subroutine put_perturbations

    !> The inherent errors of the cases of a list.
    subroutine put_inherent_errors(cases, list, values, note)
        type(case_t), intent(in) :: cases(:)
        integer, intent(in) :: list(:)
        type(sweep_result_t), intent(inout) :: values(:)
        type(note_t), intent(inout) :: note(:)
        real(dp), allocatable :: errors(:)
        integer, allocatable :: how(:)
        integer :: i

        if (size(list) == 0) return
        allocate (errors(size(list)), how(size(list)))
        call find_inherent_errors(cases(list)%body, cases(list)%start, values(list)%inherent_until, &
                                  values(list(1))%most_steps, errors, how)
        do i = 1, size(list)
            if (how(i) == status_ok) then
                values(list(i))%inherent_error = errors(i)
            else
                call note(list(i))%add(note_no_inherent, trim(status_meanings(how(i))))
            end if
        end do
    end subroutine put_inherent_errors

    !> The growth of perturbations of the cases of a list.
    subroutine put_growths(cases, list, wanted, values, status, note)
        type(case_t), intent(in) :: cases(:)
        integer, intent(in) :: list(:)
        logical, intent(in) :: wanted(kinds_of_work)
        type(sweep_result_t), intent(inout) :: values(:)
        integer, intent(inout) :: status(:)
        type(note_t), intent(inout) :: note(:)
        type(growth_t), allocatable :: growth(:)
        integer :: i, k

        if (size(list) == 0) return
        allocate (growth(size(list)))
        call find_growth(cases(list)%body, cases(list)%start, values(list)%growth_until, &
                         wanted(of_lyapunov), wanted(of_singular), &
                         values(list(1))%most_steps, growth)
        do i = 1, size(list)
            k = list(i)
            associate (found => growth(i))
                if (wanted(of_lyapunov)) call take(found%exponent, found%exponent_status, values(k)%lyapunov_exponent, &
                                                   note_no_lyapunov)
                if (wanted(of_singular)) then
                    call take(found%singular, found%singular_status, values(k)%largest_singular_value, note_no_singular)
                end if
            end associate
        end do

    contains

        !> Stores a value, or notes the reason why there is none.
        subroutine take(value, how, quantity, reason)
            real(dp), intent(in) :: value
            integer, intent(in) :: how, reason
            real(dp), intent(inout) :: quantity
            if (how == status_ok) then
                quantity = value
            else
                call note(k)%add(reason, trim(status_meanings(how)))
                if (how == status_step_limit .or. how == status_non_finite) status(k) = how
            end if
        end subroutine take

    end subroutine put_growths

end module spintop_sweep_stability
