!> Splitting methods: compositions of the flows of drift and kick.
!>
!> They are symmetric, and conserve what both flows conserve: the symplectic form, the norm of a quaternion,
!> the momentum about the vertical. The energy error stays bounded. For equations y'' = g(y) they are
!> symplectic Runge-Kutta-Nystrom methods (Hairer, Lubich and Wanner, Geometric Numerical Integration, II.5
!> and IX.3).
module spintop_splitting
    use spintop_fixed_step, only: fixed_step_t
    use spintop_formulation, only: max_states
    use spintop_kinds, only: dp
    use spintop_status, only: status_ok
    implicit none
    private
    public :: splitting_table_t, splitting_table, splitting_t

    !> Maximum number of drifts of a table.
    integer, parameter :: max_flows = 17

    !> A splitting method.
    type :: splitting_table_t
        !> Number of drifts, and of kicks with a nonzero coefficient.
        integer :: stages = 0, kicks = 0
        real(dp) :: kick(0:max_flows) = 0
        real(dp) :: drift(max_flows) = 0
    end type splitting_table_t

    !> Two methods of one order: one for any drift and kick, and one for Nystrom splits.
    type, extends(fixed_step_t) :: splitting_t
        type(splitting_table_t) :: table(2)
    contains
        procedure :: step
    end type splitting_t

contains

    !> The method of an order. Those for Nystrom splits only are shorter; there is none of order 8, and the other serves.
    elemental type(splitting_table_t) function splitting_table(order, is_nystrom) result(table)
        integer, intent(in) :: order !! 2, 4, 6 or 8
        logical, intent(in) :: is_nystrom !! whether it is for Nystrom splits only
        real(dp), parameter :: outer = 1 / (4 - 4**(1.0_dp / 3))

        if (is_nystrom .and. order == 4) then
            ! Method SRKN_6^b of Blanes and Moan (J. Comput. Appl. Math. 142, 2002). Here and below their 15 decimals are extended
            ! by Newton's method for the order conditions.
            table = mirrored( &
                [0.08298440641740501883834748_dp, 0.3963098014983680770949115_dp, &
                 -0.03905630492234843517086529_dp], &
                [0.2452989571842711626039324_dp, 0.6048726657110799749608927_dp])
        else if (is_nystrom .and. order == 6) then
            ! Method SRKN_14^a of the same authors; it begins with a drift.
            table = mirrored( &
                [0.0_dp, 0.09171915262446201798118323_dp, 0.1839831700050048984914766_dp, &
                 -0.05653436583288910439527704_dp, 0.004914688774711885640205616_dp, &
                 0.1437611271683616823873745_dp, 0.3285676937468041402004813_dp], &
                [0.03785931984061094144702118_dp, 0.1026356331024365528470823_dp, &
                 -0.02586788826655833316394696_dp, 0.3142414030714464341471425_dp, &
                 -0.1301444595174151138496151_dp, 0.1064177003695413680222801_dp, &
                 -0.008794243128510204394069428_dp])
        else if (order == 2) then
            ! Kick, drift, kick (Stoermer, Verlet, Strang).
            table = composition([real(dp) ::])
        else if (order == 4) then
            ! Five steps of order 2 (Suzuki, Phys. Lett. A 146, 1990).
            table = composition([outer, outer])
        else if (order == 6) then
            ! Nine steps of order 2 (Kahan and Li, Math. Comp. 66, 1997).
            table = composition( &
                [0.39216144400731413927925056_dp, 0.33259913678935943859974864_dp, &
                 -0.70624617255763935980996482_dp, 0.08221359629355080023149045_dp])
        else
            ! Seventeen steps of order 2 (Kahan and Li).
            table = composition( &
                [0.13020248308889008087881763_dp, 0.56116298177510838456196441_dp, &
                 -0.38947496264484728640807860_dp, 0.15884190655515560089621075_dp, &
                 -0.39590389413323757733623154_dp, 0.18453964097831570709183254_dp, &
                 0.25837438768632204729397911_dp, 0.29501172360931029087096624_dp])
        end if
    end function splitting_table

    !> The composition of steps kick, drift, kick of the sizes `step` h, for any drift that is symmetric.
    pure type(splitting_table_t) function composition(step) result(table)
        real(dp), intent(in) :: step(:)
        table = mirrored((eoshift(step, -1) + step) / 2, step)
    end function composition

    !> The table of which this is the first half, without the last kick and the last drift; one of these is in
    !> the middle, the other next to it.
    pure type(splitting_table_t) function mirrored(kick, drift) result(table)
        real(dp), intent(in) :: kick(:), drift(:)
        logical :: kick_in_middle
        associate (kicks => size(kick), drifts => size(drift), stages => size(kick) + size(drift) + 1)
            kick_in_middle = mod(stages, 2) == 0
            table%stages = stages
            table%kick(:kicks - 1) = kick
            table%kick(kicks) = 0.5_dp - sum(kick)
            if (kick_in_middle) table%kick(kicks) = 1 - 2 * sum(kick)
            table%drift(:drifts) = drift
            table%drift(drifts + 1) = 0.5_dp - sum(drift)
            if (.not. kick_in_middle) table%drift(drifts + 1) = 1 - 2 * sum(drift)
            table%kick(stages:stages - kicks:-1) = table%kick(:kicks)
            table%drift(stages:stages - drifts:-1) = table%drift(:drifts + 1)
            table%kicks = count(abs(table%kick) > 0)
        end associate
    end function mirrored

    !> One step.
    subroutine step(self, h, change, status)
        class(splitting_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        associate (table => self%table(merge(2, 1, self%formulation%splits_as_nystrom)))
            call self%formulation%compose(self%y, h, table%kick(:table%stages), table%drift(:table%stages), change)
            self%counts%evaluations = self%counts%evaluations + table%kicks
        end associate
        status = status_ok
    end subroutine step

end module spintop_splitting
