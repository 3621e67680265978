!> Lagrange's equations with theta' reset from the energy after each step (scenario 2 of the paper).
module spintop_lagrange_energy
    use spintop_formulation, only: formulation_info_t
    use spintop_lagrange, only: lagrange_t
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

contains

    !> The formulation with its reset.
    function new_lagrange_energy() result(new)
        type(lagrange_energy_t) :: new
        allocate (new%reset)
    end function new_lagrange_energy

    !> Name and properties.
    pure function describe() result(info)
        type(formulation_info_t) :: info
        info = formulation_info_t('lagrange_energy', &
            "lagrange, with theta' reset from the energy after each step (Eq 46, scenario 2)", 4)
    end function describe

end module spintop_lagrange_energy
