!> The grid of a NetCDF table: its axes, its rows as boxes of an array, and names by the CF conventions.
module spintop_netcdf_grid
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_table_column, only: column_length
    implicit none
    private
    public :: netcdf_axis_t, netcdf_name, other_unit, most_netcdf_rows, find_box, size_of_chunk

    !> Maximum number of rows: in the format with 64-bit offsets a variable is smaller than 4 GiB.
    integer(int64), parameter :: most_netcdf_rows = 2_int64**29 - 1

    !> Words that begin a unit, and those of UDUNITS for them.
    character(*), parameter :: own_words(3) = [character(18) :: 'deg', 'rev', 'g0']
    character(*), parameter :: udunits_words(3) = [character(18) :: 'degree', 'revolution', 'standard_free_fall']

    !> An axis of the grid, which is also a dimension; the last one varies fastest from row to row.
    type :: netcdf_axis_t
        character(column_length) :: name = ''
        integer :: length = 0
    end type netcdf_axis_t

contains

    !> A name that the CF conventions allow, of letters, digits and underscores: `top_inertia_2` for
    !> `top.inertia(2)`, `part_place_2_1` for `part.place(2,1)`.
    pure function netcdf_name(name) result(allowed)
        character(*), intent(in) :: name !! any name
        character(:), allocatable :: allowed
        integer :: i
        allowed = ''
        do i = 1, len_trim(name)
            select case (name(i:i))
            case ('.', '(', ',')
                allowed = allowed // '_'
            case (')')
            case default
                allowed = allowed // name(i:i)
            end select
        end do
    end function netcdf_name

    !> A unit in the form of UDUNITS, or the unit of which that has this form: the first word is another one, if it is listed.
    pure function other_unit(unit, is_own) result(other)
        character(*), intent(in) :: unit !! unit of a column, or as UDUNITS has it
        logical, intent(in) :: is_own !! whether it is that of a column
        character(:), allocatable :: other
        integer :: last, i
        last = scan(unit // ' ', ' */^') - 1
        other = trim(unit)
        do i = 1, size(own_words)
            if (unit(:last) /= merge(own_words(i), udunits_words(i), is_own)) cycle
            other = trim(merge(udunits_words(i), own_words(i), is_own)) // trim(unit(last + 1:))
        end do
        if (unit == merge(' ', '1', is_own)) other = trim(merge('1', ' ', is_own))
    end function other_unit

    !> The largest box of an array that begins with an element and contains only this and some of the next
    !> `elements - 1`, in order: all of the first dimensions, a part of the next one, one index in the others.
    pure subroutine find_box(extent, first, elements, start, count)
        integer, intent(in) :: extent(:)           !! of the array; the first varies fastest
        integer(int64), intent(in) :: first        !! number of the element, from 1
        integer(int64), intent(in) :: elements     !! maximum size of the box, within the array
        integer, intent(out) :: start(size(extent)) !! where the box begins
        integer, intent(out) :: count(size(extent)) !! extent of the box along each dimension
        integer(int64) :: rest, below
        integer :: i

        rest = first - 1
        do i = 1, size(extent)
            start(i) = int(mod(rest, int(extent(i), int64))) + 1
            rest = rest / extent(i)
        end do
        count = 1
        below = 1
        do i = 1, size(extent)
            count(i) = int(min(int(extent(i) - start(i) + 1, int64), elements / below))
            if (count(i) < extent(i)) exit
            below = below * extent(i)
        end do
    end subroutine find_box

    !> The extent of the chunks of an array, which are compressed one by one: consecutive elements, so that an array that is
    !> written in order needs the memory of one chunk.
    pure function size_of_chunk(extent) result(chunk)
        integer, intent(in) :: extent(:) !! of the array; the first varies fastest
        integer :: chunk(size(extent)), start(size(extent))
        integer(int64), parameter :: most_elements = 2_int64**17
        call find_box(extent, 1_int64, most_elements, start, chunk)
    end function size_of_chunk

end module spintop_netcdf_grid
