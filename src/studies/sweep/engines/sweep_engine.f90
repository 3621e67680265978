!> How the cases of a sweep are computed. A block has a slot for each of its cases; engines, of which each takes the cases
!> that suit it, compute their quantities, many at once where they can.
!>
!>     call run_engines(engines, slots, task)   ! the first engine that takes a case computes it
module spintop_sweep_engine
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t
    use spintop_event_text, only: column_event_t
    use spintop_kinds, only: dp
    use spintop_measures, only: growth_t
    use spintop_planning, only: plan_t
    use spintop_status, only: is_good_end, is_ok, status_meanings, status_non_finite, status_ok, status_step_limit
    use spintop_sweep_result, only: at_largest_singular_value, at_lyapunov_exponent, kinds_of_work, note_no_lyapunov, &
        note_no_singular, note_no_turns_known, note_t, of_lyapunov, of_singular, of_turns, of_whole, sweep_result_t
    implicit none
    private
    public :: task_t, slot_t, engine_t, engine_entry_t, run_engines
    public :: lacks_nothing, lacks_motion, lacks_perturbations

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

end module spintop_sweep_engine
