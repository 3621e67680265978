!> The exact solution of a case as a path on which events are sought.
module spintop_exact_path
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t
    use spintop_events, only: path_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_stepper, only: looks_per_step
    implicit none
    private
    public :: exact_path_t

    !> The exact solution as a path; its evaluations are counted.
    type, extends(path_t) :: exact_path_t
        type(exact_motion_t) :: exact
        !> Whether phi and psi count their turns, which takes steps of their own for a free body and for one that was given
        !> in other axes; otherwise its angles are the values nearest to those of the start.
        logical :: counts_turns = .true.
        !> The last instant; the turns of the angles are counted from there.
        type(motion_t), private :: last
    contains
        procedure :: begin
        procedure :: restart
        procedure :: at
    end type exact_path_t


contains

    !> Prepares the exact solution of a case; the work is at most `most_looks` instants.
    subroutine begin(self, case, most_looks, status)
        class(exact_path_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! the case; its body must have a closed form
        integer(int64), intent(in) :: most_looks !! bound of the work
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        call prepare_exact_motion(case%body, case%start, self%exact, status)
        self%greatest_rate = 0
        if (allocated(self%exact%free)) self%greatest_rate = self%exact%free%greatest_rate
        call self%restart(case, most_looks)
    end subroutine begin

    !> Returns to the start of the case, with a new bound of the work.
    subroutine restart(self, case, most_looks)
        class(exact_path_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! the case to whose start the path returns
        integer(int64), intent(in) :: most_looks !! bound of the work
        self%looks = 0
        self%most_looks = most_looks
        self%last = case%start
    end subroutine restart

    !> The exact solution at a time. A step that only counts turns is a step of the case.
    subroutine at(self, t, motion)
        class(exact_path_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        type(motion_t), intent(out) :: motion !! the motion at that time
        integer(int64) :: steps, most_steps
        self%looks = self%looks + 1
        if (self%counts_turns) then
            steps = 0
            most_steps = (self%most_looks - self%looks + looks_per_step - 1) / looks_per_step
            call self%exact%follow(self%last, t, motion, steps, most_steps)
            self%looks = self%looks + looks_per_step * steps
            if (.not. self%is_spent()) self%last = motion
        else
            motion = self%exact%at(t)
        end if
    end subroutine at

end module spintop_exact_path
