!> An observer of an integration that keeps every motion it is shown.
module recorder
    use spintop_kinds, only: dp
    use spintop_formulation, only: formulation_t, max_states
    use spintop_integration, only: observer_t
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: recorder_t

    !> The motions seen are `motions(:count)`.
    type, extends(observer_t) :: recorder_t
        type(motion_t), allocatable :: motions(:)
        integer :: count = 0
        !> Ends the run after so many motions.
        integer :: limit = huge(1)
    contains
        procedure :: observe
        procedure :: last
        procedure :: times
    end type recorder_t

contains

    subroutine observe(self, formulation, t, y, near)
        class(recorder_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        type(motion_t), allocatable :: larger(:)

        if (.not. allocated(self%motions)) allocate (self%motions(64))
        if (self%count == size(self%motions)) then
            allocate (larger(2 * self%count))
            larger(:self%count) = self%motions
            call move_alloc(larger, self%motions)
        end if
        self%count = self%count + 1
        self%motions(self%count) = formulation%motion(t, y, near)
        self%has_enough = self%count >= self%limit
    end subroutine observe

    !> The motion seen last.
    type(motion_t) function last(self)
        class(recorder_t), intent(in) :: self
        last = self%motions(self%count)
    end function last

    !> The times at which the motion was seen.
    function times(self)
        class(recorder_t), intent(in) :: self
        real(dp), allocatable :: times(:)
        allocate (times(0))
        if (self%count > 0) times = self%motions(:self%count)%t
    end function times

end module recorder
