!> Symmetric tops of a sweep, many at once, by their closed form.
module spintop_sweep_exact
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, is_finite
    use spintop_conditioning, only: inherent_error
    use spintop_event_recorder, only: event_recorder_t, exact_path_t
    use spintop_exact_block, only: compute_block, exact_block_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_motion, only: motion_t
    use spintop_nutation, only: nutation_t, whole_half_turns
    use spintop_regular_start, only: rates_describe
    use spintop_status, only: is_ok, status_step_limit
    use spintop_stepper, only: looks_per_step
    use spintop_sweep_quantities, only: engine_t, slot_t, task_t, find_free_constants, set_nutation, set_fast_top, &
        set_azimuth, set_end, set_details, precession_period, compute_stability
    use spintop_sweep_result, only: at_orientation_error, at_inherent_error, at_evaluations, &
        note_no_stop, kinds_of_work, of_details, of_end, of_energy, of_fast_top, of_free, of_inherent, of_nutation, &
        of_period, of_turns
    implicit none
    private
    public :: sweep_exact_t

    !> The engine for symmetric tops.
    type, extends(engine_t) :: sweep_exact_t
        type(exact_block_t), allocatable, private :: block
    contains
        procedure, nopass :: takes
        procedure :: compute
    end type sweep_exact_t

contains

    !> Cases in closed form: undamped symmetric tops, and free bodies where these are not computed together.
    logical function takes(slot, task)
        type(slot_t), intent(in) :: slot !! the case
        type(task_t), intent(in) :: task !! what is asked of it
        associate (body => slot%case%body, wanted => task%wanted)
            takes = slot%plan%exact .and. suits_lanes(slot%case%start)
            if (takes) takes = body%is_lagrange() .and. &
                .not. (body%given%differ .and. (wanted(of_nutation) .or. wanted(of_details)))
        end associate
    end function takes

    !> Whether the closed form can be computed in lanes, which begin with angles and rates: these do not exist at a pole,
    !> and close to it they lose digits of a quaternion and omega.
    pure logical function suits_lanes(start)
        type(motion_t), intent(in) :: start
        real(dp), parameter :: close_to_pole = 1.0e-2_dp
        suits_lanes = rates_describe(start)
        if (.not. suits_lanes) suits_lanes = all(is_finite(start%rate)) .and. sin(start%angle(2)) > close_to_pole
    end function suits_lanes

    !> Computes the cases by the closed form, the nutations of all together.
    subroutine compute(self, slots, list, task)
        class(sweep_exact_t), intent(inout) :: self
        type(slot_t), intent(inout) :: slots(:) !! the block
        integer, intent(in) :: list(:) !! the places of the cases
        type(task_t), intent(in) :: task !! what is asked of them
        ! These objects are large, and a thread may have a small stack.
        type(exact_path_t), allocatable :: path
        type(event_recorder_t), allocatable :: recorder
        real(dp) :: t_end
        logical :: event_occurred(size(list))
        integer :: i, status

        if (.not. allocated(self%block)) allocate (self%block)
        event_occurred = .true.
        associate (block => self%block, wanted => task%wanted)
            block%n = size(list)
            do i = 1, size(list)
                associate (slot => slots(list(i)))
                    if (size(task%events) > 0) then
                        ! The span ends at the event that ends the motion, if the allowed work suffices to find it.
                        event_occurred(i) = .false.
                        if (allocated(path)) deallocate (path, recorder)
                        allocate (path, recorder)
                        call path%begin(slot%case, looks_per_step * slot%max_steps, status)
                        if (is_ok(status)) then ! otherwise the kernel reports it
                            call recorder%set(task%events, task%stop_after, slot%case)
                            call recorder%search_exactly(path, slot%case, t_end, status)
                            slot%max_steps = slot%max_steps - path%looks / looks_per_step
                            event_occurred(i) = recorder%has_enough
                            slot%case%t_end = t_end
                            if (.not. is_ok(status)) call slot%fail(status)
                        end if
                    end if
                end associate
                associate (case => slots(list(i))%case)
                    block%inertia1(i) = case%body%inertia(1)
                    block%inertia3(i) = case%body%inertia(3)
                    block%mgl(i) = case%body%mgl()
                    block%phi(i) = case%start%angle(1)
                    block%theta(i) = case%start%angle(2)
                    block%psi(i) = case%start%angle(3)
                    block%phi_rate(i) = case%start%rate(1)
                    block%theta_rate(i) = case%start%rate(2)
                    block%omega3(i) = case%start%omega(3)
                    block%t_end(i) = case%t_end
                    block%t_period(i) = 0
                    if (wanted(of_period)) block%t_period(i) = precession_period(case%body, case%start)
                end associate
            end do
            if (any(wanted([of_nutation, of_period, of_end, of_energy]))) then
                call compute_block(block, wanted(of_end) .or. wanted(of_energy), wanted(of_period))
            end if
            do i = 1, size(list)
                associate (slot => slots(list(i)))
                    if (is_ok(slot%status)) call unload_lane(block, i, wanted, slot)
                    if (is_ok(slot%status) .and. .not. event_occurred(i)) call slot%note%add(note_no_stop)
                end associate
            end do
        end associate
    end subroutine compute

    !> The quantities of the case in a lane of a computed block.
    subroutine unload_lane(block, lane, wanted, slot)
        type(exact_block_t), intent(in) :: block
        integer, intent(in) :: lane
        logical, intent(in) :: wanted(kinds_of_work)
        type(slot_t), intent(inout) :: slot
        type(nutation_t) :: nutation

        if (.not. is_ok(block%status(lane))) then
            call slot%fail(block%status(lane))
            return
        end if
        if (wanted(of_nutation)) then
            nutation%theta_min = block%theta_min(lane)
            nutation%theta_max = block%theta_max(lane)
            nutation%delta_u = block%delta_u(lane)
            nutation%period = block%period(lane)
            nutation%precession = block%precession(lane)
            nutation%precession_rate = block%precession_rate(lane)
            if (.not. block%mgl(lane) > 0) then ! a free body
                nutation%precession = whole_half_turns(nutation%precession)
                nutation%precession_rate = nutation%precession / nutation%period
            end if
            nutation%phi_rate_max = block%phi_rate_max(lane)
            call set_nutation(slot, nutation, wanted)
        end if
        if (wanted(of_fast_top)) call set_fast_top(slot)
        if (wanted(of_period)) then
            call set_azimuth(slot, block%t_period(lane) > 0, block%phi_at_period(lane))
        end if
        if (wanted(of_end) .or. wanted(of_energy)) then
            call unload_end(block, lane, wanted, slot)
            if (.not. is_ok(slot%status)) return
        end if
        slot%result%of(at_evaluations) = 0
        slot%result%of(at_orientation_error) = 0
        if (wanted(of_details)) call set_details(slot)
        if (wanted(of_free)) call find_free_constants(slot, wanted)
        call compute_stability(slot, slot%case%t_end, wanted)
        if (wanted(of_inherent)) then
            slot%result%of(at_inherent_error) = inherent_error(slot%case%body, slot%case%start, slot%case%t_end)
        end if
    end subroutine unload_lane

    !> The end of the span, as far as a sweep table needs it. Angles about another axis need the whole attitude; counting
    !> their turns is work of the case.
    subroutine unload_end(block, lane, wanted, slot)
        type(exact_block_t), intent(in) :: block
        integer, intent(in) :: lane
        logical, intent(in) :: wanted(kinds_of_work)
        type(slot_t), intent(inout) :: slot
        type(exact_motion_t), allocatable :: exact ! large, and mostly not needed
        type(motion_t) :: last
        integer(int64) :: steps
        integer :: status

        associate (case => slot%case)
            if (.not. case%turn%exchanges_axes()) then
                last%t = case%t_end
                last%angle = [block%phi_end(lane), block%theta_end(lane), block%psi_end(lane)]
                last%rate(2) = block%theta_rate_end(lane)
            else
                allocate (exact)
                call prepare_exact_motion(case%body, case%start, exact, status)
                if (wanted(of_turns) .and. is_ok(status)) then
                    steps = 0
                    call exact%follow(case%start, case%t_end, last, steps, slot%max_steps)
                    if (steps >= slot%max_steps) then
                        call slot%fail(status_step_limit)
                        return
                    end if
                else
                    last = exact%at(case%t_end)
                end if
            end if
        end associate
        call set_end(slot, last, block%energy_error(lane))
    end subroutine unload_end

end module spintop_sweep_exact
