!> Every way to follow a motion that the registries know of: methods under formulations, with steps by tolerance or of
!> fixed size; and runs of a body by one of them, in any units.
module ways
    use drawn_bodies, only: body_in_units, start_in_units, units_t
    use mechanics
    implicit none
    private
    public :: way_t, ways_for, follow, label, span_of

    !> Span, s, and steps of fixed size in it.
    real(dp), parameter, public :: t_end = 6
    integer, parameter, public :: fixed_steps = 240

    !> How a motion is followed.
    type :: way_t
        type(method_info_t) :: method
        type(formulation_info_t) :: form
        logical :: adaptive = .true., fixed_point = .false.
        integer :: project = project_nothing
        !> At most so many steps of an adaptive method; 0: those of the program.
        integer :: max_steps = 0
    end type way_t

contains

    !> The ways that suit a body, with symmetry or without; those of a method by its name, of a formulation by its name, where
    !> these are given. Tolerances in SI units by convention, which MATLAB's method has for the paper's formulations, are
    !> left out.
    function ways_for(symmetric, method, form) result(ways)
        logical, intent(in) :: symmetric
        character(*), intent(in), optional :: method, form
        type(way_t), allocatable :: ways(:)
        type(method_info_t), allocatable :: methods(:)
        type(formulation_info_t), allocatable :: forms(:)
        integer :: i, j
        allocate (methods, source=method_infos())
        allocate (forms, source=formulation_infos())
        if (present(method)) methods = pack(methods, methods%name == method)
        if (present(form)) forms = pack(forms, forms%name == form)
        allocate (ways(0))
        do i = 1, size(methods)
            do j = 1, size(forms)
                if (forms(j)%symmetric_only .and. .not. symmetric) cycle
                if (.not. (has_structure(forms(j), methods(i)) .and. passes_turns(forms(j), methods(i)))) cycle
                if (methods(i)%fixed_step) ways = [ways, way_t(methods(i), forms(j), .false.)]
                if (methods(i)%name == 'ode45' .and. forms(j)%quaternion == 0) cycle
                if (methods(i)%adaptive) ways = [ways, way_t(methods(i), forms(j))]
            end do
        end do
    end function ways_for

    !> How long a motion is followed, s: energy_rate ends at a turning point.
    pure real(dp) function span_of(way)
        type(way_t), intent(in) :: way
        span_of = merge(t_end / 20, t_end, way%form%name == 'energy_rate')
    end function span_of

    !> The last motion of a run in some units, and how the run ended.
    subroutine follow(way, body, start, units, last, outcome)
        type(way_t), intent(in) :: way
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        type(units_t), intent(in) :: units
        type(motion_t), intent(out) :: last
        type(outcome_t), intent(out) :: outcome
        class(formulation_t), allocatable :: formulation
        class(stepper_t), allocatable :: stepper
        type(recorder_t) :: seen
        real(dp) :: span
        call create_formulation(trim(way%form%name), formulation)
        call create_stepper(trim(way%method%name), stepper)
        stepper%controls%project = way%project
        stepper%controls%fixed_point = way%fixed_point
        if (way%adaptive) then
            stepper%controls%relative_tolerance = 1.0e-8_dp
            if (way%method%name == 'taylor_quadruple') then
                stepper%controls%relative_tolerance = way%method%relative_tolerance
            end if
            stepper%controls%absolute_tolerance = stepper%controls%relative_tolerance / 1000
            if (way%max_steps > 0) stepper%controls%max_steps = way%max_steps
        else
            stepper%controls%steps = fixed_steps
        end if
        span = span_of(way) * units%time
        call integrate(formulation, stepper, body_in_units(body, units), start_in_units(start, units), span, [span], seen, outcome)
        if (outcome%status == status_ok) last = seen%last()
    end subroutine follow

    !> A way in words, in units.
    function label(way, units)
        type(way_t), intent(in) :: way
        type(units_t), intent(in) :: units
        character(:), allocatable :: label
        character(120) :: line
        write (line, '(a, 1x, a, 2(1x, l1), 1x, i0, 3es9.1e3)') trim(way%method%name), trim(way%form%name), way%adaptive, &
            way%fixed_point, way%project, units%mass, units%length, units%time
        label = trim(line)
    end function label

end module ways
