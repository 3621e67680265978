!> Butcher tables that ARKODE runs: those of the library, by name, and those of a user.
module spintop_arkode_tables
    use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_null_char
    use spintop_text, only: lower_case, string_t
    implicit none
    private
    public :: arkode_table_t, arkode_table_names, find_arkode_table, find_orders, max_arkode_stages

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

        pure subroutine find_table(name, implicit, table, found) bind(C, name='spintop_arkode_find')
            import :: arkode_table_t, c_char, c_int
            character(kind=c_char), intent(in) :: name(*)
            integer(c_int), intent(in), value :: implicit
            type(arkode_table_t), intent(inout) :: table
            integer(c_int), intent(out) :: found
        end subroutine find_table

        !> The orders that the coefficients of a table have, as far as conditions are checked: up to 6.
        subroutine find_orders(table, order, embedded_order) bind(C, name='spintop_arkode_orders')
            import :: arkode_table_t, c_int
            type(arkode_table_t), intent(in) :: table !! the table
            integer(c_int), intent(out) :: order, embedded_order !! those of the method and of the embedded one
        end subroutine find_orders
    end interface

contains

    !> Names of the explicit or of the implicit tables: those of SUNDIALS in lower case.
    function arkode_table_names(implicit_tables) result(names)
        logical, intent(in) :: implicit_tables !! true for the implicit tables, false for the explicit ones
        type(string_t), allocatable :: names(:)
        character(40) :: name
        integer(c_int) :: i, group
        group = merge(1_c_int, 0_c_int, implicit_tables)
        i = 0
        do while (name_of_table(group, i + 1, name) /= 0)
            i = i + 1
        end do
        allocate (names(i))
        do i = 1, size(names)
            if (name_of_table(group, i, name) /= 0) names(i)%text = lower_case(name(:index(name, c_null_char) - 1))
        end do
    end function arkode_table_names

    !> The explicit or implicit table of a name ('' for the default); `found` reports whether it exists.
    pure subroutine find_arkode_table(name, implicit_table, table, found)
        character(*), intent(in) :: name !! name of the table; '' for the default
        logical, intent(in) :: implicit_table !! whether a diagonally implicit table is requested
        type(arkode_table_t), intent(out) :: table !! the table, if it was found
        logical, intent(out) :: found !! whether it was found
        integer(c_int) :: is_found
        call find_table(trim(name) // c_null_char, merge(1_c_int, 0_c_int, implicit_table), table, is_found)
        found = is_found /= 0
    end subroutine find_arkode_table

end module spintop_arkode_tables
