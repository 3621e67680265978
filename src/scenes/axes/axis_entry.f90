!> What a scene says of one axis of a sweep, and the parameter that varies along it.
module spintop_axis_entry
    use spintop_distributions, only: law_names, law_uniform
    use spintop_kinds, only: dp
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: is_set, parameter_table_t, unset_integer
    use spintop_scene_keys, only: scene_t, max_axes, max_list_axes
    use spintop_scene_words, only: combination_names, combine_grid, combine_zip
    use spintop_text, only: to_text
    implicit none
    private
    public :: axis_entry_t, entry_of, count_axes, find_swept, is_drawn

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

contains

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

end module spintop_axis_entry
