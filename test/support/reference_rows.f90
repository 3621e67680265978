!> Reads the tables in test/reference.
module reference_rows
    use spintop_errors, only: error_t
    use spintop_kinds, only: dp
    use spintop_loaded_table, only: read_table, table_t
    implicit none
    private
    public :: known_rows_t, read_reference

    !> A table of numbers: values(row, column).
    type, extends(table_t) :: known_rows_t
        real(dp), allocatable :: values(:, :)
    end type known_rows_t

contains

    !> Reads test/reference/NAME.csv; the tests run in the root of the checkout.
    subroutine read_reference(name, table)
        character(*), intent(in) :: name
        type(known_rows_t), intent(out) :: table
        type(error_t), allocatable :: error
        integer :: k
        call read_table('test/reference/' // name // '.csv', table%table_t, error)
        if (allocated(error)) error stop 'reference_rows: no such table'
        allocate (table%values(table%rows, size(table%names)))
        do k = 1, size(table%names)
            table%values(:, k) = table%column(table%names(k)%text)
        end do
    end subroutine read_reference

end module reference_rows
