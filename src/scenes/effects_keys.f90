!> The group &effects of an input as plain data, with its rows of the parameter table.
module spintop_effects_keys
    use spintop_kinds, only: dp
    use spintop_parameters, only: parameter_table_t, unset
    use spintop_text, only: join
    use spintop_torque_table, only: interpolation_names
    implicit none
    private
    public :: effects_scene_t, swing_t, describe_effects, interpolation_of, axes_names

    !> Axes of a table of torques.
    character(*), parameter :: axes_names(2) = [character(5) :: 'body', 'space']

    !> What swings along or about three axes.
    type :: swing_t
        real(dp) :: amplitude(3) = unset, rate = unset, phase(3) = unset, phase_deg(3) = unset
    end type swing_t

    !> The contents of the group; nothing has a value unless the input gives it.
    type :: effects_scene_t
        real(dp) :: friction_torque = unset, friction_coefficient = unset, friction_radius = unset, friction_smoothing = unset
        character(256) :: friction_table = ''
        character(32) :: friction_interpolation = ''
        real(dp) :: drag_moment(3) = unset, drag_exponent = unset, drag_force = unset
        type(swing_t) :: vibration
        real(dp) :: earth_rate = unset, latitude = unset, latitude_deg = unset
        real(dp) :: rotor_momentum(3) = unset, rotor_torque(3) = unset
        real(dp) :: torque_body(3) = unset, torque_space(3) = unset
        type(swing_t) :: swing_body, swing_space !! harmonic torques
        character(256) :: torque_table = ''
        character(32) :: torque_axes = '', torque_interpolation = ''
        !> Times, s, and torques, N m, of the rows of the table of torques, once it was read.
        real(dp), allocatable :: table_times(:), table_torques(:, :)
        !> Angular velocities, rad/s, and friction, N m, of the rows of the table of friction, once it was read.
        real(dp), allocatable :: friction_rates(:), friction_torques(:)
    end type effects_scene_t

contains

    !> Binds every component to its row of the parameter table.
    subroutine describe_effects(effects, table)
        type(effects_scene_t), target, intent(inout) :: effects !! its components are bound
        type(parameter_table_t), intent(inout) :: table !! bound to the components

        call table%add('effects.friction_torque', effects%friction_torque, 'N m', '>= 0', &
                       'dry moment of the pivot without load (0)')
        call table%add('effects.friction_coefficient', effects%friction_coefficient, '', '>= 0', &
                       'coefficient of dry friction of the pivot (0)')
        call table%add('effects.friction_radius', effects%friction_radius, 'm', '> 0', 'radius of the ball of the pivot')
        call table%add('effects.friction_smoothing', effects%friction_smoothing, 'rad/s', '>= 0', &
                       'angular velocity below which dry friction is smoothed (0: the exact law)')
        call table%add('effects.friction_table', effects%friction_table, &
                       what='CSV file of friction about body z over its rate: omega3,friction_torque (path from the input)')
        call table%add('effects.friction_interpolation', effects%friction_interpolation, join(interpolation_names, '|'), &
                       'interpolation of the table of friction (linear)')
        call table%add('effects.drag_moment', effects%drag_moment, 'N m s^p', '>= 0', &
                       'coefficients of the moment of the air about body x, y, z (0)')
        call table%add('effects.drag_exponent', effects%drag_exponent, '', '[1, 3]', 'exponent p of the moment of the air (2)')
        call table%add('effects.drag_force', effects%drag_force, 'kg/m', '>= 0', &
                       'density x drag coefficient x area/2, of the drag on the centre of mass (0)')
        call describe_swing('vibration', effects%vibration, 'm', 'the pivot along space x, y, z', 'the pivot', &
                            'the pivot along space x, y, z')
        call table%add('effects.earth_rate', effects%earth_rate, 'rad/s', '>= 0', 'angular velocity of the Earth (0)')
        call table%add('effects.latitude', effects%latitude, 'rad', '[-pi/2, pi/2]', &
                       'astronomical latitude; space x, y, z are east, north, up')
        call table%add('effects.latitude_deg', effects%latitude_deg, 'deg', '[-90, 90]', 'astronomical latitude')
        call table%add('effects.rotor_momentum', effects%rotor_momentum, 'J s', '', &
                       'angular momentum of an internal rotor at the start, in body axes (0)')
        call table%add('effects.rotor_torque', effects%rotor_torque, 'N m', '', &
                       'rate of the momentum of the rotor, in body axes (0)')
        call table%add('effects.torque_body', effects%torque_body, 'N m', '', 'constant torque in body axes (0)')
        call table%add('effects.torque_space', effects%torque_space, 'N m', '', 'constant torque in space axes (0)')
        call describe_swing('torque_body', effects%swing_body, 'N m', 'a harmonic torque in body axes', &
                            'the harmonic torque in body axes', 'the harmonic torque in body axes')
        call describe_swing('torque_space', effects%swing_space, 'N m', 'a harmonic torque in space axes', &
                            'the harmonic torque in space axes', 'the harmonic torque in space axes')
        call table%add('effects.torque_table', effects%torque_table, &
                       what='CSV file of a torque over time: t,m1,m2,m3 (path from the input)')
        call table%add('effects.torque_axes', effects%torque_axes, join(axes_names, '|'), 'axes of the table of torques (body)')
        call table%add('effects.torque_interpolation', effects%torque_interpolation, join(interpolation_names, '|'), &
                       'interpolation of the table of torques (linear)')

    contains

        !> The keys of what swings; the texts say whose amplitudes, frequency and phases they are.
        subroutine describe_swing(name, swing, unit, amplitudes, frequency, phases)
            character(*), intent(in) :: name, unit, amplitudes, frequency, phases
            type(swing_t), target, intent(inout) :: swing
            character(:), allocatable :: key
            key = 'effects.' // name
            call table%add(key // '_amplitude', swing%amplitude, unit, '', 'amplitudes of ' // amplitudes // ' (0)')
            call table%add(key // '_rate', swing%rate, 'rad/s', '> 0', 'angular frequency of ' // frequency)
            call table%add(key // '_phase', swing%phase, 'rad', '', 'phases of ' // phases // ' (0)')
            call table%add(key // '_phase_deg', swing%phase_deg, 'deg', '', 'phases of ' // phases // ' (0)')
        end subroutine describe_swing

    end subroutine describe_effects

    !> The interpolation of a table: linear unless the input names another one.
    pure integer function interpolation_of(name) result(interpolation)
        character(*), intent(in) :: name !! its name in the input, or ''
        interpolation = max(1, findloc(interpolation_names, name, dim=1))
    end function interpolation_of

end module spintop_effects_keys
