!> The columns `COLUMN__KEY` of a table, its sensitivities: each the derivative of a column with respect to a number of the
!> input, and `COLUMN__KEY_error`, the estimate of its error.
!>
!> The error of the method shows from other accuracies: a tenth and a hundredth of its tolerances, or a half and a quarter of its
!> step size. Tolerances that would become finer than rounding are larger instead. There are two, because one may have the same
!> error by chance.
module spintop_sensitivity
    use spintop_axes_of_scene, only: find_swept
    use spintop_case, only: case_t, make_case
    use spintop_differences, only: node_count, nodes_t, nodes_around
    use spintop_kinds, only: dp, no_number
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: is_set, parameter_table_t, unset, unset_integer
    use spintop_planning, only: make_plan, plan_t
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: describe_scene, scene_t
    use spintop_study_column, only: study_column_t
    use spintop_sweep_axes, only: axes_t
    use spintop_table_column, only: column_t
    implicit none
    private
    public :: sensitivities_t, sensitive_key_t, varied_motions_t, sensitivity_t, is_sensitivity, split_name
    public :: set_other_accuracy, other_value, other_accuracies

    !> Number of other accuracies.
    integer, parameter :: other_accuracies = 2

    !> Tolerances below this do not make a motion more accurate; it is also taken for that of an unknown method.
    real(dp), parameter :: finest = 1.0e-15_dp
    !> Factors of the tolerances, of those that cannot be smaller, of the number of steps, and of its limit.
    real(dp), parameter :: smaller(other_accuracies) = [0.1_dp, 0.01_dp], larger(other_accuracies) = [10.0_dp, 3.0_dp]
    integer, parameter :: more(other_accuracies) = [2, 4], of_limit = 8

    !> What separates the column from the key.
    character(*), parameter :: mark = '__'
    !> Groups of the keys: body, effects, start, span.
    character(*), parameter :: groups(4) = [character(8) :: 'top', 'effects', 'initial', 'span']

    !> A number of the input, with respect to which derivatives are computed.
    type :: sensitive_key_t
        !> Its name, as `top.inertia(2)`, and its unit.
        character(:), allocatable :: name, unit
        !> Where its value stands in the scene.
        type(number_slot_t) :: slot
        !> The axis of a sweep that gives its value; 0 if the scene does.
        integer :: axis = 0
    contains
        procedure :: nodes
        procedure :: plan_at
    end type sensitive_key_t

    !> The derivative of a column.
    type :: sensitivity_t
        !> Index of the column among those of which there are derivatives, and of the key among those of the job.
        integer :: column = 0, key = 0
        !> The columns of the derivative and of its error.
        type(column_t) :: derivative, error
    end type sensitivity_t

    !> Motions with other values of keys, which give the columns of which there are derivatives.
    type, abstract :: varied_motions_t
    contains
        procedure(find_varied), deferred :: find
    end type varied_motions_t

    abstract interface
        !> Finds the columns of a motion with another value of a key. What it does not have stays as it is.
        subroutine find_varied(self, key, nodes, i, values, accuracy)
            import :: varied_motions_t, nodes_t, dp
            class(varied_motions_t), intent(in) :: self
            integer, intent(in) :: key, i !! index of the key, and that of the node
            type(nodes_t), intent(in) :: nodes !! the values of the key
            real(dp), intent(inout) :: values(:, :) !! the columns (rows) at each time
            integer, intent(in), optional :: accuracy !! the number of another accuracy
        end subroutine find_varied
    end interface

    !> The sensitivities of a job.
    type :: sensitivities_t
        integer :: count = 0
        type(sensitivity_t), allocatable :: list(:)
        type(sensitive_key_t), allocatable :: keys(:)
        type(study_column_t), allocatable, private :: sources(:)
    contains
        procedure :: find_key
        procedure :: add
        procedure :: columns
        procedure :: table_columns
        procedure :: find_derivatives
        procedure :: differentiate
        procedure :: add_changes
    end type sensitivities_t

contains

    !> Whether the name of a column is that of a sensitivity.
    pure logical function is_sensitivity(name)
        character(*), intent(in) :: name !! name of a column
        is_sensitivity = index(name, mark) > 0
    end function is_sensitivity

    !> The column and the key in the name of a sensitivity.
    pure subroutine split_name(name, column, key)
        character(*), intent(in) :: name !! `COLUMN__KEY`
        character(:), allocatable, intent(out) :: column, key !! the parts of the name
        column = name(:index(name, mark) - 1)
        key = name(index(name, mark) + len(mark):)
    end subroutine split_name

    !> The index of a key, which is added if it is new; `problem` is the reason why there are no derivatives with respect to
    !> it, or ''.
    subroutine find_key(self, name, table, axes, key, problem, hint)
        class(sensitivities_t), intent(inout) :: self
        character(*), intent(in) :: name !! name of the key, as `top.inertia(2)`
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(axes_t), intent(in) :: axes !! axes of a sweep; there may be none
        integer, intent(out) :: key !! the index; 0 if there is a problem
        character(:), allocatable, intent(out) :: problem, hint !! what is wrong, and what to do; '' if nothing is
        type(sensitive_key_t) :: found

        key = 0
        call find_swept(name, table, found%slot, problem, hint)
        if (problem /= '') return
        hint = 'name a real number of &top, &initial, &effects or &span'
        if (all(name(:index(name, '.') - 1) /= groups)) then
            problem = name // ' is not a property of the motion'
        else if (found%slot%is_whole()) then
            problem = name // ' is an integer, so there is no derivative'
        end if
        if (problem /= '') return
        found%name = name
        if (allocated(axes%axis)) found%axis = findloc(axes%axis%slot%is_same(found%slot), .true., dim=1, back=.true.)
        if (found%axis == 0 .and. .not. is_set(found%slot%get())) then
            problem = name // ' has no value at which there could be a derivative'
            hint = 'give ' // name // ' in the input'
            return
        end if
        associate (place => table%find(name(:index(name // '(', '(') - 1)))
            found%unit = trim(table%parameters(place)%unit)
        end associate
        if (.not. allocated(self%keys)) allocate (self%keys(0))
        key = findloc(self%keys%slot%is_same(found%slot), .true., dim=1)
        if (key > 0) return
        self%keys = [self%keys, found]
        key = size(self%keys)
    end subroutine find_key

    !> Adds the derivative of a column; `is_new` tells whether it was not there yet.
    subroutine add(self, column, key, is_new)
        class(sensitivities_t), intent(inout) :: self
        type(study_column_t), intent(in) :: column !! the column
        integer, intent(in) :: key !! index of the key
        logical, intent(out) :: is_new !! whether it was added
        type(sensitivity_t) :: one

        if (.not. allocated(self%list)) allocate (self%list(0), self%sources(0))
        one%column = findloc(self%sources%name, column%name, dim=1)
        if (one%column == 0) then
            self%sources = [self%sources, column]
            one%column = size(self%sources)
        end if
        one%key = key
        is_new = .not. any(self%list%column == one%column .and. self%list%key == key)
        if (.not. is_new) return
        associate (to => self%keys(key))
            one%derivative%name = trim(column%name) // mark // to%name
            one%derivative%unit = column%unit
            if (to%unit /= '' .and. column%unit == '') one%derivative%unit = '1'
            if (scan(to%unit, ' /') > 0) then
                one%derivative%unit = trim(one%derivative%unit) // '/(' // to%unit // ')'
            else if (to%unit /= '') then
                one%derivative%unit = trim(one%derivative%unit) // '/' // to%unit
            end if
            one%derivative%what = 'derivative of ' // trim(column%name) // ' with respect to ' // to%name
        end associate
        one%error = one%derivative
        one%error%name = trim(one%derivative%name) // '_error'
        one%error%what = 'estimate of the error of ' // trim(one%derivative%name)
        self%list = [self%list, one]
        self%count = size(self%list)
    end subroutine add

    !> The distinct columns of which there are derivatives.
    pure function columns(self)
        class(sensitivities_t), intent(in) :: self
        type(study_column_t), allocatable :: columns(:)
        if (allocated(self%sources)) then
            columns = self%sources
        else
            allocate (columns(0))
        end if
    end function columns

    !> The derivatives with respect to a key, each followed by its error, from the quantities at its nodes; and the nodes that are
    !> needed with other accuracies.
    pure subroutine differentiate(self, key, nodes, values, cells, best, is_needed)
        class(sensitivities_t), intent(in) :: self
        integer, intent(in) :: key !! index of the key
        type(nodes_t), intent(in) :: nodes !! its nodes
        real(dp), intent(in) :: values(:, :) !! columns, nodes; NaN where there is none
        real(dp), intent(inout) :: cells(:) !! those of the key are set
        integer, intent(inout) :: best(:) !! the difference on which each derivative of the key rests; 0 where there is none
        logical, intent(inout) :: is_needed(:) !! nodes are added
        integer :: i
        do i = 1, self%count
            if (self%list(i)%key /= key) cycle
            call nodes%differentiate(values(self%list(i)%column, :), cells(2 * i - 1), cells(2 * i), best(i))
            if (best(i) > 0) is_needed(nodes%ends(best(i))) = .true.
        end do
    end subroutine differentiate

    !> Adds to the derivatives and their errors what the quantities with other accuracies tell of the error of the method.
    pure subroutine add_changes(self, key, nodes, values, others, best, cells)
        class(sensitivities_t), intent(in) :: self
        integer, intent(in) :: key, best(:) !! index of the key; as `differentiate` gives it
        type(nodes_t), intent(in) :: nodes !! its nodes
        real(dp), intent(in) :: values(:, :), others(:, :, :) !! columns, nodes, accuracies
        real(dp), intent(inout) :: cells(:) !! those of the key change
        integer :: i
        do i = 1, self%count
            if (self%list(i)%key /= key) cycle
            call nodes%add_change(best(i), values(self%list(i)%column, :), others(self%list(i)%column, :, :), &
                                  cells(2 * i - 1), cells(2 * i))
        end do
    end subroutine add_changes

    !> The columns of a table: each derivative, followed by its error.
    pure function table_columns(self) result(columns)
        class(sensitivities_t), intent(in) :: self
        type(column_t) :: columns(2 * self%count)
        integer :: i
        do i = 1, self%count
            columns(2 * i - 1) = self%list(i)%derivative
            columns(2 * i) = self%list(i)%error
        end do
    end function table_columns

    !> The nodes around a value of the key.
    type(nodes_t) function nodes(self, value)
        class(sensitive_key_t), intent(in) :: self
        real(dp), intent(in) :: value !! value of the key, in its unit
        nodes = nodes_around(value, keeps_sign=.not. self%slot%accepts(-value))
        call nodes%limit_to(self%slot%accepts(nodes%x))
    end function nodes

    !> The derivatives and their errors at each time: the motions at all nodes of a key belong together by their times.
    subroutine find_derivatives(self, nodes, motions, base, cells, status)
        class(sensitivities_t), intent(in) :: self
        type(nodes_t), intent(in) :: nodes(:) !! the values of each key
        class(varied_motions_t), intent(in) :: motions !! the motions with other values
        real(dp), intent(in) :: base(:, :) !! the columns (rows) at each time
        real(dp), intent(out) :: cells(:, :) !! two for each derivative at each time; NaN where it does not exist
        integer, intent(out) :: status !! 0; otherwise the memory is too small for so many times
        real(dp), allocatable :: values(:, :, :), others(:, :, :, :)
        integer, allocatable :: best(:, :)
        logical :: is_needed(node_count)
        integer :: key, i, k, row

        cells = no_number
        allocate (values(size(base, 1), size(base, 2), node_count), stat=status)
        if (status == 0) allocate (best(self%count, size(base, 2)), stat=status)
        if (status == 0) allocate (others(size(base, 1), size(base, 2), node_count, other_accuracies), stat=status)
        if (status /= 0) return
        do key = 1, size(nodes)
            values = no_number
            values(:, :, 1) = base
            do i = 2, node_count
                if (nodes(key)%is_valid(i)) call motions%find(key, nodes(key), i, values(:, :, i))
            end do
            is_needed = .false.
            do row = 1, size(base, 2)
                call self%differentiate(key, nodes(key), values(:, row, :), cells(:, row), best(:, row), is_needed)
            end do
            ! The error of the method shows at other accuracies.
            others = no_number
            do k = 1, other_accuracies
                do i = 1, node_count
                    if (is_needed(i)) call motions%find(key, nodes(key), i, others(:, :, i, k), k)
                end do
            end do
            do row = 1, size(base, 2)
                call self%add_changes(key, nodes(key), values(:, row, :), others(:, row, :, :), best(:, row), cells(:, row))
            end do
        end do
    end subroutine find_derivatives

    !> Plans the motion of a scene in which the key has another value, if there is such a motion.
    subroutine plan_at(self, scene, value, varied, case, plan, exists, given, number)
        class(sensitive_key_t), intent(in) :: self
        type(scene_t), intent(in) :: scene !! contents of the input, of which the key is a number
        real(dp), intent(in) :: value !! the other value
        type(scene_t), allocatable, target, intent(out) :: varied !! the scene with that value
        type(case_t), intent(out) :: case !! its body, start and span
        type(plan_t), intent(out) :: plan !! its model and method
        logical, intent(out) :: exists !! whether there is such a motion
        type(plan_t), intent(in) :: given !! the plan of the scene
        integer, intent(in), optional :: number !! of another accuracy of its method
        type(parameter_table_t) :: table
        type(number_slot_t) :: slot
        type(problems_t) :: problems
        character(:), allocatable :: problem

        allocate (varied, source=scene)
        varied%certified = .false.
        if (present(number)) call set_other_accuracy(varied, given, number, keeps_rows=.true.)
        call describe_scene(varied, table)
        call table%find_number(self%name, slot, problem)
        call slot%set(value)
        call make_case(varied, case, problems)
        if (.not. problems%any()) call make_plan(varied, case, plan, problems)
        exists = .not. problems%any()
    end subroutine plan_at

    !> Changes the accuracy that a scene asks for. With the exact solution nothing changes.
    pure subroutine set_other_accuracy(scene, plan, number, keeps_rows)
        type(scene_t), intent(inout) :: scene !! contents of the input
        type(plan_t), intent(in) :: plan !! the plan of the scene
        integer, intent(in) :: number !! which of the accuracies
        logical, intent(in) :: keeps_rows !! its rows are those of the plan: the steps of fixed size are counted
        real(dp) :: relative

        if (scene%method == 'exact') return
        scene%max_steps = int(min(real(scene%max_steps, dp) * of_limit, real(huge(scene%max_steps) - 1, dp)))
        if (plan%is_adaptive()) then
            relative = finest
            if (is_set(scene%relative_tolerance)) relative = scene%relative_tolerance
            if (allocated(plan%stepper)) relative = plan%stepper%controls%relative_tolerance
            scene%relative_tolerance = other_value('integration.relative_tolerance', relative, relative, number)
            if (is_set(scene%absolute_tolerance)) scene%absolute_tolerance = &
                other_value('integration.absolute_tolerance', scene%absolute_tolerance, relative, number)
            return
        end if
        if (keeps_rows) then
            scene%samples = plan%samples
            scene%steps = plan%stepper%controls%steps
            scene%step = unset
        end if
        if (scene%steps /= unset_integer) scene%steps = more(number) * scene%steps
        if (is_set(scene%step)) scene%step = scene%step / more(number)
    end subroutine set_other_accuracy

    !> The value of a number of the input with another accuracy.
    pure real(dp) function other_value(name, value, relative, number) result(other)
        character(*), intent(in) :: name !! the number, as `integration.steps`
        real(dp), intent(in) :: value !! its value
        real(dp), intent(in) :: relative !! the relative tolerance
        integer, intent(in) :: number !! which of the accuracies
        other = value
        select case (name)
        case ('integration.relative_tolerance', 'integration.absolute_tolerance')
            other = value * smaller(number)
            if (relative * smaller(number) < finest) other = value * larger(number)
        case ('integration.steps')
            other = value * more(number)
        case ('integration.step')
            other = value / more(number)
        case ('integration.max_steps')
            other = value * of_limit
        end select
    end function other_value

end module spintop_sensitivity
