!> The Butcher tables of ARKODE, for tests of each of them.
module library_tables
    use spintop_arkode, only: arkode_table_names, arkode_table, arkode_table_t
    use spintop_text, only: string_t
    implicit none
    private
    public :: library_table_t, all_library_tables

    type :: library_table_t
        character(40) :: name = ''
        logical :: implicit = .false.
        integer :: stages = 0, order = 0, embedded_order = 0
        !> With its coefficients.
        type(arkode_table_t) :: table = arkode_table_t()
    end type library_table_t

contains

    !> All tables, explicit ones first.
    function all_library_tables() result(tables)
        type(library_table_t), allocatable :: tables(:)
        type(string_t), allocatable :: names(:)
        integer :: i, explicit
        explicit = size(arkode_table_names(.false.))
        allocate (names, source=[arkode_table_names(.false.), arkode_table_names(.true.)])
        allocate (tables(size(names)))
        do i = 1, size(names)
            tables(i)%name = names(i)%text
            tables(i)%implicit = i > explicit
            tables(i)%table = arkode_table(names(i)%text, tables(i)%implicit)
            tables(i)%stages = int(tables(i)%table%stages)
            tables(i)%order = int(tables(i)%table%order)
            tables(i)%embedded_order = int(tables(i)%table%embedded_order)
        end do
    end function all_library_tables

end module library_tables
