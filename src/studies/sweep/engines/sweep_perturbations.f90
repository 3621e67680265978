!> What perturbations of the motions of a sweep tell, found together in lanes for the cases of a block, however their motions
!> were computed: Lyapunov exponents and largest singular values.
module spintop_sweep_perturbations
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_lyapunov, only: find_growth, growth_t
    use spintop_sweep_engine, only: engine_t, slot_t, task_t
    use spintop_sweep_result, only: at_lyapunov_exponent, at_largest_singular_value, note_no_lyapunov, &
        note_no_singular, kinds_of_work, of_lyapunov, of_singular
    implicit none
    private
    public :: perturbations_t

    !> The engine for perturbations of motions that have been computed.
    type, extends(engine_t) :: perturbations_t
    contains
        procedure :: compute
        procedure, nopass :: shares_lanes
    end type perturbations_t

contains

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
        call compute_growths(slots, pack(list, slots(list)%growth_until > 0), task%wanted)
    end subroutine compute

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
            associate (found => growth(i), slot => slots(list(i)))
                if (wanted(of_lyapunov)) call slot%store_or_explain(at_lyapunov_exponent, found%exponent, &
                                                                    found%exponent_status, note_no_lyapunov)
                if (wanted(of_singular)) call slot%store_or_explain(at_largest_singular_value, found%singular, &
                                                                    found%singular_status, note_no_singular)
            end associate
        end do
    end subroutine compute_growths

end module spintop_sweep_perturbations
