!> Splitting methods: compositions of the flows of drift and kick.
!>
!> They are symmetric, and conserve what both flows conserve: the symplectic form, the norm of a quaternion,
!> the momentum about the vertical. The energy error stays bounded. For equations y'' = g(y) they are
!> symplectic Runge-Kutta-Nystrom methods (Hairer, Lubich and Wanner, Geometric Numerical Integration, II.5
!> and IX.3).
module spintop_splitting
    use spintop_kinds, only: dp
    use spintop_fixed_step, only: fixed_step_t
    use spintop_formulation, only: max_states
    use spintop_splitting_tables, only: splitting_table_t
    use spintop_status, only: status_ok
    implicit none
    private
    public :: splitting_t

    !> Two methods of one order: one for Nystrom splits, and one for any drift and kick.
    type, extends(fixed_step_t) :: splitting_t
        type(splitting_table_t) :: nystrom, general
    contains
        procedure :: step
    end type splitting_t

contains

    !> One step.
    subroutine step(self, h, change, status)
        class(splitting_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        if (self%formulation%splits_as_nystrom) then
            call compose(self%nystrom)
        else
            call compose(self%general)
        end if
        status = status_ok

    contains

        subroutine compose(table)
            type(splitting_table_t), intent(in) :: table
            call self%formulation%compose(self%y, h, table%kick(:table%stages), table%drift(:table%stages), change)
            self%counts%evaluations = self%counts%evaluations + table%kicks
        end subroutine compose

    end subroutine step

end module spintop_splitting
