!> The columns of a trajectory table: a line of the registry each, with the vector of the motion of which the column is a
!> component. A scalar is a vector with one component. The help, the choice of columns, the units in the header and the rows
!> derive from the registry.
module spintop_trajectory_columns
    use spintop_attitude, only: rotation_angle, to_space, vertical_from_quaternion
    use spintop_case, only: case_t
    use spintop_certificate, only: proof_count, proof_of_omega1, proof_of_omega3, proof_of_orientation, proof_of_phi, &
        proof_of_psi, proof_of_q0, proof_of_q1, proof_of_q2, proof_of_q3, proof_of_theta, proof_words
    use spintop_kinds, only: cross, dp, is_finite, is_zero
    use spintop_conditioning, only: conditioning_t, prepare_conditioning
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_loads, only: work_damping, work_drag, work_friction, work_rotor, work_torque, work_vibration, works
    use spintop_motion, only: motion_t
    use spintop_parameters, only: is_set
    use spintop_quantities, only: axial_momentum, axis_height_rate, axis_tip, euler_residuals, goryachev_integral, &
        kovalevskaya_integral, vertical_momentum, specific_force, energy_scale, kinetic_energy, potential_energy, &
        support_force
    use spintop_row_block, only: text_buffer_t
    use spintop_row_proof, only: row_proof_t, wanted_proofs
    use spintop_scene_keys, only: scene_t
    use spintop_study_column, only: by_default, categorical, column => study_column_t, compares, near_poles, &
        needs_effects, needs_exact, needs_work, off_poles, proof_group, study_column_t
    use spintop_uncertainties, only: data_radii
    use spintop_measures, only: watch_centre_height, watch_energy, watch_kinetic_energy, watch_omega, watch_phi, &
        watch_potential_energy, watch_psi, watch_spin_momentum, watch_theta, watch_turning, watch_vertical, &
        watch_vertical_momentum
    implicit none
    private
    public :: trajectory_columns, is_free_of_angles, row_maker_t

    !> The vectors by their numbers.
    enum, bind(C)
        enumerator :: vector_time = 1, vector_angles, vector_rates, vector_omega, vector_quaternion, vector_vertical
        enumerator :: vector_axis, vector_centre, vector_energies, vector_energy_error, vector_momenta, vector_residuals
        enumerator :: vector_changes, vector_force, vector_force_beside_axis, vector_errors, vector_inherent_error
        enumerator :: vector_norm_error, vector_axis_z_rate, vector_kovalevskaya, vector_goryachev, vector_accelerometer
        enumerator :: vector_work, vector_bounds, vector_proof, vector_omega_in_space
    end enum
    !> Number of vectors.
    integer, parameter :: vectors = vector_omega_in_space

    !> Number of components of the longest vector.
    integer, parameter :: longest = max(proof_count, works + 1)

    !> The group of the columns of the time, the angles and their rates, which need nothing else of a motion.
    character(*), parameter :: angle_group = 'angles'
    !> Groups of columns that need no angles nor their rates.
    character(*), parameter :: groups_free_of_angles(*) = [character(8) :: 'rates', 'attitude', 'energy', 'momenta']

    !> The registry of the columns.
    type(column), parameter :: registry(*) = [ &
        column('t', 's', 'time', angle_group, vector_time, by_default + near_poles), &
        column('phi', 'rad', 'precession angle, continuous', angle_group, vector_angles, by_default + near_poles, 1, watch_phi), &
        column('theta', 'rad', 'inclination of body z to the vertical', &
               angle_group, vector_angles, by_default + near_poles, 2, watch_theta), &
        column('psi', 'rad', 'spin angle, continuous', angle_group, vector_angles, by_default + near_poles, 3, watch_psi), &
        column('phi_rate', 'rad/s', 'precession rate', angle_group, vector_rates, by_default + near_poles + off_poles), &
        column('theta_rate', 'rad/s', 'nutation rate', angle_group, vector_rates, by_default + near_poles, 2), &
        column('psi_rate', 'rad/s', 'spin rate', angle_group, vector_rates, by_default + near_poles + off_poles, 3), &
        column('omega1', 'rad/s', 'angular velocity about body x', 'rates', vector_omega, 0, 1, watch_omega), &
        column('omega2', 'rad/s', 'angular velocity about body y', 'rates', vector_omega, 0, 2, watch_omega), &
        column('omega3', 'rad/s', 'angular velocity about body z', 'rates', vector_omega, 0, 3, watch_omega), &
        column('q0', '', 'attitude quaternion, scalar part', 'attitude', vector_quaternion), &
        column('q1', '', 'attitude quaternion, x', 'attitude', vector_quaternion, 0, 2), &
        column('q2', '', 'attitude quaternion, y', 'attitude', vector_quaternion, 0, 3), &
        column('q3', '', 'attitude quaternion, z', 'attitude', vector_quaternion, 0, 4), &
        column('gamma1', '', 'upward vertical in body axes, x', 'attitude', vector_vertical, 0, 1, watch_vertical), &
        column('gamma2', '', 'upward vertical in body axes, y', 'attitude', vector_vertical, 0, 2, watch_vertical), &
        column('gamma3', '', 'upward vertical in body axes, z', 'attitude', vector_vertical, 0, 3, watch_vertical), &
        column('axis_x', '', 'body z in space axes, x', 'attitude', vector_axis), &
        column('axis_y', '', 'body z in space axes, y', 'attitude', vector_axis, 0, 2), &
        column('axis_z', '', 'body z in space axes, z', 'attitude', vector_axis, 0, 3, watch_vertical), &
        column('com_x', 'm', 'centre of mass in space axes, x', 'attitude', vector_centre, by_default), &
        column('com_y', 'm', 'centre of mass in space axes, y', 'attitude', vector_centre, by_default, 2), &
        column('com_z', 'm', 'centre of mass in space axes, z (height above the pivot)', &
               'attitude', vector_centre, by_default, 3, watch_centre_height), &
        column('kinetic', 'J', 'kinetic energy', 'energy', vector_energies, by_default, 1, watch_kinetic_energy), &
        column('potential', 'J', 'potential energy above the height of the pivot, with -O.IO/2 - O.h where the Earth &
               &turns (O its rate, h of a rotor)', &
               'energy', vector_energies, by_default, 2, watch_potential_energy), &
        column('energy', 'J', 'total energy', 'energy', vector_energies, by_default, 3, watch_energy), &
        column('energy_error', '', 'change of energy since the start over (kinetic at start + m g |r|)', &
               'energy', vector_energy_error, needs_work), &
        column('lz', 'J s', 'angular momentum about the vertical', 'momenta', vector_momenta, 0, 1, watch_vertical_momentum), &
        column('l3', 'J s', 'angular momentum about body z', 'momenta', vector_momenta, 0, 2, watch_spin_momentum), &
        column('R1', 'N m', "residual of Euler's first equation (Eq 51)", 'residuals', vector_residuals, by_default), &
        column('R2', 'N m', "residual of Euler's second equation (Eq 51)", 'residuals', vector_residuals, by_default, 2), &
        column('R3', 'J s', 'change of Lz since the start (Eq 51)', 'residuals', vector_changes, by_default), &
        column('R4', 'J', 'change of energy since the start (Eq 51)', 'residuals', vector_changes, by_default, 2), &
        column('force_x', 'N', 'support force on the body, x', 'force', vector_force, by_default + near_poles), &
        column('force_y', 'N', 'support force on the body, y', 'force', vector_force, by_default + near_poles, 2), &
        column('force_z', 'N', 'support force on the body, z', 'force', vector_force, by_default + near_poles, 3), &
        column('force_r', 'N', 'support force away from the vertical, in the plane of the axis', &
               'force', vector_force_beside_axis, near_poles), &
        column('force_n', 'N', 'support force along the line of nodes', 'force', vector_force_beside_axis, near_poles, 2), &
        column('orientation_error', 'rad', 'rotation angle from the exact attitude', &
               'errors', vector_errors, by_default + needs_exact + compares), &
        column('tip_error', '', 'distance of the axis tip from the exact one', &
               'errors', vector_errors, needs_exact + compares, 2), &
        column('inherent_error', 'rad', 'error of the attitude due to rounding of the data', &
               'errors', vector_inherent_error, by_default + needs_exact), &
        column('norm_error', '', 'norm error abs(q) - 1 of the computed quaternion', 'errors', vector_norm_error), &
        column('omega_x', 'rad/s', 'angular velocity about space x', 'rates', vector_omega_in_space), &
        column('omega_y', 'rad/s', 'angular velocity about space y', 'rates', vector_omega_in_space, 0, 2), &
        column('omega_z', 'rad/s', 'angular velocity about space z', 'rates', vector_omega_in_space, 0, 3), &
        column('axis_z_rate', '1/s', 'rate of axis_z, zero at the turning points of theta', &
               'attitude', vector_axis_z_rate, 0, 1, watch_turning), &
        column('kovalevskaya', '1/s^4', 'Kovalevskaya integral; constant for I1 = I2 = 2 I3 and ' // 'centre of mass in body x y', &
               'momenta', vector_kovalevskaya), &
        column('goryachev', '1/s^3', 'integral of Goryachev and Chaplygin; constant for I1 = I2 = 4 I3, Lz = 0 and centre &
               &of mass in body x y', 'momenta', vector_goryachev), &
        column('accelerometer1', 'm/s^2', 'reading of an accelerometer at the centre of mass, body x', &
               'force', vector_accelerometer), &
        column('accelerometer2', 'm/s^2', 'reading of an accelerometer at the centre of mass, body y', &
               'force', vector_accelerometer, 0, 2), &
        column('accelerometer3', 'm/s^2', 'reading of an accelerometer at the centre of mass, body z', &
               'force', vector_accelerometer, 0, 3), &
        column('work', 'J', 'work of all effects since the start', &
               'energy', vector_work, by_default + needs_effects + needs_work, works + 1), &
        column('work_damping', 'J', 'work of viscous damping', 'energy', vector_work, needs_effects + needs_work, work_damping), &
        column('work_friction', 'J', 'work of dry friction', 'energy', vector_work, needs_effects + needs_work, work_friction), &
        column('work_drag', 'J', 'work of the air', 'energy', vector_work, needs_effects + needs_work, work_drag), &
        column('work_vibration', 'J', 'work of the moving pivot', &
               'energy', vector_work, needs_effects + needs_work, work_vibration), &
        column('work_torque', 'J', 'work of given torques', 'energy', vector_work, needs_effects + needs_work, work_torque), &
        column('work_rotor', 'J', 'work of the drive of the rotor', &
               'energy', vector_work, needs_effects + needs_work, work_rotor), &
        column('q0_bound', '', 'upper bound of the error of q0, proved', proof_group, vector_bounds, 0, proof_of_q0), &
        column('q1_bound', '', 'upper bound of the error of q1, proved', proof_group, vector_bounds, 0, proof_of_q1), &
        column('q2_bound', '', 'upper bound of the error of q2, proved', proof_group, vector_bounds, 0, proof_of_q2), &
        column('q3_bound', '', 'upper bound of the error of q3, proved', proof_group, vector_bounds, 0, proof_of_q3), &
        column('theta_bound', 'rad', 'upper bound of the error of theta, proved', proof_group, vector_bounds, 0, proof_of_theta), &
        column('phi_bound', 'rad', 'upper bound of the error of phi, proved', proof_group, vector_bounds, 0, proof_of_phi), &
        column('psi_bound', 'rad', 'upper bound of the error of psi, proved', proof_group, vector_bounds, 0, proof_of_psi), &
        column('omega1_bound', 'rad/s', 'upper bound of the error of omega1, proved', &
               proof_group, vector_bounds, 0, proof_of_omega1), &
        column('omega2_bound', 'rad/s', 'upper bound of the error of omega2, proved', &
               proof_group, vector_bounds, 0, proof_of_omega1 + 1), &
        column('omega3_bound', 'rad/s', 'upper bound of the error of omega3, proved', &
               proof_group, vector_bounds, 0, proof_of_omega3), &
        column('orientation_bound', 'rad', 'upper bound of the rotation angle from the true attitude, proved', &
               proof_group, vector_bounds, 0, proof_of_orientation), &
        column('proof', '', 'proved, or unproved if a bound of the row is infinite', proof_group, vector_proof, categorical)]

    !> All columns, in the order of the table's documentation. A variable, since flang 19 fails at components of constants.
    type(column), protected :: trajectory_columns(size(registry)) = registry

    !> Gives the values of columns, one motion of a case after the other.
    type :: row_maker_t
        !> The proof of the numbers, where it is wanted.
        type(row_proof_t) :: proof
        type(study_column_t), allocatable, private :: columns(:)
        !> The vectors by their numbers, and the numbers of those of which the columns are components.
        real(dp), private :: vectors(longest, vectors) = 0
        integer, allocatable, private :: needed(:)
        !> Whether the angles and their rates are enough for all columns; whether some columns are in other units than their own.
        logical, private :: needs_angles_only = .false., has_converted = .false.
        type(case_t), private :: case
        !> Place of the accelerometers relative to the centre of mass, body axes, m.
        real(dp), private :: lever_arm(3) = 0
        !> The motion of the body as it was given, and as it was computed.
        type(motion_t), private :: motion, computed
        !> Work of effects since the start by its parts, J.
        real(dp), private :: work(works) = 0
        !> Energy and vertical momentum at the start, and the scale of the energy error.
        real(dp), private :: energy_of_start = 0, momentum_of_start = 0, energy_scale = 1
        type(exact_motion_t), allocatable, private :: oracle
        type(conditioning_t), allocatable, private :: conditioning
        !> What was computed of this motion when a column asked for it.
        logical, private :: has_energies = .false., has_force = .false.
        real(dp), private :: known_energies(2) = 0, known_force(3) = 0
    contains
        procedure :: set
        procedure :: row
        procedure :: wants_angles_of
        procedure :: find_exact_row
        procedure :: is_defined
        procedure :: write_row
    end type row_maker_t

contains

    !> Replaces the attitude and the rates of a formulation by the given values. Rates that do not exist at a
    !> pole are not replaced.
    pure subroutine use_given_start(start, motion)
        type(motion_t), intent(in) :: start
        type(motion_t), intent(inout) :: motion
        motion%angle = start%angle
        where (is_finite(start%rate)) motion%rate = start%rate
        motion%omega = start%omega
        motion%quaternion = start%quaternion
    end subroutine use_given_start

    !> Kinetic and potential energy, J.
    function energies(self)
        type(row_maker_t), intent(inout) :: self
        real(dp) :: energies(2)
        if (.not. self%has_energies) self%known_energies = [kinetic_energy(self%case%given_body, self%motion), &
                                                            potential_energy(self%case%given_body, self%motion)]
        self%has_energies = .true.
        energies = self%known_energies
    end function energies

    !> Change of the energy since the start, J.
    real(dp) function energy_change(self)
        type(row_maker_t), intent(inout) :: self
        energy_change = sum(energies(self)) - self%energy_of_start
    end function energy_change

    !> The support force in space axes, N.
    function force_on(self) result(force)
        type(row_maker_t), intent(inout) :: self
        real(dp) :: force(3)
        if (.not. self%has_force) self%known_force = support_force(self%case%given_body, self%motion)
        self%has_force = .true.
        force = self%known_force
    end function force_on

    !> Whether the value follows from the attitude, the angular velocity and its rate.
    elemental logical function is_free_of_angles(of)
        type(column), intent(in) :: of !! the column
        is_free_of_angles = any(groups_free_of_angles == of%group)
    end function is_free_of_angles

    !> The components of a vector for the current motion; those that it does not have are left as they were.
    subroutine fill_vector(now, which)
        type(row_maker_t), intent(inout) :: now !! the motion; the components are set
        integer, intent(in) :: which !! number of the vector
        type(motion_t) :: exact
        real(dp) :: force(3)
        integer :: status
        associate (vector => now%vectors(:, which), body => now%case%given_body)
            select case (which)
            case (vector_time)
                vector(1) = now%motion%t
            case (vector_angles)
                vector(:3) = now%motion%angle
            case (vector_rates)
                vector(:3) = now%motion%rate
            case (vector_omega)
                vector(:3) = now%motion%omega
            case (vector_omega_in_space)
                vector(:3) = to_space(now%motion%quaternion, now%motion%omega)
            case (vector_quaternion)
                vector(:4) = now%motion%quaternion
            case (vector_vertical) ! upward, in body axes
                vector(:3) = vertical_from_quaternion(now%motion%quaternion)
            case (vector_axis)
                vector(:3) = to_space(now%motion%quaternion, [0.0_dp, 0.0_dp, 1.0_dp])
            case (vector_centre)
                vector(:3) = to_space(now%motion%quaternion, body%centre_of_mass)
            case (vector_energies) ! kinetic, potential, and their sum
                vector(:2) = energies(now)
                vector(3) = sum(vector(:2))
            case (vector_energy_error)
                ! Without the work of effects, relative to the scale of the energies, which work may exceed.
                vector(1) = (energy_change(now) - sum(now%work)) / max(now%energy_scale, sum(abs(now%work)))
            case (vector_momenta) ! about the vertical, and about body z
                vector(1) = vertical_momentum(body, now%motion)
                vector(2) = axial_momentum(body, now%motion)
            case (vector_residuals) ! of Euler's equations
                vector(:3) = euler_residuals(body, now%motion)
            case (vector_changes) ! of the vertical momentum and of the energy
                vector(:2) = [vertical_momentum(body, now%motion) - now%momentum_of_start, energy_change(now)]
            case (vector_force)
                vector(:3) = force_on(now)
            case (vector_force_beside_axis) ! along (sin phi, -cos phi, 0), and along the line of nodes (cos phi, sin phi, 0)
                force = force_on(now)
                associate (phi => now%motion%angle(1))
                    vector(:2) = [force(1) * sin(phi) - force(2) * cos(phi), force(1) * cos(phi) + force(2) * sin(phi)]
                end associate
            case (vector_errors) ! of the attitude, and of the axis tip, in the axes of the computation
                if (.not. allocated(now%oracle)) then
                    allocate (now%oracle)
                    call prepare_exact_motion(now%case%body, now%case%start, now%oracle, status)
                end if
                exact = now%oracle%at(now%computed%t)
                vector(1) = rotation_angle(exact%quaternion, now%computed%quaternion)
                vector(2) = norm2(axis_tip(now%case%body, now%computed) - axis_tip(now%case%body, exact))
            case (vector_inherent_error)
                if (.not. allocated(now%conditioning)) then
                    allocate (now%conditioning)
                    call prepare_conditioning(now%case%body, now%case%start, now%conditioning, status)
                end if
                vector(1) = now%conditioning%floor_at(now%motion%t)
            case (vector_norm_error)
                vector(1) = now%motion%norm_error
            case (vector_axis_z_rate)
                vector(1) = axis_height_rate(now%motion)
            case (vector_kovalevskaya)
                vector(1) = kovalevskaya_integral(body, now%motion)
            case (vector_goryachev)
                vector(1) = goryachev_integral(body, now%motion)
            case (vector_accelerometer) ! in body axes
                vector(:3) = specific_force(body, now%motion) + acceleration_at(now%motion, now%lever_arm)
            case (vector_work) ! the parts, and their sum
                vector(:works) = now%work
                vector(works + 1) = sum(now%work)
            case (vector_bounds) ! one for each quantity (spintop_certificate)
                vector(:proof_count) = now%proof%bounds
            case (vector_proof) ! 1 where all bounds of the row are proved
                vector(1) = merge(1, 0, now%proof%is_proved())
            end select
        end associate
    end subroutine fill_vector

    !> The acceleration of a place of the body against that of the centre of mass, in body axes, m/s^2.
    pure function acceleration_at(motion, arm)
        type(motion_t), intent(in) :: motion
        real(dp), intent(in) :: arm(3)
        real(dp) :: acceleration_at(3)
        acceleration_at = cross(motion%omega_rate, arm) + cross(motion%omega, cross(motion%omega, arm))
    end function acceleration_at

    !> Sets the columns of the rows, and the case. Columns that need an exact motion are for bodies that have one. The scene
    !> says what is to be proved, and of which data.
    subroutine set(self, columns, case, scene)
        class(row_maker_t), intent(inout) :: self
        type(study_column_t), intent(in) :: columns(:) !! the columns
        type(case_t), intent(in) :: case !! the case whose motions are shown, in the axes in which its body was given
        type(scene_t), intent(in), optional :: scene !! contents of the input, if numbers may be proved
        integer :: i
        call self%proof%close()
        self%proof = row_proof_t()
        if (allocated(self%oracle)) deallocate (self%oracle)
        if (allocated(self%conditioning)) deallocate (self%conditioning)
        self%columns = columns
        self%needed = pack([(i, i=1, vectors)], [(any(columns%source == i), i=1, vectors)])
        self%has_converted = any(columns%is_converted())
        self%needs_angles_only = .not. case%turn%is_turned() .and. all(columns%group == angle_group)
        self%case = case
        self%work = 0
        associate (body => case%given_body, start => case%given_start)
            self%energy_of_start = kinetic_energy(body, start) + potential_energy(body, start)
            self%momentum_of_start = vertical_momentum(body, start)
            self%energy_scale = energy_scale(body, start)
        end associate
        self%lever_arm = 0
        if (.not. present(scene)) return
        where (is_set(scene%fit%lever_arm)) self%lever_arm = scene%fit%lever_arm
        call self%proof%open(wanted_proofs(columns%quantity(), scene%certified, ''), scene%certified, case%given_body, &
                             case%given_start, data_radii(scene))
    end subroutine set

    !> The row of a motion, which is in the axes of the computation; all but the errors are those of the
    !> body as it was given. That at the start, by its time, is told as it was given.
    function row(self, computed, as_computed, work) result(values)
        class(row_maker_t), intent(inout) :: self
        type(motion_t), intent(in) :: computed !! the motion in the axes of the computation
        logical, intent(in), optional :: as_computed !! whether the start, too, is shown as it was computed
        real(dp), intent(in), optional :: work(works) !! of effects, J; that of the last motion if it is not given
        real(dp) :: values(size(self%columns))
        real(dp) :: printed(proof_count)
        logical :: is_start
        if (present(work)) self%work = work
        is_start = is_zero(computed%t)
        if (present(as_computed)) is_start = is_start .and. .not. as_computed
        self%computed = computed
        self%motion = self%case%turn%back(computed, computed%given_angle)
        if (is_start) call use_given_start(self%case%given_start, self%motion)
        if (any(self%proof%wanted)) then
            printed = 0
            printed(proof_of_q0:proof_of_q3) = self%motion%quaternion
            printed([proof_of_phi, proof_of_theta, proof_of_psi]) = self%motion%angle
            printed(proof_of_omega1:proof_of_omega3) = self%motion%omega
            call self%proof%prove(self%motion%t, printed)
            self%motion%quaternion = printed(proof_of_q0:proof_of_q3)
            self%motion%angle = printed([proof_of_phi, proof_of_theta, proof_of_psi])
            self%motion%omega = printed(proof_of_omega1:proof_of_omega3)
        end if
        call find_values(self, values)
    end function row

    !> Whether the angles and their rates at an instant are enough for a row, which `find_exact_row` then gives: no turns are
    !> to be counted, and no number is to be proved.
    pure logical function wants_angles_of(self, exact)
        class(row_maker_t), intent(in) :: self
        type(exact_motion_t), intent(in) :: exact !! the exact motion of the case
        wants_angles_of = self%needs_angles_only .and. .not. exact%has_to_follow() .and. .not. any(self%proof%wanted)
    end function wants_angles_of

    !> The row at a time t of the exact motion, which is much faster than `row` and has the same values.
    subroutine find_exact_row(self, exact, t, values)
        class(row_maker_t), intent(inout) :: self
        type(exact_motion_t), intent(in) :: exact !! the exact motion of the case
        real(dp), intent(in) :: t !! time, s
        real(dp), intent(out) :: values(:) !! the row, one value per column
        self%motion%t = t
        call exact%find_angles(t, self%motion%angle, self%motion%rate)
        if (is_zero(t)) call use_given_start(self%case%given_start, self%motion)
        call find_values(self, values)
    end subroutine find_exact_row

    !> The values of the columns for the current motion. A vector is computed once for all of its columns.
    subroutine find_values(self, values)
        class(row_maker_t), intent(inout) :: self
        real(dp), intent(out) :: values(:)
        integer :: i
        self%has_energies = .false.
        self%has_force = .false.
        do i = 1, size(self%needed)
            call fill_vector(self, self%needed(i))
        end do
        do i = 1, size(self%columns)
            values(i) = self%vectors(self%columns(i)%component, self%columns(i)%source)
        end do
        if (self%has_converted) values = values / self%columns%size
    end subroutine find_values

    !> Whether the last row, given, is finite, but for bounds and for what does not exist at a pole.
    pure logical function is_defined(self, values)
        class(row_maker_t), intent(in) :: self
        real(dp), intent(in) :: values(:) !! the last row, one value per column
        logical :: at_pole
        integer :: i
        is_defined = all(abs(values) <= huge(1.0_dp)) ! faster than calls of is_finite
        if (is_defined) return
        at_pole = abs(sin(self%motion%angle(2))) <= 4 * epsilon(1.0_dp)
        do i = 1, size(values)
            if (is_finite(values(i)) .or. self%columns(i)%group == proof_group) cycle
            if (.not. (at_pole .and. self%columns(i)%is(off_poles))) return
        end do
        is_defined = .true.
    end function is_defined

    !> Adds the values of a row to a text, those of words as words.
    subroutine write_row(self, values, text)
        class(row_maker_t), intent(in) :: self
        real(dp), intent(in) :: values(:) !! the row, one value per column
        type(text_buffer_t), intent(inout) :: text !! the cells are added
        integer :: i
        do i = 1, size(values)
            if (self%columns(i)%is(categorical)) then
                call text%add_text(trim(proof_words(nint(values(i)))))
            else
                call text%add_reals(values(i:i))
            end if
        end do
    end subroutine write_row

end module spintop_trajectory_columns
