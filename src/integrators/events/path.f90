!> The interface of a motion that can be evaluated at any time within an interval.
module spintop_path
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_loads, only: works
    use spintop_motion, only: motion_t
    use spintop_motions, only: instants, motions_t
    implicit none
    private
    public :: path_t

    !> An extension defines the motion, and how many evaluations are allowed.
    type, abstract :: path_t
        !> A bound of the angular velocity along the path, rad/s; 0 if none is known.
        real(dp) :: greatest_rate = 0
        !> Evaluations so far, and how many are allowed.
        integer(int64) :: looks = 0, most_looks = huge(1_int64)
    contains
        procedure(at), deferred :: at
        procedure :: at_without_angles
        procedure :: motion_at
        procedure :: at_several
        procedure :: work_until
        procedure :: is_spent
    end type path_t

    abstract interface
        !> The motion at a time.
        subroutine at(self, t, motion)
            import :: path_t, motion_t, dp
            class(path_t), intent(inout) :: self
            real(dp), intent(in) :: t !! time, s
            type(motion_t), intent(out) :: motion !! the motion at that time
        end subroutine at
    end interface

contains

    !> The motion at a time; its angles and their rates need not be set. By default the whole motion.
    subroutine at_without_angles(self, t, motion)
        class(path_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        type(motion_t), intent(out) :: motion !! the motion at that time
        call self%at(t, motion)
    end subroutine at_without_angles

    !> The motion at a time, with angles and their rates or, where it is cheaper, without.
    subroutine motion_at(self, t, with_angles, motion)
        class(path_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        logical, intent(in) :: with_angles !! whether they are needed
        type(motion_t), intent(out) :: motion !! the motion at that time
        if (with_angles) then
            call self%at(t, motion)
        else
            call self%at_without_angles(t, motion)
        end if
    end subroutine motion_at

    !> The motion, without angles, at several instants. By default one after the other.
    subroutine at_several(self, t, used, motions)
        class(path_t), intent(inout) :: self
        real(dp), intent(in) :: t(instants) !! times, s
        integer, intent(in) :: used !! how many of them are different: those that count as work
        type(motions_t), intent(out) :: motions !! the motion at these times
        type(motion_t) :: motion
        integer :: i
        do i = 1, instants
            if (i <= used) call self%at_without_angles(t(i), motion)
            call motions%set_motion(i, motion)
        end do
    end subroutine at_several

    !> The work of effects from the start to a time, by its parts, J; by default there are none.
    function work_until(self, t) result(work)
        class(path_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: work(works)
        work = 0
    end function work_until

    !> Whether the allowed number of evaluations is used up.
    logical function is_spent(self)
        class(path_t), intent(in) :: self
        is_spent = self%looks >= self%most_looks
    end function is_spent

end module spintop_path
