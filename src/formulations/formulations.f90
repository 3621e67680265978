!> The registry of formulations: one line each; lists, help, checks and tests derive from it.
module spintop_formulations
    use spintop_body, only: body_t
    use spintop_euler_angles, only: euler_angles_t, of_energy_rate, of_euler, of_lagrange, of_lagrange_energy
    use spintop_formulation, only: formulation_info_t, formulation_t
    use spintop_rigid_body, only: rigid_body_t
    use spintop_space_frame, only: space_frame_t
    use spintop_status, only: status_ok, status_unknown_name
    implicit none
    private
    public :: formulation_infos, create_formulation

contains

    !> Formulation number i in the order in which they are listed; not allocated beyond the last.
    subroutine take(i, formulation)
        integer, intent(in) :: i
        class(formulation_t), allocatable, intent(out) :: formulation
        select case (i)
        case (1)
            allocate (formulation, source=euler_angles_t(kind=of_euler))
        case (2)
            allocate (formulation, source=euler_angles_t(kind=of_lagrange))
        case (3)
            allocate (formulation, source=euler_angles_t(kind=of_energy_rate, has_ends=.true.))
        case (4)
            allocate (formulation, source=euler_angles_t(kind=of_lagrange_energy, resets_speed=.true.))
        case (5)
            allocate (rigid_body_t :: formulation)
        case (6)
            allocate (space_frame_t :: formulation)
        end select
    end subroutine take

    !> Names and properties of all formulations.
    function formulation_infos() result(infos)
        type(formulation_info_t), allocatable :: infos(:)
        class(formulation_t), allocatable :: formulation
        allocate (infos(0))
        do
            call take(size(infos) + 1, formulation)
            if (.not. allocated(formulation)) return
            infos = [infos, formulation%info()]
        end do
    end function formulation_infos

    !> The formulation of a name; not allocated, with `status_unknown_name`, if there is none.
    subroutine create_formulation(name, formulation, status, body)
        character(*), intent(in) :: name !! as in an input
        class(formulation_t), allocatable, intent(out) :: formulation !! not allocated if the name is unknown
        integer, intent(out), optional :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(body_t), intent(in), optional :: body !! the body for which it is: what equations offer depends on its effects
        type(formulation_info_t) :: info
        integer :: i
        i = 0
        do
            i = i + 1
            call take(i, formulation)
            if (.not. allocated(formulation)) exit
            info = formulation%info()
            if (info%name == name) exit
        end do
        if (allocated(formulation) .and. present(body)) formulation%body = body
        if (present(status)) status = merge(status_ok, status_unknown_name, allocated(formulation))
    end subroutine create_formulation

end module spintop_formulations
