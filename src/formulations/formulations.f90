!> The registry of formulations: one line each; lists, help, checks and tests derive from it.
module spintop_formulations
    use spintop_body, only: body_t
    use spintop_body_with_effects, only: body_with_effects_t
    use spintop_euler_angles, only: energy_rate_t, euler_t, lagrange_t
    use spintop_formulation, only: formulation_info_t, formulation_t
    use spintop_rigid_body, only: rigid_body_t
    use spintop_space_frame, only: space_frame_t
    use spintop_status, only: status_ok, status_unknown_name
    implicit none
    private
    public :: formulation_infos, create_formulation

contains

    !> Formulation number i in the order in which they are listed, in its variant for bodies with effects if that is wanted and
    !> there is one; not allocated beyond the last.
    subroutine take(i, with_effects, formulation)
        integer, intent(in) :: i
        logical, intent(in) :: with_effects
        class(formulation_t), allocatable, intent(out) :: formulation
        select case (i)
        case (1)
            allocate (euler_t :: formulation)
        case (2)
            allocate (lagrange_t :: formulation)
        case (3)
            allocate (formulation, source=energy_rate_t(has_ends=.true.))
        case (4)
            allocate (formulation, source=lagrange_t(resets_speed=.true.))
        case (5)
            if (with_effects) allocate (body_with_effects_t :: formulation)
            if (.not. with_effects) allocate (rigid_body_t :: formulation)
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
            call take(size(infos) + 1, .false., formulation)
            if (.not. allocated(formulation)) return
            infos = [infos, formulation%info()]
        end do
    end function formulation_infos

    !> The formulation of a name, in its variant for bodies with effects if the body has any and there is one; not
    !> allocated, with `status_unknown_name`, if there is none.
    subroutine create_formulation(name, formulation, status, body)
        character(*), intent(in) :: name !! as in an input
        class(formulation_t), allocatable, intent(out) :: formulation !! not allocated if the name is unknown
        integer, intent(out), optional :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(body_t), intent(in), optional :: body !! the body for which it is
        type(formulation_info_t) :: info
        logical :: with_effects
        integer :: i
        with_effects = .false.
        if (present(body)) with_effects = allocated(body%effects)
        i = 0
        do
            i = i + 1
            call take(i, with_effects, formulation)
            if (.not. allocated(formulation)) exit
            info = formulation%info()
            if (info%name == name) exit
        end do
        ! What the equations offer depends on the effects.
        if (allocated(formulation) .and. with_effects) formulation%body = body
        if (present(status)) status = merge(status_ok, status_unknown_name, allocated(formulation))
    end subroutine create_formulation

end module spintop_formulations
