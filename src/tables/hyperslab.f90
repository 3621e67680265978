!> Consecutive elements of an array as a few boxes of it.
module spintop_hyperslab
    use, intrinsic :: iso_fortran_env, only: int64
    implicit none
    private
    public :: find_box

contains

    !> The largest box of an array that begins with an element and holds nothing but it and some of
    !> the next `elements - 1`, in order: all along the first dimensions, a part of the next, one
    !> index in the others.
    pure subroutine find_box(extent, first, elements, start, count)
        integer, intent(in) :: extent(:)           !! of the array; the first varies fastest
        integer(int64), intent(in) :: first        !! number of the element, from 1
        integer(int64), intent(in) :: elements     !! most of the box, within the array
        integer, intent(out) :: start(size(extent)) !! where the box begins
        integer, intent(out) :: count(size(extent)) !! what it has along each dimension
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

end module spintop_hyperslab
