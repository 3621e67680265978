!> Free bodies of a sweep, many at once, by their closed form.
module spintop_sweep_free
    use spintop_conditioning, only: inherent_error
    use spintop_free_block, only: free_block_t
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_quantities, only: energy_scale, kinetic_energy
    use spintop_status, only: is_ok
    use spintop_sweep_engine, only: engine_t, slot_t, task_t
    use spintop_sweep_quantities, only: set_azimuth, set_end, set_fast_top, set_free_constants
    use spintop_sweep_result, only: kinds_of_work, of_end, of_energy, of_fast_top, of_inherent, of_measured, &
        of_period, of_range, of_turns
    use spintop_sweep_stability, only: compute_stability
    implicit none
    private
    public :: sweep_free_t

    !> The engine for free bodies without symmetry about body z, up to the end of the span, and without quantities that are
    !> measured along the motion.
    type, extends(engine_t) :: sweep_free_t
        type(free_block_t), allocatable, private :: block
    contains
        procedure, nopass :: takes
        procedure :: compute
    end type sweep_free_t

contains

    !> Free bodies up to the end of their span, without quantities that are measured along the motion.
    logical function takes(slot, task)
        type(slot_t), intent(in) :: slot !! the case
        type(task_t), intent(in) :: task !! what is asked of it
        associate (body => slot%case%body, wanted => task%wanted)
            takes = slot%plan%exact .and. body%is_free() .and. .not. body%is_lagrange() &
                    .and. size(task%events) == 0 .and. .not. wanted(of_measured) &
                    .and. .not. (body%given%differ .and. (wanted(of_turns) .or. wanted(of_range)))
        end associate
    end function takes

    !> Computes the cases together.
    subroutine compute(self, slots, list, task)
        class(sweep_free_t), intent(inout) :: self
        type(slot_t), intent(inout) :: slots(:) !! the block
        integer, intent(in) :: list(:) !! the places of the cases
        type(task_t), intent(in) :: task !! what is asked of them
        integer :: i

        if (.not. allocated(self%block)) allocate (self%block)
        associate (block => self%block, wanted => task%wanted)
            block%n = size(list)
            do i = 1, size(list)
                associate (case => slots(list(i))%case)
                    block%inertia(i, :) = case%body%inertia
                    block%omega(i, :) = case%start%omega
                    block%quaternion(i, :) = case%start%quaternion
                    block%angle(i, :) = case%start%angle
                    block%t_end(i) = case%t_end
                    block%most_steps(i) = slots(list(i))%max_steps
                end associate
            end do
            call block%compute(wanted(of_end) .or. wanted(of_energy), wanted(of_turns))
            do i = 1, size(list)
                if (is_ok(block%status(i))) then
                    call set_quantities(block, i, wanted, slots(list(i)))
                else
                    call slots(list(i))%fail(block%status(i))
                end if
            end do
        end associate
    end subroutine compute

    !> The quantities of the i-th case of a computed block.
    subroutine set_quantities(block, i, wanted, slot)
        type(free_block_t), intent(in) :: block
        integer, intent(in) :: i
        logical, intent(in) :: wanted(kinds_of_work)
        type(slot_t), intent(inout) :: slot
        type(motion_t) :: last
        real(dp) :: change

        call compute_stability(slot, slot%case%t_end, wanted)
        if (wanted(of_fast_top)) call set_fast_top(slot)
        if (wanted(of_period)) call set_azimuth(.false., 0.0_dp, slot%result, slot%note)
        associate (case => slot%case)
            if (wanted(of_end) .or. wanted(of_energy)) then
                last%t = case%t_end
                last%omega = block%omega_end(i, :)
                last%quaternion = block%quaternion_end(i, :)
                last%angle = block%angle_end(i, :)
                last%rate(2) = block%theta_rate_end(i)
                change = kinetic_energy(case%body, last) - kinetic_energy(case%body, case%start)
                call set_end(slot, last, abs(change) / energy_scale(case%body, case%start))
            end if
            slot%result%evaluations = 0
            slot%result%orientation_error = 0
            if (wanted(of_inherent)) slot%result%inherent_error = inherent_error(case%body, case%start, case%t_end)
        end associate
        call set_free_constants(slot, block%constants(i), wanted)
    end subroutine set_quantities

end module spintop_sweep_free
