!> Lagrange's equations with theta' reset from the energy after each step (scenario 2 of the paper).
module spintop_lagrange_energy
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_states, reset_t
    use spintop_formulation, only: formulation_info_t
    use spintop_lagrange, only: lagrange_t
    use spintop_motion, only: motion_t
    use spintop_symmetric_top, only: symmetric_top_t
    implicit none
    private
    public :: lagrange_energy_t

    !> The state of `lagrange_t`. After a step theta is kept, and theta' is computed from the energy.
    type, extends(lagrange_t) :: lagrange_energy_t
    contains
        procedure, nopass :: describe
    end type lagrange_energy_t

    interface lagrange_energy_t
        module procedure new_lagrange_energy
    end interface lagrange_energy_t

    !> theta' = sign(theta') sqrt(max(0, radicand of Eq 46)).
    type, extends(reset_t) :: energy_reset_t
        private
        type(symmetric_top_t) :: top = symmetric_top_t()
    contains
        procedure :: set
        procedure :: apply
    end type energy_reset_t

contains

    !> The formulation with its reset.
    function new_lagrange_energy() result(new)
        type(lagrange_energy_t) :: new
        allocate (energy_reset_t :: new%reset)
    end function new_lagrange_energy

    !> Name and properties.
    pure function describe() result(info)
        type(formulation_info_t) :: info
        info = formulation_info_t('lagrange_energy', &
            "lagrange, with theta' reset from the energy after each step (Eq 46, scenario 2)", 4)
    end function describe

    !> Constants of the motion.
    pure subroutine set(self, body, start)
        class(energy_reset_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        call self%top%set(body, start)
    end subroutine set

    !> A negative radicand is clipped. A theta' that has this energy to rounding stays: near a turning point
    !> the root knows it to half of the digits only.
    pure subroutine apply(self, y, clipped)
        class(energy_reset_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states)
        logical, intent(out) :: clipped
        real(dp) :: radicand
        radicand = self%top%speed_budget(y(2))
        clipped = .false.
        if (abs(radicand - y(3)**2) <= self%top%budget_rounding(y(2))) return
        y(3) = sign(sqrt(max(0.0_dp, radicand)), y(3))
        clipped = radicand < 0
    end subroutine apply

end module spintop_lagrange_energy
