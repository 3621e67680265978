!> Bodies of common shapes: mass properties from dimensions and density.
!>
!> Every part is a homogeneous solid of revolution. Its row in `part_infos` lists its dimensions; its formula is in
!> `build_part`. Every shape is one such part about body z, on a massless support. Its row in `shape_infos` lists the
!> part and the dimensions it needs; `build_shape` says where the part is.
module spintop_shapes
    use spintop_kinds, only: dp, pi
    implicit none
    private
    public :: shape_info_t, dimensions_t, solid_t, shape_infos, build_shape, shape_by_inertia
    public :: part_info_t, part_infos, build_part

    !> Dimensions that shapes are made of.
    type :: dimensions_t
        !> Outer and inner radius, m.
        real(dp) :: radius = 0, inner_radius = 0
        !> Extent along the axis, m.
        real(dp) :: thickness = 0
        !> From the pivot to the centre of the solid, m.
        real(dp) :: rod_length = 0
    end type dimensions_t

    !> Properties of a shape.
    type :: solid_t
        !> Volume, m^3.
        real(dp) :: volume = 0
        !> From the pivot, or from the place of a part, to the centre of mass along the axis, m.
        real(dp) :: length = 0
        !> Moments of inertia about the centre of mass, divided by the mass, m^2: across, along z.
        real(dp) :: across = 0, along = 0
    end type solid_t

    !> Registry entry of a shape.
    type :: shape_info_t
        character(16) :: name
        character(96) :: what
        !> Its part.
        character(16) :: part
        !> Which dimensions it needs besides the radius.
        logical :: needs_inner_radius, needs_thickness, needs_rod_length
    end type shape_info_t

    !> Registry entry of a part of a body.
    type :: part_info_t
        character(16) :: name
        character(96) :: what
        !> Which of the dimensions radius, inner radius and thickness it needs, and which it takes; those that are not
        !> given are zero.
        logical :: needs(3), takes(3)
    end type part_info_t

    !> All parts.
    type(part_info_t), parameter :: part_infos(*) = [ &
        part_info_t('disc', 'disc or ring about its centre', [.true., .false., .false.], [.true., .true., .true.]), &
        part_info_t('rod', 'rod about its centre; thickness is its length', &
                    [.false., .false., .true.], [.true., .false., .true.]), &
        part_info_t('cylinder', 'cylinder or tube about its centre; thickness is its height', &
                    [.true., .false., .true.], [.true., .true., .true.]), &
        part_info_t('cone', 'cone that opens along its axis from its apex; thickness is its height', &
                    [.true., .false., .true.], [.true., .false., .true.]), &
        part_info_t('sphere', 'ball or hollow ball about its centre', [.true., .false., .false.], [.true., .true., .false.]), &
        part_info_t('torus', 'torus about its centre; its hole has the inner radius', &
                    [.true., .true., .false.], [.true., .true., .false.]), &
        part_info_t('point_mass', 'mass without extent', [.false., .false., .false.], [.false., .false., .false.])]

    !> Name of the shape that is given by its mass properties.
    character(*), parameter :: shape_by_inertia = 'inertia'

    !> All shapes with a formula.
    type(shape_info_t), parameter :: shape_infos(*) = [ &
        shape_info_t('spinning_wheel', 'disc at the end of a massless rod (the paper, Example 2)', &
                     'disc', .false., .true., .true.), &
        shape_info_t('ring', 'flat ring (gyroscope rotor) at the end of a massless rod', &
                     'disc', .true., .true., .true.), &
        shape_info_t('sphere', 'ball at the end of a massless rod', 'sphere', .false., .false., .true.), &
        shape_info_t('cylinder', 'cylinder standing on the centre of its base', &
                     'cylinder', .false., .true., .false.), &
        shape_info_t('cone', 'cone standing on its apex; thickness is its height', &
                     'cone', .false., .true., .false.)]

contains

    !> Volume, length and radii of inertia of a shape.
    pure type(solid_t) function build_shape(name, size) result(solid)
        character(*), intent(in) :: name !! name of the shape
        type(dimensions_t), intent(in) :: size !! dimensions of the shape
        type(dimensions_t) :: taken
        integer :: i
        i = findloc(shape_infos%name, name, dim=1)
        if (i == 0) return
        taken = size
        if (.not. shape_infos(i)%needs_inner_radius) taken%inner_radius = 0
        solid = build_part(trim(shape_infos(i)%part), taken)
        if (shape_infos(i)%needs_rod_length) solid%length = size%rod_length
        if (name == 'cylinder') solid%length = size%thickness / 2
    end function build_shape

    !> Volume, length and radii of inertia of a part; zeros for an unknown one and for a point mass.
    pure type(solid_t) function build_part(name, size) result(solid)
        character(*), intent(in) :: name !! name of the part
        type(dimensions_t), intent(in) :: size !! its dimensions
        real(dp) :: middle, tube
        associate (r => size%radius, s => size%inner_radius, h => size%thickness)
            select case (name)
            case ('disc', 'rod', 'cylinder')
                solid%volume = pi * (r - s) * (r + s) * h
                solid%across = (3 * (r**2 + s**2) + h**2) / 12
                solid%along = (r**2 + s**2) / 2
            case ('sphere')
                solid%volume = 4 * pi * (r**3 - s**3) / 3
                ! 2 (r^5 - s^5)/(5 (r^3 - s^3)), also for a thin shell.
                solid%along = r**2
                if (s > 0) solid%along = solid%along + s**3 * (r + s) / (r**2 + r * s + s**2)
                solid%along = 2 * solid%along / 5
                solid%across = solid%along
            case ('cone')
                solid = solid_t(pi * r**2 * h / 3, 3 * h / 4, 3 * (4 * r**2 + h**2) / 80, 3 * r**2 / 10)
            case ('torus')
                middle = (r + s) / 2
                tube = (r - s) / 2
                solid = solid_t(2 * pi**2 * middle * tube**2, 0.0_dp, middle**2 / 2 + 5 * tube**2 / 8, &
                                middle**2 + 3 * tube**2 / 4)
            case default
                solid = solid_t()
            end select
        end associate
    end function build_part

end module spintop_shapes
