!> Passages of levels that were found, in rising order of time.
module spintop_passages
    use spintop_kinds, only: dp
    implicit none
    private
    public :: passages_t

    !> Passage i is of event `event(i)`, at `t(i)` seconds, i = 1 .. n.
    type :: passages_t
        integer :: n = 0
        integer, allocatable :: event(:)
        real(dp), allocatable :: t(:)
    contains
        procedure :: add
    end type passages_t

contains

    !> Adds a passage in its place by time.
    subroutine add(self, event, t)
        class(passages_t), intent(inout) :: self
        integer, intent(in) :: event !! its number
        real(dp), intent(in) :: t !! s
        integer :: place
        if (self%n == 0) then
            allocate (self%event(0), self%t(0))
        end if
        place = count(self%t <= t)
        self%event = [self%event(:place), event, self%event(place + 1:)]
        self%t = [self%t(:place), t, self%t(place + 1:)]
        self%n = self%n + 1
    end subroutine add

end module spintop_passages
