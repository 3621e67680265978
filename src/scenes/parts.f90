!> The parts of a composed body: the groups &part of an input, and their sum.
module spintop_parts
    use spintop_kinds, only: dp, is_zero
    use spintop_parameters, only: given, is_set, one_per_group, parameter_table_t, unset
    use spintop_principal_axes, only: steiner
    use spintop_problems, only: problems_t
    use spintop_shapes, only: build_part, dimensions_t, part_info_t, part_infos, solid_t
    use spintop_text, only: join
    implicit none
    private
    public :: parts_t, describe_parts, sum_parts, max_parts

    !> Maximum number of parts of a body.
    integer, parameter :: max_parts = 32

    !> The groups &part, one element or row each.
    type :: parts_t
        character(16) :: shape(max_parts) = ''
        real(dp), dimension(max_parts) :: mass = unset, density = unset, radius = unset, inner_radius = unset, thickness = unset
        real(dp), dimension(max_parts, 3) :: place = unset, axis = unset
    contains
        procedure :: any => has_any
    end type parts_t

    !> Names for messages. They are constants, because threads make bodies: see `status_names`.
    character(*), parameter :: numbers(max_parts) = [character(4) :: '(1)', '(2)', '(3)', '(4)', '(5)', '(6)', '(7)', &
        '(8)', '(9)', '(10)', '(11)', '(12)', '(13)', '(14)', '(15)', '(16)', '(17)', '(18)', '(19)', '(20)', '(21)', &
        '(22)', '(23)', '(24)', '(25)', '(26)', '(27)', '(28)', '(29)', '(30)', '(31)', '(32)']
    character(*), parameter :: dimension_names(3) = [character(17) :: 'part.radius', 'part.inner_radius', 'part.thickness']

contains

    !> Adds the keys of the groups &part.
    subroutine describe_parts(parts, table)
        type(parts_t), target, intent(inout) :: parts !! its components are bound; it must exist as long as the table
        type(parameter_table_t), intent(inout) :: table !! the parameters of an input
        call table%add('part.shape', parts%shape, join(part_infos%name, '|'), &
                       'shape of a part of the body; one group for each part', elements=one_per_group)
        call table%add('part.mass', parts%mass, 'kg', '> 0', 'mass of the part', elements=one_per_group)
        call table%add('part.density', parts%density, 'kg/m^3', '> 0', 'density of the part, or give its mass', &
                       elements=one_per_group)
        call table%add('part.radius', parts%radius, 'm', '> 0', 'outer radius of the part', elements=one_per_group)
        call table%add('part.inner_radius', parts%inner_radius, 'm', '>= 0', 'radius of the hole in the part', &
                       elements=one_per_group)
        call table%add('part.thickness', parts%thickness, 'm', '>= 0', 'extent of the part along its axis', elements=one_per_group)
        call table%add('part.place', parts%place, 'm', '', &
                       'centre of the part (cone: apex) from the pivot in body axes (0, 0, 0)', elements=one_per_group)
        call table%add('part.axis', parts%axis, '', '', 'direction of the axis of the part in body axes, of any length (0, 0, 1)', &
                       elements=one_per_group)
    end subroutine describe_parts

    !> Whether there are parts.
    pure logical function has_any(self)
        class(parts_t), intent(in) :: self
        integer :: i
        has_any = any([(is_used(self, i), i=1, max_parts)])
    end function has_any

    !> Mass, centre of mass and inertia tensor about the pivot of all parts; problems of their description are reported.
    subroutine sum_parts(parts, mass, centre, inertia, products, problems)
        type(parts_t), intent(in) :: parts !! the parts
        real(dp), intent(out) :: mass, centre(3), inertia(3), products(3)
            !! kg; m; diagonal and products of the tensor, kg m^2
        type(problems_t), intent(inout) :: problems !! problems of the parts are added
        type(solid_t) :: solid
        real(dp) :: own_mass, place(3), axis(3), moments(3), others(3)
        integer :: i

        mass = 0
        centre = 0
        inertia = 0
        products = 0
        do i = 1, max_parts
            if (.not. is_used(parts, i)) cycle
            call read_part(parts, i, solid, own_mass, place, axis, problems)
            if (problems%any()) cycle
            place = place + solid%length * axis
            mass = mass + own_mass
            centre = centre + own_mass * place
            call steiner(own_mass, place, moments, others)
            inertia = inertia + (moments + own_mass * (solid%across + (solid%along - solid%across) * axis**2))
            products = products + (others + own_mass * (solid%along - solid%across) * cshift(axis, 1) * cshift(axis, 2))
        end do
        if (problems%any()) return
        centre = centre / mass
        if (any(is_set(parts%place)) .or. any(abs(centre) > 0)) return
        call problems%warn('part', 'no part has a place: the centre of mass is at the pivot, and its weight has no moment', &
                           'give place, as place = 0, 0, 0 for this')
    end subroutine sum_parts

    !> Whether anything of a part is given.
    pure logical function is_used(parts, i)
        type(parts_t), intent(in) :: parts
        integer, intent(in) :: i
        is_used = parts%shape(i) /= '' .or. maxval([parts%mass(i), parts%density(i), parts%radius(i), parts%inner_radius(i), &
                                                   parts%thickness(i), parts%place(i, :), parts%axis(i, :)]) > unset
    end function is_used

    !> One part, whose dimensions must be those of its shape: its solid, mass, place and unit vector of its axis.
    subroutine read_part(parts, i, solid, mass, place, axis, problems)
        type(parts_t), intent(in) :: parts
        integer, intent(in) :: i
        type(solid_t), intent(out) :: solid
        real(dp), intent(out) :: mass, place(3), axis(3)
        type(problems_t), intent(inout) :: problems
        type(part_info_t) :: info
        real(dp) :: sizes(3)
        character(24) :: key
        integer :: k

        sizes = [parts%radius(i), parts%inner_radius(i), parts%thickness(i)]
        if (.not. any(part_infos%name == parts%shape(i))) then
            call problems%add('part', 'part.shape' // trim(numbers(i)) // ' is not given', &
                              'each group &part names the shape of one part')
            return
        end if
        info = part_infos(findloc(part_infos%name, parts%shape(i), dim=1))
        do k = 1, size(sizes)
            key = trim(dimension_names(k)) // numbers(i)
            if (info%needs(k) .and. .not. is_set(sizes(k))) then
                call problems%add('part.shape' // trim(numbers(i)), trim(key) // ' is not given', &
                                  'part ' // trim(info%name) // ' needs it')
            else if (is_set(sizes(k)) .and. .not. info%takes(k)) then
                call problems%add(trim(key), trim(key) // ' is not for a ' // trim(info%name), 'omit it')
            end if
        end do
        if (is_set(sizes(2)) .and. is_set(sizes(1)) .and. sizes(2) >= sizes(1)) then
            call problems%add('part.inner_radius' // trim(numbers(i)), 'the inner radius is not smaller than the radius', &
                              'the radius of the hole is smaller than that of the part')
        end if
        if (is_set(parts%mass(i)) .and. is_set(parts%density(i))) then
            call problems%add('part.density' // trim(numbers(i)), 'mass and density of the part are both given', 'give one of them')
        else if (.not. (is_set(parts%mass(i)) .or. is_set(parts%density(i)))) then
            call problems%add('part.shape' // trim(numbers(i)), 'neither mass nor density of the part is given', &
                              'give one of them')
        end if
        place = given(parts%place(i, :))
        axis = [0, 0, 1]
        if (any(is_set(parts%axis(i, :)))) axis = given(parts%axis(i, :))
        if (all(is_zero(axis))) then
            call problems%add('part.axis(' // numbers(i) (2:index(numbers(i), ')') - 1) // ',1)', &
                              'the axis of a part has no direction', 'give a vector that is not zero')
            axis = [0, 0, 1]
        end if
        axis = axis / norm2(axis)
        sizes = max(sizes, 0.0_dp)
        solid = build_part(info%name, dimensions_t(radius=sizes(1), inner_radius=sizes(2), thickness=sizes(3)))
        mass = parts%mass(i)
        if (is_set(parts%density(i))) mass = parts%density(i) * solid%volume
        if (is_zero(mass)) then
            call problems%add('part.density' // trim(numbers(i)), 'the part has no volume', 'give its mass, not its density')
        end if
    end subroutine read_part

end module spintop_parts
