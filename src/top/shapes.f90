!> Bodies of common shapes: mass properties from dimensions and density.
!>
!> Every shape is a homogeneous solid of revolution about body z, on a massless support. Its row in
!> `shape_infos` lists the dimensions it needs; its formula is in `build_shape`.
module spintop_shapes
    use spintop_kinds, only: dp, pi
    implicit none
    private
    public :: shape_info_t, dimensions_t, solid_t, shape_infos, build_shape, shape_by_inertia

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
        !> From the pivot to the centre of mass along body z, m.
        real(dp) :: length = 0
        !> Moments of inertia about the centre of mass, divided by the mass, m^2: across, along z.
        real(dp) :: across = 0, along = 0
    end type solid_t

    !> Registry entry of a shape.
    type :: shape_info_t
        character(16) :: name
        character(96) :: what
        !> Which dimensions it needs besides the radius.
        logical :: needs_inner_radius, needs_thickness, needs_rod_length
    end type shape_info_t

    !> Name of the shape that is given by its mass properties.
    character(*), parameter :: shape_by_inertia = 'inertia'

    !> All shapes with a formula.
    type(shape_info_t), parameter :: shape_infos(*) = [ &
        shape_info_t('spinning_wheel', 'disc at the end of a massless rod (the paper, Example 2)', &
                     .false., .true., .true.), &
        shape_info_t('ring', 'flat ring (gyroscope rotor) at the end of a massless rod', &
                     .true., .true., .true.), &
        shape_info_t('sphere', 'ball at the end of a massless rod', .false., .false., .true.), &
        shape_info_t('cylinder', 'cylinder standing on the centre of its base', &
                     .false., .true., .false.), &
        shape_info_t('cone', 'cone standing on its apex; thickness is its height', &
                     .false., .true., .false.)]

contains

    !> Volume, length and radii of inertia of a shape.
    pure type(solid_t) function build_shape(name, size) result(solid)
        character(*), intent(in) :: name !! name of the shape
        type(dimensions_t), intent(in) :: size !! dimensions of the shape
        associate (r => size%radius, s => size%inner_radius, h => size%thickness)
            select case (name)
            case ('spinning_wheel')
                solid = disc(0.0_dp, r, h, size%rod_length)
            case ('ring')
                solid = disc(s, r, h, size%rod_length)
            case ('cylinder')
                solid = disc(0.0_dp, r, h, h / 2)
            case ('sphere')
                solid = solid_t(4 * pi * r**3 / 3, size%rod_length, 2 * r**2 / 5, 2 * r**2 / 5)
            case ('cone')
                solid = solid_t(pi * r**2 * h / 3, 3 * h / 4, 3 * (4 * r**2 + h**2) / 80, &
                                3 * r**2 / 10)
            case default
                solid = solid_t()
            end select
        end associate
    end function build_shape

    !> A disc with a round hole.
    pure type(solid_t) function disc(inner, outer, height, length)
        real(dp), intent(in) :: inner, outer, height, length
        disc%volume = pi * (outer - inner) * (outer + inner) * height
        disc%length = length
        disc%across = (3 * (outer**2 + inner**2) + height**2) / 12
        disc%along = (outer**2 + inner**2) / 2
    end function disc

end module spintop_shapes
