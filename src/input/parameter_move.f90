!> Moves parameters: copies of their texts and places, which are many, would take longer than a motion.
module spintop_parameter_move
    use spintop_parameter, only: parameter_t
    implicit none
    private
    public :: move_parameter

contains

    !> Moves a parameter. What `from` has afterwards is of no use.
    elemental subroutine move_parameter(from, to)
        type(parameter_t), intent(inout) :: from !! the parameter
        type(parameter_t), intent(inout) :: to !! where it goes
        type(parameter_t) :: moved
        call move_alloc(from%name, moved%name)
        call move_alloc(from%group, moved%group)
        call move_alloc(from%key, moved%key)
        call move_alloc(from%unit, moved%unit)
        call move_alloc(from%rule, moved%rule)
        call move_alloc(from%what, moved%what)
        call move_alloc(from%default, moved%default)
        call move_alloc(from%choices, moved%choices)
        call move_alloc(from%aliases, moved%aliases)
        call move_alloc(from%places, moved%places)
        to = from ! the rest
        call move_alloc(moved%name, to%name)
        call move_alloc(moved%group, to%group)
        call move_alloc(moved%key, to%key)
        call move_alloc(moved%unit, to%unit)
        call move_alloc(moved%rule, to%rule)
        call move_alloc(moved%what, to%what)
        call move_alloc(moved%default, to%default)
        call move_alloc(moved%choices, to%choices)
        call move_alloc(moved%aliases, to%aliases)
        call move_alloc(moved%places, to%places)
    end subroutine move_parameter

end module spintop_parameter_move
