!> Stability of relative equilibria: a top at rest, sleeping or in steady precession, and a body in permanent
!> rotation about the vertical (Staude, J. reine angew. Math. 113, 1894) or about a principal axis.
!>
!> In axes that follow the body, except for its rotation about a symmetry axis, vertical and momentum are
!> constant. The eigenvalues are those of the Euler-Poisson equations, linearised in these axes.
module spintop_relative_equilibrium
    use spintop_kinds, only: dp, is_finite, skew
    use spintop_body, only: body_t
    use spintop_euler_poisson, only: euler_poisson_state, euler_poisson_rate, euler_poisson_matrix, &
        invariant_gradients, turning_about, state_units
    use spintop_motion, only: motion_t
    use spintop_spectrum, only: find_spectrum
    use spintop_status, only: is_ok, status_non_finite, status_ok, status_unsuitable
    use spintop_validity, only: plain_body_status, motion_status
    implicit none
    private
    public :: find_equilibrium_eigenvalues

    !> Tolerance of the equilibrium, relative to the terms that balance each other; ten digits suffice.
    real(dp), parameter :: slack = 1.0e-10_dp

contains

    !> Eigenvalues of the motion linearised about a relative equilibrium, 1/s. The largest real part is the
    !> growth rate of perturbations. Eigenvalues that belong to invariants and symmetries are zero and come
    !> last. `status_unsuitable`: the motion is not a relative equilibrium; `status_non_finite`,
    !> `status_bad_body`, `status_bad_start`: body or motion is not valid.
    subroutine find_equilibrium_eigenvalues(body, motion, eigenvalues, status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! any instant of the motion
        complex(dp), intent(out) :: eigenvalues(6) !! 1/s
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: x(6), unit(6), axis(3), spin, matrix(6, 6), forms(6, 4), directions(6, 1)

        eigenvalues = 0
        status = plain_body_status(body)
        if (is_ok(status)) status = motion_status(motion, body)
        if (.not. is_ok(status)) return
        x = euler_poisson_state(body, motion)
        ! Without weight any direction may be the vertical; that of the momentum is constant.
        if (.not. norm2(body%weight_moment()) > 0 .and. norm2(x(4:6)) > 0) x(1:3) = x(4:6) / norm2(x(4:6))
        unit = state_units(body, x)
        axis = body%symmetry_axis()
        call find_spin(body, x, unit, axis, spin, status)
        if (.not. is_ok(status)) return

        matrix = euler_poisson_matrix(body, x)
        matrix(1:3, 1:3) = matrix(1:3, 1:3) + spin * skew(axis)
        matrix(4:6, 4:6) = matrix(4:6, 4:6) + spin * skew(axis)
        forms = invariant_gradients(body, x)
        directions(:, 1) = turning_about(axis, x)
        call find_spectrum(matrix, unit, 0.0_dp, forms, directions, eigenvalues, status)
    end subroutine find_equilibrium_eigenvalues

    !> The rate of the rotation about the symmetry axis that leaves the state unchanged, rad/s.
    pure subroutine find_spin(body, x, unit, axis, spin, status)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: x(6), unit(6), axis(3)
        real(dp), intent(out) :: spin
        integer, intent(out) :: status
        real(dp) :: rate(6), turning(6), terms

        rate = euler_poisson_rate(body, x) / unit
        turning = turning_about(axis, x) / unit
        associate (omega => x(4:6) / body%inertia)
            if (norm2(turning) > slack) then
                spin = -dot_product(rate, turning) / dot_product(turning, turning)
            else
                ! Upright or hanging: of all such rotations, the one for which the axes are at rest in space.
                spin = dot_product(axis, omega)
            end if
            terms = norm2(omega) + (norm2(body%weight_moment()) + norm2(body%damping * omega)) / unit(6)
        end associate
        status = status_ok
        if (norm2(rate + spin * turning) > slack * terms) status = status_unsuitable
        if (.not. all(is_finite([rate, spin, terms]))) status = status_non_finite
    end subroutine find_spin

end module spintop_relative_equilibrium
