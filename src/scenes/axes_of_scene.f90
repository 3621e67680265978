!> The axes of a sweep as a scene describes them, with all that is wrong about them.
module spintop_axes_of_scene
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_body_of_scene, only: is_set
    use spintop_compare, only: is_finite
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t, unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t, max_axes
    use spintop_sweep_axes, only: axes_t, combination_names, combine_grid, combine_zip
    use spintop_sweep_axis, only: axis_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: make_axes, find_swept, count_axes

    !> What a sweep as a whole has, and its cases have not.
    character(*), parameter :: fixed(*) = [character(15) :: 'sweep.', 'work_precision.', 'stability.', &
        'span.samples', 'span.stop_after']
    !> Rounding of the spacing that a whole number may show, relative.
    real(dp), parameter :: spacing_slack = 8 * epsilon(1.0_dp)

contains

    !> The axes of a scene; `table` knows the parameters that can vary. With problems they have no cases.
    subroutine make_axes(scene, table, axes, problems)
        type(scene_t), intent(in) :: scene
        type(parameter_table_t), intent(in) :: table
        type(axes_t), intent(out) :: axes
        type(problems_t), intent(inout) :: problems
        type(number_slot_t) :: slots(max_axes)
        integer :: i, combination
        logical :: drawn

        combination = findloc(combination_names, scene%combine, dim=1)
        drawn = all(combination /= [combine_grid, combine_zip])
        if (count_axes(scene) == 0) then
            call problems%add('sweep', 'a sweep needs an axis', &
                              "give parameter(1) = 'initial.spin_ratio', say, and its values; or a table")
            return
        end if
        if (drawn .and. scene%cases == unset_integer) then
            call problems%add('sweep.combine', 'the number of cases to draw is not given', 'give cases')
        else if (scene%cases /= unset_integer .and. .not. drawn) then
            call problems%add('sweep.cases', 'the cases of a ' // trim(scene%combine) // ' are those of its values', &
                              "leave it out, or take combine = 'random' or 'latin_hypercube'")
        end if
        allocate (axes%axis(count_axes(scene)))
        do i = 1, size(axes%axis)
            call make_axis(i, axes%axis(i), slots(i))
        end do
        if (combination == combine_zip .and. any(axes%axis%count /= axes%axis(1)%count) &
            .and. .not. problems%any()) call refuse_lengths()
        if (problems%any()) return
        call axes%combine(combination, int(scene%cases, int64), int(scene%seed, int64))
        if (axes%cases == 0) then
            call problems%add('sweep.count', 'the grid has more cases than can be counted', 'take fewer values')
        end if

    contains

        subroutine make_axis(i, axis, slot)
            integer, intent(in) :: i
            type(axis_t), intent(out) :: axis
            type(number_slot_t), intent(out) :: slot
            character(:), allocatable :: problem, hint, subscript
            logical :: has_ends, has_count
            integer :: listed, k

            subscript = '(' // to_text(i) // ')'
            axis%name = trim(scene%parameter(i))
            if (axis%name == '') then
                call problems%add('sweep.parameter' // subscript, 'axis ' // to_text(i) // ' has no parameter', &
                                  'number the axes without gaps')
                return
            end if
            call find_swept(axis%name, table, slot, problem, hint)
            if (problem /= '') then
                call problems%add('sweep.parameter' // subscript, problem, hint)
                return
            end if
            if (any([(slots(k)%is_same(slot), k=1, i - 1)])) then
                call problems%add('sweep.parameter' // subscript, axis%name // ' is on two axes', 'vary it on one')
            end if
            axis%whole = slot%is_whole()
            has_ends = is_set(scene%from(i)) .and. is_set(scene%to(i))
            has_count = scene%count(i) /= unset_integer
            listed = count_listed(scene%values(i, :))
            if (listed > 0) then
                if (is_set(scene%from(i)) .or. is_set(scene%to(i)) .or. has_count) then
                    call problems%add('sweep.values', 'the values of axis ' // to_text(i) // &
                                      ' are given twice', 'give either values, or from, to and count')
                end if
                axis%listed = scene%values(i, :listed)
                axis%count = listed
            else if (has_ends .and. drawn .and. has_count) then
                call problems%add('sweep.count' // subscript, 'values that are drawn are not counted by axis', &
                                  'leave it out; sweep.cases is the number of cases')
                return
            else if (has_ends .and. (drawn .or. has_count)) then
                call space_values(i, axis, subscript)
            else
                call problems%add('sweep.parameter' // subscript, 'axis ' // to_text(i) // ' has no values', &
                                  'give values, or ' // trim(merge('from and to       ', 'from, to and count', drawn)))
                return
            end if
            call check_values(slot, axis, subscript)
        end subroutine make_axis

        !> Values equally spaced, or with equal ratios, or any between two ends.
        subroutine space_values(i, axis, subscript)
            integer, intent(in) :: i
            type(axis_t), intent(inout) :: axis
            character(*), intent(in) :: subscript
            real(dp) :: distance
            axis%from = scene%from(i)
            axis%to = scene%to(i)
            if (.not. drawn) axis%count = scene%count(i)
            axis%logarithmic = scene%spacing(i) == 'log'
            distance = axis%to - axis%from
            if (axis%logarithmic) then
                if (.not. (axis%from > 0 .and. axis%to > 0)) then
                    call problems%add('sweep.spacing', 'logarithmic spacing needs positive ends', &
                                      "take spacing = 'linear' or other ends")
                    return
                end if
                distance = max(axis%from, axis%to) / min(axis%from, axis%to)
            end if
            if (.not. is_finite(distance)) then
                call problems%add('sweep.to' // subscript, 'the ends of axis ' // to_text(i) // ' are too far apart', &
                                  'take other ends')
            end if
        end subroutine space_values

        !> Every listed value, or both ends of an interval, must be in the parameter's range; those of an
        !> integer must all be whole.
        subroutine check_values(slot, axis, subscript)
            type(number_slot_t), intent(in) :: slot
            type(axis_t), intent(in) :: axis
            character(*), intent(in) :: subscript
            character(:), allocatable :: problem, place
            integer :: k

            problem = ''
            place = 'sweep.parameter' // subscript
            if (allocated(axis%listed)) then
                do k = 1, axis%count
                    problem = slot%refusal(axis%listed(k))
                    place = 'sweep.values(' // subscript(2:len(subscript) - 1) // ',' // to_text(k) // ')'
                    if (problem /= '') exit
                end do
            else
                problem = slot%refusal(axis%from)
                if (problem /= '') then
                    place = 'sweep.from' // subscript
                else
                    problem = slot%refusal(axis%to)
                    if (problem /= '') place = 'sweep.to' // subscript
                end if
                if (problem == '' .and. axis%whole) then
                    do k = 1, axis%count
                        associate (value => axis%unrounded(k))
                            if (abs(value - anint(value)) > spacing_slack * abs(value)) then
                                problem = slot%refusal(value)
                                exit
                            end if
                        end associate
                    end do
                end if
            end if
            if (problem /= '') then
                call problems%add(place, axis%name // ' ' // problem, 'change the values of the axis')
            end if
        end subroutine check_values

        !> Tells the lengths of axes that do not go side by side.
        subroutine refuse_lengths()
            character(:), allocatable :: lengths
            integer :: k
            lengths = ''
            do k = 1, size(axes%axis)
                if (k > 1) lengths = lengths // ', '
                lengths = lengths // axes%axis(k)%name // ' has ' // to_text(axes%axis(k)%count)
            end do
            call problems%add('sweep.combine', 'axes side by side need as many values each: ' // lengths, &
                              "give as many values each, or take combine = 'grid'")
        end subroutine refuse_lengths

    end subroutine make_axes

    !> Finds the number that a parameter of that name holds; `problem` says why it cannot vary, or ''.
    subroutine find_swept(name, table, slot, problem, hint)
        character(*), intent(in) :: name
        type(parameter_table_t), intent(in) :: table
        type(number_slot_t), intent(out) :: slot
        character(:), allocatable, intent(out) :: problem, hint
        integer :: i
        call table%find_number(name, slot, problem)
        hint = '`spintop list parameters` shows them all'
        do i = 1, size(fixed)
            if (problem /= '' .or. index(name, trim(fixed(i))) /= 1) cycle
            problem = name // ' cannot vary'
            hint = 'vary a parameter of the top, its start, its span or its integration'
        end do
    end subroutine find_swept

    !> Number of the last axis of which anything is given; 0 if there is none.
    pure integer function count_axes(scene) result(count)
        type(scene_t), intent(in) :: scene
        do count = max_axes, 1, -1
            if (scene%parameter(count) /= '' .or. scene%count(count) /= unset_integer .or. any(is_set( &
                [scene%values(count, 1), scene%from(count), scene%to(count)]))) return
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

end module spintop_axes_of_scene
