!> The passages found, in rising order of time.
module spintop_passages
    use spintop_kinds, only: dp
    implicit none
    private
    public :: passages_t

    !> Room for the first passages.
    integer, parameter :: first_room = 16

    !> Passage i is of event `event(i)`, at `t(i)` seconds, i = 1 .. n; what is beyond n is room for more.
    type :: passages_t
        integer :: n = 0
        integer, allocatable :: event(:)
        real(dp), allocatable :: t(:)
    contains
        procedure :: add
        procedure :: merge_from
    end type passages_t

contains

    !> Adds a passage behind the others. The work for n passages is of the order of n.
    subroutine add(self, event, t)
        class(passages_t), intent(inout) :: self
        integer, intent(in) :: event !! its number
        real(dp), intent(in) :: t !! s
        integer, allocatable :: more_events(:)
        real(dp), allocatable :: more_times(:)

        if (self%n == 0 .and. .not. allocated(self%t)) allocate (self%event(first_room), self%t(first_room))
        if (self%n == size(self%t)) then
            allocate (more_events(2 * self%n), more_times(2 * self%n))
            more_events(:self%n) = self%event
            more_times(:self%n) = self%t
            call move_alloc(more_events, self%event)
            call move_alloc(more_times, self%t)
        end if
        self%n = self%n + 1
        self%event(self%n) = event
        self%t(self%n) = t
    end subroutine add

    !> Puts the passages from number `first` on, which are in order, among those before, which are in
    !> order, too. Of two at the same time the one that was added sooner stays first.
    subroutine merge_from(self, first)
        class(passages_t), intent(inout) :: self
        integer, intent(in) :: first
        integer, allocatable :: events(:)
        real(dp), allocatable :: times(:)
        integer :: i, k, last

        if (first <= 1 .or. first > self%n) return
        if (self%t(first) >= self%t(first - 1)) return
        k = self%n - first + 1
        allocate (events(k), times(k))
        events(:) = self%event(first:self%n)
        times(:) = self%t(first:self%n)
        last = first - 1
        do i = self%n, 1, -1
            if (k == 0) exit
            if (last > 0) then
                if (self%t(last) > times(k)) then
                    self%t(i) = self%t(last)
                    self%event(i) = self%event(last)
                    last = last - 1
                    cycle
                end if
            end if
            self%t(i) = times(k)
            self%event(i) = events(k)
            k = k - 1
        end do
    end subroutine merge_from

end module spintop_passages
