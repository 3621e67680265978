!> The values of all quantities at the latest instants, so that searches for several events share them.
module spintop_recent_values
    use spintop_kinds, only: dp
    implicit none
    private
    public :: recent_values_t

    !> Number of instants that are kept: more than a measurement of the rounding error takes.
    integer, parameter :: room = 16

    !> `begin`, then `find` what was kept by `keep`.
    type :: recent_values_t
        private
        integer :: kept = 0, latest = 0
        real(dp) :: t(room) = 0
        real(dp), allocatable :: values(:, :)
    contains
        procedure :: begin
        procedure :: find
        procedure :: keep
    end type recent_values_t

contains

    !> Forgets everything, and makes room for so many quantities.
    pure subroutine begin(self, quantities)
        class(recent_values_t), intent(inout) :: self
        integer, intent(in) :: quantities !! number of quantities
        self%kept = 0
        self%latest = 0
        if (allocated(self%values)) deallocate (self%values)
        allocate (self%values(quantities, room))
    end subroutine begin

    !> The value of quantity `k` at time `t`, if it is known.
    pure subroutine find(self, t, k, value, known)
        class(recent_values_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        integer, intent(in) :: k !! number of the quantity
        real(dp), intent(out) :: value !! its value; 0 if it is not known
        logical, intent(out) :: known !! whether it is known
        integer :: i
        value = 0
        do i = 1, self%kept
            known = self%t(i) >= t .and. self%t(i) <= t
            if (.not. known) cycle
            value = self%values(k, i)
            return
        end do
        known = .false.
    end subroutine find

    !> Keeps the values at a time, in the place of the oldest.
    pure subroutine keep(self, t, values)
        class(recent_values_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp), intent(in) :: values(:) !! one value for each quantity
        self%latest = mod(self%latest, room) + 1
        self%kept = max(self%kept, self%latest)
        self%t(self%latest) = t
        self%values(:, self%latest) = values
    end subroutine keep

end module spintop_recent_values
