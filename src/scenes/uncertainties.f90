!> Radii of the data of a scene: proved bounds hold for every top within them.
module spintop_uncertainties
    use spintop_certificate, only: radius_count
    use spintop_kinds, only: degree, dp
    use spintop_parameters, only: given, is_set
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t
    implicit none
    private
    public :: data_radii, has_radii, check_uncertainties

contains

    !> Radii of the moments of inertia, m, g, phi, theta, psi and their rates, or omega3 in place of psi'; omega, quaternion,
    !> centre of mass, damping, products of inertia: the order of the data in spintop_certificate. 0 where none is given. A
    !> length is that of the centre of mass on body z.
    pure function data_radii(scene) result(radii)
        type(scene_t), intent(in) :: scene !! contents of the input
        real(dp) :: radii(radius_count)
        real(dp) :: angle(3), tensor(3, 3)
        integer :: i
        tensor = given(scene%uncertainty%inertia_tensor)
        tensor = max(tensor, transpose(tensor))
        angle = given(scene%uncertainty%angle)
        ! Rounded up, as the product may be rounded down.
        where (is_set(scene%uncertainty%angle_deg)) angle = scene%uncertainty%angle_deg * degree * (1 + 4 * epsilon(degree))
        associate (of => scene%uncertainty)
            radii = [(max(given(of%inertia(i)), tensor(i, i)), i=1, 3), given(of%mass), given(of%gravity), angle, &
                     given(of%rate(1:2)), max(given(of%rate(3)), given(of%omega3)), given(of%omega), spread(0.0_dp, 1, 4), &
                     given(of%centre_of_mass(1:2)), max(given(of%centre_of_mass(3)), given(of%length)), given(of%damping), &
                     tensor(2, 3), tensor(3, 1), tensor(1, 2)]
        end associate
    end function data_radii

    !> Whether the input gives radii.
    pure logical function has_radii(scene)
        type(scene_t), intent(in) :: scene !! contents of the input
        has_radii = any(is_set([scene%uncertainty%mass, scene%uncertainty%gravity, scene%uncertainty%length, &
                                scene%uncertainty%inertia, scene%uncertainty%angle, scene%uncertainty%angle_deg, &
                                scene%uncertainty%rate, scene%uncertainty%omega3, scene%uncertainty%omega, &
                                scene%uncertainty%centre_of_mass, scene%uncertainty%damping, &
                                scene%uncertainty%inertia_tensor]))
    end function has_radii

    !> Reports radii of numbers that are not data of this input, and radii that nothing uses.
    subroutine check_uncertainties(scene, has_bounds, problems)
        type(scene_t), intent(in) :: scene !! contents of the input
        logical, intent(in) :: has_bounds !! whether the table has bounds
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        character(*), parameter :: names(3) = [character(5) :: 'phi', 'theta', 'psi']
        integer :: i

        if (.not. has_radii(scene)) return
        if (scene%certified) call problems%add('uncertainty', 'uncertain data have no certified digits', &
                                               'omit the radii or output.certified')
        if (.not. (has_bounds .or. scene%certified)) call problems%add('uncertainty', 'the table has no bounds that the &
            &radii could widen', 'add columns such as theta_bound')
        if (scene%shape /= 'inertia') then
            if (any(is_set([scene%uncertainty%mass, scene%uncertainty%inertia, scene%uncertainty%length, &
                            scene%uncertainty%centre_of_mass, scene%uncertainty%inertia_tensor]))) then
                call problems%add('uncertainty', 'the radii of mass, inertia, length and centre of mass &
                                  &belong to shape = ''inertia''', &
                                  'give the body by its mass properties')
            end if
        end if
        call need(scene%uncertainty%mass, scene%mass, 'top.mass')
        call need(maxval(scene%uncertainty%inertia), minval(scene%inertia), 'top.inertia')
        call need(maxval(scene%uncertainty%inertia_tensor), maxval(scene%inertia_tensor), 'top.inertia_tensor')
        call need(scene%uncertainty%length, scene%length, 'top.length')
        call need(scene%uncertainty%omega3, scene%omega3, 'initial.omega3')
        do i = 1, 3
            call need(scene%uncertainty%omega(i), scene%omega(i), 'initial.omega')
            call need(scene%uncertainty%centre_of_mass(i), scene%centre_of_mass(i), 'top.centre_of_mass')
            ! An angle that is not given is 0.
            if (is_set(scene%uncertainty%angle(i)) .and. is_set(scene%uncertainty%angle_deg(i))) then
                call problems%add('uncertainty', 'the radius of ' // trim(names(i)) // ' is given twice', &
                                  'give it either in radians or in degrees')
            end if
        end do
        if (all(is_set(scene%quaternion)) .and. any(is_set([scene%uncertainty%angle, scene%uncertainty%angle_deg]))) then
            call problems%add('uncertainty.initial', 'the attitude is given by a quaternion, not by angles', &
                              'give the angles, or omit their radii')
        end if
        if (all(is_set(scene%omega)) .and. any(is_set(scene%uncertainty%rate))) then
            call problems%add('uncertainty.initial', 'the angular velocity is given by omega, not by rates', &
                              'give the rates, or omit their radii')
        end if
        if (is_set(scene%uncertainty%rate(3)) .and. (is_set(scene%omega3) .or. is_set(scene%spin_ratio))) then
            call problems%add('uncertainty.initial.psi_rate', 'the spin is not given by psi_rate', &
                              'give the radius of what is given')
        end if
        if (scene%inertia_about /= 'pivot' .and. &
            any(is_set([scene%uncertainty%inertia, scene%uncertainty%inertia_tensor]))) then
            call problems%add('uncertainty.top', 'the moments of inertia are not those about the pivot', &
                              'give them about the pivot')
        end if

    contains

        !> A radius is that of a number that the input gives.
        subroutine need(radius, number, name)
            real(dp), intent(in) :: radius, number
            character(*), intent(in) :: name
            if (is_set(radius) .and. .not. is_set(number)) then
                call problems%add('uncertainty.' // name, name // ' is not given', 'give the radius of what is given')
            end if
        end subroutine need

    end subroutine check_uncertainties

end module spintop_uncertainties
