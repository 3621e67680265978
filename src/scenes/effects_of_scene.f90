!> Makes the effects of a scene, and checks them; reads their tables of torques.
module spintop_effects_of_scene
    use spintop_body, only: body_t
    use spintop_body_of_scene, only: check_axes
    use spintop_body_turn, only: turn_to_principal_axes
    use spintop_kinds, only: dp, degree, is_zero, is_equal, is_finite
    use spintop_effects, only: effects_t, harmonic_t
    use spintop_effects_keys, only: axes_names, effects_scene_t, interpolation_of, swing_t
    use spintop_errors, only: error_t
    use spintop_files, only: beside_input, path_from
    use spintop_loaded_table, only: read_table, table_t
    use spintop_loads, only: friction_jams
    use spintop_parameters, only: given, is_set
    use spintop_problems, only: problems_t
    use spintop_text, only: to_text, join
    use spintop_torque_table, only: driving_row, make_friction_table, make_torque_table, fewest_rows, last_of_piece
    implicit none
    private
    public :: make_effects, warn_of_effects, read_effect_tables, read_columns

    character(*), parameter :: key_of_torques = 'effects.torque_table', key_of_friction = 'effects.friction_table'
    character(*), parameter :: columns_of_torques(4) = [character(2) :: 't', 'm1', 'm2', 'm3']
    character(*), parameter :: columns_of_friction(2) = [character(15) :: 'omega3', 'friction_torque']

contains

    !> The effects of a body; a body without any has none allocated. Problems of their description are reported.
    subroutine make_effects(scene, body, problems)
        type(effects_scene_t), intent(in) :: scene !! the group of the input
        type(body_t), intent(inout) :: body !! its effects are set; its mass properties are
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(effects_t) :: effects
        type(body_t) :: principal

        if (allocated(body%effects)) deallocate (body%effects)
        call read_friction(scene, effects, problems)
        effects%drag_moment = given(scene%drag_moment)
        effects%drag_force = given(scene%drag_force)
        if (is_set(scene%drag_exponent)) then
            effects%drag_exponent = scene%drag_exponent
            if (.not. any(is_set(scene%drag_moment))) then
                call problems%add('effects.drag_exponent', 'there is no moment of the air whose exponent it is', &
                                  'give drag_moment(3) too')
            end if
        end if
        call read_swing('vibration', 'the vibration', scene%vibration, effects%vibration_phase, problems)
        effects%vibration_amplitude = given(scene%vibration%amplitude)
        if (is_set(scene%vibration%rate)) effects%vibration_rate = scene%vibration%rate
        call read_earth_rotation(scene, effects, problems)
        effects%rotor_momentum = given(scene%rotor_momentum)
        effects%rotor_torque = given(scene%rotor_torque)
        effects%torque_body = given(scene%torque_body)
        effects%torque_space = given(scene%torque_space)
        call read_harmonic_torque('torque_body', scene%swing_body, effects%harmonic_body, problems)
        call read_harmonic_torque('torque_space', scene%swing_space, effects%harmonic_space, problems)
        if (scene%torque_table == '' .and. scene%torque_axes /= '') then
            call problems%add('effects.torque_axes', 'there is no table of torques', 'give torque_table too')
        end if
        if (scene%torque_table == '' .and. scene%torque_interpolation /= '') then
            call problems%add('effects.torque_interpolation', 'there is no table of torques', 'give torque_table too')
        end if
        if (scene%torque_table /= '' .and. allocated(scene%table_times)) then
            effects%table_in_space = scene%torque_axes == axes_names(2)
            allocate (effects%table)
            call make_torque_table(scene%table_times, scene%table_torques, interpolation_of(scene%torque_interpolation), &
                                   effects%table)
        end if
        if (problems%any() .or. effects%acting() == 0) return
        principal = body
        if (body%has_products()) then
            call turn_to_principal_axes(body, principal)
            call check_axes(body, effects%drag_moment, 'effects.drag_moment', 'the moment of the air differs', problems)
        end if
        if (friction_jams(principal, effects%friction_arm)) then
            call problems%add('effects.friction_coefficient', 'friction may jam the body: m mu rho |[r]x I^-1| is 1 or more, &
                &so that the load of the pivot need not exist', 'use a smaller friction_coefficient or friction_radius')
            return
        end if
        body%effects = effects
    end subroutine make_effects

    !> Warnings of a computation: smoothed friction that makes the equations stiff, and steps of fixed size across the
    !> knots of a table.
    subroutine warn_of_effects(body, t_end, has_fixed_steps, problems)
        type(body_t), intent(in) :: body !! mass properties about the fixed point, with effects or not
        real(dp), intent(in) :: t_end !! length of the span, s
        logical, intent(in) :: has_fixed_steps !! whether the step size is fixed
        type(problems_t), intent(inout) :: problems !! warnings are added
        real(dp), parameter :: stiff = 1.0e6_dp
        real(dp) :: dry
        integer :: order
        if (.not. allocated(body%effects)) return
        associate (effects => body%effects)
            dry = effects%friction_torque + effects%friction_arm * body%mass * body%gravity
            if (effects%friction_smoothing > 0) then
                if (t_end * dry > stiff * effects%friction_smoothing * minval(body%inertia)) then
                    call problems%warn('effects.friction_smoothing', 'the smoothed friction makes the equations stiff', &
                                       'use an implicit method such as arkode_dirk, a larger value, or 0, the exact law')
                end if
            end if
            if (.not. has_fixed_steps) return
            if (allocated(effects%friction_table)) call limit(key_of_friction, effects%friction_table%interpolation + 1)
            if (.not. allocated(effects%table)) return
            order = effects%table%interpolation + 1
            if (any(effects%table%is_jump)) order = 1
            if (any(effects%table%knots > 0 .and. effects%table%knots < t_end)) call limit(key_of_torques, order)
        end associate

    contains

        !> Warns that a table limits the order of a method.
        subroutine limit(key, order)
            character(*), intent(in) :: key
            integer, intent(in) :: order
            call problems%warn(key, 'steps of fixed size do not end at the rows of the table: the order of the method is ' // &
                               to_text(order) // ' at most', 'use a method with step control')
        end subroutine limit

    end subroutine warn_of_effects

    !> Dry friction, and its table, which was read before and whose value at rest is dry friction.
    subroutine read_friction(scene, effects, problems)
        type(effects_scene_t), intent(in) :: scene
        type(effects_t), intent(inout) :: effects
        type(problems_t), intent(inout) :: problems
        integer :: interpolation

        effects%friction_torque = given(scene%friction_torque)
        effects%friction_smoothing = given(scene%friction_smoothing)
        effects%friction_arm = given(scene%friction_coefficient) * given(scene%friction_radius)
        if (is_set(scene%friction_coefficient) .and. .not. is_set(scene%friction_radius)) then
            call problems%add('effects.friction_coefficient', 'the moment of friction needs the radius of the pivot', &
                              'give friction_radius too')
        else if (is_set(scene%friction_radius) .and. .not. is_set(scene%friction_coefficient)) then
            call problems%add('effects.friction_radius', 'the moment of friction needs a coefficient', &
                              'give friction_coefficient too')
        end if
        if (is_set(scene%friction_smoothing) .and. .not. (is_set(scene%friction_torque) .or. scene%friction_table /= '' &
                                                          .or. is_set(scene%friction_coefficient))) then
            call problems%add('effects.friction_smoothing', 'there is no dry friction to smooth', &
                              'give friction_torque, or friction_coefficient and friction_radius')
        end if
        if (scene%friction_table == '' .and. scene%friction_interpolation /= '') then
            call problems%add('effects.friction_interpolation', 'there is no table of friction', 'give friction_table too')
        end if
        if (.not. allocated(scene%friction_rates)) return
        interpolation = interpolation_of(scene%friction_interpolation)
        associate (dry => scene%friction_torques(1), omega => scene%friction_rates, friction => scene%friction_torques)
            if (effects%friction_smoothing > 0 .and. driving_row(omega, friction - dry, interpolation) > 0) then
                call problems%add('effects.friction_smoothing', 'the friction of the table falls from its value at rest, which &
                                  &smoothed would be less, so that the rest would drive the body', 'leave it out')
                return
            end if
            effects%friction_torque = effects%friction_torque + dry
            allocate (effects%friction_table)
            call make_friction_table(omega, friction, interpolation, effects%friction_table)
        end associate
    end subroutine read_friction

    !> A harmonic torque, if its amplitude is not zero.
    subroutine read_harmonic_torque(name, swing, harmonic, problems)
        character(*), intent(in) :: name !! of the keys, up to `_amplitude`
        type(swing_t), intent(in) :: swing
        type(harmonic_t), allocatable, intent(inout) :: harmonic
        type(problems_t), intent(inout) :: problems
        real(dp) :: angle(3)
        call read_swing(name, 'the harmonic torque', swing, angle, problems)
        if (all(is_zero(given(swing%amplitude))) .or. .not. is_set(swing%rate)) return
        harmonic = harmonic_t(given(swing%amplitude), angle, swing%rate)
    end subroutine read_harmonic_torque

    !> The phases of what has amplitudes, a rate and phases, which must be given together.
    subroutine read_swing(name, what, swing, angle, problems)
        character(*), intent(in) :: name, what !! of the keys, up to `_amplitude`; the same in words
        type(swing_t), intent(in) :: swing
        real(dp), intent(out) :: angle(3) !! the phases, rad
        type(problems_t), intent(inout) :: problems
        logical :: swings

        angle = given(swing%phase)
        if (any(is_set(swing%phase_deg))) then
            angle = given(swing%phase_deg) * degree
            if (any(is_set(swing%phase))) call problems%add('effects.' // name // '_phase_deg', 'the phases are given twice', &
                                                            'give them either in radians or in degrees')
        end if
        swings = any(is_set(swing%amplitude))
        if (swings .and. .not. is_set(swing%rate)) then
            call problems%add('effects.' // name // '_amplitude', what // ' has an amplitude without a rate', &
                              'give ' // name // '_rate too')
        else if (.not. swings .and. is_set(swing%rate)) then
            call problems%add('effects.' // name // '_rate', what // ' has a rate without an amplitude', &
                              'give ' // name // '_amplitude(3) too')
        else if (.not. swings .and. any(is_set([swing%phase, swing%phase_deg]))) then
            call problems%add('effects.' // name // '_phase', what // ' has phases without an amplitude', &
                              'give ' // name // '_amplitude(3) and ' // name // '_rate too')
        end if
    end subroutine read_swing

    !> The rotation of the Earth.
    subroutine read_earth_rotation(scene, effects, problems)
        type(effects_scene_t), intent(in) :: scene
        type(effects_t), intent(inout) :: effects
        type(problems_t), intent(inout) :: problems
        real(dp), parameter :: right_angle = 90
        real(dp) :: latitude
        latitude = given(scene%latitude)
        if (is_set(scene%latitude_deg)) then
            ! A pole is one exactly.
            latitude = scene%latitude_deg * degree
            if (abs(scene%latitude_deg) >= right_angle) latitude = sign(acos(0.0_dp), latitude)
            if (is_set(scene%latitude)) then
                call problems%add('effects.latitude_deg', 'the latitude is given twice', &
                                  'give it either in radians or in degrees')
            end if
        end if
        call effects%turn_with_earth(given(scene%earth_rate), latitude)
        if (is_set(scene%earth_rate) .neqv. (is_set(scene%latitude) .or. is_set(scene%latitude_deg))) then
            if (is_set(scene%earth_rate)) then
                call problems%add('effects.earth_rate', 'the rotation of the Earth needs a latitude', &
                                  'give latitude or latitude_deg too')
            else
                call problems%add(merge('effects.latitude    ', 'effects.latitude_deg', is_set(scene%latitude)), &
                                  'a latitude without the rotation of the Earth has no effect', &
                                  'give earth_rate too, 7.292115e-5 for the Earth')
            end if
        end if
    end subroutine read_earth_rotation

    !> Reads and checks the tables of torques and of friction; problems are reported, and then the scene has none.
    subroutine read_effect_tables(input, scene, problems)
        character(*), intent(in) :: input !! path of the input: those of the tables are relative to it
        type(effects_scene_t), intent(inout) :: scene !! what is in the tables is set
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(table_t) :: table
        real(dp), allocatable :: values(:, :)
        integer :: fewest, interpolation

        if (scene%torque_table /= '') then
            fewest = fewest_rows(interpolation_of(scene%torque_interpolation))
            call read_columns(path_from(input, scene%torque_table), key_of_torques, columns_of_torques, fewest, table, values, &
                              problems)
            if (.not. problems%any()) call check_times(values(:, 1), fewest, problems)
            if (.not. problems%any()) then
                scene%table_times = values(:, 1)
                scene%table_torques = transpose(values(:, 2:))
            end if
        end if
        if (scene%friction_table == '') return
        interpolation = interpolation_of(scene%friction_interpolation)
        call read_columns(path_from(input, scene%friction_table), key_of_friction, columns_of_friction, &
                          fewest_rows(interpolation), table, values, problems)
        if (.not. problems%any()) call check_friction(table, values(:, 1), values(:, 2), interpolation, problems)
        if (problems%any()) return
        scene%friction_rates = values(:, 1)
        scene%friction_torques = values(:, 2)
    end subroutine read_effect_tables

    !> Reads columns of a table that an input names, with finite numbers in enough rows.
    subroutine read_columns(path, key, names, fewest, table, values, problems)
        character(*), intent(in) :: path, key, names(:) !! of the file, of the input, of the columns
        integer, intent(in) :: fewest !! rows that the interpolation needs
        type(table_t), intent(out) :: table
        real(dp), allocatable, intent(out) :: values(:, :) !! rows, columns
        type(problems_t), intent(inout) :: problems
        type(error_t), allocatable :: error
        real(dp), allocatable :: column(:)
        integer :: i

        call read_table(path, table, error)
        do i = 1, size(names)
            if (.not. allocated(error)) call table%read_column(trim(names(i)), column, error)
            if (allocated(error)) then
                call problems%add(key, error%message, 'its columns are ' // join(names, ', ') // '; ' // beside_input)
                return
            end if
            if (i == 1) allocate (values(size(column), size(names)))
            values(:, i) = column
        end do
        if (size(column) < fewest) then
            call problems%add(key, 'the table has ' // to_text(size(column)) // ' rows, too few for this interpolation', &
                              'it needs ' // to_text(fewest) // ' at least')
            return
        end if
        do i = 1, size(column)
            if (all(is_finite(values(i, :)))) cycle
            call problems%add(key, table%place_of_row(i) // ': row ' // to_text(i) // ' has a value that is not finite', &
                              'give finite numbers')
            return
        end do
    end subroutine read_columns

    !> Checks that the times are in increasing order from the start or before; two of one time are a jump, with enough rows on
    !> each side.
    subroutine check_times(t, fewest, problems)
        real(dp), intent(in) :: t(:)
        integer, intent(in) :: fewest !! rows that the interpolation needs
        type(problems_t), intent(inout) :: problems
        integer :: i, last

        do i = 2, size(t)
            if (t(i) > t(i - 1) .or. (is_equal(t(i), t(i - 1)) .and. .not. is_equal(t(i), t(max(1, i - 2))))) cycle
            call problems%add(key_of_torques, 'the times of the table do not increase: t = ' // to_text(t(i)) // ' in row ' // &
                              to_text(i), 'sort the rows by t, each time once, or twice where the torque jumps')
            return
        end do
        i = 1
        do while (i <= size(t))
            last = last_of_piece(t, i)
            if (last - i + 1 < fewest) then
                call problems%add(key_of_torques, 'the piece of the table from t = ' // to_text(t(i)) // ' to ' // &
                                  to_text(t(last)) // ', up to a jump, has ' // to_text(last - i + 1) // &
                                  ' rows, too few for this interpolation', 'it needs ' // to_text(fewest) // ' at least')
                return
            end if
            i = last + 1
        end do
        if (t(1) > 0) call problems%add(key_of_torques, 'the table begins at t = ' // to_text(t(1)) // ', after the start', &
                                        'its first row is at t = 0 or before')
    end subroutine check_times

    !> Checks that the angular velocities increase from zero, and that friction nowhere drives the body.
    subroutine check_friction(table, omega, friction, interpolation, problems)
        type(table_t), intent(in) :: table !! for places in the file
        real(dp), intent(in) :: omega(:), friction(:)
        integer, intent(in) :: interpolation
        type(problems_t), intent(inout) :: problems
        integer :: row

        if (omega(1) < 0 .or. omega(1) > 0) then
            call problems%add(key_of_friction, table%place_of_row(1) // ': the table begins at omega3 = ' // to_text(omega(1)), &
                              'its first row is at omega3 = 0, with the dry friction; negative ones follow by symmetry')
            return
        end if
        do row = 2, size(omega)
            if (omega(row) > omega(row - 1)) cycle
            call problems%add(key_of_friction, table%place_of_row(row) // ': omega3 = ' // to_text(omega(row)) // &
                              ' is not larger than in the row before', 'sort the rows by omega3, each once')
            return
        end do
        row = findloc(friction < 0, .true., dim=1)
        if (row > 0) then
            call problems%add(key_of_friction, table%place_of_row(row) // ': friction_torque = ' // to_text(friction(row)) // &
                              ' would drive the body', 'a moment against the rotation is positive')
            return
        end if
        row = driving_row(omega, friction, interpolation)
        if (row > 0) call problems%add(key_of_friction, table%place_of_row(row) // ': from this row to the next the spline is &
                                       &negative, which would drive the body', &
                                       'give more rows, or friction_interpolation = ''monotone''')
    end subroutine check_friction

end module spintop_effects_of_scene
