!> Perturbations of the motions of many rigid bodies, one in each lane of a vector, by Taylor series.
!>
!> A perturbation is a small rotation epsilon of the body, in body axes, and a change delta of its angular
!> velocity. With the motion (omega, Gamma) and the change gamma = Gamma x epsilon of the vertical
!>
!>     epsilon' = delta + epsilon x omega,   I delta' = (I delta) x omega + (I omega) x delta + m g gamma x r
!>                                                      - damping delta
!>
!> The length of the vertical does not change. A rotation about the vertical, epsilon = a Gamma, changes nothing else
!> and stays the same for all times.
module spintop_lane_tangents
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kernel_types, only: lane_body_t, lanes
    implicit none
    private
    public :: carry_tangents, components

    !> Components of a perturbation: delta, epsilon. lane_series.h repeats their number.
    integer, parameter :: components = 6

    interface
        !> Propagates perturbations along the motions. `whole` is the sum of the magnitudes of their components, those of
        !> delta in units of `pace`, and `last` the same of the last two terms of their series.
        pure subroutine carry_tangents(order, body, c, duration, pace, number, before, after, whole, last) &
            bind(C, name='spintop_carry_tangents')
            import :: c_double, c_int, lane_body_t, lanes
            integer(c_int), value :: order !! order of the series, up to that of the motions
            type(lane_body_t), intent(in) :: body !! the bodies
            real(c_double), intent(in) :: c(*) !! Taylor coefficients of the motions (lane, row, term)
            real(c_double), intent(in) :: duration(lanes), pace(lanes) !! s; rad/s
            integer(c_int), value :: number !! of perturbations
            real(c_double), intent(in) :: before(*) !! the perturbations (lane, component, number): delta, epsilon
            real(c_double), intent(inout) :: after(*) !! the same after the duration
            real(c_double), intent(out) :: whole(lanes), last(lanes) !! their size before it, and that of the last two terms
        end subroutine carry_tangents
    end interface

end module spintop_lane_tangents
