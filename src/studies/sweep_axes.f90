!> The axes of a sweep: which parameters vary, over which values, and the values of each case.
module spintop_sweep_axes
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_body_of_scene, only: is_set
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t, unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t, max_axes
    use spintop_text, only: to_text
    implicit none
    private
    public :: axes_t, make_axes, put_values

    !> The values of one parameter: listed, or equally spaced (in their logarithm).
    type :: axis_t
        character(:), allocatable :: name
        integer :: count = 0
        real(dp), allocatable :: listed(:)
        real(dp) :: from = 0, to = 0
        logical :: logarithmic = .false.
    contains
        procedure :: value
    end type axis_t

    !> The grid of all combinations; the last axis varies fastest.
    type :: axes_t
        type(axis_t), allocatable :: axis(:)
        integer(int64) :: cases = 0
    contains
        procedure :: values_of
        procedure :: slots_in
        procedure :: varies
    end type axes_t

contains

    !> Reads the axes of a scene; `table` knows the parameters that can vary.
    subroutine make_axes(scene, table, axes, problems)
        type(scene_t), intent(in) :: scene
        type(parameter_table_t), intent(in) :: table
        type(axes_t), intent(out) :: axes
        type(problems_t), intent(inout) :: problems
        integer :: i, count

        count = 0
        do i = 1, max_axes
            if (scene%parameter(i) /= '') count = i
        end do
        if (count == 0) then
            call problems%add('sweep', 'a sweep needs an axis', &
                              "give parameter(1) = 'initial.spin_ratio', say, and its values")
            return
        end if
        allocate (axes%axis(count))
        axes%cases = 1
        do i = 1, count
            call make_axis(i, axes%axis(i))
            if (problems%any()) cycle
            axes%cases = axes%cases * axes%axis(i)%count
        end do

    contains

        subroutine make_axis(i, axis)
            integer, intent(in) :: i
            type(axis_t), intent(out) :: axis
            type(number_slot_t) :: slot
            character(:), allocatable :: problem, subscript
            integer :: listed, k

            subscript = '(' // to_text(i) // ')'
            axis%name = trim(scene%parameter(i))
            if (axis%name == '') then
                call problems%add('sweep.parameter' // subscript, 'axis ' // to_text(i) // ' has no parameter', &
                                  'number the axes without gaps')
                return
            end if
            call table%find_number(axis%name, slot, problem)
            if (problem /= '') then
                call problems%add('sweep.parameter' // subscript, problem, &
                                  '`spintop list parameters` shows them all')
                return
            end if
            if (index(axis%name, 'sweep.') == 1 .or. index(axis%name, 'span.samples') == 1) then
                call problems%add('sweep.parameter' // subscript, axis%name // ' cannot vary', &
                                  'vary a parameter of the top, its start, its span or its integration')
                return
            end if
            do k = 1, i - 1
                if (axes%axis(k)%name == axis%name) then
                    call problems%add('sweep.parameter' // subscript, axis%name // ' is on two axes', &
                                      'vary it on one')
                end if
            end do
            listed = count_listed(scene%values(i, :))
            if (listed > 0) then
                if (is_set(scene%from(i)) .or. is_set(scene%to(i)) .or. scene%count(i) /= unset_integer) then
                    call problems%add('sweep.values', 'the values of axis ' // to_text(i) // &
                                      ' are given twice', 'give either values, or from, to and count')
                end if
                axis%listed = scene%values(i, :listed)
                axis%count = listed
            else if (is_set(scene%from(i)) .and. is_set(scene%to(i)) &
                     .and. scene%count(i) /= unset_integer) then
                call space_values(i, axis)
            else
                call problems%add('sweep.parameter' // subscript, 'axis ' // to_text(i) // ' has no values', &
                                  'give values, or from, to and count')
                return
            end if
            call check_values(slot, axis, subscript)
        end subroutine make_axis

        !> Values equally spaced, or with equal ratios.
        subroutine space_values(i, axis)
            integer, intent(in) :: i
            type(axis_t), intent(inout) :: axis
            axis%from = scene%from(i)
            axis%to = scene%to(i)
            axis%count = scene%count(i)
            axis%logarithmic = scene%spacing(i) == 'log'
            if (axis%logarithmic .and. .not. (axis%from > 0 .and. axis%to > 0)) then
                call problems%add('sweep.spacing', 'logarithmic spacing needs positive ends', &
                                  "take spacing = 'linear' or other ends")
            end if
        end subroutine space_values

        !> Every listed value, or both ends of an interval, must be in the parameter's range.
        subroutine check_values(slot, axis, subscript)
            type(number_slot_t), intent(in) :: slot
            type(axis_t), intent(in) :: axis
            character(*), intent(in) :: subscript
            character(:), allocatable :: problem
            integer :: k
            do k = 1, axis%count, merge(1, max(1, axis%count - 1), allocated(axis%listed))
                problem = slot%refusal(axis%value(k))
                if (problem == '') cycle
                call problems%add('sweep.parameter' // subscript, problem, 'change the values of the axis')
                return
            end do
        end subroutine check_values

    end subroutine make_axes

    !> Value number k of an axis.
    elemental real(dp) function value(self, k)
        class(axis_t), intent(in) :: self
        integer, intent(in) :: k
        real(dp) :: fraction
        if (allocated(self%listed)) then
            value = self%listed(k)
        else if (k == self%count .and. k > 1) then
            value = self%to
        else
            fraction = real(k - 1, dp) / max(1, self%count - 1)
            if (self%logarithmic) then
                value = self%from * (self%to / self%from)**fraction
            else
                value = self%from + (self%to - self%from) * fraction
            end if
        end if
    end function value

    !> Number of leading values that are given.
    pure integer function count_listed(values) result(count)
        real(dp), intent(in) :: values(:)
        do count = 0, size(values) - 1
            if (.not. is_set(values(count + 1))) return
        end do
        count = size(values)
    end function count_listed

    !> The values of the axes in case `number`, from 1.
    pure function values_of(self, number) result(values)
        class(axes_t), intent(in) :: self
        integer(int64), intent(in) :: number
        real(dp) :: values(size(self%axis))
        integer(int64) :: rest, n
        integer :: i
        rest = number - 1
        do i = size(self%axis), 1, -1
            n = self%axis(i)%count
            values(i) = self%axis(i)%value(int(mod(rest, n)) + 1)
            rest = rest / n
        end do
    end function values_of

    !> Where the values of the axes go in the scene that a table describes.
    function slots_in(self, table) result(slots)
        class(axes_t), intent(in) :: self
        type(parameter_table_t), intent(in) :: table
        type(number_slot_t), allocatable :: slots(:)
        character(:), allocatable :: problem
        integer :: i
        allocate (slots(size(self%axis)))
        do i = 1, size(slots)
            call table%find_number(self%axis(i)%name, slots(i), problem)
        end do
    end function slots_in

    !> Puts the values of a case into the slots of a scene.
    subroutine put_values(slots, values)
        type(number_slot_t), intent(in) :: slots(:)
        real(dp), intent(in) :: values(:)
        type(number_slot_t) :: slot
        integer :: i
        do i = 1, size(slots)
            slot = slots(i)
            call slot%put(values(i))
        end do
    end subroutine put_values

    !> Whether a parameter of a group varies.
    pure logical function varies(self, group)
        class(axes_t), intent(in) :: self
        character(*), intent(in) :: group
        integer :: i
        varies = .false.
        do i = 1, size(self%axis)
            varies = varies .or. index(self%axis(i)%name, group // '.') == 1
        end do
    end function varies

end module spintop_sweep_axes
