!> Where the motion comes from that others are measured against.
module spintop_reference_kinds
    implicit none
    private
    public :: reference_names, reference_auto, reference_exact

    !> Places of words below: `auto` takes the exact motion where there is one, else quadruple precision.
    integer, parameter :: reference_auto = 1, reference_exact = 2
    !> The words for these in an input.
    character(*), parameter :: reference_names(3) = [character(9) :: 'auto', 'exact', 'quadruple']

end module spintop_reference_kinds
