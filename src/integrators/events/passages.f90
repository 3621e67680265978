!> A list of passages in increasing order of time.
module spintop_passages
    use spintop_kinds, only: dp
    implicit none
    private
    public :: passages_t

    !> Initial capacity.
    integer, parameter :: first_room = 16
    !> Room for no more.
    integer, parameter :: most_room = huge(1) - 1

    !> Passage i belongs to event `event(i)`, at time `t(i)`, s, i = 1 .. n. Elements beyond n are free
    !> capacity.
    type :: passages_t
        integer :: n = 0
        !> There was no memory for another.
        logical :: is_full = .false.
        integer, allocatable :: event(:)
        real(dp), allocatable :: t(:)
    contains
        procedure :: add
        procedure :: merge_from
    end type passages_t

contains

    !> Adds a passage behind the others, if there is memory for it. The work for n passages is of the order of n.
    subroutine add(self, event, t)
        class(passages_t), intent(inout) :: self
        integer, intent(in) :: event !! its number
        real(dp), intent(in) :: t !! time of the passage, s
        integer, allocatable :: more_events(:)
        real(dp), allocatable :: more_times(:)
        integer :: failure

        if (self%n == 0 .and. .not. allocated(self%t)) allocate (self%event(first_room), self%t(first_room))
        if (self%n == size(self%t)) then
            self%is_full = self%n > most_room / 2
            if (self%is_full) return
            allocate (more_events(2 * self%n), stat=failure)
            if (failure == 0) allocate (more_times(2 * self%n), stat=failure)
            self%is_full = failure /= 0
            if (self%is_full) return
            more_events(:self%n) = self%event
            more_times(:self%n) = self%t
            call move_alloc(more_events, self%event)
            call move_alloc(more_times, self%t)
        end if
        self%n = self%n + 1
        self%event(self%n) = event
        self%t(self%n) = t
    end subroutine add

    !> Merges the passages from number `first` on, which are in order, with those before, which are also in
    !> order. Of two passages at the same time, the one that was added earlier stays first.
    subroutine merge_from(self, first)
        class(passages_t), intent(inout) :: self
        integer, intent(in) :: first !! number of the first passage to merge
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
