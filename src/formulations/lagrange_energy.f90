!> Lagrange's equations with the energy restored after every step (the paper's scenario 2).
module spintop_lagrange_energy
    use spintop_kinds, only: dp
    use spintop_formulation, only: formulation_info_t, max_states
    use spintop_lagrange, only: lagrange_t
    implicit none
    private
    public :: lagrange_energy_t

    !> The state of `lagrange_t`; after a step theta is kept and theta' taken from the energy.
    type, extends(lagrange_t) :: lagrange_energy_t
    contains
        procedure, nopass :: info
        procedure :: after_step
    end type lagrange_energy_t

contains

    !> Name and properties.
    pure function info()
        type(formulation_info_t) :: info
        info = formulation_info_t('lagrange_energy', &
            "lagrange, with theta' reset from the energy after each step (Eq 46, scenario 2)", 4, &
            resets_speed=.true.)
    end function info

    !> theta' = sign(theta') sqrt(max(0, radicand of Eq 46)); a negative radicand is clipped.
    pure subroutine after_step(self, y, changed, clipped)
        class(lagrange_energy_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states)
        logical, intent(out) :: changed, clipped
        real(dp) :: radicand
        radicand = self%top%speed_budget(y(2))
        y(3) = sign(sqrt(max(0.0_dp, radicand)), y(3))
        changed = .true.
        clipped = radicand < 0
    end subroutine after_step

end module spintop_lagrange_energy
