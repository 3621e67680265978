!> The axes of a sweep from arrays of a caller of the library: the values of parameters, side by side.
module spintop_axes_of_arrays
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_axis_entry, only: count_axes, find_swept
    use spintop_parameters, only: parameter_table_t
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t
    use spintop_scene_words, only: combine_zip
    use spintop_sweep_axes, only: axes_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: given_axis_t, make_axes_of_arrays

    !> The values of a parameter, one for each case.
    type :: given_axis_t
        !> Its name, as `initial.spin_ratio`.
        character(:), allocatable :: name
        real(dp), allocatable :: values(:)
    end type given_axis_t

contains

    !> The axes of some arrays, which have the same length. Without any, there is one case: that of the scene. With
    !> problems the axes have no cases.
    subroutine make_axes_of_arrays(given, scene, table, axes, problems)
        type(given_axis_t), intent(in) :: given(:) !! names of the parameters, and a value of each for every case
        type(scene_t), intent(in) :: scene !! contents of the input
        type(parameter_table_t), intent(in) :: table !! its parameters
        type(axes_t), intent(out) :: axes !! the axes; without cases if there are problems
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        character(:), allocatable :: problem, hint
        integer :: i, k

        if (count_axes(scene) > 0 .or. scene%sweep_table /= '') then
            call problems%add('sweep', 'the cases are given twice', 'give either arrays or a group &sweep')
        end if
        allocate (axes%axis(size(given)))
        do i = 1, size(given)
            associate (axis => axes%axis(i))
                axis%name = given(i)%name
                call find_swept(axis%name, table, axis%slot, problem, hint)
                if (any([(axes%axis(k)%slot%is_same(axis%slot), k=1, i - 1)])) then
                    problem = axis%name // ' has two arrays'
                    hint = 'give it one'
                end if
                if (problem /= '') then
                    call problems%add('sweep', problem, hint)
                    cycle
                end if
                axis%whole = axis%slot%is_whole()
                axis%listed = given(i)%values
                axis%count = size(axis%listed)
                do k = 1, axis%count
                    if (axis%slot%accepts(axis%listed(k))) cycle
                    call problems%add('sweep', 'element ' // to_text(k) // ' of ' // axis%name // ' ' // &
                                      axis%slot%refusal(axis%listed(k)), 'give a value in the range')
                    exit
                end do
            end associate
        end do
        if (problems%any()) return
        axes%combination = combine_zip
        if (size(given) == 0) then
            axes%cases = 1
        else
            call axes%combine(combine_zip, int(axes%axis(1)%count, int64), 1_int64)
        end if
    end subroutine make_axes_of_arrays

end module spintop_axes_of_arrays
