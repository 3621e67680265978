!> What a sweep table says of a case, from what was computed of it; a quantity that does not exist is
!> NaN, with the reason in a note.
module spintop_sweep_quantities
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
    use spintop_kinds, only: dp, pi, degree
    use spintop_compare, only: is_finite
    use spintop_case, only: case_t
    use spintop_fast_top, only: fast_top_t, fast_top
    use spintop_motion, only: motion_t
    use spintop_force_extremes, only: force_extremes_t, find_force_extremes
    use spintop_nutation, only: nutation_t, find_nutation
    use spintop_nutation_watch, only: nutation_watch_t, no_class
    use spintop_status, only: status_ok, status_non_finite, status_meanings
    use spintop_sweep_notes, only: note_t, note_no_period, note_no_turns, note_no_nutation, note_no_class, &
        note_no_fast_top, note_no_details, note_no_azimuth, note_no_exact_motion, note_no_precession_period
    use spintop_sweep_columns, only: quantities, q_theta_min, q_theta_max, q_delta_u, &
        q_delta_u_fast_top, q_nutation_period, q_nutation_rate, q_nutation_rate_fast_top, &
        q_precession_per_nutation, q_precession_rate, q_precession_rate_fast_top, &
        q_nutations_per_turn, q_nutations_per_turn_fast_top, q_precession_period, &
        q_azimuth_after_period_deg, q_nutations_in_period, q_phi_rate_max, q_fast_top_ratio, &
        q_com_z_min, q_theta_end, q_phi_end, q_psi_end, q_theta_rate_end, q_energy_error_max, &
        q_motion_class, q_spin_per_nutation, q_theta_rate_max, q_force_max, q_force_z_min, &
        q_force_z_max, q_t_end, q_orientation_error, q_inherent_error
    implicit none
    private
    public :: no_values, put_nutation, put_measured, put_fast_top, put_azimuth, put_end, put_details, &
        precession_period, note_missing, told_last

    !> Quantities of which a note tells only where nothing else has.
    integer, parameter :: told_last(*) = [q_nutations_in_period, q_orientation_error, q_inherent_error]

contains

    !> No quantity at all, and no class of motion.
    pure function no_values() result(values)
        real(dp) :: values(quantities)
        values = ieee_value(0.0_dp, ieee_quiet_nan)
        values(q_motion_class) = no_class
    end function no_values

    !> The whole nutation.
    subroutine put_nutation(case, nutation, values, note)
        type(case_t), intent(in) :: case
        type(nutation_t), intent(in) :: nutation
        real(dp), intent(inout) :: values(quantities)
        type(note_t), intent(inout) :: note

        values(q_theta_min) = nutation%theta_min
        values(q_theta_max) = nutation%theta_max
        if (case%turn%flipped) then
            values(q_theta_min) = pi - nutation%theta_max
            values(q_theta_max) = pi - nutation%theta_min
        end if
        values(q_delta_u) = nutation%delta_u
        values(q_phi_rate_max) = nutation%phi_rate_max
        values(q_com_z_min) = case%body%centre_of_mass(3) * cos(nutation%theta_max)
        if (.not. is_finite(nutation%period)) then
            call note%add(note_no_period, 'the axis approaches the upright for ever')
            return
        end if
        values(q_nutation_period) = nutation%period
        values(q_nutation_rate) = 2 * pi / nutation%period
        values(q_precession_per_nutation) = nutation%precession
        values(q_precession_rate) = nutation%precession_rate
        if (abs(nutation%precession) > 0) then
            values(q_nutations_per_turn) = 2 * pi / abs(nutation%precession)
        else
            call note%add(note_no_turns, 'no precession')
        end if
        if (precession_period(case) > 0) then
            values(q_nutations_in_period) = precession_period(case) / nutation%period
        end if
    end subroutine put_nutation

    !> The nutation as it was measured on the way.
    subroutine put_measured(case, watch, values, note)
        type(case_t), intent(in) :: case
        type(nutation_watch_t), intent(in) :: watch
        real(dp), intent(inout) :: values(quantities)
        type(note_t), intent(inout) :: note
        type(nutation_t) :: nutation
        logical :: seen

        call watch%nutation(nutation, seen)
        if (.not. seen) then
            call note%add(note_no_nutation)
            return
        end if
        call put_nutation(case, nutation, values, note)
        values(q_com_z_min) = watch%com_z_min
        values(q_spin_per_nutation) = nutation%spin
        values(q_motion_class) = nutation%class
        if (nutation%class == no_class) call note%add(note_no_class, 'it changes from nutation to nutation')
    end subroutine put_measured

    !> The paper's formulas for a fast top.
    subroutine put_fast_top(case, values, note)
        type(case_t), intent(in) :: case
        real(dp), intent(inout) :: values(quantities)
        type(note_t), intent(inout) :: note
        type(fast_top_t) :: motion

        if (.not. precession_period(case) > 0) then
            call note%add(note_no_fast_top, 'they need a spin and a weight')
            return
        end if
        values(q_precession_period) = precession_period(case)
        if (.not. case%body%is_symmetric()) then
            call note%add(note_no_fast_top, 'they need a symmetric body')
            return
        end if
        motion = fast_top(case%body, case%start%angle(2), case%start%omega(3))
        values(q_delta_u_fast_top) = motion%delta_u
        values(q_nutation_rate_fast_top) = motion%nutation_rate
        values(q_precession_rate_fast_top) = motion%precession_rate
        values(q_nutations_per_turn_fast_top) = motion%nutations_per_turn
        values(q_fast_top_ratio) = motion%ratio
    end subroutine put_fast_top

    !> More of the whole nutation of a top whose motion is known in closed form.
    subroutine put_details(case, values, note)
        type(case_t), intent(in) :: case
        real(dp), intent(inout) :: values(quantities)
        type(note_t), intent(inout) :: note
        type(nutation_t) :: nutation
        type(force_extremes_t) :: force
        integer :: status
        call find_nutation(case%body, case%start, nutation, status)
        if (status == status_ok) call find_force_extremes(case%body, case%start, force, status)
        if (status /= status_ok) then
            call note%add(note_no_details, trim(status_meanings(status)))
            return
        end if
        values(q_motion_class) = nutation%class
        values(q_spin_per_nutation) = merge(-1, 1, case%turn%flipped) * nutation%spin
        values(q_theta_rate_max) = nutation%theta_rate_max
        values(q_force_max) = force%largest
        values(q_force_z_min) = force%lowest_vertical
        values(q_force_z_max) = force%highest_vertical
    end subroutine put_details

    !> The azimuth after T_p, given the change of phi by then (rad), if the motion was seen then.
    subroutine put_azimuth(seen, azimuth, values, note)
        logical, intent(in) :: seen
        real(dp), intent(in) :: azimuth
        real(dp), intent(inout) :: values(quantities)
        type(note_t), intent(inout) :: note
        if (seen) then
            values(q_azimuth_after_period_deg) = azimuth / degree
        else
            call note%add(note_no_azimuth, 'the span has no step at T_p')
        end if
    end subroutine put_azimuth

    !> The end of the span: `motion` is in the axes of the computation.
    subroutine put_end(case, motion, energy_error, values)
        type(case_t), intent(in) :: case
        type(motion_t), intent(in) :: motion
        real(dp), intent(in) :: energy_error
        real(dp), intent(inout) :: values(quantities)
        values(q_energy_error_max) = energy_error
        if (case%turn%is_turned()) then
            call put_seen(case%turn%back(motion, case%given_start%angle))
        else
            call put_seen(motion)
        end if

    contains

        !> The same in the axes in which the body was given.
        subroutine put_seen(seen)
            type(motion_t), intent(in) :: seen
            values(q_t_end) = seen%t
            values(q_theta_end) = seen%angle(2)
            values(q_phi_end) = seen%angle(1)
            values(q_psi_end) = seen%angle(3)
            values(q_theta_rate_end) = seen%rate(2)
        end subroutine put_seen

    end subroutine put_end

    !> Notes why a quantity is missing which none of the others that come with it tells about.
    subroutine note_missing(case, quantity, note)
        type(case_t), intent(in) :: case
        integer, intent(in) :: quantity !! one of `told_last`
        type(note_t), intent(inout) :: note
        if (quantity == q_nutations_in_period) then
            if (.not. (note%has(note_no_fast_top) .or. precession_period(case) > 0)) then
                call note%add(note_no_precession_period, 'it needs a spin and a weight')
            end if
        else if (.not. note%has(note_no_exact_motion)) then
            if (.not. case%body%is_symmetric()) then
                call note%add(note_no_exact_motion, 'the body is not symmetric')
            else if (.not. case%body%is_lagrange()) then
                call note%add(note_no_exact_motion, 'the body is damped')
            else
                call note%add(note_no_exact_motion, trim(status_meanings(status_non_finite)))
            end if
        end if
    end subroutine note_missing

    !> The paper's T_p, s; 0 without spin or weight, negative for no top.
    pure real(dp) function precession_period(case)
        type(case_t), intent(in) :: case
        precession_period = 0
        if (.not. case%body%mgl() > 0) return
        precession_period = 2 * pi * abs(case%body%inertia(3) * case%start%omega(3)) / case%body%mgl()
    end function precession_period

end module spintop_sweep_quantities
