!> Makes the axes of a sweep from the description in a scene, and reports the problems of that description.
module spintop_axes_of_scene
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_axis_laws, only: axis_entry_t, count_axes, entry_of, find_swept, is_drawn, components_of, &
        read_covariance, read_law
    use spintop_compare, only: is_finite
    use spintop_sweep_axis, only: law_uniform
    use spintop_parameters, only: is_set, parameter_table_t, unset_integer
    use spintop_problems, only: problems_t
    use spintop_sample_design, only: dimensions_fit, design_saltelli, design_sobol
    use spintop_scene_keys, only: scene_t
    use spintop_scene_words, only: combination_names, combine_saltelli, combine_sobol, combine_zip
    use spintop_sweep_axes, only: axes_t, axis_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: make_axes, find_swept, count_axes

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
        integer :: combination

        if (count_axes(scene) == 0) then
            call problems%add('sweep', 'a sweep needs an axis', &
                              "give for example parameter(1) = 'initial.spin_ratio' and its values, or a table")
            return
        end if
        combination = findloc(combination_names, scene%combine, dim=1)
        call check_cases(scene, problems)
        call make_each(scene, table, axes%axis, problems)
        call read_covariance(scene, count_axes(scene), combination == combine_saltelli, factor, problems)
        if (combination == combine_zip .and. .not. problems%any()) call check_lengths(axes%axis, problems)
        if (.not. problems%any()) call check_design(scene, combination, axes%axis, problems)
        if (problems%any()) return
        call axes%combine(combination, scene%cases, int(scene%seed, int64))
        if (size(factor) > 0) call axes%correlate(factor)
        if (axes%cases == 0) then
            call problems%add('sweep.count', 'the grid has more than 1e15 cases', 'use fewer values')
        end if
    end subroutine make_axes

    !> Makes the axes: one for each number that varies, several for a vector that is drawn as a whole.
    subroutine make_each(scene, table, axis, problems)
        type(scene_t), intent(in) :: scene
        type(parameter_table_t), intent(in) :: table
        type(axis_t), allocatable, intent(inout) :: axis(:)
        type(problems_t), intent(inout) :: problems
        type(axis_entry_t), allocatable :: entries(:)
        integer :: i, k, made
        logical :: is_made

        allocate (entries(count_axes(scene)))
        do i = 1, size(entries)
            entries(i) = entry_of(scene, i)
        end do
        allocate (axis(sum([(components_of(entries(i)), i=1, size(entries))])))
        made = 0
        do i = 1, size(entries)
            do k = 1, components_of(entries(i))
                made = made + 1
                axis(made)%component = k
                axis(made)%components = components_of(entries(i))
                call make_axis(entries(i), axis(:made - 1), table, axis(made), is_made, problems)
                if (.not. is_made) exit
            end do
        end do
    end subroutine make_each

    !> Checks that a sample has the number of cases and of dimensions that its design can have.
    subroutine check_design(scene, combination, axis, problems)
        type(scene_t), intent(in) :: scene
        integer, intent(in) :: combination
        type(axis_t), intent(in) :: axis(:)
        type(problems_t), intent(inout) :: problems
        integer(int64) :: group, nearest

        if (combination == combine_sobol .or. combination == combine_saltelli) then
            if (.not. dimensions_fit(merge(design_sobol, design_saltelli, combination == combine_sobol), &
                                     sum(axis%dimensions()))) then
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

    !> The number of cases is given where they are drawn, and only there.
    subroutine check_cases(scene, problems)
        type(scene_t), intent(in) :: scene
        type(problems_t), intent(inout) :: problems
        logical :: given
        given = scene%cases /= unset_integer
        if (is_drawn(scene) .and. .not. given) then
            call problems%add('sweep.combine', 'the number of random cases is not given', 'give cases')
        else if (given .and. .not. is_drawn(scene)) then
            call problems%add('sweep.cases', 'the number of cases of a ' // trim(scene%combine) // ' follows from its values', &
                              "omit it, or use combine = 'random' or 'latin_hypercube'")
        end if
    end subroutine check_cases

    !> An axis: the number that varies, and its values.
    subroutine make_axis(entry, others, table, axis, is_made, problems)
        type(axis_entry_t), intent(in) :: entry
        type(axis_t), intent(in) :: others(:) !! those before it
        type(parameter_table_t), intent(in) :: table
        type(axis_t), intent(inout) :: axis !! its component is known
        logical, intent(out) :: is_made !! whether the number that varies was found
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: problem, hint
        logical :: found
        integer :: i

        is_made = .false.
        axis%name = entry%name
        if (axis%components > 1) axis%name = axis%name // '(' // to_text(axis%component) // ')'
        if (axis%name == '') then
            call problems%add(entry%key('parameter'), entry%in_words() // ' has no parameter', &
                              'number the axes without gaps')
            return
        end if
        call find_swept(axis%name, table, axis%slot, problem, hint)
        if (problem /= '') then
            call problems%add(entry%key('parameter'), problem, hint)
            return
        end if
        if (any([(others(i)%slot%is_same(axis%slot), i=1, size(others))])) then
            call problems%add(entry%key('parameter'), axis%name // ' is on two axes', 'vary it on one')
        end if
        is_made = .true.
        axis%whole = axis%slot%is_whole()
        if (entry%law /= law_uniform) then
            call read_law(entry, axis, problems)
            return
        end if
        if (is_set(entry%mean) .or. is_set(entry%deviation)) then
            call problems%add(entry%key('distribution'), 'the values of ' // entry%in_words() // ' are uniform', &
                              "omit mean and deviation, or use distribution = 'normal' or 'lognormal'")
        end if
        call read_values(entry, axis, found, problems)
        if (found) call check_values(entry, axis, problems)
    end subroutine make_axis

    !> The values listed, or the interval; `found` tells whether there are any.
    subroutine read_values(entry, axis, found, problems)
        type(axis_entry_t), intent(in) :: entry
        type(axis_t), intent(inout) :: axis
        logical, intent(out) :: found
        type(problems_t), intent(inout) :: problems
        logical :: has_ends

        has_ends = is_set(entry%from) .and. is_set(entry%to)
        found = .false.
        if (size(entry%listed) > 0) then
            if (is_set(entry%from) .or. is_set(entry%to) .or. entry%has_count()) then
                call problems%add('sweep.values', 'the values of ' // entry%in_words() // ' are given twice', &
                                  'give either values, or from, to and count')
            end if
            axis%listed = entry%listed
            axis%count = size(entry%listed)
            found = .true.
        else if (has_ends .and. entry%drawn .and. entry%has_count()) then
            call problems%add(entry%key('count'), 'a random axis has no number of values', &
                              'omit it; sweep.cases is the number of cases')
        else if (has_ends .and. (entry%drawn .or. entry%has_count())) then
            call read_interval(entry, axis, problems)
            found = .true.
        else
            call problems%add(entry%key('parameter'), entry%in_words() // ' has no values', &
                              'give values, or ' // &
                              trim(merge('from and to       ', 'from, to and count', entry%drawn)))
        end if
    end subroutine read_values

    !> Values with equal differences or equal ratios, or the ends of an interval.
    subroutine read_interval(entry, axis, problems)
        type(axis_entry_t), intent(in) :: entry
        type(axis_t), intent(inout) :: axis
        type(problems_t), intent(inout) :: problems
        real(dp) :: distance

        axis%from = entry%from
        axis%to = entry%to
        if (.not. entry%drawn) axis%count = entry%count
        axis%logarithmic = entry%logarithmic
        distance = axis%to - axis%from
        if (axis%logarithmic) then
            if (.not. (axis%from > 0 .and. axis%to > 0)) then
                call problems%add('sweep.spacing', 'logarithmic spacing needs positive ends', &
                                  "use spacing = 'linear' or other ends")
                return
            end if
            distance = max(axis%from, axis%to) / min(axis%from, axis%to)
        end if
        if (.not. is_finite(distance)) then
            call problems%add(entry%key('to'), 'the ends of ' // entry%in_words() // ' are too far apart', &
                              'use other ends')
        end if
    end subroutine read_interval

    !> Checks that all listed values, or both ends of an interval, are in the range of the parameter, and are
    !> whole numbers if it is an integer.
    subroutine check_values(entry, axis, problems)
        type(axis_entry_t), intent(in) :: entry
        type(axis_t), intent(in) :: axis
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: place
        integer :: k

        if (allocated(axis%listed)) then
            do k = 1, axis%count
                place = 'sweep.values(' // to_text(entry%number) // ',' // to_text(k) // ')'
                if (is_refused(axis%listed(k), place)) return
            end do
            return
        end if
        if (is_refused(axis%from, entry%key('from'))) return
        if (is_refused(axis%to, entry%key('to'))) return
        if (.not. axis%whole) return
        do k = 1, axis%count
            associate (value => axis%unrounded(k))
                if (abs(value - anint(value)) <= spacing_slack * abs(value)) cycle
                if (is_refused(value, entry%key('parameter'))) return
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

    !> Axes that go side by side have as many values each.
    subroutine check_lengths(axes, problems)
        type(axis_t), intent(in) :: axes(:)
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: lengths
        integer :: k

        if (all(axes%count == axes(1)%count)) return
        lengths = ''
        do k = 1, size(axes)
            if (k > 1) lengths = lengths // ', '
            lengths = lengths // axes(k)%name // ' has ' // to_text(axes(k)%count)
        end do
        call problems%add('sweep.combine', 'axes side by side need equal numbers of values: ' // lengths, &
                          "give equal numbers of values, or use combine = 'grid'")
    end subroutine check_lengths

end module spintop_axes_of_scene
