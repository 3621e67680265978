!> The registry of formulations: one line each; lists, help, checks and tests derive from it. It is built
!> once, at the first question, and shared by all threads.
module spintop_formulations
    use spintop_body, only: body_t
    use spintop_body_with_effects, only: body_with_effects_t
    use spintop_formulation, only: formulation_t, formulation_info_t
    use spintop_energy_rate, only: energy_rate_t
    use spintop_euler_angles, only: euler_t, lagrange_t
    use spintop_rigid_body, only: rigid_body_t
    use spintop_space_frame, only: space_frame_t
    use spintop_status, only: status_ok, status_unknown_name
    implicit none
    private
    public :: formulation_infos, create_formulation

    !> Room for so many.
    integer, parameter :: most = 16

    type :: entry_t
        class(formulation_t), allocatable :: prototype
        !> The variant for bodies with effects; not allocated if there is none.
        class(formulation_t), allocatable :: with_effects
    end type entry_t

    !> The formulations by name, in the order in which they are listed.
    type :: registry_t
        integer :: size = 0
        type(entry_t) :: entry(most)
    contains
        procedure :: add
    end type registry_t

    type(registry_t), target :: registry

contains

    !> The registry. Who finds it unbuilt builds it; the others wait for that.
    function known_formulations() result(known)
        type(registry_t), pointer :: known
        !$omp critical (formulations_registry)
        if (registry%size == 0) call list_formulations(registry)
        !$omp end critical (formulations_registry)
        known => registry
    end function known_formulations

    !> Adds all formulations to the registry.
    subroutine list_formulations(known)
        type(registry_t), intent(out) :: known
        type(rigid_body_t) :: body
        type(body_with_effects_t) :: affected
        type(space_frame_t) :: top
        call known%add(euler_t())
        call known%add(lagrange_t())
        call known%add(energy_rate_t(has_ends=.true.))
        call known%add(lagrange_t(resets_speed=.true.))
        call known%add(body, with_effects=affected)
        call known%add(top)
    end subroutine list_formulations

    !> Adds a formulation.
    subroutine add(self, prototype, with_effects)
        class(registry_t), intent(inout) :: self
        class(formulation_t), intent(in) :: prototype
        class(formulation_t), intent(in), optional :: with_effects
        self%size = self%size + 1
        allocate (self%entry(self%size)%prototype, source=prototype)
        if (present(with_effects)) allocate (self%entry(self%size)%with_effects, source=with_effects)
    end subroutine add

    !> Names and properties of all formulations.
    function formulation_infos() result(infos)
        type(formulation_info_t), allocatable :: infos(:)
        type(registry_t), pointer :: known
        integer :: i
        known => known_formulations()
        allocate (infos(known%size))
        do i = 1, known%size
            infos(i) = known%entry(i)%prototype%info()
        end do
    end function formulation_infos

    !> The formulation of a name, in its variant for bodies with effects if the body has any and there is one; not
    !> allocated, with `status_unknown_name`, if there is none.
    subroutine create_formulation(name, formulation, status, body)
        character(*), intent(in) :: name !! as in an input
        class(formulation_t), allocatable, intent(out) :: formulation !! not allocated if the name is unknown
        integer, intent(out), optional :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(body_t), intent(in), optional :: body !! the body for which it is
        type(registry_t), pointer :: known
        type(formulation_info_t) :: info
        logical :: affected
        integer :: i
        affected = .false.
        if (present(body)) affected = allocated(body%effects)
        known => known_formulations()
        do i = 1, known%size
            info = known%entry(i)%prototype%info()
            if (info%name /= name) cycle
            if (affected .and. allocated(known%entry(i)%with_effects)) then
                allocate (formulation, source=known%entry(i)%with_effects)
                formulation%body = body ! what the equations offer depends on the effects
            else
                allocate (formulation, source=known%entry(i)%prototype)
            end if
            exit
        end do
        if (present(status)) status = merge(status_ok, status_unknown_name, allocated(formulation))
    end subroutine create_formulation

end module spintop_formulations
