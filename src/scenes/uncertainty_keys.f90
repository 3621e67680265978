!> The group &uncertainty of an input as plain data, with its rows of the parameter table: radii of other keys. Bounds hold
!> for all data within them.
module spintop_uncertainty_keys
    use spintop_kinds, only: dp
    use spintop_parameters, only: parameter_table_t, unset
    implicit none
    private
    public :: uncertainty_scene_t, describe_uncertainty

    !> The contents of the group, in the units of the keys; nothing has a value unless the input gives it.
    type :: uncertainty_scene_t
        real(dp) :: mass = unset
        real(dp) :: gravity = unset
        real(dp) :: length = unset
        real(dp) :: inertia(3) = unset
        real(dp) :: centre_of_mass(3) = unset
        real(dp) :: damping(3) = unset
        real(dp) :: angle(3) = unset
        real(dp) :: angle_deg(3) = unset
        real(dp) :: rate(3) = unset
        real(dp) :: omega3 = unset
        real(dp) :: omega(3) = unset
    end type uncertainty_scene_t

contains

    !> Adds the keys to the table of an input.
    subroutine describe_uncertainty(scene, table)
        type(uncertainty_scene_t), target, intent(inout) :: scene !! the group; it must exist as long as the table
        type(parameter_table_t), intent(inout) :: table !! the keys are added
        character(*), parameter :: top = 'uncertainty.top.', initial = 'uncertainty.initial.', range = '>= 0'
        character(*), parameter :: angles(3) = [character(5) :: 'phi', 'theta', 'psi']
        integer :: i

        call table%add(top // 'mass', scene%mass, 'kg', range, 'radius of the mass')
        call table%add(top // 'gravity', scene%gravity, 'm/s^2', range, 'radius of gravity')
        call table%add(top // 'length', scene%length, 'm', range, 'radius of the length')
        call table%add(top // 'inertia', scene%inertia, 'kg m^2', range, 'radii of the moments of inertia')
        call table%add(top // 'centre_of_mass', scene%centre_of_mass, 'm', range, 'radii of the centre of mass')
        call table%add(top // 'damping', scene%damping, 'N m s', range, 'radii of the damping coefficients')
        do i = 1, 3
            call table%add(initial // trim(angles(i)), scene%angle(i), 'rad', range, 'radius of that angle')
        end do
        do i = 1, 3
            call table%add(initial // trim(angles(i)) // '_deg', scene%angle_deg(i), 'deg', range, 'radius of that angle')
        end do
        do i = 1, 3
            call table%add(initial // trim(angles(i)) // '_rate', scene%rate(i), 'rad/s', range, 'radius of that rate')
        end do
        call table%add(initial // 'omega3', scene%omega3, 'rad/s', range, 'radius of omega3')
        call table%add(initial // 'omega', scene%omega, 'rad/s', range, 'radii of omega')
    end subroutine describe_uncertainty

end module spintop_uncertainty_keys
