!> What a NetCDF file of a table contains besides its rows: where it comes from, its columns, and the grid of its rows.
!> The header of the same table as text follows from it, so that tables of both formats are recognised alike.
module spintop_netcdf_description
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_netcdf_grid, only: netcdf_axis_t
    use spintop_provenance, only: describe_provenance, fact_t
    use spintop_shard, only: read_shard_line, shard_t
    use spintop_table_column, only: table_column_t
    use spintop_table_head, only: table_head
    use spintop_text, only: string_t
    implicit none
    private
    public :: netcdf_description_t

    !> All but the rows.
    type :: netcdf_description_t
        !> Attributes of the whole file, and another one: the lines of the resolved input.
        type(fact_t), allocatable :: facts(:)
        type(string_t), allocatable :: input(:)
        type(table_column_t), allocatable :: columns(:)
        !> The axes of the grid, of which the last varies fastest from row to row. Columns along an axis are its
        !> coordinate.
        type(netcdf_axis_t), allocatable :: axes(:)
        !> The line that names a part of a sweep; '' if the file contains the whole. The rows of a part are no grid: they
        !> are stored along one dimension, and the axes are those of the whole.
        character(:), allocatable :: part
        !> What a file says of the end of its rows (spintop_table_end); '' if nothing.
        character(:), allocatable :: ending
        !> Level of the compression, 0 to 9: a file in the format NetCDF-4. Without one (-1) it has the classic format.
        integer :: compression = -1
    contains
        procedure :: head
        procedure :: is_part
        procedure :: rows_of_part
    end type netcdf_description_t

contains

    !> Whether the file contains a part of a sweep.
    pure logical function is_part(self)
        class(netcdf_description_t), intent(in) :: self
        is_part = .false.
        if (allocated(self%part)) is_part = self%part /= ''
    end function is_part

    !> Number of rows of a part; 0 if the line that names it is damaged.
    integer function rows_of_part(self) result(rows)
        class(netcdf_description_t), intent(in) :: self
        type(shard_t) :: shard
        integer(int64) :: cases
        logical :: valid
        call read_shard_line(self%part, shard, cases, valid)
        rows = 0
        if (valid) rows = int(shard%last(cases) - shard%first(cases) + 1)
    end function rows_of_part

    !> The header as a table of text has it.
    function head(self) result(text)
        class(netcdf_description_t), intent(in) :: self
        character(:), allocatable :: text
        type(string_t), allocatable :: lines(:)
        call describe_provenance(self%facts, self%input, self%columns, lines)
        text = table_head(lines, self%columns%name)
        if (self%is_part()) text = '# ' // self%part // new_line('a') // text
    end function head

end module spintop_netcdf_description
