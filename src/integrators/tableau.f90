!> Butcher tables that a user gives as text: their coefficients, which are checked, and the kind of method that they are.
!>
!> The text is the table as books print it: a line for each stage with its node, a bar and its coefficients, and below them
!> lines of weights without a node, of the method and of an embedded one. `order 5 4` gives the orders of both.
module spintop_tableau
    use spintop_kinds, only: dp
    use spintop_literals, only: read_real
    use spintop_text, only: to_text
    implicit none
    private
    public :: tableau_t, parse_tableau, max_tableau_stages

    !> Maximum number of stages.
    integer, parameter :: max_tableau_stages = 16
    !> Highest order whose conditions are checked.
    integer, parameter :: highest_checked = 5
    !> Admissible residual of a condition, for coefficients of double precision.
    real(dp), parameter :: rounding = 1.0e-13_dp
    !> Largest number of a table.
    real(dp), parameter :: largest = 1.0e6_dp

    !> A table: k_i = f(t + c_i h, y + h sum_j a_ij k_j), y+ = y + h sum_i b_i k_i.
    type :: tableau_t
        !> Name of the method, as in tables, and the text of the input by which it is found.
        character(20) :: name = ''
        character(256) :: key = ''
        integer :: stages = 0
        !> Orders of the method and of the embedded one; 0 if there is none.
        integer :: order = 0, embedded_order = 0
        !> a(i, j) multiplies k_j in stage i.
        real(dp) :: a(max_tableau_stages, max_tableau_stages) = 0
        !> Weights, those of the embedded method, and the nodes.
        real(dp), dimension(max_tableau_stages) :: b = 0, embedded = 0, c = 0
    contains
        procedure :: is_explicit
        procedure :: is_triangular
    end type tableau_t

contains

    !> Whether each stage follows from those before it.
    pure logical function is_explicit(self)
        class(tableau_t), intent(in) :: self
        integer :: i
        is_explicit = all([(all(abs(self%a(i, i:)) <= 0), i=1, self%stages)])
    end function is_explicit

    !> Whether each stage follows from those before it and from itself.
    pure logical function is_triangular(self)
        class(tableau_t), intent(in) :: self
        integer :: i
        is_triangular = all([(all(abs(self%a(i, i + 1:)) <= 0), i=1, self%stages)])
    end function is_triangular

    !> Reads and checks a table; `problem` is what is wrong with it, with the line, or ''.
    subroutine parse_tableau(text, tableau, problem)
        character(*), intent(in) :: text !! contents of the file
        type(tableau_t), intent(out) :: tableau !! the table, if there is no problem
        character(:), allocatable, intent(out) :: problem !! what is wrong; '' if nothing is
        real(dp) :: values(max_tableau_stages)
        character(:), allocatable :: line
        integer :: first, length, number, count, rows, bar

        problem = ''
        rows = 0
        number = 0
        first = 1
        do while (first <= len(text) .and. problem == '')
            length = scan(text(first:) // new_line('a'), new_line('a')) - 1
            line = text(first:first + length - 1)
            line = clean(line(:scan(line // '#', '#') - 1))
            first = first + length + 1
            number = number + 1
            bar = index(line, '|')
            if (line == '') then
                cycle
            else if (index(line, 'order ') == 1) then
                call read_numbers(line(7:), values, count, problem)
                if (problem == '') call set_orders(values(:count), tableau, problem)
            else if (bar == 0) then
                problem = "this is neither 'order P' nor a row of the table, which has a bar: c | a1 a2 ..."
            else
                call read_numbers(line(bar + 1:), values, count, problem)
                if (problem == '') call add_row(line(:bar - 1), values(:count), tableau, rows, problem)
            end if
            if (problem /= '') problem = 'line ' // to_text(number) // ': ' // problem
        end do
        if (problem == '') call check_whole(tableau, rows, problem)
    end subroutine parse_tableau

    !> A line without tabs, carriage returns and blanks at its ends.
    pure function clean(line) result(text)
        character(*), intent(in) :: line
        character(:), allocatable :: text
        integer :: i
        text = line
        do i = 1, len(text)
            if (iachar(text(i:i)) < 32) text(i:i) = ' '
        end do
        text = trim(adjustl(text))
    end function clean

    !> The numbers of a text, which may be fractions.
    subroutine read_numbers(text, values, count, problem)
        character(*), intent(in) :: text
        real(dp), intent(out) :: values(max_tableau_stages)
        integer, intent(out) :: count
        character(:), allocatable, intent(out) :: problem
        character(:), allocatable :: rest
        integer :: length

        values = 0
        count = 0
        problem = ''
        rest = trim(adjustl(text))
        do while (rest /= '')
            length = index(rest // ' ', ' ') - 1
            if (count == max_tableau_stages) then
                problem = 'a table has at most ' // to_text(max_tableau_stages) // ' stages'
                return
            end if
            count = count + 1
            call read_number(rest(:length), values(count), problem)
            if (problem /= '') return
            rest = trim(adjustl(rest(length + 1:)))
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
    subroutine set_orders(values, tableau, problem)
        real(dp), intent(in) :: values(:)
        type(tableau_t), intent(inout) :: tableau
        character(:), allocatable, intent(inout) :: problem
        integer :: i
        logical :: is_whole(size(values))

        is_whole = [(abs(values(i) - nint(values(i))) <= 0 .and. nint(values(i)) >= 1 .and. nint(values(i)) <= 20, &
                     i=1, size(values))]
        if (tableau%order > 0) then
            problem = 'the orders are given twice'
        else if (size(values) < 1 .or. size(values) > 2 .or. .not. all(is_whole)) then
            problem = "expected 'order P' or 'order P Q', of the method and of the embedded one, whole numbers from 1 to 20"
        else
            tableau%order = nint(values(1))
            if (size(values) == 2) tableau%embedded_order = nint(values(2))
        end if
    end subroutine set_orders

    !> Adds a row of the table: that of a stage or, without a node, weights.
    subroutine add_row(node, values, tableau, rows, problem)
        character(*), intent(in) :: node
        real(dp), intent(in) :: values(:)
        type(tableau_t), intent(inout) :: tableau
        integer, intent(inout) :: rows !! number of rows of weights
        character(:), allocatable, intent(inout) :: problem
        real(dp) :: total

        if (node == '') then
            rows = rows + 1
            if (rows > 2) problem = 'there are three rows of weights; expected those of the method and of an embedded one'
            if (size(values) /= tableau%stages) then
                problem = 'this row has ' // to_text(size(values)) // ' weights, and the table ' // &
                          to_text(tableau%stages) // ' stages'
            end if
            if (problem /= '') return
            if (rows == 1) tableau%b(:size(values)) = values
            if (rows == 2) tableau%embedded(:size(values)) = values
        else if (rows > 0) then
            problem = 'a stage below the weights; expected all stages above them'
        else if (tableau%stages == max_tableau_stages) then
            problem = 'a table has at most ' // to_text(max_tableau_stages) // ' stages'
        else
            tableau%stages = tableau%stages + 1
            associate (i => tableau%stages)
                call read_number(trim(node), tableau%c(i), problem)
                if (problem /= '') return
                tableau%a(i, :size(values)) = values
                total = sum(values)
                if (abs(total - tableau%c(i)) > rounding * (1 + sum(abs(values)))) then
                    problem = 'the coefficients of stage ' // to_text(i) // ' add up to ' // to_text(total) // &
                              ', and not to its node ' // to_text(tableau%c(i))
                end if
            end associate
        end if
    end subroutine add_row

    !> Checks that the table is complete, and its orders.
    subroutine check_whole(tableau, rows, problem)
        type(tableau_t), intent(in) :: tableau
        integer, intent(in) :: rows
        character(:), allocatable, intent(inout) :: problem

        if (tableau%stages == 0) then
            problem = 'there are no stages; expected rows c | a1 a2 ...'
        else if (rows == 0) then
            problem = 'there are no weights; expected a row | b1 b2 ... below the stages'
        else if (tableau%order == 0) then
            problem = "there is no order; expected a line 'order P'"
        else if ((rows == 2) .neqv. (tableau%embedded_order > 0)) then
            problem = "an embedded method has a second row of weights and a second order, 'order P Q'"
        else if (any(abs(tableau%a(:, tableau%stages + 1:)) > 0)) then
            problem = 'a stage has more coefficients than there are stages'
        else if (rows == 2 .and. all(abs(tableau%b - tableau%embedded) <= 0)) then
            problem = 'the two rows of weights are the same'
        else
            call check_order(tableau, tableau%b, tableau%order, 'the method', problem)
            if (rows == 2) call check_order(tableau, tableau%embedded, tableau%embedded_order, 'the embedded method', problem)
        end if
    end subroutine check_whole

    !> Checks the conditions of an order, up to the highest one that is checked (Hairer, Norsett and Wanner, Solving ODEs I, II.2).
    subroutine check_order(tableau, b, order, whose, problem)
        type(tableau_t), intent(in) :: tableau
        real(dp), intent(in) :: b(:)
        integer, intent(in) :: order
        character(*), intent(in) :: whose
        character(:), allocatable, intent(inout) :: problem
        integer, parameter :: conditions = 17
        !> The order of each condition, and the reciprocal of its right-hand side.
        integer, parameter :: orders(conditions) = [1, 2, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 5, 5, 5, 5, 5]
        integer, parameter :: density(conditions) = [1, 2, 3, 6, 4, 8, 12, 24, 5, 10, 15, 30, 20, 20, 40, 60, 120]
        character(*), parameter :: names(conditions) = [character(12) :: 'b', 'b c', 'b c^2', 'b A c', 'b c^3', 'b c A c', &
            'b A c^2', 'b A A c', 'b c^4', 'b c^2 A c', 'b c A c^2', 'b c A A c', 'b (A c)^2', 'b A c^3', 'b A c A c', &
            'b A A c^2', 'b A A A c']
        real(dp), dimension(size(b)) :: ac, ac2, aac
        real(dp) :: trees(size(b), conditions), found
        integer :: i

        if (problem /= '') return
        associate (a => tableau%a, c => tableau%c)
            ac = matmul(a, c)
            ac2 = matmul(a, c**2)
            aac = matmul(a, ac)
            trees(:, 1) = 1
            trees(:, 2) = c
            trees(:, 3) = c**2
            trees(:, 4) = ac
            trees(:, 5) = c**3
            trees(:, 6) = c * ac
            trees(:, 7) = ac2
            trees(:, 8) = aac
            trees(:, 9) = c**4
            trees(:, 10) = c**2 * ac
            trees(:, 11) = c * ac2
            trees(:, 12) = c * aac
            trees(:, 13) = ac**2
            trees(:, 14) = matmul(a, c**3)
            trees(:, 15) = matmul(a, c * ac)
            trees(:, 16) = matmul(a, ac2)
            trees(:, 17) = matmul(a, aac)
        end associate
        do i = 1, conditions
            if (orders(i) > min(order, highest_checked)) return
            found = dot_product(b, trees(:, i))
            if (abs(found - 1.0_dp / density(i)) <= rounding * (1 + dot_product(abs(b), abs(trees(:, i))))) cycle
            problem = whose // ' does not have order ' // to_text(order) // ': the condition of order ' // to_text(orders(i)) // &
                      ', sum ' // trim(names(i)) // ' = 1/' // to_text(density(i)) // ', gives ' // to_text(found)
            return
        end do
    end subroutine check_order

end module spintop_tableau
