!> The axes of a sweep as a scene describes them: their entries, their distributions, and the problems of that description.
module spintop_axis_laws
    use spintop_compare, only: is_equal
    use spintop_kinds, only: dp
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: is_set, parameter_table_t, unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t, max_axes, max_list_axes
    use spintop_scene_words, only: combination_names, combine_grid, combine_zip
    use spintop_sweep_axis, only: factor_covariance, law_lognormal, law_normal, law_sphere, sphere_attitude, &
        sphere_direction, sphere_inclination, sphere_turn, axis_t, law_names, law_uniform
    use spintop_text, only: join, to_text
    implicit none
    private
    public :: components_of, read_law, read_covariance, axis_entry_t, entry_of, count_axes, find_swept, is_drawn

    !> Parameters of the sweep as a whole, which cannot vary from case to case.
    character(*), parameter :: fixed(*) = [character(15) :: 'sweep.', 'statistics.', 'work_precision.', &
        'stability.', 'fit.', 'sensor.', 'output.', 'span.samples', 'span.stop_after']

    !> What a scene says of one axis; what it leaves out is unset.
    type :: axis_entry_t
        integer :: number = 0
        character(:), allocatable :: name
        real(dp), allocatable :: listed(:)
        real(dp) :: from, to
        integer :: count = unset_integer
        logical :: logarithmic = .false.
        !> Values are drawn from the interval, which needs no count then.
        logical :: drawn = .false.
        !> Distribution by its place in `law_names`, its mean and its standard deviation.
        integer :: law = law_uniform
        real(dp) :: mean, deviation
        !> The variance, where the covariance matrix gives it.
        real(dp) :: variance
    contains
        procedure :: key
        procedure :: in_words
        procedure :: has_count
        procedure :: has_values
    end type axis_entry_t

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

contains

    !> Number of components of the parameter of an axis: those of a vector that is drawn as a whole, else 1.
    pure integer function components_of(entry)
        type(axis_entry_t), intent(in) :: entry !! what the scene says of the axis
        integer :: sphere
        components_of = 1
        if (entry%law /= law_sphere) return
        sphere = find_sphere(entry%name)
        if (sphere > 0) components_of = components(sphere)
    end function components_of

    !> What a parameter is that can be uniform on a sphere; 0 if it is none.
    pure integer function find_sphere(name) result(sphere)
        character(*), intent(in) :: name
        integer :: k
        sphere = 0
        do k = 1, size(on_sphere)
            if (on_sphere(k) == name) sphere = sphere_of(k)
        end do
    end function find_sphere

    !> Reads the distribution of an axis that is not uniform over an interval or a list; problems are reported once for all
    !> components of a vector.
    subroutine read_law(entry, axis, problems)
        type(axis_entry_t), intent(in) :: entry !! what the scene says of the axis
        type(axis_t), intent(inout) :: axis !! its name, slot and component are known
        type(problems_t), intent(inout) :: problems !! problems of the scene are added

        axis%law = entry%law
        if (is_set(entry%mean)) axis%mean = entry%mean
        if (axis%law == law_sphere) axis%sphere = find_sphere(entry%name)
        if (axis%component > 1) return
        if (.not. entry%drawn) then
            call problems%add(entry%key('distribution'), 'a distribution needs a random sample', &
                              "use combine = 'random', 'latin_hypercube' or 'sobol'")
        else if (entry%has_values()) then
            call problems%add(entry%key('distribution'), entry%in_words() // ' has a distribution and values', &
                              "omit values, from, to, count and spacing, or use distribution = 'uniform'")
        else if (axis%law == law_sphere) then
            call check_sphere(entry, axis, problems)
        else
            call read_normal(entry, axis, problems)
        end if
    end subroutine read_law

    !> Reports parameters of a distribution on an axis that is uniform.
    subroutine check_sphere(entry, axis, problems)
        type(axis_entry_t), intent(in) :: entry
        type(axis_t), intent(in) :: axis
        type(problems_t), intent(inout) :: problems
        if (axis%sphere == 0) then
            call problems%add(entry%key('distribution'), entry%name // ' is neither an attitude nor a direction', &
                              "'sphere' is for " // join(on_sphere, ', '))
        else if (is_set(entry%deviation)) then
            call problems%add(entry%key('deviation'), "distribution 'sphere' has no deviation", 'omit it')
        else if (axis%sphere == sphere_direction .and. .not. axis%mean > 0) then
            call problems%add(entry%key('mean'), 'the magnitude of ' // entry%name // ' is not given', &
                              'give mean > 0, the magnitude of the vector')
        else if (axis%sphere /= sphere_direction .and. is_set(entry%mean)) then
            call problems%add(entry%key('mean'), "distribution 'sphere' of " // entry%name // ' has no mean', 'omit it')
        end if
    end subroutine check_sphere

    !> Reads mean and standard deviation of a value or of its logarithm.
    subroutine read_normal(entry, axis, problems)
        type(axis_entry_t), intent(in) :: entry
        type(axis_t), intent(inout) :: axis
        type(problems_t), intent(inout) :: problems
        real(dp) :: largest, limit

        if (is_set(entry%deviation)) axis%deviation = entry%deviation
        if (is_set(entry%variance)) axis%deviation = sqrt(max(0.0_dp, entry%variance))
        if (axis%whole) then
            call problems%add(entry%key('distribution'), axis%name // ' is a whole number', "use distribution = 'uniform'")
        else if (.not. is_set(entry%mean)) then
            call problems%add(entry%key('parameter'), entry%in_words() // ' has no mean', 'give mean and deviation')
        else if (is_set(entry%deviation) .and. is_set(entry%variance)) then
            call problems%add(entry%key('deviation'), 'the deviation of ' // entry%in_words() // ' is given twice', &
                              'omit it, or its variance in the covariance')
        else if (.not. axis%deviation > 0) then
            call problems%add(entry%key('parameter'), entry%in_words() // ' has no deviation', &
                              'give deviation > 0, or a covariance')
        else
            largest = abs(axis%mean) + most_deviations * axis%deviation
            limit = merge(log(huge(limit)), huge(limit), axis%law == law_lognormal)
            if (.not. largest < limit) then
                call problems%add(entry%key('deviation'), 'the values of ' // entry%in_words() // ' can be too large', &
                                  'use another mean or deviation')
            end if
        end if
    end subroutine read_normal

    !> Reads the covariance of normal values, or of the logarithms of log-normal ones: the lower triangular factor of the axes
    !> with such values in their order; empty where no covariance is given.
    subroutine read_covariance(scene, entries, independent, factor, problems)
        type(scene_t), intent(in) :: scene !! contents of the input
        integer, intent(in) :: entries !! number of axes in the input
        logical, intent(in) :: independent !! whether the axes must be independent
        real(dp), allocatable, intent(out) :: factor(:, :) !! the factor
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(axis_entry_t) :: entry
        real(dp), allocatable :: covariance(:, :)
        integer, allocatable :: normal(:)
        logical :: positive
        integer :: i, j

        allocate (factor(0, 0), normal(0))
        if (.not. any(is_set(scene%covariance))) return
        do i = 1, entries
            entry = entry_of(scene, i)
            if (any(entry%law == [law_normal, law_lognormal])) normal = [normal, i]
        end do
        call check_covariance(scene, normal, problems)
        if (independent .and. .not. problems%any()) then
            call problems%add('sweep.covariance', 'sensitivity indices need independent axes', 'omit the covariance')
        end if
        if (problems%any()) return
        allocate (covariance(size(normal), size(normal)))
        do j = 1, size(normal)
            do i = 1, size(normal)
                covariance(i, j) = covariance_of(scene, normal(i), normal(j))
            end do
        end do
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
        integer :: i, j

        do i = 1, size(scene%covariance, 1)
            do j = 1, size(scene%covariance, 2)
                associate (one => scene%covariance(i, j), mirrored => scene%covariance(j, i))
                    if (.not. is_set(one)) cycle
                    if (abs(one) > 0 .and. .not. (any(normal == i) .and. any(normal == j))) then
                        call problems%add(key(i, j), 'a covariance is that of two axes with normal values', &
                                          "use distribution = 'normal' or 'lognormal', or omit it")
                        return
                    else if (is_set(mirrored) .and. .not. is_equal(one, mirrored)) then
                        call problems%add(key(i, j), 'the covariance is not symmetric', 'give each covariance once')
                        return
                    end if
                end associate
            end do
        end do

    contains

        !> The key of an element of the covariance.
        function key(i, j)
            integer, intent(in) :: i, j
            character(:), allocatable :: key
            key = 'sweep.covariance(' // to_text(i) // ',' // to_text(j) // ')'
        end function key

    end subroutine check_covariance

    !> A covariance, or a variance, that is given in some way; 0 if it is not.
    pure real(dp) function covariance_of(scene, i, j) result(covariance)
        type(scene_t), intent(in) :: scene
        integer, intent(in) :: i, j
        covariance = 0
        if (is_set(scene%covariance(i, j))) then
            covariance = scene%covariance(i, j)
        else if (is_set(scene%covariance(j, i))) then
            covariance = scene%covariance(j, i)
        else if (i == j) then
            covariance = scene%deviation(i)**2
        end if
    end function covariance_of

    !> What a scene says of axis `i`.
    pure type(axis_entry_t) function entry_of(scene, i) result(entry)
        type(scene_t), intent(in) :: scene !! contents of the input
        integer, intent(in) :: i !! number of the axis
        entry%number = i
        entry%name = trim(scene%parameter(i))
        if (i <= max_list_axes) then
            allocate (entry%listed, source=scene%values(i, :count_listed(scene%values(i, :))))
        else
            allocate (entry%listed(0))
        end if
        entry%from = scene%from(i)
        entry%to = scene%to(i)
        entry%count = scene%count(i)
        entry%logarithmic = scene%spacing(i) == 'log'
        entry%drawn = is_drawn(scene)
        entry%law = max(law_uniform, findloc(law_names, scene%distribution(i), dim=1))
        entry%mean = scene%mean(i)
        entry%deviation = scene%deviation(i)
        entry%variance = scene%covariance(i, i)
    end function entry_of

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

    !> Number of leading values that are given.
    pure integer function count_listed(values) result(count)
        real(dp), intent(in) :: values(:)
        do count = 0, size(values) - 1
            if (.not. is_set(values(count + 1))) return
        end do
        count = size(values)
    end function count_listed

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

    !> A key of the axis: `sweep.from(2)`.
    function key(self, name)
        class(axis_entry_t), intent(in) :: self
        character(*), intent(in) :: name !! of the key without its group
        character(:), allocatable :: key
        key = 'sweep.' // name // '(' // to_text(self%number) // ')'
    end function key

    !> The axis in a message: `axis 2`.
    function in_words(self)
        class(axis_entry_t), intent(in) :: self
        character(:), allocatable :: in_words
        in_words = 'axis ' // to_text(self%number)
    end function in_words

    !> Whether the number of values is given.
    pure logical function has_count(self)
        class(axis_entry_t), intent(in) :: self
        has_count = self%count /= unset_integer
    end function has_count

    !> Whether a list of values, an interval, or a part of one is given.
    pure logical function has_values(self)
        class(axis_entry_t), intent(in) :: self
        has_values = size(self%listed) > 0 .or. is_set(self%from) .or. is_set(self%to) .or. self%has_count() &
                     .or. self%logarithmic
    end function has_values

end module spintop_axis_laws
