!> The scene of a case of a sweep.
!>
!>     call swept%copy(scene, axes)            ! once: the scene that describes the axes
!>     call axes%find_values(number, values)   ! for each case: its numbers,
!>     call swept%set_values(values)           ! set in
!>     call make_case(swept%scene, ...)        ! its scene
module spintop_case_scene
    use spintop_kinds, only: dp
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t
    use spintop_scene_keys, only: describe_scene, scene_t
    use spintop_sweep_axes, only: axes_t
    implicit none
    private
    public :: case_scene_t

    !> A copy of the scene that describes some axes, which takes the values of one case after another. Its
    !> slots point into the scene, so it must not be copied.
    type :: case_scene_t
        type(scene_t), allocatable :: scene
        !> Where the value of each axis goes.
        type(number_slot_t), allocatable, private :: slots(:)
    contains
        procedure :: copy => copy_scene
        procedure :: set_values => set_values
    end type case_scene_t

contains

    !> Makes it a copy of the scene that describes the axes.
    subroutine copy_scene(self, scene, axes)
        class(case_scene_t), target, intent(inout) :: self
        type(scene_t), intent(in) :: scene !! the scene
        type(axes_t), intent(in) :: axes !! the axes
        type(parameter_table_t) :: table
        character(:), allocatable :: problem
        integer :: i
        allocate (self%scene, source=scene)
        call describe_scene(self%scene, table)
        allocate (self%slots(size(axes%axis)))
        do i = 1, size(self%slots)
            call table%find_number(axes%axis(i)%name, self%slots(i), problem)
        end do
    end subroutine copy_scene

    !> Sets the values of a case, in the order of the axes, in the scene: those from the first that may have changed.
    subroutine set_values(self, values, first)
        class(case_scene_t), target, intent(inout) :: self
        real(dp), intent(in) :: values(:) !! one value for each axis
        integer, intent(in), optional :: first !! number of that axis; all are set if it is absent
        integer :: i, begin
        begin = 1
        if (present(first)) begin = first
        do i = begin, size(self%slots)
            call self%slots(i)%set(values(i))
        end do
    end subroutine set_values

end module spintop_case_scene
