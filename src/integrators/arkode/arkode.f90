!> Runge-Kutta methods of SUNDIALS ARKODE, explicit and diagonally implicit, with a table of the library or of a user, adaptive
!> or with a fixed step size. arkode.c calls the library; here are the equations and the end of a step.
!>
!> Reynolds, Gardner, Woodward and Chinomona, ACM TOMS 49 (2023).
!>
!> A user gives a table as text, as books print it: a line for each stage with its node, a bar and its coefficients, and below them
!> lines of weights without a node, of the method and of an embedded one. `order 5 4` gives the orders of both. Coefficients and
!> orders are checked.
module spintop_arkode
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_int64_t, c_loc, &
        c_null_char, c_null_ptr, c_ptr
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, is_equal, is_finite
    use spintop_fixed_step, only: advance_on_grid, begin_on_grid, grid_stepper_t, longest_step
    use spintop_formulation, only: formulation_info_t, max_states
    use spintop_status, only: is_ok, status_integrator, status_non_finite, status_not_converged, status_ok, &
        status_outside, status_step_too_small
    use spintop_literals, only: read_real
    use spintop_stepper, only: method_info_t, name_of_method, run_state_t, stepper_t
    use spintop_text, only: append, lower_case, replace_all, split, string_t, to_text
    implicit none
    private
    public :: arkode_table_t, arkode_table_names, arkode_table, find_orders, arkode_t
    public :: tableau_t, parse_tableau, tableau_info, create_tableau_stepper

    !> Maximum number of stages.
    integer, parameter :: max_arkode_stages = 16

    !> A table: k_i = f(t + c_i h, y + h sum_j a_ji k_j), y+ = y + h sum_i b_i k_i. Columns of a are stages.
    type, bind(C) :: arkode_table_t
        !> Not 0 if a stage depends on itself.
        integer(c_int) :: implicit = 0
        !> Orders of the method, and of the embedded one, with which step control compares it; 0 if there is none.
        integer(c_int) :: stages = 0, order = 0, embedded_order = 0
        real(c_double) :: a(max_arkode_stages, max_arkode_stages) = 0
        real(c_double), dimension(max_arkode_stages) :: b = 0, embedded = 0, c = 0
    end type arkode_table_t

    interface
        integer(c_int) function name_of_table(implicit, i, name) bind(C, name='spintop_arkode_name')
            import :: c_char, c_int
            integer(c_int), value :: implicit, i
            character(kind=c_char), intent(out) :: name(*)
        end function name_of_table

        pure subroutine find_table(name, implicit, table) bind(C, name='spintop_arkode_find')
            import :: arkode_table_t, c_char, c_int
            character(kind=c_char), intent(in) :: name(*)
            integer(c_int), intent(in), value :: implicit
            type(arkode_table_t), intent(inout) :: table
        end subroutine find_table

        !> The orders that the coefficients of a table have, as far as conditions are checked: up to 6.
        subroutine find_orders(table, order, embedded_order) bind(C, name='spintop_arkode_orders')
            import :: arkode_table_t, c_int
            type(arkode_table_t), intent(in) :: table !! the table
            integer(c_int), intent(out) :: order, embedded_order !! those of the method and of the embedded one
        end subroutine find_orders

        type(c_ptr) function create_run(n, t, y, unit, scale, absolute, relative, cyclic, table, is_adaptive, by_insertion) &
            bind(C, name='spintop_arkode_create')
            import :: arkode_table_t, c_double, c_int, c_ptr
            integer(c_int), value :: n, is_adaptive, by_insertion
            real(c_double), value :: t
            real(c_double), dimension(*), intent(in) :: y, unit, scale, absolute, relative
            integer(c_int), intent(in) :: cyclic(*)
            type(arkode_table_t), intent(in) :: table
        end function create_run

        integer(c_int) function step_of_run(run, current, h, t_end, t_stop, rejected, jacobians) &
            bind(C, name='spintop_arkode_step')
            import :: c_double, c_int, c_int64_t, c_ptr
            type(c_ptr), value :: run, current
            real(c_double), value :: h, t_end, t_stop
            integer(c_int64_t), intent(inout) :: rejected, jacobians
        end function step_of_run

        subroutine restart_run(run, t, y, h) bind(C, name='spintop_arkode_restart')
            import :: c_double, c_ptr
            type(c_ptr), value :: run
            real(c_double), value :: t, h
            real(c_double), intent(in) :: y(*)
        end subroutine restart_run

        real(c_double) function last_trial(run) bind(C, name='spintop_arkode_last_trial')
            import :: c_double, c_ptr
            type(c_ptr), value :: run
        end function last_trial

        subroutine destroy_run(run) bind(C, name='spintop_arkode_destroy')
            import :: c_ptr
            type(c_ptr), value :: run
        end subroutine destroy_run
    end interface

    !> What the functions that ARKODE calls during a step need.
    type :: step_t
        type(run_state_t), pointer :: run => null()
        !> Status of the last evaluation of the right-hand side.
        integer :: status = status_ok
    end type step_t

    !> ARKStep with an explicit or, if `info%implicit`, a diagonally implicit table.
    type, extends(grid_stepper_t) :: arkode_t
        !> A table that is not of ARKODE's own.
        type(arkode_table_t), allocatable :: own
        !> The run on the side of C.
        type(c_ptr) :: handle = c_null_ptr
        type(step_t) :: current = step_t()
        !> The state as ARKODE has it.
        real(dp) :: y_known(max_states) = 0
    contains
        procedure :: begin
        procedure :: advance
        procedure :: try_step
        procedure :: finish
        procedure :: order
    end type arkode_t

    !> Factor of the step size after a failure of the right-hand side.
    real(dp), parameter :: cut = 0.25_dp
    !> ARKODE does not control steps shorter than this, in units of the spacing of the end of the span: it treats so close a stop
    !> time as reached.
    real(dp), parameter :: smallest_spacings = 512
    !> The tolerance for ARKODE with a fixed step size, where it has no effect.
    real(dp), parameter :: fixed_step_tolerance = 1.0e-12_dp
    !> Return values of the functions that ARKODE calls: continue, retry with a shorter step, fail.
    integer(c_int), parameter :: go_on = 0, retry = 1, give_up = -1
    !> What its steps return.
    integer, parameter :: status_of(0:3) = [status_ok, status_step_too_small, status_not_converged, status_integrator]

    !> Highest order whose conditions ARKODE checks.
    integer, parameter :: highest_checked = 6
    !> Admissible difference of a node and the sum of its coefficients, for coefficients of double precision.
    real(dp), parameter :: rounding = 1.0e-13_dp
    !> Largest number of a table.
    real(dp), parameter :: largest = 1.0e6_dp

    !> A table with the name of its method, as in tables, and the text of the input by which it is found.
    type :: tableau_t
        !> Name of its method.
        character(name_of_method) :: name = ''
        !> What stands for it in an input: the path of its file, and the checksum.
        character(256) :: key = ''
        !> Its coefficients.
        type(arkode_table_t) :: table
    end type tableau_t

contains

    !> Names of the explicit or of the implicit tables: those of SUNDIALS in lower case.
    function arkode_table_names(implicit_tables) result(names)
        logical, intent(in) :: implicit_tables !! true for the implicit tables, false for the explicit ones
        type(string_t), allocatable :: names(:)
        character(40) :: name
        allocate (names(0))
        do while (name_of_table(merge(1_c_int, 0_c_int, implicit_tables), size(names) + 1, name) /= 0)
            call append(names, lower_case(name(:index(name, c_null_char) - 1)))
        end do
    end function arkode_table_names

    !> The table of the library of a name; without stages if there is none.
    pure type(arkode_table_t) function arkode_table(name, implicit_table) result(table)
        character(*), intent(in) :: name !! name of the table; '' for the default
        logical, intent(in) :: implicit_table !! whether a diagonally implicit table is requested
        call find_table(trim(name) // c_null_char, merge(1_c_int, 0_c_int, implicit_table), table)
    end function arkode_table

    !> The table that is given, or the selected one.
    type(arkode_table_t) function table_of(self) result(table)
        class(arkode_t), intent(in) :: self
        if (allocated(self%own)) then
            table = self%own
        else
            table = arkode_table(self%controls%table, self%info%implicit)
        end if
    end function table_of

    !> Order of the table; 0 if there is none of the name that is selected.
    integer function order(self)
        class(arkode_t), intent(in) :: self
        type(arkode_table_t) :: table
        table = table_of(self)
        order = table%order
    end function order

    !> First slope, and a new run of ARKODE, because the result must not depend on earlier runs. A failure in the library is
    !> reported by the first step.
    subroutine begin(self, status)
        class(arkode_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(arkode_table_t) :: table
        type(formulation_info_t) :: info
        real(dp) :: tolerances(2)

        call begin_on_grid(self, status)
        if (.not. is_ok(status)) return
        status = status_integrator
        table = table_of(self)
        if (table%stages == 0) return
        info = self%formulation%info()
        tolerances = fixed_step_tolerance
        if (self%controls%steps == 0) then
            ! ARKODE limits the root mean square of the errors of the components. With this factor no component exceeds its
            ! tolerance, as with ode45.
            tolerances = [self%controls%relative_tolerance, self%controls%absolute_tolerance] / sqrt(real(info%states, dp))
        end if
        call self%set_weight(tolerances(1), tolerances(2))
        self%y_known = self%y
        call self%finish()
        self%handle = create_run(int(info%states, c_int), self%t, self%y, self%formulation%units(), &
            self%formulation%scale, self%weight%absolute, self%weight%relative, merge(1_c_int, 0_c_int, self%formulation%cyclic), &
            table, merge(1_c_int, 0_c_int, self%controls%steps == 0), merge(1_c_int, 0_c_int, self%controls%fixed_point))
        if (c_associated(self%handle)) status = status_ok
    end subroutine begin

    !> Frees what ARKODE keeps of the run.
    subroutine finish(self)
        class(arkode_t), intent(inout) :: self
        call destroy_run(self%handle)
        self%handle = c_null_ptr
    end subroutine finish

    !> One accepted step; rejected steps are counted.
    subroutine advance(self, status)
        class(arkode_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        status = status_ok
        if (.not. all(is_equal(self%y, self%y_known))) then
            ! The caller has changed the state since the last step.
            call self%evaluate(self%t, self%y, self%slope, status)
            call restart(self, 0.0_dp)
        end if
        if (.not. is_ok(status)) return
        if (self%controls%steps == 0) then
            call advance_adaptively(self, status)
        else
            call advance_on_grid(self, status)
        end if
    end subroutine advance

    !> Makes ARKODE go on from the state, with a first step of size `h` if that is not 0.
    subroutine restart(self, h)
        class(arkode_t), intent(inout) :: self
        real(dp), intent(in) :: h
        self%y_known = self%y
        call restart_run(self%handle, self%t, self%y, h)
    end subroutine restart

    !> A step on the grid of fixed step size, or where it ends.
    subroutine try_step(self, h, t_new, status)
        class(arkode_t), intent(inout) :: self
        real(dp), intent(in) :: h, t_new !! step size, s, and time at its end, s
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        call take_step(self, h, t_new, t_new, status)
        ! ARKODE sums its steps, with rounding errors.
        if (is_ok(status)) self%t = t_new
        if (status == status_outside) call restart(self, 0.0_dp)
    end subroutine try_step

    !> A step whose size ARKODE chooses. With an explicit table ARKODE fails at once if the right-hand side fails within the
    !> step; the step is then repeated with a smaller size.
    subroutine advance_adaptively(self, status)
        class(arkode_t), intent(inout) :: self
        integer, intent(out) :: status
        real(dp) :: stop_time, h, h_smallest

        h_smallest = smallest_spacings * spacing(self%t_end)
        stop_time = min(self%t_end, self%t + longest_step(self%formulation, self%y))
        if (stop_time - self%t <= h_smallest) then
            ! Too short for step control.
            status = status_step_too_small
            if (stop_time <= self%t) return
            call restart(self, 0.0_dp)
            call take_step(self, stop_time - self%t, stop_time, stop_time, status)
            if (is_ok(status)) self%t = stop_time
            return
        end if
        do
            call take_step(self, 0.0_dp, self%t_end, stop_time, status)
            if (is_ok(status) .or. is_ok(self%current%status)) exit
            h = cut * last_trial(self%handle)
            if (.not. h > 0) h = cut**2 * (stop_time - self%t)
            if (h <= h_smallest) exit
            call restart(self, h)
        end do
    end subroutine advance_adaptively

    !> One step of ARKODE, of the size `h` if that is not 0, and its status. After a failure the state is the one before.
    subroutine take_step(self, h, t_end, t_stop, status)
        class(arkode_t), intent(inout), target :: self
        real(dp), intent(in) :: h, t_end, t_stop
        integer, intent(out) :: status
        type(run_state_t) :: before
        integer(c_int64_t) :: rejected, jacobians
        integer(int64) :: evaluations

        before = self%run_state_t
        rejected = 0
        jacobians = 0
        self%current%run => self%run_state_t
        self%current%status = status_ok
        status = status_of(step_of_run(self%handle, c_loc(self%current), h, t_end, t_stop, rejected, jacobians))
        if (.not. is_ok(status)) then
            evaluations = self%counts%evaluations
            self%run_state_t = before
            self%counts%evaluations = evaluations
            if (.not. is_ok(self%current%status)) status = self%current%status
        end if
        self%y_known = self%y
        self%counts%rejected = self%counts%rejected + rejected
        self%counts%jacobians = self%counts%jacobians + jacobians
    end subroutine take_step

    !> y' = f(t, y), called by ARKODE. The slope at the state reached is known and costs nothing.
    integer(c_int) function find_slope(current, t, y, slope) bind(C, name='spintop_arkode_rhs') result(verdict)
        type(c_ptr), value :: current
        real(c_double), value :: t
        real(c_double), intent(in) :: y(max_states)
        real(c_double), intent(inout) :: slope(max_states)
        type(step_t), pointer :: now
        logical :: known

        call c_f_pointer(current, now)
        known = all(is_equal(y, now%run%y))
        if (now%run%formulation%depends_on_time) known = known .and. is_equal(t, now%run%t)
        if (known) then
            now%status = status_ok
            slope = now%run%slope
        else
            call now%run%evaluate(t, y, slope, now%status)
        end if
        verdict = go_on
        if (is_ok(now%status)) return
        verdict = give_up
        if (now%run%controls%steps == 0 .or. now%status == status_outside) verdict = retry
    end function find_slope

    !> After an accepted step to `t`, called by ARKODE, which continues from the state that the formulation makes of it.
    integer(c_int) function finish_step(current, t, y) bind(C, name='spintop_arkode_finish') result(verdict)
        type(c_ptr), value :: current
        real(c_double), value :: t
        real(c_double), intent(inout) :: y(max_states)
        type(step_t), pointer :: now
        logical :: changed

        call c_f_pointer(current, now)
        verdict = give_up
        now%status = status_non_finite
        if (.not. all(is_finite(y))) return
        call now%run%accept_step(t, y, changed)
        y = now%run%y
        call now%run%evaluate(t, now%run%y, now%run%slope, now%status)
        if (is_ok(now%status)) verdict = go_on
    end function finish_step

    !> Properties of the method of a table.
    function tableau_info(tableau) result(info)
        type(tableau_t), intent(in) :: tableau !! a table without a problem
        type(method_info_t) :: info
        character(:), allocatable :: orders
        associate (table => tableau%table)
            info = method_info_t(tableau%name, order=int(table%order), fixed_step=.true., adaptive=table%embedded_order > 0, &
                                 implicit=table%implicit /= 0, caught_by_reset=table%order == 1, family='own table')
            orders = to_text(info%order)
            if (info%adaptive) orders = orders // '(' // to_text(int(table%embedded_order)) // ')'
            info%what = trim(merge('implicit', 'explicit', info%implicit)) // ' Runge-Kutta method of order ' // orders // &
                        ' with ' // to_text(int(table%stages)) // ' stages, from a file'
        end associate
    end function tableau_info

    !> The method of a table.
    subroutine create_tableau_stepper(tableau, stepper)
        type(tableau_t), intent(in) :: tableau !! a table without a problem
        class(stepper_t), allocatable, intent(out) :: stepper !! with default settings
        allocate (stepper, source=arkode_t(info=tableau_info(tableau), own=tableau%table))
    end subroutine create_tableau_stepper

    !> Reads and checks a table; `problem` is what is wrong with it, with the line, or ''.
    subroutine parse_tableau(text, tableau, problem)
        character(*), intent(in) :: text !! contents of the file
        type(tableau_t), intent(out) :: tableau !! the table, if there is no problem
        character(:), allocatable, intent(out) :: problem !! what is wrong; '' if nothing is
        real(dp), allocatable :: values(:)
        type(string_t), allocatable :: lines(:)
        character(:), allocatable :: line
        integer :: number, order_line, rows, bar

        problem = ''
        rows = 0
        order_line = 0
        call split(replace_all(replace_all(text, achar(9), ' '), achar(13), ' '), new_line('a'), lines)
        do number = 1, size(lines)
            if (problem /= '') exit
            line = trim(lines(number)%text(:scan(lines(number)%text // '#', '#') - 1))
            bar = index(line, '|')
            if (line == '') cycle
            if (index(line, 'order ') == 1) then
                order_line = number
                call read_numbers(line(7:), values, problem)
                if (problem == '') call set_orders(values, tableau%table, problem)
            else if (bar == 0) then
                problem = "this is neither 'order P' nor a row of the table, which has a bar: c | a1 a2 ..."
            else
                call read_numbers(line(bar + 1:), values, problem)
                if (problem == '') call add_row(line(:bar - 1), values, tableau%table, rows, problem)
            end if
            if (problem /= '') problem = 'line ' // to_text(number) // ': ' // problem
        end do
        if (problem == '') call check_whole(tableau%table, rows, order_line, problem)
    end subroutine parse_tableau

    !> The numbers of a text, which may be fractions.
    subroutine read_numbers(text, values, problem)
        character(*), intent(in) :: text
        real(dp), allocatable, intent(out) :: values(:)
        character(:), allocatable, intent(out) :: problem
        type(string_t), allocatable :: words(:)
        real(dp) :: value
        integer :: i

        allocate (values(0))
        problem = ''
        call split(text, ' ', words)
        do i = 1, size(words)
            if (words(i)%text == '') cycle
            if (size(values) == max_arkode_stages) problem = 'a table has at most ' // to_text(max_arkode_stages) // ' stages'
            if (problem /= '') return
            call read_number(words(i)%text, value, problem)
            values = [values, value]
        end do
    end subroutine read_numbers

    !> A number or a fraction.
    subroutine read_number(word, value, problem)
        character(*), intent(in) :: word
        real(dp), intent(out) :: value
        character(:), allocatable, intent(inout) :: problem
        real(dp) :: part(2)
        character(:), allocatable :: wrong, hint
        integer :: slash

        value = 0
        part = 1
        slash = index(word // '/', '/')
        call read_real(word(:slash - 1), part(1), wrong, hint)
        if (wrong == '' .and. slash <= len(word)) call read_real(word(slash + 1:), part(2), wrong, hint)
        if (wrong /= '' .or. abs(part(2)) <= 0 .or. maxval(abs(part)) > largest) then
            problem = "'" // word // "' is not a number; expected a number or a fraction, as 0.25 or 1/4"
            return
        end if
        value = part(1) / part(2)
    end subroutine read_number

    !> Sets the orders of the method and of the embedded one.
    subroutine set_orders(values, table, problem)
        real(dp), intent(in) :: values(:)
        type(arkode_table_t), intent(inout) :: table
        character(:), allocatable, intent(inout) :: problem

        if (table%order > 0) then
            problem = 'the orders are given twice'
        else if (size(values) < 1 .or. size(values) > 2 .or. any(abs(values - nint(values)) > 0) &
                 .or. any(values < 1 .or. values > 20)) then
            problem = "expected 'order P' or 'order P Q', of the method and of the embedded one, whole numbers from 1 to 20"
        else
            table%order = nint(values(1), c_int)
            if (size(values) == 2) table%embedded_order = nint(values(2), c_int)
        end if
    end subroutine set_orders

    !> Adds a row of the table: that of a stage or, without a node, weights.
    subroutine add_row(node, values, table, rows, problem)
        character(*), intent(in) :: node
        real(dp), intent(in) :: values(:)
        type(arkode_table_t), intent(inout) :: table
        integer, intent(inout) :: rows !! number of rows of weights
        character(:), allocatable, intent(inout) :: problem

        if (node == '') then
            rows = rows + 1
            if (rows > 2) problem = 'there are three rows of weights; expected those of the method and of an embedded one'
            if (size(values) /= table%stages) then
                problem = 'this row has ' // to_text(size(values)) // ' weights, and the table ' // &
                          to_text(int(table%stages)) // ' stages'
            end if
            if (problem /= '') return
            if (rows == 1) table%b(:size(values)) = values
            if (rows == 2) table%embedded(:size(values)) = values
        else if (rows > 0) then
            problem = 'a stage below the weights; expected all stages above them'
        else if (table%stages == max_arkode_stages) then
            problem = 'a table has at most ' // to_text(max_arkode_stages) // ' stages'
        else
            table%stages = table%stages + 1
            associate (i => int(table%stages))
                call read_number(trim(node), table%c(i), problem)
                if (problem /= '') return
                table%a(:size(values), i) = values
                if (abs(table%a(i, i)) > 0) table%implicit = 1
                if (any(abs(table%a(i + 1:, i)) > 0)) then
                    problem = 'stage ' // to_text(i) // ' depends on a later one; expected stages that depend on those before &
                              &them and on themselves only (of the other methods there are gauss_4, gauss_6 and gauss_8)'
                else if (abs(sum(values) - table%c(i)) > rounding * (1 + sum(abs(values)))) then
                    problem = 'the coefficients of stage ' // to_text(i) // ' add up to ' // to_text(sum(values)) // &
                              ', and not to its node ' // to_text(table%c(i))
                end if
            end associate
        end if
    end subroutine add_row

    !> Checks that the table is complete, and compares the orders with those that ARKODE finds.
    subroutine check_whole(table, rows, order_line, problem)
        type(arkode_table_t), intent(in) :: table
        integer, intent(in) :: rows, order_line !! number of rows of weights, and of the line with the orders
        character(:), allocatable, intent(inout) :: problem
        integer(c_int) :: found(2), given(2)
        integer :: i

        if (table%stages == 0) then
            problem = 'there are no stages; expected rows c | a1 a2 ...'
        else if (rows == 0) then
            problem = 'there are no weights; expected a row | b1 b2 ... below the stages'
        else if (table%order == 0) then
            problem = "there is no order; expected a line 'order P'"
        else if ((rows == 2) .neqv. (table%embedded_order > 0)) then
            problem = "an embedded method has a second row of weights and a second order, 'order P Q'"
        else if (rows == 2 .and. all(abs(table%b - table%embedded) <= 0)) then
            problem = 'the two rows of weights are the same'
        end if
        if (problem /= '') return
        given = [table%order, table%embedded_order]
        call find_orders(table, found(1), found(2))
        do i = 2, 1, -1
            if (found(i) >= min(given(i), highest_checked)) cycle
            problem = 'line ' // to_text(order_line) // ': ' // &
                      trim(merge('the method         ', 'the embedded method', i == 1)) // ' does not have order ' // &
                      to_text(int(given(i))) // ': its coefficients fulfil the conditions of order ' // &
                      to_text(int(found(i))) // '; correct them, or give that order'
        end do
    end subroutine check_whole

end module spintop_arkode
