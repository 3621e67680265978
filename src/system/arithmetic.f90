!> The arithmetic of a caller who may have changed it: rounding upwards, traps, or numbers flushed to zero make wrong results
!> or end the process. Functions that other programs call compute with the default, and leave the caller's as it was:
!>
!>     type(default_arithmetic_t) :: arithmetic
!>     call arithmetic%begin()     ! up to the end of the procedure
module spintop_arithmetic
    use, intrinsic :: iso_c_binding, only: c_int8_t
    implicit none
    private
    public :: default_arithmetic_t

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

contains

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

end module spintop_arithmetic
