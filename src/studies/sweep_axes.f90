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
    public :: axes_t, make_axes

    !> The values of one parameter.
    type :: axis_t
        character(:), allocatable :: name
        real(dp), allocatable :: values(:)
    end type axis_t

    !> The grid of all combinations; the last axis varies fastest.
    type :: axes_t
        type(axis_t), allocatable :: axis(:)
        integer(int64) :: cases = 0
    contains
        procedure :: values_of
        procedure :: apply
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
            axes%cases = axes%cases * size(axes%axis(i)%values)
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
                axis%values = scene%values(i, :listed)
            else if (is_set(scene%from(i)) .and. is_set(scene%to(i)) &
                     .and. scene%count(i) /= unset_integer) then
                call space_values(i, axis)
            else
                call problems%add('sweep.parameter' // subscript, 'axis ' // to_text(i) // ' has no values', &
                                  'give values, or from, to and count')
                return
            end if
            do k = 1, size(axis%values)
                problem = slot%refusal(axis%values(k))
                if (problem == '') cycle
                call problems%add('sweep.parameter' // subscript, problem, 'change the values of the axis')
                exit
            end do
        end subroutine make_axis

        !> Values equally spaced, or with equal ratios.
        subroutine space_values(i, axis)
            integer, intent(in) :: i
            type(axis_t), intent(inout) :: axis
            integer :: k
            associate (from => scene%from(i), to => scene%to(i), n => scene%count(i))
                allocate (axis%values(n))
                if (scene%spacing(i) == 'log' .and. .not. (from > 0 .and. to > 0)) then
                    call problems%add('sweep.spacing', 'logarithmic spacing needs positive ends', &
                                      "take spacing = 'linear' or other ends")
                    return
                end if
                do k = 1, n
                    if (scene%spacing(i) == 'log') then
                        axis%values(k) = from * (to / from)**(real(k - 1, dp) / max(1, n - 1))
                    else
                        axis%values(k) = from + (to - from) * (real(k - 1, dp) / max(1, n - 1))
                    end if
                end do
                if (n > 1) axis%values(n) = to
            end associate
        end subroutine space_values

    end subroutine make_axes

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
            n = size(self%axis(i)%values)
            values(i) = self%axis(i)%values(mod(rest, n) + 1)
            rest = rest / n
        end do
    end function values_of

    !> Puts the values of a case into the scene that a table describes.
    subroutine apply(self, number, table)
        class(axes_t), intent(in) :: self
        integer(int64), intent(in) :: number
        type(parameter_table_t), intent(inout) :: table
        type(number_slot_t) :: slot
        character(:), allocatable :: problem
        real(dp) :: values(size(self%axis))
        integer :: i
        values = self%values_of(number)
        do i = 1, size(values)
            call table%find_number(self%axis(i)%name, slot, problem)
            call slot%put(values(i))
        end do
    end subroutine apply

end module spintop_sweep_axes
