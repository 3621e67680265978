!> The columns of a trajectory table: one row of the table below each; the help, the choice of
!> columns, the units in the header and the computation derive from it.
module spintop_columns
    use spintop_kinds, only: dp
    use spintop_attitude, only: rotation_angle, vertical_from_quaternion, to_space
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_compare, only: is_finite
    use spintop_conditioning, only: conditioning_t, prepare_conditioning
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_motion, only: motion_t
    use spintop_quantities, only: energy_scale, kinetic_energy, potential_energy, vertical_momentum, &
        axial_momentum, euler_residuals, support_force, axis_tip, axis_height_rate
    implicit none
    private
    public :: column_t, column_computer_t, trajectory_columns, default_trajectory_columns
    public :: needs_exact_motion, varies_near_poles, place_of_column

    !> What a table says of a column.
    type :: column_t
        character(20) :: name
        character(8) :: unit
        character(96) :: what
        !> Columns of a group are computed together, when one of them is asked for.
        integer :: group
    end type column_t

    integer, parameter :: group_angles = 1, group_omega = 2, group_quaternion = 3, &
        group_vertical = 4, group_axis = 5, group_centre = 6, group_energy = 7, group_momenta = 8, &
        group_residuals = 9, group_force = 10, group_oracle = 11, group_inherent = 12, &
        group_drift = 13, group_turning = 14, groups = group_turning

    !> All columns, in the order of the table's documentation.
    type(column_t), parameter :: trajectory_columns(*) = [ &
        column_t('t', 's', 'time', group_angles), &
        column_t('phi', 'rad', 'precession angle, continuous', group_angles), &
        column_t('theta', 'rad', 'inclination of body z to the vertical', group_angles), &
        column_t('psi', 'rad', 'spin angle, continuous', group_angles), &
        column_t('phi_rate', 'rad/s', 'precession rate', group_angles), &
        column_t('theta_rate', 'rad/s', 'nutation rate', group_angles), &
        column_t('psi_rate', 'rad/s', 'spin rate', group_angles), &
        column_t('omega1', 'rad/s', 'angular velocity about body x', group_omega), &
        column_t('omega2', 'rad/s', 'angular velocity about body y', group_omega), &
        column_t('omega3', 'rad/s', 'angular velocity about body z', group_omega), &
        column_t('q0', '', 'attitude quaternion, scalar part', group_quaternion), &
        column_t('q1', '', 'attitude quaternion, x', group_quaternion), &
        column_t('q2', '', 'attitude quaternion, y', group_quaternion), &
        column_t('q3', '', 'attitude quaternion, z', group_quaternion), &
        column_t('gamma1', '', 'upward vertical in body axes, x', group_vertical), &
        column_t('gamma2', '', 'upward vertical in body axes, y', group_vertical), &
        column_t('gamma3', '', 'upward vertical in body axes, z', group_vertical), &
        column_t('axis_x', '', 'body z in space axes, x', group_axis), &
        column_t('axis_y', '', 'body z in space axes, y', group_axis), &
        column_t('axis_z', '', 'body z in space axes, z', group_axis), &
        column_t('com_x', 'm', 'centre of mass in space axes, x', group_centre), &
        column_t('com_y', 'm', 'centre of mass in space axes, y', group_centre), &
        column_t('com_z', 'm', 'centre of mass in space axes, z (height above the pivot)', group_centre), &
        column_t('kinetic', 'J', 'kinetic energy', group_energy), &
        column_t('potential', 'J', 'potential energy above the height of the pivot', group_energy), &
        column_t('energy', 'J', 'total energy', group_energy), &
        column_t('energy_error', '', 'change of energy since the start over (kinetic at start + m g |r|)', &
                 group_energy), &
        column_t('lz', 'J s', 'angular momentum about the vertical', group_momenta), &
        column_t('l3', 'J s', 'angular momentum about body z', group_momenta), &
        column_t('R1', 'N m', "residual of Euler's first equation (Eq 51)", group_residuals), &
        column_t('R2', 'N m', "residual of Euler's second equation (Eq 51)", group_residuals), &
        column_t('R3', 'J s', 'change of lz since the start (Eq 51)', group_residuals), &
        column_t('R4', 'J', 'change of energy since the start (Eq 51)', group_residuals), &
        column_t('force_x', 'N', 'support force on the body, x', group_force), &
        column_t('force_y', 'N', 'support force on the body, y', group_force), &
        column_t('force_z', 'N', 'support force on the body, z', group_force), &
        column_t('force_r', 'N', 'support force away from the vertical, in the plane of the axis', &
                 group_force), &
        column_t('force_n', 'N', 'support force along the line of nodes', group_force), &
        column_t('orientation_error', 'rad', 'rotation angle from the exact attitude', group_oracle), &
        column_t('tip_error', '', 'distance of the axis tip from the exact one', group_oracle), &
        column_t('inherent_error', 'rad', 'error of the attitude due to rounding of the data', &
                 group_inherent), &
        column_t('norm_error', '', 'norm error abs(q) - 1 of the computed quaternion', &
                 group_drift), &
        column_t('axis_z_rate', '1/s', 'rate of axis_z, zero at the turning points of theta', group_turning)]

    !> Columns of the table when none are named.
    character(*), parameter :: default_trajectory_columns(*) = [character(20) :: &
        't', 'phi', 'theta', 'psi', 'phi_rate', 'theta_rate', 'psi_rate', 'com_x', 'com_y', 'com_z', &
        'kinetic', 'potential', 'energy', 'R1', 'R2', 'R3', 'R4', 'force_x', 'force_y', 'force_z', &
        'orientation_error', 'inherent_error']

    !> Computes the chosen columns of a motion.
    type :: column_computer_t
        private
        type(case_t) :: case
        !> Angles of the last row; those of the next are continuous with them.
        real(dp) :: near(3) = 0
        !> Where the chosen columns stand among all.
        integer, allocatable :: chosen(:)
        !> Groups in use, and where each begins among all columns.
        logical :: wanted(groups) = .false.
        integer :: first(groups) = 0, last(groups) = 0
        !> Energy and vertical momentum of the start, and the scale of the energy error.
        real(dp) :: energy = 0, momentum = 0, energy_scale = 1
        !> The exact motion, where there is one.
        type(exact_motion_t) :: oracle
        type(conditioning_t) :: conditioning
    contains
        procedure :: set
        procedure :: row
        procedure :: is_defined
        procedure :: come_near
    end type column_computer_t

contains

    !> Chooses columns by their place in `trajectory_columns` and takes the start's invariants.
    !> Columns that `needs_exact_motion` are for bodies that have one.
    subroutine set(self, chosen, case)
        class(column_computer_t), intent(out) :: self
        integer, intent(in) :: chosen(:)
        type(case_t), intent(in) :: case
        integer :: i, group, status

        self%case = case
        self%near = case%given_start%angle
        self%chosen = chosen
        do i = 1, size(trajectory_columns)
            group = trajectory_columns(i)%group
            if (self%first(group) == 0) self%first(group) = i
            self%last(group) = i
        end do
        self%wanted(trajectory_columns(chosen)%group) = .true.
        associate (body => case%given_body, start => case%given_start)
            self%energy = kinetic_energy(body, start) + potential_energy(body, start)
            self%momentum = vertical_momentum(body, start)
            self%energy_scale = energy_scale(body, start)
        end associate
        if (self%wanted(group_oracle)) then
            call prepare_exact_motion(case%body, case%start, self%oracle, status)
        end if
        if (self%wanted(group_inherent)) then
            call prepare_conditioning(case%body, case%start, self%conditioning, status)
        end if
    end subroutine set

    !> Place of a column in `trajectory_columns`, 0 if there is none of that name.
    pure integer function place_of_column(name) result(place)
        character(*), intent(in) :: name
        do place = size(trajectory_columns), 1, -1
            if (trajectory_columns(place)%name == name) return
        end do
    end function place_of_column

    !> Whether a column compares with the exact motion.
    elemental logical function needs_exact_motion(column)
        type(column_t), intent(in) :: column
        needs_exact_motion = column%group == group_oracle .or. column%group == group_inherent
    end function needs_exact_motion

    !> Whether a column may vary much faster near a pole than the attitude turns: it depends on phi or psi.
    elemental logical function varies_near_poles(column)
        type(column_t), intent(in) :: column
        varies_near_poles = column%group == group_angles .or. column%group == group_force
    end function varies_near_poles

    !> The chosen columns of a motion, which is in the axes of the computation; all but the errors
    !> are those of the body as it was given. That of the start (`is_start`) is told as it was given.
    function row(self, computed, is_start) result(values)
        class(column_computer_t), intent(inout) :: self
        type(motion_t), intent(in) :: computed
        logical, intent(in), optional :: is_start
        real(dp), allocatable :: values(:)
        real(dp) :: all_values(maxval(self%last)), kinetic, potential, drift
        type(motion_t) :: motion
        type(body_t) :: body
        integer :: group

        body = self%case%given_body
        motion = self%case%turn%back(computed, self%near)
        if (present(is_start)) then
            if (is_start) call take_start(self%case%given_start, motion)
        end if
        self%near = motion%angle
        kinetic = kinetic_energy(body, motion)
        potential = potential_energy(body, motion)
        drift = kinetic + potential - self%energy
        do group = 1, groups
            if (.not. self%wanted(group)) cycle
            associate (slice => all_values(self%first(group):self%last(group)))
                select case (group)
                case (group_angles)
                    slice = [motion%t, motion%angle, motion%rate]
                case (group_omega)
                    slice = motion%omega
                case (group_quaternion)
                    slice = motion%quaternion
                case (group_drift)
                    slice = motion%norm_error
                case (group_turning)
                    slice = axis_height_rate(motion)
                case (group_vertical)
                    slice = vertical_from_quaternion(motion%quaternion)
                case (group_axis)
                    slice = to_space(motion%quaternion, [0.0_dp, 0.0_dp, 1.0_dp])
                case (group_centre)
                    slice = to_space(motion%quaternion, body%centre_of_mass)
                case (group_energy)
                    slice = [kinetic, potential, kinetic + potential, drift / self%energy_scale]
                case (group_momenta)
                    slice = [vertical_momentum(body, motion), axial_momentum(body, motion)]
                case (group_residuals)
                    slice(1:2) = first_two(euler_residuals(body, motion))
                    slice(3:4) = [vertical_momentum(body, motion) - self%momentum, drift]
                case (group_force)
                    slice = with_cylindrical(support_force(body, motion), motion%angle(1))
                case (group_oracle)
                    slice = errors_against(self%oracle%at(computed%t), computed, self%case%body)
                case (group_inherent)
                    slice = self%conditioning%floor_at(motion%t)
                end select
            end associate
        end do
        values = all_values(self%chosen)
    end function row

    !> Whether the last row, given, is finite, but for the rates of phi and psi at a pole.
    pure logical function is_defined(self, values)
        class(column_computer_t), intent(in) :: self
        real(dp), intent(in) :: values(:)
        logical :: lost(size(values))
        lost = .not. is_finite(values)
        if (any(lost) .and. abs(sin(self%near(2))) <= 4 * epsilon(1.0_dp)) then
            lost = lost .and. trajectory_columns(self%chosen)%name /= 'phi_rate' &
                   .and. trajectory_columns(self%chosen)%name /= 'psi_rate'
        end if
        is_defined = .not. any(lost)
    end function is_defined

    !> Attitude and rates as they were given, in place of what a formulation makes of them. Rates that
    !> do not exist at a pole stay as they were computed.
    pure subroutine take_start(start, motion)
        type(motion_t), intent(in) :: start
        type(motion_t), intent(inout) :: motion
        motion%angle = start%angle
        where (is_finite(start%rate)) motion%rate = start%rate
        motion%omega = start%omega
        motion%quaternion = start%quaternion
    end subroutine take_start

    !> The angles of the next row are continuous with those of another computer's last one.
    subroutine come_near(self, other)
        class(column_computer_t), intent(inout) :: self
        class(column_computer_t), intent(in) :: other
        self%near = other%near
    end subroutine come_near

    pure function first_two(vector) result(pair)
        real(dp), intent(in) :: vector(3)
        real(dp) :: pair(2)
        pair = vector(1:2)
    end function first_two

    !> A force in space axes, and its components along (sin phi, -cos phi, 0) and along the line
    !> of nodes (cos phi, sin phi, 0).
    pure function with_cylindrical(force, phi) result(components)
        real(dp), intent(in) :: force(3), phi
        real(dp) :: components(5)
        components = [force, force(1) * sin(phi) - force(2) * cos(phi), &
                      force(1) * cos(phi) + force(2) * sin(phi)]
    end function with_cylindrical

    !> Orientation error and tip error against the exact motion.
    pure function errors_against(exact, motion, body) result(errors)
        type(motion_t), intent(in) :: exact, motion
        type(body_t), intent(in) :: body
        real(dp) :: errors(2)
        errors = [rotation_angle(exact%quaternion, motion%quaternion), &
                  norm2(axis_tip(body, motion) - axis_tip(body, exact))]
    end function errors_against

end module spintop_columns
