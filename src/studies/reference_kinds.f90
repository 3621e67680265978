!> Where the motion comes from that others are measured against.
module spintop_reference_kinds
    implicit none
    private
    public :: reference_names, reference_auto, reference_exact, reference_quadruple

    !> The exact motion, or a motion in quadruple precision; `auto` takes the first where there is one.
    integer, parameter :: reference_auto = 1, reference_exact = 2, reference_quadruple = 3
    !> The words for these in an input.
    character(*), parameter :: reference_names(3) = [character(9) :: 'auto', 'exact', 'quadruple']

end module spintop_reference_kinds
