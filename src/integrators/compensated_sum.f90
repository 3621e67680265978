!> The compensated sum of the changes of a state, step by step: what rounding takes from one sum is added to the next change
!> (Kahan, Comm. ACM 8, 1965).
module spintop_compensated_sum
    use spintop_kinds, only: dp
    use spintop_formulation, only: max_states
    implicit none
    private
    public :: add_change

contains

    !> Adds a change to a state.
    pure subroutine add_change(y, change, rest, y_new)
        real(dp), intent(in) :: y(max_states) !! the state
        real(dp), intent(in) :: change(max_states) !! its change over a step
        real(dp), intent(inout) :: rest(max_states) !! what the last sum lacks, then what this one lacks
        real(dp), intent(out) :: y_new(max_states) !! the state after the step
        real(dp) :: total(max_states)
        total = change + rest
        y_new = y + total
        rest = total - (y_new - y)
    end subroutine add_change

end module spintop_compensated_sum
