!> The cases of a sweep, and how their quantities are computed. A block has a slot for each of its cases; engines, of which each
!> takes the cases that suit it, compute their quantities, many at once where they can. A quantity that does not exist is NaN,
!> with the reason in a note.
!>
!>     call run_engines(engines, slots, task)   ! the first engine that takes a case computes it
module spintop_sweep_quantities
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_event_recorder, only: column_event_t
    use spintop_floquet, only: find_multipliers
    use spintop_force_extremes, only: force_extremes_t, find_force_extremes
    use spintop_free_motion, only: free_motion_t, inclination_range, prepare_free_motion
    use spintop_kinds, only: dp, pi, degree, is_finite, cross
    use spintop_measures, only: growth_t, measures_t, no_class, watch_centre_height, watch_nutation_rate, &
        watch_precession_rate, watch_total_force, watch_turning, watch_vertical_force
    use spintop_momentum_path, only: find_momentum_path, momentum_path_t
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_nutation, only: nutation_t, find_nutation
    use spintop_planning, only: plan_t
    use spintop_relative_equilibrium, only: find_equilibrium_eigenvalues
    use spintop_status, only: is_good_end, is_ok, status_meanings, status_non_finite, status_ok, status_step_limit, &
        status_unsuitable
    use spintop_steady_motion, only: fast_top_t, fast_top, critical_omega3
    use spintop_sweep_result, only: at_largest_singular_value, at_lyapunov_exponent, kinds_of_work, note_no_lyapunov, &
        note_no_singular, note_no_turns_known, note_t, of_lyapunov, of_singular, of_turns, of_whole, sweep_result_t, &
        at_theta_min, at_theta_max, at_delta_u, at_delta_u_fast_top, at_nutation_period, at_nutation_rate, &
        at_nutation_rate_fast_top, at_precession_per_nutation, at_precession_rate, at_precession_rate_fast_top, &
        at_nutations_per_turn, at_nutations_per_turn_fast_top, at_precession_period, at_azimuth_after_period, &
        at_nutations_in_period, at_phi_rate_max, at_fast_top_ratio, at_com_z_min, at_theta_end, at_phi_end, at_psi_end, &
        at_theta_rate_end, at_energy_error_max, at_motion_class, at_spin_per_nutation, at_theta_rate_max, at_force_max, &
        at_force_z_min, at_force_z_max, at_t_end, at_momentum_period, at_momentum_turn, at_momentum_turn_geometric, &
        at_momentum_axis, at_omega_max, note_no_period, note_no_turns, note_no_nutation, note_no_class, note_no_fast_top, &
        note_no_details, note_no_azimuth, note_no_exact_motion, note_no_momentum_period, note_no_precession_period, &
        note_not_free, note_no_threshold, note_nothing_to_bound, of_class, of_fastest, of_force, of_free, of_geometric, &
        of_lowest, of_nutation_rate, of_range, of_vertical_force, at_critical_omega3, at_sleeping_ratio, at_growth_rate, &
        at_upright_multiplier, note_no_growth, note_no_multiplier, only_without_effects, of_growth, of_multiplier
    use spintop_tangent_flow, only: drive_period
    implicit none
    private
    public :: task_t, slot_t, engine_t, engine_entry_t, run_engines, lacks_nothing, lacks_motion, lacks_perturbations, &
        extremes, watched_for, set_nutation, set_measured, set_fast_top, set_azimuth, set_end, set_details, &
        precession_period, explain_missing, find_free_constants, compute_stability, set_threshold

    !> What a case still lacks: the quantities of its motion, and then those that perturbations of it tell.
    integer, parameter :: lacks_nothing = 0, lacks_motion = 1, lacks_perturbations = 2

    !> What is asked of every case of a sweep.
    type :: task_t
        !> Selected groups of quantities.
        logical :: wanted(kinds_of_work) = .false.
        !> The motion ends at the n-th of the events, if there are any.
        type(column_event_t), allocatable :: events(:)
        integer :: stop_after = 1
    end type task_t

    !> A case of a block, and what is known of it.
    type :: slot_t
        type(case_t) :: case
        !> Model, method and settings.
        type(plan_t), pointer :: plan => null()
        !> Remaining work, in steps.
        integer(int64) :: max_steps = 0
        integer :: lacks = lacks_nothing
        !> `status_ok`, another good end, or the reason of a failure (spintop_status).
        integer :: status = status_ok
        type(note_t) :: note
        type(sweep_result_t) :: result
        !> The end of the motion, s, up to which the growth of perturbations is to be found; 0 where it is not.
        real(dp) :: growth_until = 0
    contains
        procedure :: fail
        procedure :: explain_turns
        procedure :: store_growth
    end type slot_t

    !> A way to compute cases.
    type, abstract :: engine_t
        !> What it gives to cases that lack it.
        integer :: gives = lacks_motion
    contains
        procedure, nopass :: takes
        procedure, nopass :: shares_lanes
        procedure(compute), deferred :: compute
    end type engine_t

    !> An engine of a list.
    type :: engine_entry_t
        class(engine_t), allocatable :: engine
    end type engine_entry_t

    abstract interface
        !> Computes some cases of a block. Those that it sets back to `lacks_motion` are left to the engines after it.
        subroutine compute(self, slots, list, task)
            import :: engine_t, slot_t, task_t
            class(engine_t), intent(inout) :: self
            type(slot_t), intent(inout) :: slots(:) !! the block
            integer, intent(in) :: list(:) !! the places of the cases, one at least
            type(task_t), intent(in) :: task !! what is asked of them, the same in every call
        end subroutine compute
    end interface

    real(dp), parameter :: no_angles(3) = 0

    !> A column that is the extreme of a quantity that is watched: its place, its work, the quantity, and whether it is the largest.
    type :: extreme_t
        integer :: place, work, watch
        logical :: is_largest
    end type extreme_t

    !> The columns that are extremes.
    type(extreme_t), parameter :: extremes(*) = [ &
        extreme_t(at_com_z_min, of_lowest, watch_centre_height, .false.), &
        extreme_t(at_theta_rate_max, of_nutation_rate, watch_nutation_rate, .true.), &
        extreme_t(at_force_z_min, of_vertical_force, watch_vertical_force, .false.), &
        extreme_t(at_force_z_max, of_vertical_force, watch_vertical_force, .true.), &
        extreme_t(at_force_max, of_force, watch_total_force, .true.)]

contains

    !> Computes the cases of a block: each by the first engine that takes it.
    subroutine run_engines(engines, slots, task)
        type(engine_entry_t), intent(inout) :: engines(:) !! the last for what is lacking takes all
        type(slot_t), intent(inout) :: slots(:) !! the cases
        type(task_t), intent(in) :: task !! what is asked of them
        integer :: list(size(slots)), i, k, n
        logical :: is_like(size(slots))

        do i = 1, size(engines)
            associate (engine => engines(i)%engine)
                n = 0
                do k = 1, size(slots)
                    if (slots(k)%lacks /= engine%gives) cycle
                    if (.not. engine%takes(slots(k), task)) cycle
                    n = n + 1
                    list(n) = k
                end do
                do while (n > 0)
                    is_like(:n) = [(engine%shares_lanes(slots(list(1)), slots(list(k))), k=1, n)]
                    associate (like => pack(list(:n), is_like(:n)), others => pack(list(:n), .not. is_like(:n)))
                        slots(like)%lacks = lacks_nothing
                        call engine%compute(slots, like, task)
                        n = size(others)
                        list(:n) = others
                    end associate
                end do
            end associate
        end do
    end subroutine run_engines

    !> Whether the engine can compute a case: any that has not failed, unless the engine overrides this.
    logical function takes(slot, task)
        type(slot_t), intent(in) :: slot !! the case
        type(task_t), intent(in) :: task !! what is asked of it
        takes = is_good_end(slot%status)
    end function takes

    !> Whether two cases can be computed together; any two unless the engine overrides this.
    logical function shares_lanes(a, b)
        type(slot_t), intent(in) :: a, b !! the cases
        shares_lanes = .true.
    end function shares_lanes

    !> Notes that the motion passed poles within its error, where turns are wanted.
    subroutine explain_turns(self, passages, wanted)
        class(slot_t), intent(inout) :: self
        integer, intent(in) :: passages !! number of such passages
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        if (passages == 0 .or. .not. (wanted(of_turns) .or. wanted(of_whole))) return
        call self%note%add(note_no_turns_known, 'the motion passes a pole within its error')
    end subroutine explain_turns

    !> Stores what perturbations tell, or notes the reasons why they do not. Work that was not finished, or overflow, is a failure
    !> of the case.
    subroutine store_growth(self, found, wanted)
        class(slot_t), intent(inout) :: self
        type(growth_t), intent(in) :: found !! the growth
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        if (wanted(of_lyapunov)) call store(at_lyapunov_exponent, found%exponent, found%exponent_status, note_no_lyapunov)
        if (wanted(of_singular)) call store(at_largest_singular_value, found%singular, found%singular_status, note_no_singular)

    contains

        subroutine store(place, value, how, reason)
            integer, intent(in) :: place, how, reason
            real(dp), intent(in) :: value
            if (is_ok(how)) then
                self%result%of(place) = value
            else
                call self%note%add(reason, trim(status_meanings(how)))
                if (how == status_step_limit .or. how == status_non_finite) self%status = how
            end if
        end subroutine store

    end subroutine store_growth

    !> Ends a case without success.
    subroutine fail(self, status)
        class(slot_t), intent(inout) :: self
        integer, intent(in) :: status !! the reason
        self%status = status
        call self%note%explain(trim(status_meanings(status)))
    end subroutine fail

    !> The whole nutation of a closed form, in the axes of the input and relative to its frame.
    subroutine set_nutation(slot, nutation, wanted)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        type(nutation_t), intent(in) :: nutation !! quantities of the nutation, in the axes of the computation
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        type(nutation_t) :: seen
        seen = nutation
        associate (case => slot%case, turn => slot%case%turn)
            if (wanted(of_lowest)) slot%result%of(at_com_z_min) = case%body%centre_of_mass(3) * cos(nutation%theta_max)
            if (turn%flipped) then
                seen%theta_min = pi - nutation%theta_max
                seen%theta_max = pi - nutation%theta_min
            end if
            if (turn%is_shifted()) then
                seen%phi_rate_max = largest_relative_rate(case, nutation)
                seen%precession_rate = nutation%precession_rate - turn%phi_shift
                seen%precession = seen%precession_rate * nutation%period
            end if
        end associate
        call set_extremes(seen, slot%result)
        call set_means(slot, seen)
    end subroutine set_nutation

    !> The extremes of theta and of the precession rate.
    subroutine set_extremes(nutation, values)
        type(nutation_t), intent(in) :: nutation
        type(sweep_result_t), intent(inout) :: values
        values%of(at_theta_min) = nutation%theta_min
        values%of(at_theta_max) = nutation%theta_max
        values%of(at_delta_u) = nutation%delta_u
        values%of(at_phi_rate_max) = nutation%phi_rate_max
    end subroutine set_extremes

    !> The precession rate of a top relative to a frame that turns that is largest in magnitude. With u = cos(theta) the
    !> rate (lz - l3 u)/(I1 (1 - u^2)) is largest at a turning point; less the rate of the frame it may be so at the other
    !> one, or where it is least in between: where 2 lz u = l3 (1 + u^2).
    pure real(dp) function largest_relative_rate(case, nutation) result(largest)
        type(case_t), intent(in) :: case
        type(nutation_t), intent(in) :: nutation
        real(dp) :: half(3), l3, excess, ratio, rates(3), noise(3)
        integer :: i

        associate (theta => case%start%angle(2), inertia => case%body%inertia, shift => case%turn%phi_shift)
            l3 = inertia(3) * case%start%omega(3)
            ! lz - l3, and (1 - u)/2 at the three places.
            excess = inertia(1) * sin(theta)**2 * case%start%rate(1) - 2 * l3 * sin(theta / 2)**2
            half(1:2) = sin([nutation%theta_min, nutation%theta_max] / 2)**2
            half(3) = half(1)
            if (abs(excess + l3) > abs(l3)) then
                ratio = l3 / (excess + l3)
                ratio = (1 - ratio / (1 + sqrt(1 - ratio**2))) / 2
                if (ratio > half(1) .and. ratio < half(2)) half(3) = ratio
            end if
            rates = (excess + 2 * l3 * half) / (4 * inertia(1) * half * (1 - half))
            noise = 8 * epsilon(noise) * (abs(excess) + 2 * abs(l3)) / (4 * inertia(1) * half * (1 - half))
            largest = nutation%phi_rate_max - shift
            do i = 1, 3
                if (is_finite(rates(i)) .and. abs(rates(i) - shift) > abs(largest) + noise(i)) largest = rates(i) - shift
            end do
        end associate
    end function largest_relative_rate

    !> The period, and what happens in it.
    subroutine set_means(slot, nutation)
        type(slot_t), intent(inout) :: slot
        type(nutation_t), intent(in) :: nutation
        real(dp) :: precession_time

        if (.not. is_finite(nutation%period)) then
            call slot%note%add(note_no_period, 'the axis approaches the upright asymptotically')
            return
        end if
        associate (case => slot%case, values => slot%result)
            values%of(at_nutation_period) = nutation%period
            values%of(at_nutation_rate) = 2 * pi / nutation%period
            values%of(at_precession_per_nutation) = nutation%precession
            values%of(at_precession_rate) = nutation%precession_rate
            if (abs(nutation%precession) > 0) then
                values%of(at_nutations_per_turn) = 2 * pi / abs(nutation%precession)
            else
                call slot%note%add(note_no_turns, 'no precession')
            end if
            precession_time = precession_period(case%body, case%start)
            if (precession_time > 0) values%of(at_nutations_in_period) = precession_time / nutation%period
        end associate
    end subroutine set_means

    !> The quantities that are watched along a motion for what is wanted.
    pure function watched_for(wanted) result(of)
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        integer, allocatable :: of(:)
        integer :: i
        of = pack([watch_turning], [wanted(of_whole) .or. wanted(of_range)])
        if (wanted(of_class) .or. wanted(of_fastest)) of = [of, watch_precession_rate]
        do i = 1, size(extremes)
            if (wanted(extremes(i)%work) .and. all(of /= extremes(i)%watch)) of = [of, extremes(i)%watch]
        end do
    end function watched_for

    !> What was measured along the motion: extremes over the span, and what needs a whole nutation.
    subroutine set_measured(slot, found, wanted)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        type(measures_t), intent(in) :: found !! what was measured
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        type(nutation_t) :: nutation
        type(extreme_t) :: of
        logical :: is_whole
        integer :: i

        do i = 1, size(extremes)
            of = extremes(i)
            if (wanted(of%work)) slot%result%of(of%place) = merge(found%largest(of%watch), found%least(of%watch), of%is_largest)
        end do
        call found%find_nutation(nutation, is_whole)
        call set_extremes(nutation, slot%result)
        if (.not. wanted(of_whole)) return
        if (.not. is_whole) then
            if (found%turns%is_interrupted) then
                call slot%note%add(note_no_nutation, 'its turning points are within the error of the method')
            else
                call slot%note%add(note_no_nutation)
            end if
            return
        end if
        call set_means(slot, nutation)
        slot%result%of(at_spin_per_nutation) = nutation%spin
        slot%result%of(at_motion_class) = nutation%class
        if ((wanted(of_fastest) .or. wanted(of_class)) .and. nutation%class == no_class) then
            call slot%note%add(note_no_class, 'it changes from nutation to nutation')
        end if
    end subroutine set_measured

    !> The formulas of the paper for a fast top.
    subroutine set_fast_top(slot)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        type(fast_top_t) :: motion

        associate (case => slot%case, values => slot%result)
            if (.not. precession_period(case%body, case%start) > 0) then
                call slot%note%add(note_no_fast_top, 'they need ' // needs_of_period(case))
                return
            end if
            values%of(at_precession_period) = precession_period(case%body, case%start)
            if (.not. case%body%is_symmetric()) then
                call slot%note%add(note_no_fast_top, 'they need a symmetric body')
                return
            end if
            motion = fast_top(case%body, case%start%angle(2), case%start%omega(3))
            values%of(at_delta_u_fast_top) = motion%delta_u
            values%of(at_nutation_rate_fast_top) = motion%nutation_rate
            values%of(at_precession_rate_fast_top) = motion%precession_rate
            values%of(at_nutations_per_turn_fast_top) = motion%nutations_per_turn
            values%of(at_fast_top_ratio) = motion%ratio
        end associate
    end subroutine set_fast_top

    !> Details of the whole nutation of a top with a closed form.
    subroutine set_details(slot)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        type(nutation_t) :: nutation
        type(force_extremes_t) :: force
        integer :: status
        associate (case => slot%case, values => slot%result)
            call find_nutation(case%body, case%start, nutation, status)
            if (is_ok(status)) call find_force_extremes(case%body, case%start, force, status)
            if (.not. is_ok(status)) then
                call slot%note%add(note_no_details, trim(status_meanings(status)))
                return
            end if
            if (abs(case%turn%phi_shift) > 0) then
                call slot%note%add(note_no_class, 'it is not found relative to a frame that turns')
            else
                values%of(at_motion_class) = nutation%class
            end if
            if (is_finite(nutation%period)) then
                if (case%turn%is_shifted()) nutation%spin = nutation%spin - case%turn%psi_shift * nutation%period
                values%of(at_spin_per_nutation) = merge(-1, 1, case%turn%flipped) * nutation%spin
            end if
            values%of(at_theta_rate_max) = nutation%theta_rate_max
            values%of(at_force_max) = force%largest
            values%of(at_force_z_min) = force%lowest_vertical
            values%of(at_force_z_max) = force%highest_vertical
        end associate
    end subroutine set_details

    !> The azimuth after T_p, from the change of phi in that time (rad), if the motion reached it.
    subroutine set_azimuth(slot, seen, azimuth)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        logical, intent(in) :: seen !! whether the motion reached T_p
        real(dp), intent(in) :: azimuth !! change of phi in T_p, rad
        if (seen) then
            slot%result%of(at_azimuth_after_period) = azimuth / degree
        else
            call slot%note%add(note_no_azimuth, 'the span has no step at T_p')
        end if
    end subroutine set_azimuth

    !> The end of the span: `motion` is in the axes of the computation.
    subroutine set_end(slot, motion, energy_error)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        type(motion_t), intent(in) :: motion !! the motion at the end of the span, in the axes of the computation
        real(dp), intent(in) :: energy_error !! largest relative energy error
        type(motion_t) :: seen
        seen = motion
        if (slot%case%turn%is_turned()) seen = slot%case%turn%back(motion, motion%given_angle)
        slot%result%of(at_energy_error_max) = energy_error
        slot%result%of(at_t_end) = seen%t
        slot%result%of([at_phi_end, at_theta_end, at_psi_end]) = seen%angle
        slot%result%of(at_theta_rate_end) = seen%rate(2)
    end subroutine set_end

    !> Notes why a case lacks a quantity: the note of its column, unless something else tells the same.
    subroutine explain_missing(missing, case, note)
        integer, intent(in) :: missing !! index of the note
        type(case_t), intent(in) :: case !! the case that lacks the quantity
        type(note_t), intent(inout) :: note !! notes on the case
        if (note%has(missing)) return
        select case (missing)
        case (note_no_precession_period)
            if (.not. (note%has(note_no_fast_top) .or. precession_period(case%body, case%start) > 0)) then
                call note%add(missing, 'it needs ' // needs_of_period(case))
            end if
        case (note_no_exact_motion)
            if (case%body%has_closed_form()) then
                call note%add(missing, trim(status_meanings(status_non_finite)))
            else if (.not. case%body%is_symmetric()) then
                call note%add(missing, 'the body is not symmetric')
            else if (allocated(case%body%effects)) then
                call note%add(missing, 'the effects on the body do more than shift phi and psi')
            else
                call note%add(missing, 'the body is damped')
            end if
        case (note_no_threshold)
            call note%add(missing, trim(merge('gravity exerts no torque ', 'the body is not symmetric', case%body%is_symmetric())))
        case (note_nothing_to_bound)
            if (note%flags == 0) call note%add(missing)
        case default
            call note%add(missing)
        end select
    end subroutine explain_missing

    !> The constants of a free body from its exact solution; of a body that is not symmetric about body z also the range of theta.
    subroutine find_free_constants(slot, wanted)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        type(free_motion_t) :: free
        type(momentum_path_t) :: path
        real(dp) :: momentum(3), gamma(3), range(2)
        integer :: status

        associate (case => slot%case)
            if (.not. case%body%is_free()) then
                if (wanted(of_free)) call slot%note%add(note_not_free)
                return
            end if
            if (.not. (wanted(of_free) .or. (wanted(of_range) .and. .not. case%body%has_closed_nutation()))) return
            if (case%turn%to_principal_axes) then
                call prepare_free_motion(case%body, case%start, free, status)
            else
                call prepare_free_motion(case%given_body, case%given_start, free, status)
            end if
            if (.not. is_ok(status)) then
                call slot%note%add(note_not_free, trim(status_meanings(status)))
                return
            end if
        end associate
        associate (case => slot%case, values => slot%result)
            if (wanted(of_free)) then
                values%of(at_omega_max) = free%greatest_rate
                if (free%about > 0) values%of(at_momentum_axis) = free%about
                if (free%about == 0) then
                    call slot%note%add(note_no_momentum_period, 'the body rotates about a fixed axis')
                else if (.not. is_finite(free%period)) then
                    call slot%note%add(note_no_momentum_period, 'the body approaches a rotation about its intermediate axis')
                else
                    values%of(at_momentum_period) = free%period
                    values%of(at_momentum_turn) = free%turn
                    if (wanted(of_geometric)) then
                        path = find_momentum_path(case%given_body%inertia, case%given_start%omega)
                        if (case%turn%to_principal_axes) path = find_momentum_path(case%body%inertia, case%start%omega)
                        values%of(at_momentum_turn_geometric) = real(path%geometric_turn(), dp)
                    end if
                end if
            end if
            ! The range of an axis that is not a principal axis was measured.
            if (.not. wanted(of_range) .or. case%body%has_closed_nutation() .or. case%turn%to_principal_axes) return
            momentum = case%given_body%inertia * case%given_start%omega
            range = case%given_start%angle(2)
            if (any(abs(momentum) > 0)) then
                gamma = vertical_from_quaternion(case%given_start%quaternion)
                range = inclination_range(free%axis_angle, atan2(norm2(cross(momentum, gamma)), dot_product(momentum, gamma)))
            end if
            values%of(at_theta_min) = range(1)
            values%of(at_theta_max) = range(2)
            values%of(at_delta_u) = 2 * sin((range(2) + range(1)) / 2) * sin((range(2) - range(1)) / 2)
        end associate
    end subroutine find_free_constants

    !> What a case without T_p lacks.
    pure function needs_of_period(case) result(needs)
        type(case_t), intent(in) :: case
        character(:), allocatable :: needs
        needs = 'a spin and a weight'
        if (case%body%given%differ) needs = 'body z as the axis of symmetry'
    end function needs_of_period

    !> T_p of the paper, s; 0 without spin, without weight, and for a body that is not a top about body z as it was given.
    pure real(dp) function precession_period(body, start)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! the motion at the start
        precession_period = 0
        if (body%given%differ .or. .not. body%mgl() > 0) return
        precession_period = 2 * pi * abs(body%inertia(3) * start%omega(3)) / body%mgl()
    end function precession_period

    !> The growth rate at a relative equilibrium, and the largest multiplier over a period of the vibration. The Lyapunov exponent
    !> and the largest singular value up to the end of the motion are left to `perturbations_t`.
    subroutine compute_stability(slot, t_end, wanted)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        real(dp), intent(in) :: t_end !! end of the motion, s
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        complex(dp) :: eigenvalues(6), multipliers(6)
        real(dp) :: axis(3), quaternion(4)
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
        if (.not. wanted(of_multiplier)) return
        ! The centre of mass is above the pivot, and the body rotates about the vertical with the angular velocity that the start
        ! has about that axis of the body.
        associate (body => slot%case%body)
            if (.not. drive_period(body) > 0) then
                call slot%note%add(note_no_multiplier, 'the only effect must be a vertical vibration, or that and a rotor')
                return
            end if
            axis = [0.0_dp, 0.0_dp, 1.0_dp]
            if (norm2(body%centre_of_mass) > 0) axis = body%centre_of_mass / norm2(body%centre_of_mass)
            ! The smallest rotation that brings the axis upright; from below about body x.
            quaternion = [1 + axis(3), axis(2), -axis(1), 0.0_dp]
            if (.not. norm2(quaternion) > 0) quaternion = [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp]
            call find_multipliers(body, motion_from_quaternion(0.0_dp, quaternion / norm2(quaternion), &
                dot_product(slot%case%start%omega, axis) * axis, no_angles), drive_period(body), multipliers, how)
        end associate
        if (is_ok(how)) then
            slot%result%of(at_upright_multiplier) = maxval(abs(multipliers))
        else if (how == status_unsuitable) then
            call slot%note%add(note_no_multiplier, 'the body cannot rotate steadily about the axis through its centre of mass')
        else
            call slot%note%add(note_no_multiplier, trim(status_meanings(how)))
        end if
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

end module spintop_sweep_quantities
