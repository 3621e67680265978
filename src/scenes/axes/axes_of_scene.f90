!> Makes the axes of a sweep from the description in a scene, and reports the problems of that description.
module spintop_axes_of_scene
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, is_equal, is_finite
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: is_set, parameter_table_t, unset, unset_integer
    use spintop_problems, only: problems_t
    use spintop_sobol_sequence, only: most_sobol_dimensions
    use spintop_scene_keys, only: max_axes, max_list_axes, scene_t, combination_names, combine_grid, combine_saltelli, &
        combine_sobol, combine_zip
    use spintop_sweep_axes, only: axes_t, axis_t, base_of
    use spintop_sweep_axis, only: factor_covariance, law_lognormal, law_names, law_normal, law_sphere, law_uniform, &
        sphere_attitude, sphere_direction, sphere_inclination, sphere_turn
    use spintop_text, only: join, to_text
    use spintop_units, only: find_unit, units_of
    implicit none
    private
    public :: make_axes, find_swept, find_axis, find_in_unit, count_axes

    !> Parameters of the sweep as a whole, which cannot vary from case to case.
    character(*), parameter :: fixed(*) = [character(15) :: 'sweep.', 'statistics.', 'work_precision.', &
        'stability.', 'fit.', 'sensor.', 'output.', 'span.samples', 'span.stop_after']

    !> The parameters that can be uniform on a sphere, and what each of them is.
    character(*), parameter :: on_sphere(*) = [character(18) :: 'initial.quaternion', 'initial.omega', &
        'top.centre_of_mass', 'initial.theta', 'initial.theta_deg', 'initial.phi', 'initial.phi_deg', 'initial.psi', &
        'initial.psi_deg']
    integer, parameter :: sphere_of(size(on_sphere)) = [sphere_attitude, sphere_direction, sphere_direction, &
        sphere_inclination, sphere_inclination, sphere_turn, sphere_turn, sphere_turn, sphere_turn]
    !> Components of each kind.
    integer, parameter :: components(4) = [4, 3, 1, 1]
    !> A normal value is never as many deviations from the mean.
    real(dp), parameter :: most_deviations = 9
    !> Relative rounding error of the spacing that is allowed for an integer.
    real(dp), parameter :: spacing_slack = 8 * epsilon(1.0_dp)

contains

    !> The axes of a scene; `table` contains the parameters that can vary. With problems the axes have no
    !> cases.
    subroutine make_axes(scene, table, axes, problems)
        type(scene_t), target, intent(in) :: scene !! contents of the input
        type(parameter_table_t), intent(in) :: table !! its parameters
        type(axes_t), intent(out) :: axes !! the axes; without cases if there are problems
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        real(dp), allocatable :: factor(:, :)
        integer :: combination, i, k, made
        logical :: is_given, is_made

        if (count_axes(scene) == 0) then
            call problems%add('sweep', 'a sweep needs an axis', &
                              "give for example parameter(1) = 'initial.spin_ratio' and its values, or a table")
            return
        end if
        combination = findloc(combination_names, scene%combine, dim=1)
        is_given = scene%cases /= unset_integer
        if (is_drawn(scene) .and. .not. is_given) then
            call problems%add('sweep.combine', 'the number of random cases is not given', 'give cases')
        else if (is_given .and. .not. is_drawn(scene)) then
            call problems%add('sweep.cases', 'the number of cases of a ' // trim(scene%combine) // ' follows from its values', &
                              "omit it, or use combine = 'random' or 'latin_hypercube'")
        end if
        ! One axis for each number that varies, several for a vector that is drawn as a whole.
        allocate (axes%axis(sum([(components_of(scene, i), i=1, count_axes(scene))])))
        made = 0
        do i = 1, count_axes(scene)
            do k = 1, components_of(scene, i)
                made = made + 1
                axes%axis(made)%component = k
                axes%axis(made)%components = components_of(scene, i)
                call make_axis(scene, i, axes%axis(:made - 1), table, axes%axis(made), is_made, problems)
                if (.not. is_made) exit
            end do
        end do
        call read_covariance(scene, combination == combine_saltelli, factor, problems)
        if (.not. problems%any()) call check_design(scene, combination, axes%axis, problems)
        if (problems%any()) return
        call axes%combine(combination, scene%cases, int(scene%seed, int64))
        if (size(factor) > 0) call axes%correlate(factor)
        if (axes%cases == 0) then
            call problems%add('sweep.count', 'the grid has more than 1e15 cases', 'use fewer values')
        end if
    end subroutine make_axes

    !> Checks that axes side by side have as many values each, and that a sample has the number of cases and of dimensions that
    !> its design can have.
    subroutine check_design(scene, combination, axis, problems)
        type(scene_t), intent(in) :: scene
        integer, intent(in) :: combination
        type(axis_t), intent(in) :: axis(:)
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: lengths
        integer(int64) :: group, nearest
        integer :: k

        if (combination == combine_zip .and. any(axis%count /= axis(1)%count)) then
            lengths = ''
            do k = 1, size(axis)
                if (k > 1) lengths = lengths // ', '
                lengths = lengths // axis(k)%name // ' has ' // to_text(axis(k)%count)
            end do
            call problems%add('sweep.combine', 'axes side by side need equal numbers of values: ' // lengths, &
                              "give equal numbers of values, or use combine = 'grid'")
        else if (combination == combine_sobol .or. combination == combine_saltelli) then
            ! The design of Saltelli has two coordinates for each dimension.
            if (merge(1, 2, combination == combine_sobol) * sum(axis%dimensions()) > most_sobol_dimensions) then
                call problems%add('sweep.combine', 'the sample has more dimensions than there are direction numbers for', &
                                  'use fewer axes, or another design')
            end if
        end if
        if (combination /= combine_saltelli) return
        group = count(axis%component == 1) + 2
        if (mod(scene%cases, group) == 0) return
        nearest = max(group, (scene%cases + group / 2) / group * group)
        call problems%add('sweep.cases', 'sensitivity indices need groups of ' // to_text(group) // ' cases', &
                          'give a multiple, such as ' // to_text(nearest))
    end subroutine check_design

    !> An axis: the number that varies, and its values.
    subroutine make_axis(scene, i, others, table, axis, is_made, problems)
        type(scene_t), intent(in) :: scene
        integer, intent(in) :: i !! number of the axis in it
        type(axis_t), intent(in) :: others(:) !! those before it
        type(parameter_table_t), intent(in) :: table
        type(axis_t), intent(inout) :: axis !! its component is known
        logical, intent(out) :: is_made !! whether the number that varies was found
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: problem, hint
        logical :: found

        is_made = .false.
        axis%name = trim(scene%parameter(i))
        if (axis%components > 1) axis%name = axis%name // '(' // to_text(axis%component) // ')'
        if (axis%name == '') then
            call problems%add(key_of(i, 'parameter'), called(i) // ' has no parameter', &
                              'number the axes without gaps; decimals follow a point, as in 25.5')
            return
        end if
        call find_axis(axis, others, table, problem, hint)
        if (problem /= '') then
            call problems%add(key_of(i, 'parameter'), problem, hint)
            return
        end if
        is_made = .true.
        if (law_of(scene, i) /= law_uniform) then
            call read_law(scene, i, axis, problems)
            return
        end if
        if (is_set(scene%mean(i)) .or. is_set(scene%deviation(i))) then
            call problems%add(key_of(i, 'distribution'), 'the values of ' // called(i) // ' are uniform', &
                              "omit mean and deviation, or use distribution = 'normal' or 'lognormal'")
        end if
        call read_values(scene, i, axis, found, problems)
        if (found) call check_values(i, axis, problems)
    end subroutine make_axis

    !> The values listed, or with equal differences or equal ratios, or the ends of an interval; `found` tells whether there are
    !> any.
    subroutine read_values(scene, i, axis, found, problems)
        type(scene_t), intent(in) :: scene
        integer, intent(in) :: i !! number of the axis in it
        type(axis_t), intent(inout) :: axis
        logical, intent(out) :: found
        type(problems_t), intent(inout) :: problems
        real(dp) :: distance
        logical :: has_ends

        has_ends = is_set(scene%from(i)) .and. is_set(scene%to(i))
        found = .true.
        if (size(listed_of(scene, i)) > 0) then
            if (is_set(scene%from(i)) .or. is_set(scene%to(i)) .or. scene%count(i) /= unset_integer) then
                call problems%add('sweep.values', 'the values of ' // called(i) // ' are given twice', &
                                  'give either values, or from, to and count')
            end if
            axis%listed = listed_of(scene, i)
            axis%count = size(listed_of(scene, i))
        else if (has_ends .and. is_drawn(scene) .and. scene%count(i) /= unset_integer) then
            found = .false.
            call problems%add(key_of(i, 'count'), 'a random axis has no number of values', &
                              'omit it; sweep.cases is the number of cases')
        else if (has_ends .and. (is_drawn(scene) .or. scene%count(i) /= unset_integer)) then
            axis%from = scene%from(i)
            axis%to = scene%to(i)
            if (.not. is_drawn(scene)) axis%count = scene%count(i)
            axis%logarithmic = scene%spacing(i) == 'log'
            distance = axis%to - axis%from
            if (axis%logarithmic .and. .not. min(axis%from, axis%to) > 0) then
                call problems%add('sweep.spacing', 'logarithmic spacing needs positive ends', &
                                  "use spacing = 'linear' or other ends")
                return
            end if
            if (axis%logarithmic) distance = max(axis%from, axis%to) / min(axis%from, axis%to)
            if (.not. is_finite(distance)) then
                call problems%add(key_of(i, 'to'), 'the ends of ' // called(i) // ' are too far apart', 'use other ends')
            end if
        else
            found = .false.
            call problems%add(key_of(i, 'parameter'), called(i) // ' has no values', 'give values, or ' // &
                              trim(merge('from and to       ', 'from, to and count', is_drawn(scene))))
        end if
    end subroutine read_values

    !> Checks that all listed values, or both ends of an interval, are in the range of the parameter, and are
    !> whole numbers if it is an integer.
    subroutine check_values(i, axis, problems)
        integer, intent(in) :: i !! number of the axis in the scene
        type(axis_t), intent(in) :: axis
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: place
        integer :: k

        if (allocated(axis%listed)) then
            do k = 1, axis%count
                place = 'sweep.values(' // to_text(i) // ',' // to_text(k) // ')'
                if (is_refused(axis%listed(k), place)) return
            end do
            return
        end if
        if (is_refused(axis%from, key_of(i, 'from'))) return
        if (is_refused(axis%to, key_of(i, 'to'))) return
        if (.not. axis%whole) return
        do k = 1, axis%count
            associate (value => axis%unrounded(k))
                if (abs(value - anint(value)) <= spacing_slack * abs(value)) cycle
                if (is_refused(value, key_of(i, 'parameter'))) return
            end associate
        end do

    contains

        !> Whether the parameter cannot have a value, which then is a problem of a key.
        logical function is_refused(value, key)
            real(dp), intent(in) :: value
            character(*), intent(in) :: key
            character(:), allocatable :: reason
            reason = axis%slot%refusal(value)
            is_refused = reason /= ''
            if (is_refused) call problems%add(key, axis%name // ' ' // reason, 'change the values of the axis')
        end function is_refused

    end subroutine check_values

    !> Number of components of the parameter of an axis: those of a vector that is drawn as a whole, else 1.
    pure integer function components_of(scene, i)
        type(scene_t), intent(in) :: scene
        integer, intent(in) :: i !! number of the axis in it
        integer :: place
        components_of = 1
        place = findloc(on_sphere, scene%parameter(i), dim=1)
        if (law_of(scene, i) == law_sphere .and. place > 0) components_of = components(sphere_of(place))
    end function components_of

    !> Reads the distribution of an axis that is not uniform over an interval: what lies on a sphere, or mean and standard
    !> deviation of a value or of its logarithm.
    subroutine read_law(scene, i, axis, problems)
        type(scene_t), intent(in) :: scene
        integer, intent(in) :: i !! number of the axis in it
        type(axis_t), intent(inout) :: axis !! its name, slot and component are known
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: name
        real(dp) :: largest, limit
        integer :: place

        name = trim(scene%parameter(i))
        axis%law = law_of(scene, i)
        if (is_set(scene%mean(i))) axis%mean = scene%mean(i)
        place = findloc(on_sphere, name, dim=1)
        if (axis%law == law_sphere .and. place > 0) axis%sphere = sphere_of(place)
        if (axis%component > 1) return
        if (is_set(scene%deviation(i))) axis%deviation = scene%deviation(i)
        if (is_set(scene%covariance(i, i))) axis%deviation = sqrt(max(0.0_dp, scene%covariance(i, i)))
        largest = abs(axis%mean) + most_deviations * axis%deviation
        limit = merge(log(huge(limit)), huge(limit), axis%law == law_lognormal)
        if (.not. is_drawn(scene)) then
            call refuse('distribution', 'a distribution needs a random sample', &
                        "use combine = 'random', 'latin_hypercube' or 'sobol'")
        else if (size(listed_of(scene, i)) > 0 .or. is_set(scene%from(i)) .or. is_set(scene%to(i)) &
                 .or. scene%count(i) /= unset_integer .or. scene%spacing(i) == 'log') then
            call refuse('distribution', called(i) // ' has a distribution and values', &
                        "omit values, from, to, count and spacing, or use distribution = 'uniform'")
        else if (axis%law == law_sphere) then
            if (axis%sphere == 0) then
                call refuse('distribution', name // ' is neither an attitude nor a direction', &
                            "'sphere' is for " // join(on_sphere, ', '))
            else if (is_set(scene%deviation(i))) then
                call refuse('deviation', "distribution 'sphere' has no deviation", 'omit it')
            else if (axis%sphere == sphere_direction .and. .not. axis%mean > 0) then
                call refuse('mean', 'the magnitude of ' // name // ' is not given', 'give mean > 0, the magnitude of the vector')
            else if (axis%sphere /= sphere_direction .and. is_set(scene%mean(i))) then
                call refuse('mean', "distribution 'sphere' of " // name // ' has no mean', 'omit it')
            end if
        else if (axis%whole) then
            call refuse('distribution', axis%name // ' is a whole number', "use distribution = 'uniform'")
        else if (.not. is_set(scene%mean(i))) then
            call refuse('parameter', called(i) // ' has no mean', 'give mean and deviation')
        else if (is_set(scene%deviation(i)) .and. is_set(scene%covariance(i, i))) then
            call refuse('deviation', 'the deviation of ' // called(i) // ' is given twice', &
                        'omit it, or its variance in the covariance')
        else if (.not. axis%deviation > 0) then
            call refuse('parameter', called(i) // ' has no deviation', 'give deviation > 0, or a covariance')
        else if (.not. largest < limit) then
            call refuse('deviation', 'the values of ' // called(i) // ' can be too large', 'use another mean or deviation')
        end if

    contains

        !> A problem of a key of the axis.
        subroutine refuse(key, message, hint)
            character(*), intent(in) :: key, message, hint
            call problems%add(key_of(i, key), message, hint)
        end subroutine refuse

    end subroutine read_law

    !> Reads the covariance of normal values, or of the logarithms of log-normal ones: the lower triangular factor of the axes
    !> with such values in their order; empty where no covariance is given.
    subroutine read_covariance(scene, independent, factor, problems)
        type(scene_t), intent(in) :: scene !! contents of the input
        logical, intent(in) :: independent !! whether the axes must be independent
        real(dp), allocatable, intent(out) :: factor(:, :) !! the factor
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        real(dp), allocatable :: covariance(:, :)
        integer, allocatable :: normal(:)
        logical :: positive
        integer :: i

        allocate (factor(0, 0), normal(0))
        if (.not. any(is_set(scene%covariance))) return
        do i = 1, count_axes(scene)
            if (any(law_of(scene, i) == [law_normal, law_lognormal])) normal = [normal, i]
        end do
        call check_covariance(scene, normal, problems)
        if (independent .and. .not. problems%any()) then
            call problems%add('sweep.covariance', 'sensitivity indices need independent axes', 'omit the covariance')
        end if
        if (problems%any()) return
        allocate (covariance(size(normal), size(normal)))
        covariance(:, :) = scene%covariance(normal, normal)
        do i = 1, size(normal)
            ! One of two mirrored elements may be given, or a deviation in place of a variance.
            where (.not. is_set(covariance(:, i))) covariance(:, i) = scene%covariance(normal(i), normal)
            if (.not. is_set(covariance(i, i))) covariance(i, i) = scene%deviation(normal(i))**2
        end do
        where (.not. is_set(covariance)) covariance = 0
        deallocate (factor)
        allocate (factor(size(normal), size(normal)))
        call factor_covariance(covariance, factor, positive)
        if (.not. positive) then
            call problems%add('sweep.covariance', 'the covariance matrix is not positive definite', &
                              'each correlation is between -1 and 1, and all together are those of some variables')
        end if
    end subroutine read_covariance

    !> Checks that covariances are those of axes with normal values, and that the matrix is symmetric.
    subroutine check_covariance(scene, normal, problems)
        type(scene_t), intent(in) :: scene
        integer, intent(in) :: normal(:)
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: key
        integer :: i, j

        do i = 1, size(scene%covariance, 1)
            do j = 1, size(scene%covariance, 2)
                associate (one => scene%covariance(i, j), mirrored => scene%covariance(j, i))
                    if (.not. is_set(one)) cycle
                    key = 'sweep.covariance(' // to_text(i) // ',' // to_text(j) // ')'
                    if (abs(one) > 0 .and. .not. (any(normal == i) .and. any(normal == j))) then
                        call problems%add(key, 'a covariance is that of two axes with normal values', &
                                          "use distribution = 'normal' or 'lognormal', or omit it")
                        return
                    else if (is_set(mirrored) .and. .not. is_equal(one, mirrored)) then
                        call problems%add(key, 'the covariance is not symmetric', 'give each covariance once')
                        return
                    end if
                end associate
            end do
        end do
    end subroutine check_covariance

    !> Whether the cases of a sweep are a sample.
    pure logical function is_drawn(scene)
        type(scene_t), intent(in) :: scene !! contents of the input
        is_drawn = all(scene%combine /= combination_names([combine_grid, combine_zip]))
    end function is_drawn

    !> Index of the last axis for which anything is given; 0 if there is none.
    pure integer function count_axes(scene) result(count)
        type(scene_t), intent(in) :: scene !! contents of the input
        do count = max_axes, 1, -1
            if (scene%parameter(count) /= '' .or. scene%count(count) /= unset_integer .or. any(is_set( &
                [scene%from(count), scene%to(count), scene%mean(count), scene%deviation(count), &
                 scene%covariance(count, :)])) .or. scene%distribution(count) /= '') return
            ! Only the first axes have lists.
            if (is_set(scene%values(min(count, max_list_axes), 1)) .and. count <= max_list_axes) return
        end do
    end function count_axes

    !> The listed values of an axis.
    pure function listed_of(scene, i) result(values)
        type(scene_t), intent(in) :: scene
        integer, intent(in) :: i
        real(dp), allocatable :: values(:)
        integer :: n
        n = 0
        if (i <= max_list_axes) n = findloc(is_set([scene%values(i, :), unset]), .false., dim=1) - 1
        allocate (values, source=scene%values(min(i, max_list_axes), :n))
    end function listed_of

    !> The distribution of an axis by its place in `law_names`.
    pure integer function law_of(scene, i)
        type(scene_t), intent(in) :: scene
        integer, intent(in) :: i
        law_of = max(law_uniform, findloc(law_names, scene%distribution(i), dim=1))
    end function law_of

    !> Finds the number that a parameter contains; `problem` is the reason why it cannot vary, or ''.
    subroutine find_swept(name, table, slot, problem, hint)
        character(*), intent(in) :: name !! name of a parameter, as `top.inertia(2)`
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(number_slot_t), intent(out) :: slot !! the element, if there is no problem
        character(:), allocatable, intent(out) :: problem, hint !! why it cannot vary, and what to do; '' if it can vary
        integer :: i
        call table%find_number(name, slot, problem)
        hint = '`spintop list parameters` shows them all'
        do i = 1, size(fixed)
            if (problem /= '' .or. index(name, trim(fixed(i))) /= 1) cycle
            problem = name // ' cannot vary'
            hint = 'vary a parameter of the top, its start, its span or its integration'
        end do
    end subroutine find_swept

    !> Finds the number of an axis by its name, which may end in a unit.
    subroutine find_axis(axis, others, table, problem, hint)
        type(axis_t), intent(inout) :: axis !! its name; it gets its key, slot and unit
        type(axis_t), intent(in) :: others(:) !! those before it
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        character(:), allocatable, intent(out) :: problem, hint !! why it cannot vary, and what to do; '' if it can vary
        character(:), allocatable :: units
        real(dp) :: factor
        call find_in_unit(axis%name, table, axis%key, axis%unit, factor, units)
        call find_swept(axis%key, table, axis%slot, problem, hint)
        axis%slot%size = factor
        axis%whole = axis%slot%is_whole()
        if (problem /= '' .and. units /= '') hint = units
        if (problem /= '' .or. .not. any(others%slot%is_same(axis%slot))) return
        problem = axis%name // ' is on two axes'
        hint = 'vary it on one'
    end subroutine find_axis

    !> The key and the unit in a name: `initial.omega3_rpm` is the key initial.omega3 in rpm. Any other name is its own key.
    subroutine find_in_unit(name, table, key, unit, factor, hint)
        character(*), intent(in) :: name !! of a number of the input
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        character(:), allocatable, intent(out) :: key, unit !! the unit is '' if the key is not known
        real(dp), intent(out) :: factor !! size of the unit in that of the key
        character(:), allocatable, intent(out) :: hint !! the units of a known key that has no such unit, or ''
        character(:), allocatable :: own, problem
        integer :: last, place

        key = name
        unit = ''
        factor = 1
        hint = ''
        place = table%find(base_of(name))
        if (place > 0) unit = trim(table%parameters(place)%unit)
        last = index(name, '_', back=.true.)
        if (place > 0 .or. last == 0) return
        place = table%find(base_of(name(:last - 1)))
        if (place == 0) return
        own = trim(table%parameters(place)%unit)
        call find_unit(name(last + 1:), own, unit, factor, problem)
        if (problem == '') key = name(:last - 1)
        if (problem /= '') hint = name(:last - 1) // ' is in ' // own // '; ' // units_of(own)
    end subroutine find_in_unit

    !> A key of an axis: `sweep.from(2)`.
    pure function key_of(i, name) result(key)
        integer, intent(in) :: i
        character(*), intent(in) :: name !! of the key without its group
        character(:), allocatable :: key
        key = 'sweep.' // name // '(' // to_text(i) // ')'
    end function key_of

    !> An axis in a message: `axis 2`.
    pure function called(i)
        integer, intent(in) :: i
        character(:), allocatable :: called
        called = 'axis ' // to_text(i)
    end function called

end module spintop_axes_of_scene
