!> Results for C: tables of columns, as structures that the library makes and deletes, and that C reads.
!> `include/spintop.h` describes them.
module spintop_c_result
    use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_int, c_loc, c_long_long, c_null_char, &
        c_null_ptr, c_ptr
    use spintop_execution, only: memory_run_t
    use spintop_loaded_table, only: data_table_t
    use spintop_table_column, only: column_t
    use spintop_text, only: string_t
    implicit none
    private
    public :: columns_t, hand_result

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

    !> Where the words of a column are.
    type :: places_t
        type(c_ptr), allocatable :: at(:)
    end type places_t

    !> Columns as C reads them, and to what they point: the name, the unit and the meaning of each, and its words.
    type :: columns_t
        type(c_column_t), allocatable :: face(:)
        type(string_t), allocatable, private :: texts(:, :)
        type(places_t), allocatable, private :: words(:)
    contains
        procedure :: describe
    end type columns_t

    !> A result, and what it points to.
    type :: owner_t
        type(c_result_t) :: result
        type(memory_run_t) :: run
        type(columns_t), allocatable :: columns(:)
        type(c_table_t), allocatable :: tables(:)
    end type owner_t

contains

    !> Describes columns, without values.
    subroutine describe(self, columns)
        class(columns_t), target, intent(inout) :: self
        class(column_t), intent(in) :: columns(:) !! name, unit and meaning of each
        integer :: i
        allocate (self%face(size(columns)), self%texts(3, size(columns)))
        do i = 1, size(columns)
            self%texts(1, i)%text = trim(columns(i)%name) // c_null_char
            self%texts(2, i)%text = trim(columns(i)%unit) // c_null_char
            self%texts(3, i)%text = trim(columns(i)%what) // c_null_char
            self%face(i) = c_column_t(c_loc(self%texts(1, i)%text), c_loc(self%texts(2, i)%text), c_loc(self%texts(3, i)%text))
        end do
    end subroutine describe

    !> Hands the result of a run to C, which owns it from then on.
    type(c_ptr) function hand_result(run) result(handle)
        type(memory_run_t), intent(inout) :: run !! its tables are moved
        type(owner_t), pointer :: owner
        integer :: i

        allocate (owner)
        owner%run%summary = trim(run%summary) // c_null_char
        owner%run%warnings = trim(run%warnings) // c_null_char
        call move_alloc(run%table, owner%run%table)
        allocate (owner%columns(size(owner%run%table)), owner%tables(size(owner%run%table)))
        do i = 1, size(owner%tables)
            call describe_table(owner%run%table(i), owner%columns(i), owner%tables(i))
        end do
        owner%result = c_result_t(int(run%code, c_int), size(owner%tables), c_loc(owner%tables), c_loc(owner%run%summary), &
                                  c_loc(owner%run%warnings), c_loc(owner))
        handle = c_loc(owner%result)
    end function hand_result

    !> Describes a table. Its texts get null characters at their ends.
    subroutine describe_table(table, columns, face)
        type(data_table_t), target, intent(inout) :: table
        type(columns_t), target, intent(inout) :: columns
        type(c_table_t), intent(out) :: face
        integer :: i, k

        call columns%describe(table%column)
        allocate (columns%words(size(table%column)))
        do i = 1, size(table%column)
            associate (data => table%column(i), column => columns%face(i))
                if (size(data%values) > 0) column%values = c_loc(data%values)
                if (.not. allocated(data%words)) cycle
                allocate (columns%words(i)%at(max(1, size(data%words))))
                do k = 1, size(data%words)
                    data%words(k)%text = trim(data%words(k)%text) // c_null_char
                    columns%words(i)%at(k) = c_loc(data%words(k)%text)
                end do
                column%words = c_loc(columns%words(i)%at)
                column%word_count = size(data%words)
            end associate
        end do
        table%name = trim(table%name) // c_null_char
        if (.not. allocated(table%frame)) table%frame = ''
        table%frame = trim(table%frame) // c_null_char
        face = c_table_t(c_loc(table%name), c_loc(columns%face), size(table%column, kind=c_long_long), table%rows, &
                         c_loc(table%frame))
    end subroutine describe_table

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
