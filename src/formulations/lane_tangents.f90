!> Perturbations of the motions of many rigid bodies, one in each lane of a vector, by Taylor series.
!>
!> A perturbation is a small rotation epsilon of the body, in body axes, and a change delta of its angular
!> velocity. With the motion (omega, Gamma) and the change gamma = Gamma x epsilon of the vertical
!>
!>     epsilon' = delta + epsilon x omega,   I delta' = (I delta) x omega + (I omega) x delta + m g gamma x r
!>                                                      - damping delta + I f
!>
!> The length of the vertical does not change. A rotation about the vertical, epsilon = a Gamma, changes nothing else
!> and stays the same for all times. `f` is the angular acceleration due to changes of the body, 1/s^2.
module spintop_lane_tangents
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kinds, only: dp
    use spintop_lane_series, only: lanes, rows
    implicit none
    private
    public :: carry_tangents, components

    !> Components of a perturbation: delta, epsilon. lane_series.c repeats their number.
    integer, parameter :: components = 6

    interface
        pure subroutine c_carry_tangents(order, coupling, decay, pull, swing, c, is_forced, force, duration, pace, &
                                         before, after, whole, last) bind(C, name='spintop_carry_tangents')
            import :: c_double, c_int
            integer(c_int), value :: order, is_forced
            real(c_double), dimension(*), intent(in) :: coupling, decay, pull, swing, c, force, duration, pace, before
            real(c_double), intent(out) :: after(*), whole(*), last(*)
        end subroutine c_carry_tangents
    end interface

contains

    !> Carries a perturbation along the motions. `whole` is the sum of the magnitudes of its components, those of delta
    !> in units of `pace`, and `last` the same of the last two terms of its series.
    pure subroutine carry_tangents(order, coupling, decay, pull, swing, c, duration, pace, before, after, whole, last, &
                                   force)
        integer, intent(in) :: order !! order of the series, up to that of the motions
        real(dp), dimension(lanes, 3), intent(in) :: coupling, decay, pull, swing !! as in `expand`
        real(dp), intent(in) :: c(lanes, rows, 0:order) !! Taylor coefficients of the motions
        real(dp), intent(in) :: duration(lanes), pace(lanes) !! s; rad/s
        real(dp), intent(in) :: before(lanes, components) !! the perturbations: delta, epsilon
        real(dp), intent(out) :: after(lanes, components), whole(lanes), last(lanes)
            !! perturbations after the duration; their size before it, and the size of the last two terms
        real(dp), intent(in), optional :: force(lanes, 3, 0:order) !! Taylor coefficients of f, 1/s^2
        if (present(force)) then
            call c_carry_tangents(order, coupling, decay, pull, swing, c, 1, force, duration, pace, before, after, &
                                  whole, last)
        else
            call c_carry_tangents(order, coupling, decay, pull, swing, c, 0, before, duration, pace, before, after, &
                                  whole, last)
        end if
    end subroutine carry_tangents

end module spintop_lane_tangents
