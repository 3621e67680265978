!> Makes the body of a scene, and checks its mass properties.
module spintop_body_of_scene
    use spintop_kinds, only: dp, is_equal, is_zero
    use spintop_body, only: body_t
    use spintop_shapes, only: dimensions_t, solid_t, shape_infos, build_shape, &
        shape_by_inertia
    use spintop_parameters, only: is_set
    use spintop_parts, only: sum_parts
    use spintop_principal_axes, only: clear_rounding, find_principal_axes, steiner
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t
    implicit none
    private
    public :: make_body, check_axes

    !> Tolerance of the triangle inequality in units of rounding, for inertias that satisfy it with equality.
    real(dp), parameter :: triangle_slack = 8 * epsilon(1.0_dp)
    !> Names for messages. They are constants, because threads make bodies: see `status_names`.
    character(*), parameter :: inertia_names(3) = 'top.inertia(' // ['1', '2', '3'] // ')'
    !> Keys that not every description of a body takes; first the others, then the dimensions of a shape.
    character(*), parameter :: keys(12) = [character(18) :: 'top.shape', 'top.mass', 'top.inertia', 'top.inertia_tensor', &
        'top.centre_of_mass', 'top.length', 'top.inertia_about', 'top.density', 'top.radius', 'top.inner_radius', &
        'top.thickness', 'top.rod_length']
    integer, parameter :: first_of_numbers = 3, density = 8, first_dimension = 9

contains

    !> Which of the `keys` are given.
    pure function given_keys(scene) result(are_given)
        type(scene_t), intent(in) :: scene
        logical :: are_given(size(keys))
        are_given = [scene%shape /= shape_by_inertia, is_set(scene%mass), any(is_set(scene%inertia)), &
                     any(is_set(scene%inertia_tensor)), any(is_set(scene%centre_of_mass)), is_set(scene%length), &
                     scene%inertia_about /= 'pivot', is_set([scene%density, scene%radius, scene%inner_radius, &
                                                             scene%thickness, scene%rod_length])]
    end function given_keys

    !> The body of a scene; problems of its description are reported.
    subroutine make_body(scene, body, problems)
        type(scene_t), intent(in) :: scene !! contents of the input
        type(body_t), intent(out) :: body !! mass properties about the fixed point; valid without errors in `problems`
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        logical :: are_given(size(keys))
        integer :: i

        body%gravity = scene%gravity
        body%damping = scene%damping
        if (scene%parts%any()) then
            are_given = given_keys(scene)
            do i = 1, size(keys)
                if (are_given(i)) call problems%add(trim(keys(i)), trim(keys(i)) // ' is not for a body of parts', &
                                                    'omit it, or the groups &part')
            end do
            call sum_parts(scene%parts, body%mass, body%centre_of_mass, body%inertia, body%products, problems)
            if (.not. problems%any()) call clear_rounding(body%inertia, body%products, body%centre_of_mass)
        else if (scene%shape == shape_by_inertia) then
            call read_inertia(scene, body, problems)
        else
            call read_shape(scene, body, problems)
        end if
        if (.not. problems%any()) call check_axes(body, body%damping, 'top.damping', 'the damping differs', problems)
    end subroutine make_body

    !> Mass properties that are given as numbers.
    subroutine read_inertia(scene, body, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(inout) :: body
        type(problems_t), intent(inout) :: problems
        logical :: are_given(size(keys))
        integer :: i

        are_given = given_keys(scene)
        do i = density, size(keys)
            if (are_given(i)) call problems%add(trim(keys(i)), trim(keys(i)) // ' is for a shape', &
                                                "omit it, or name a shape other than 'inertia'")
        end do
        if (.not. is_set(scene%mass)) call require('top.mass')
        if (any(is_set(scene%inertia_tensor))) then
            call read_tensor(scene, body, problems)
        else if (all(is_set(scene%inertia))) then
            body%inertia = scene%inertia
        else
            call require('top.inertia')
        end if
        if (all(is_set(scene%centre_of_mass)) .and. is_set(scene%length)) then
            call problems%add('top.length', 'the centre of mass is given twice', &
                              'give either centre_of_mass or length')
        else if (is_set(scene%length)) then
            body%centre_of_mass = [0.0_dp, 0.0_dp, scene%length]
        else if (all(is_set(scene%centre_of_mass))) then
            body%centre_of_mass = scene%centre_of_mass
        else
            call problems%add('top', 'the centre of mass is not given', &
                              'give length (along body z) or centre_of_mass(3)')
        end if
        if (problems%any()) return
        body%mass = scene%mass
        call refer_to_pivot(scene, body, problems)

    contains

        subroutine require(name)
            character(*), intent(in) :: name
            call problems%add('top', name // ' is not given', &
                              'it has no default; or name a shape')
        end subroutine require

    end subroutine read_inertia

    !> The inertia tensor of a scene: the elements on and above the diagonal, or their mirror images.
    subroutine read_tensor(scene, body, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(inout) :: body
        type(problems_t), intent(inout) :: problems
        !> Difference of two mirrored elements that counts as rounding of their digits, relative to the largest element.
        real(dp), parameter :: unequal = 1.0e-9_dp
        integer :: i, j

        if (any(is_set(scene%inertia))) then
            call problems%add('top.inertia_tensor', 'the inertia is given twice', 'give either inertia or inertia_tensor')
            return
        end if
        associate (given => scene%inertia_tensor, mirrored => transpose(scene%inertia_tensor))
            if (.not. all(is_set(given) .or. is_set(mirrored))) then
                call problems%add('top.inertia_tensor', 'the inertia tensor is not complete', &
                                  'give its diagonal and the elements above it')
            else if (any(is_set(given) .and. is_set(mirrored) .and. &
                         abs(given - mirrored) > unequal * maxval(abs(given), is_set(given)))) then
                call problems%add('top.inertia_tensor', 'the inertia tensor is not symmetric', &
                                  'omit the elements below its diagonal')
            else
                do i = 1, 3
                    body%inertia(i) = given(i, i)
                    j = mod(i, 3) + 1
                    body%products(i) = merge(given(min(j, 6 - i - j), max(j, 6 - i - j)), &
                                             given(max(j, 6 - i - j), min(j, 6 - i - j)), &
                                             is_set(given(min(j, 6 - i - j), max(j, 6 - i - j))))
                end do
            end if
        end associate
    end subroutine read_tensor

    !> Checks an inertia that is given as numbers, and refers it to the pivot.
    subroutine refer_to_pivot(scene, body, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(inout) :: body
        type(problems_t), intent(inout) :: problems
        real(dp) :: shift(3), shift_products(3), moments(3), central(3), axes(4)
        character(18) :: name
        logical :: is_tensor

        is_tensor = any(is_set(scene%inertia_tensor))
        moments = body%inertia
        if (is_tensor) call find_principal_axes(body%inertia, body%products, moments, axes)
        if (breaks_triangle(moments) .or. minval(moments) < -triangle_slack * maxval(moments)) then
            name = inertia_names(maxloc(moments, dim=1))
            if (is_tensor) name = 'top.inertia_tensor'
            call problems%add(trim(name), &
                'no body has these moments of inertia: the largest exceeds the sum of the others', &
                'each moment is at most the sum of the other two')
            return
        end if
        call steiner(body%mass, body%centre_of_mass, shift, shift_products)
        if (scene%inertia_about == 'centre_of_mass') then
            body%inertia = body%inertia + shift
            body%products = body%products + shift_products
        else
            central = moments - shift
            if (is_tensor) call find_principal_axes(body%inertia - shift, body%products - shift_products, central, axes)
            if (any(central < -triangle_slack * moments) .or. breaks_triangle(central)) then
                call problems%warn('top.inertia', 'no mass distribution has this inertia about the pivot &
                    &with its centre of mass there (is the term m l^2 missing?)', &
                    "computed as given; inertia_about = 'centre_of_mass' adds that term")
            end if
        end if
        if (is_tensor) call clear_rounding(body%inertia, body%products, body%centre_of_mass)
    end subroutine refer_to_pivot

    !> Coefficients about axes that are not principal axes must not distinguish them.
    subroutine check_axes(body, coefficients, name, what_differs, problems)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: coefficients(3) !! about body x, y, z
        character(*), intent(in) :: name, what_differs !! the parameter, and what is wrong, such as 'the damping differs'
        type(problems_t), intent(inout) :: problems !! a problem is added if they differ
        logical :: differ(3)
        differ = .not. is_equal(cshift(coefficients, 1), cshift(coefficients, 2))
        if (any(differ .and. .not. is_zero(body%products))) then
            call problems%add(name, what_differs // ' about axes that are not principal axes of inertia', &
                              'give equal coefficients about these axes')
        end if
    end subroutine check_axes

    !> Mass properties of a shape.
    subroutine read_shape(scene, body, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(inout) :: body
        type(problems_t), intent(inout) :: problems
        type(solid_t) :: solid
        real(dp) :: shift(3), no_products(3)
        logical :: are_given(size(keys)), are_needed(size(keys))
        integer :: i

        are_given = given_keys(scene)
        are_needed = .false.
        do i = 1, size(shape_infos)
            if (shape_infos(i)%name == scene%shape) are_needed(first_dimension:) = [.true., shape_infos(i)%needs_inner_radius, &
                shape_infos(i)%needs_thickness, shape_infos(i)%needs_rod_length]
        end do
        do i = first_dimension, size(keys)
            call check(i)
        end do
        do i = first_of_numbers, density - 1
            call check(i)
        end do
        if (is_set(scene%mass) .and. is_set(scene%density)) then
            call problems%add('top.density', 'mass and density are both given', 'give one of them')
        else if (.not. is_set(scene%mass) .and. .not. is_set(scene%density)) then
            call problems%add('top', 'neither mass nor density is given', 'give one of them')
        end if
        if (is_set(scene%inner_radius) .and. is_set(scene%radius) &
            .and. scene%inner_radius >= scene%radius) then
            call problems%add('top.inner_radius', 'the inner radius is not smaller than the radius', &
                              'the radius of the hole is smaller than that of the ring')
        end if
        if (problems%any()) return

        solid = build_shape(scene%shape, dimensions_t(scene%radius, scene%inner_radius, &
                                                      scene%thickness, scene%rod_length))
        body%mass = scene%mass
        if (is_set(scene%density)) body%mass = scene%density * solid%volume
        body%centre_of_mass = [0.0_dp, 0.0_dp, solid%length]
        call steiner(body%mass, body%centre_of_mass, shift, no_products)
        body%inertia = body%mass * [solid%across, solid%across, solid%along] + shift
        if (is_zero(body%mass)) then
            call problems%add('top.thickness', 'the body has no volume', 'give its mass, not its density')
        end if

    contains

        !> Checks that a key is given if and only if the shape needs it.
        subroutine check(key)
            integer, intent(in) :: key
            if (are_needed(key) .and. .not. are_given(key)) then
                call problems%add('top', trim(keys(key)) // ' is not given', &
                                  'shape ' // trim(scene%shape) // ' needs it')
            else if (are_given(key) .and. .not. are_needed(key)) then
                call problems%add(trim(keys(key)), trim(keys(key)) // ' is not for shape ' // trim(scene%shape), 'omit it')
            end if
        end subroutine check

    end subroutine read_shape

    !> Whether the largest moment exceeds the sum of the others by more than rounding errors.
    pure logical function breaks_triangle(inertia)
        real(dp), intent(in) :: inertia(3)
        breaks_triangle = 2 * maxval(inertia) > sum(inertia) * (1 + triangle_slack)
    end function breaks_triangle

end module spintop_body_of_scene
