!> Results for C: tables of columns, as structures that the library makes and deletes, and that C reads.
!> `include/spintop.h` describes them.
module spintop_c_result
    use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_loc, c_long_long, c_null_ptr, c_ptr
    use spintop_c_error, only: c_text_t
    use spintop_loaded_table, only: data_column_t, data_table_t
    use spintop_execution, only: memory_run_t
    use spintop_table_column, only: column_t
    implicit none
    private
    public :: c_column_t, described_column_t, hand_result

    !> `spintop_column` of the header.
    type, bind(C) :: c_column_t
        type(c_ptr) :: name = c_null_ptr, unit = c_null_ptr, what = c_null_ptr, values = c_null_ptr, words = c_null_ptr
        integer(c_long_long) :: word_count = 0
    end type c_column_t

    !> `spintop_table` of the header.
    type, bind(C) :: c_table_t
        type(c_ptr) :: name = c_null_ptr, columns = c_null_ptr
        integer(c_long_long) :: column_count = 0, row_count = 0
        type(c_ptr) :: frame = c_null_ptr
    end type c_table_t

    !> `spintop_result` of the header.
    type, bind(C) :: c_result_t
        integer(c_int) :: code = 0, table_count = 0
        type(c_ptr) :: tables = c_null_ptr, summary = c_null_ptr, warnings = c_null_ptr, owner = c_null_ptr
    end type c_result_t

    !> The texts of a column.
    type :: described_column_t
        type(c_text_t) :: name, unit, what
        type(c_text_t), allocatable :: words(:)
        type(c_ptr), allocatable :: word_places(:)
    contains
        procedure :: describe
    end type described_column_t

    !> A table, and what it points to.
    type :: table_owner_t
        type(c_text_t) :: name, frame
        type(data_table_t) :: data
        type(described_column_t), allocatable :: described(:)
        type(c_column_t), allocatable :: columns(:)
    end type table_owner_t

    !> A result, and what it points to.
    type :: owner_t
        type(c_result_t) :: result
        type(c_text_t) :: summary, warnings
        type(table_owner_t), allocatable :: table(:)
        type(c_table_t), allocatable :: tables(:)
    end type owner_t

contains

    !> Hands the result of a run to C, which owns it from then on.
    type(c_ptr) function hand_result(run) result(handle)
        type(memory_run_t), intent(inout) :: run !! its tables are moved
        type(owner_t), pointer :: owner
        integer :: i

        allocate (owner)
        call owner%summary%set(run%summary)
        call owner%warnings%set(run%warnings)
        allocate (owner%table(size(run%table)), owner%tables(size(run%table)))
        do i = 1, size(run%table)
            call adopt_table(run%table(i), owner%table(i))
            owner%tables(i) = face_of(owner%table(i))
        end do
        owner%result = c_result_t(int(run%code, c_int), size(owner%tables), c_loc(owner%tables), owner%summary%at(), &
                                  owner%warnings%at(), c_loc(owner))
        handle = c_loc(owner%result)
    end function hand_result

    !> A table as C reads it.
    type(c_table_t) function face_of(table) result(face)
        type(table_owner_t), target, intent(in) :: table
        face = c_table_t(table%name%at(), c_loc(table%columns), size(table%columns, kind=c_long_long), table%data%rows, &
                         table%frame%at())
    end function face_of

    !> Moves a table to its owner, and describes its columns for C.
    subroutine adopt_table(table, owner)
        type(data_table_t), target, intent(inout) :: table
        type(table_owner_t), target, intent(inout) :: owner
        integer :: i

        call owner%name%set(table%name)
        if (.not. allocated(table%frame)) table%frame = ''
        call owner%frame%set(table%frame)
        owner%data%rows = table%rows
        call move_alloc(table%column, owner%data%column)
        allocate (owner%columns(size(owner%data%column)), owner%described(size(owner%data%column)))
        do i = 1, size(owner%columns)
            call describe_column(owner%data%column(i), owner%described(i), owner%columns(i))
        end do
    end subroutine adopt_table

    subroutine describe_column(data, described, column)
        type(data_column_t), target, intent(in) :: data
        type(described_column_t), target, intent(inout) :: described
        type(c_column_t), intent(out) :: column
        integer :: i

        call described%describe(data%column_t, column)
        if (size(data%values) > 0) column%values = c_loc(data%values)
        if (.not. allocated(data%words)) return
        allocate (described%words(max(1, size(data%words))), described%word_places(max(1, size(data%words))))
        do i = 1, size(data%words)
            call described%words(i)%set(data%words(i)%text)
            described%word_places(i) = described%words(i)%at()
        end do
        column%words = c_loc(described%word_places)
        column%word_count = size(data%words)
    end subroutine describe_column

    !> Describes a column without values.
    subroutine describe(self, about, column)
        class(described_column_t), target, intent(inout) :: self
        type(column_t), intent(in) :: about !! name, unit and meaning
        type(c_column_t), intent(out) :: column !! the column for C
        call self%name%set(about%name)
        call self%unit%set(about%unit)
        call self%what%set(about%what)
        column%name = self%name%at()
        column%unit = self%unit%at()
        column%what = self%what%at()
    end subroutine describe

    !> Deletes a result.
    subroutine delete_result(handle) bind(C, name='spintop_result_delete')
        type(c_ptr), value :: handle !! the result; may be null
        type(c_result_t), pointer :: result
        type(owner_t), pointer :: owner
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, result)
        call c_f_pointer(result%owner, owner)
        deallocate (owner)
    end subroutine delete_result

end module spintop_c_result
