!> Butcher tables that a user gives as text, for ARKODE: their coefficients, which are checked, and the methods that they are.
!>
!> The text is the table as books print it: a line for each stage with its node, a bar and its coefficients, and below them
!> lines of weights without a node, of the method and of an embedded one. `order 5 4` gives the orders of both.
module spintop_tableau
    use, intrinsic :: iso_c_binding, only: c_int
    use spintop_arkode, only: arkode_t, arkode_table_t, find_orders, max_arkode_stages
    use spintop_kinds, only: dp
    use spintop_literals, only: read_real
    use spintop_stepper, only: method_info_t, stepper_t
    use spintop_text, only: replace_all, split, string_t, to_text
    implicit none
    private
    public :: tableau_t, parse_tableau, tableau_info, create_tableau_stepper

    !> Highest order whose conditions ARKODE checks.
    integer, parameter :: highest_checked = 6
    !> Admissible difference of a node and the sum of its coefficients, for coefficients of double precision.
    real(dp), parameter :: rounding = 1.0e-13_dp
    !> Largest number of a table.
    real(dp), parameter :: largest = 1.0e6_dp

    !> A table with the name of its method, as in tables, and the text of the input by which it is found.
    type :: tableau_t
        character(20) :: name = ''
        character(256) :: key = ''
        type(arkode_table_t) :: table
    end type tableau_t

contains

    !> Properties of the method of a table.
    function tableau_info(tableau) result(info)
        type(tableau_t), intent(in) :: tableau !! a table without a problem
        type(method_info_t) :: info
        character(:), allocatable :: orders
        associate (table => tableau%table)
            info%name = tableau%name
            info%implicit = table%implicit /= 0
            info%order = int(table%order)
            info%adaptive = table%embedded_order > 0
            info%fixed_step = .true.
            info%caught_by_reset = table%order == 1
            info%family = 'own table'
            orders = to_text(int(table%order))
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
        real(dp) :: values(max_arkode_stages)
        type(string_t), allocatable :: lines(:)
        character(:), allocatable :: line
        integer :: number, order_line, count, rows, bar

        problem = ''
        rows = 0
        order_line = 0
        call split(replace_all(replace_all(text, achar(9), ' '), achar(13), ' '), new_line('a'), lines)
        do number = 1, size(lines)
            if (problem /= '') exit
            line = trim(lines(number)%text(:scan(lines(number)%text // '#', '#') - 1))
            bar = index(line, '|')
            if (line == '') then
                cycle
            else if (index(line, 'order ') == 1) then
                order_line = number
                call read_numbers(line(7:), values, count, problem)
                if (problem == '') call set_orders(values(:count), tableau%table, problem)
            else if (bar == 0) then
                problem = "this is neither 'order P' nor a row of the table, which has a bar: c | a1 a2 ..."
            else
                call read_numbers(line(bar + 1:), values, count, problem)
                if (problem == '') call add_row(line(:bar - 1), values(:count), tableau%table, rows, problem)
            end if
            if (problem /= '') problem = 'line ' // to_text(number) // ': ' // problem
        end do
        if (problem == '') call check_whole(tableau%table, rows, order_line, problem)
    end subroutine parse_tableau

    !> The numbers of a text, which may be fractions.
    subroutine read_numbers(text, values, count, problem)
        character(*), intent(in) :: text
        real(dp), intent(out) :: values(max_arkode_stages)
        integer, intent(out) :: count
        character(:), allocatable, intent(out) :: problem
        type(string_t), allocatable :: words(:)
        integer :: i

        values = 0
        count = 0
        problem = ''
        call split(text, ' ', words)
        do i = 1, size(words)
            if (words(i)%text == '') cycle
            if (count == max_arkode_stages) problem = 'a table has at most ' // to_text(max_arkode_stages) // ' stages'
            if (problem /= '') return
            count = count + 1
            call read_number(words(i)%text, values(count), problem)
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

end module spintop_tableau
