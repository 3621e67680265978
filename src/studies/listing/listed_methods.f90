!> The methods and the formulations in the lists of `spintop list`.
module spintop_listed_methods
    use spintop_arkode, only: arkode_table_names
    use spintop_body, only: body_t
    use spintop_formulation, only: formulation_info_t, formulation_t
    use spintop_formulations, only: create_formulation, formulation_infos
    use spintop_kinds, only: dp
    use spintop_listed_items, only: listing_t
    use spintop_methods, only: method_aliases, create_stepper, exact_info, method_infos
    use spintop_status, only: is_ok
    use spintop_stepper, only: method_info_t, stepper_t
    use spintop_suitability, only: can_run
    use spintop_text, only: append, join, to_text
    implicit none
    private
    public :: add_methods, add_formulations

contains

    !> The methods: `kind` is exact, fixed, adaptive or both; `order` is null where the tolerance or the
    !> Butcher table decides; `formulations` are those that the method can integrate for a Lagrange top.
    subroutine add_methods(list)
        type(listing_t), intent(inout) :: list !! the items are added
        type(method_info_t), allocatable :: methods(:)
        integer :: i

        allocate (methods, source=[exact_info, method_infos()])
        call list%add_line('auto', 'the cheapest adequate one (the default)')
        do i = 1, size(methods)
            call add_method(list, methods(i))
        end do
        call append(list%text, '')
        call append(list%text, 'tables of arkode_erk:  ' // join(arkode_table_names(.false.), ', '))
        call append(list%text, 'tables of arkode_dirk: ' // join(arkode_table_names(.true.), ', '))
    end subroutine add_methods

    subroutine add_method(list, method)
        type(listing_t), intent(inout) :: list
        type(method_info_t), intent(in) :: method
        character(:), allocatable :: steps
        character(8) :: kind

        kind = 'exact'
        if (method%fixed_step) kind = 'fixed'
        if (method%adaptive) kind = merge('both    ', 'adaptive', method%fixed_step)
        steps = ''
        if (method%order > 0) steps = 'order ' // to_text(method%order)
        if (method%adaptive) steps = steps // ' adaptive'
        if (method%fixed_step) steps = steps // ' fixed'
        call list%begin_item(method%name, method%what, adjustl(steps))
        associate (json => list%json)
            call json%add('family', method%family)
            if (method%order > 0) then
                call json%add('order', method%order)
            else
                call json%add_null('order')
            end if
            call json%add('kind', kind)
            call json%add('implicit', method%implicit)
            call json%add('symmetric', method%symmetric)
            call json%add('description', method%what)
            call json%add('formulations', formulations_of(method))
            call json%add('aliases', aliases_of(method%name))
            if (method%takes_table) then
                call json%add('tables', arkode_table_names(method%implicit))
            else
                call json%add_null('tables')
            end if
            call json%close()
        end associate
    end subroutine add_method

    !> The formulations under which a method can integrate a Lagrange top.
    function formulations_of(method) result(names)
        type(method_info_t), intent(in) :: method
        character(16), allocatable :: names(:)
        type(formulation_info_t), allocatable :: forms(:)
        logical, allocatable :: runs(:)
        class(formulation_t), allocatable :: formulation
        class(stepper_t), allocatable :: stepper
        type(body_t) :: top
        integer :: i

        allocate (forms, source=formulation_infos())
        allocate (runs(size(forms)), source=.false.)
        call create_stepper(method%name, stepper)
        ! The exact solution has none.
        if (allocated(stepper)) then
            if (.not. method%adaptive) stepper%controls%steps = 1
            stepper%controls%relative_tolerance = max(stepper%controls%relative_tolerance, method%finest_tolerance)
            top%inertia = [2.0_dp, 2.0_dp, 1.0_dp]
            top%centre_of_mass(3) = 1
            do i = 1, size(forms)
                call create_formulation(forms(i)%name, formulation)
                runs(i) = is_ok(can_run(stepper, formulation, top))
            end do
        end if
        allocate (names(count(runs)))
        names = pack(forms%name, runs)
    end function formulations_of

    !> Other names of a method.
    pure function aliases_of(name) result(others)
        character(*), intent(in) :: name
        character(40), allocatable :: others(:)
        integer :: i, equals
        allocate (others(0))
        do i = 1, size(method_aliases)
            equals = index(method_aliases(i), '=')
            if (method_aliases(i)(equals + 1:) == name) others = [character(40) :: others, method_aliases(i)(:equals - 1)]
        end do
    end function aliases_of

    !> The formulations.
    subroutine add_formulations(list)
        type(listing_t), intent(inout) :: list !! the items are added
        type(formulation_info_t), allocatable :: forms(:)
        integer :: i

        allocate (forms, source=formulation_infos())
        call list%add_line('auto', 'the one that suits the method and the body (the default)')
        do i = 1, size(forms)
            call list%begin_item(forms(i)%name, forms(i)%what)
            call list%json%add('states', forms(i)%states)
            call list%json%add('symmetric_only', forms(i)%symmetric_only)
            call list%json%add('singular_at_poles', forms(i)%singular_at_poles)
            call list%end_item(forms(i)%what)
        end do
    end subroutine add_formulations

end module spintop_listed_methods
