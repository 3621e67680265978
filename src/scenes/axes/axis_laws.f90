!> The distributions of the axes of a sweep from the description in a scene, and the problems of that description.
module spintop_axis_laws
    use spintop_axis_entry, only: axis_entry_t, entry_of
    use spintop_compare, only: is_equal
    use spintop_distributions, only: factor_covariance, law_lognormal, law_normal, law_sphere, sphere_attitude, &
        sphere_direction, sphere_inclination, sphere_turn
    use spintop_kinds, only: dp
    use spintop_parameters, only: is_set
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t
    use spintop_sweep_axis, only: axis_t
    use spintop_text, only: join, to_text
    implicit none
    private
    public :: components_of, read_law, read_covariance

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

end module spintop_axis_laws
