!> The caller of a library, who is told how far a call is, and may want it to stop. Each thread of the caller has its own
!> function, which the calls of this thread ask a few times a second; their own threads have `copyin(current)`.
!>
!>     call begin_call()
!>     ...                        ! tell_share; if (stop_is_wanted()) return
!>     call end_call(error)       ! an error if the call was stopped
!>
!> A caller may have changed the arithmetic: rounding upwards, traps, or numbers flushed to zero make wrong results or end the
!> process. Functions that other programs call compute with the default, and leave the caller's as it was:
!>
!>     type(default_arithmetic_t) :: arithmetic
!>     call arithmetic%begin()    ! up to the end of the procedure
module spintop_caller
    use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_procpointer, c_funptr, c_int, c_int8_t, &
        c_null_funptr, c_null_ptr, c_ptr
    use spintop_errors, only: error_t, exit_failed
    use spintop_kinds, only: dp
    use spintop_process, only: seconds
    implicit none
    private
    public :: set_caller, begin_call, end_call, tell_share, stop_is_wanted, refuse_if_stopped, current, default_arithmetic_t

    !> A call in progress.
    type :: call_t
        private
        type(c_funptr) :: asks = c_null_funptr
        type(c_ptr) :: data = c_null_ptr
        real(dp) :: share = 0, asked = 0
        !> Not 0: the caller wants it to stop.
        integer :: stops = 0
    end type call_t

    !> Bytes of an environment of C, at the most.
    integer, parameter :: room = 64

    !> A thread that computes with the default arithmetic. The caller's comes back when the object ends.
    type :: default_arithmetic_t
        integer(c_int8_t), private :: held(room) = 0
        logical, private :: is_held = .false.
    contains
        procedure :: begin
        final :: restore
    end type default_arithmetic_t

    interface
        subroutine c_hold(held) bind(C, name='spintop_hold_arithmetic')
            import :: c_int8_t
            integer(c_int8_t), intent(out) :: held(*)
        end subroutine c_hold

        subroutine c_restore(held) bind(C, name='spintop_restore_arithmetic')
            import :: c_int8_t
            integer(c_int8_t), intent(in) :: held(*)
        end subroutine c_restore
    end interface

    abstract interface
        !> Whether a call is to stop: not 0.
        integer(c_int) function asks_caller(share, data) bind(C)
            import :: c_double, c_int, c_ptr
            real(c_double), value :: share
            type(c_ptr), value :: data
        end function asks_caller
    end interface

    !> The function of this thread and its datum, which its next call asks.
    type(c_funptr) :: own_function = c_null_funptr
    type(c_ptr) :: own_data = c_null_ptr
    !> The call for which this thread works; none if its caller has no function. For `copyin` only.
    type(call_t), pointer :: current => null()
    !$omp threadprivate(own_function, own_data, current)

    !> Seconds between two questions.
    real(dp), parameter :: pause = 0.1_dp

contains

    !> Sets the function that the calls of this thread ask.
    subroutine set_caller(asks, data)
        type(c_funptr), intent(in) :: asks !! of the interface `asks_caller`, or null for none
        type(c_ptr), intent(in) :: data !! its second argument
        own_function = asks
        own_data = data
    end subroutine set_caller

    !> Begins a call of this thread.
    subroutine begin_call()
        nullify (current)
        if (.not. c_associated(own_function)) return
        allocate (current)
        current%asks = own_function
        current%data = own_data
        current%asked = seconds()
    end subroutine begin_call

    !> Ends the call of this thread.
    subroutine end_call(error)
        type(error_t), allocatable, intent(inout) :: error !! that of the call: that it was stopped, if it was
        if (.not. associated(current)) return
        if (current%stops /= 0) error = stopped()
        deallocate (current)
    end subroutine end_call

    !> Tells how much of the call is done.
    subroutine tell_share(share)
        real(dp), intent(in) :: share !! from 0 to 1
        if (.not. associated(current)) return
        !$omp atomic write
        current%share = share
    end subroutine tell_share

    !> Whether the caller wants the call to stop. Any of its threads may ask at any time: it costs nothing without a caller who
    !> may, and little with one.
    logical function stop_is_wanted() result(stops)
        procedure(asks_caller), pointer :: asks
        integer :: answer
        real(dp) :: asked
        stops = .false.
        if (.not. associated(current)) return
        !$omp atomic read
        answer = current%stops
        !$omp atomic read
        asked = current%asked
        if (answer == 0 .and. seconds() - asked > pause) then
            !$omp critical (caller)
            if (current%stops == 0 .and. seconds() - current%asked > pause) then
                call c_f_procpointer(current%asks, asks)
                answer = asks(current%share, current%data)
                !$omp atomic write
                current%stops = answer
                asked = seconds()
                !$omp atomic write
                current%asked = asked
            end if
            !$omp end critical (caller)
        end if
        stops = answer /= 0
    end function stop_is_wanted

    !> Refuses to go on if the caller wants the call to stop.
    subroutine refuse_if_stopped(error)
        type(error_t), allocatable, intent(inout) :: error !! set, unless there is one
        if (allocated(error)) return
        if (stop_is_wanted()) error = stopped()
    end subroutine refuse_if_stopped

    pure type(error_t) function stopped()
        stopped = error_t(exit_failed, 'stopped, as the caller wants')
    end function stopped

    !> Keeps the arithmetic of the caller, and begins with the default one.
    subroutine begin(self)
        class(default_arithmetic_t), intent(inout) :: self
        call c_hold(self%held)
        self%is_held = .true.
    end subroutine begin

    subroutine restore(self)
        type(default_arithmetic_t), intent(inout) :: self
        if (self%is_held) call c_restore(self%held)
        self%is_held = .false.
    end subroutine restore

end module spintop_caller
