!> Words of the input that several modules use.
module spintop_scene_words
    implicit none
    private
    public :: study_kinds, kind_trajectory, kind_sweep, kind_precision, kind_stability, kind_benchmark, kind_fit
    public :: reference_names, reference_auto, reference_exact, reference_quadruple
    public :: combination_names, combine_grid, combine_zip, combine_random, combine_latin_hypercube, combine_sobol, &
        combine_saltelli
    public :: key_length

    !> Maximum length of the name of a key with its subscripts.
    integer, parameter :: key_length = 40

    !> Kinds of study: indices of `study_kinds`.
    integer, parameter :: kind_trajectory = 1, kind_sweep = 2, kind_precision = 3, kind_stability = 4, &
        kind_benchmark = 5, kind_fit = 6
    !> Their names in an input (study.kind).
    character(*), parameter :: study_kinds(6) = [character(14) :: 'trajectory', 'sweep', 'work_precision', 'stability', &
        'benchmark', 'fit']

    !> Kinds of reference motion: indices of `reference_names`. `auto` is the exact solution where it exists,
    !> else a motion in quadruple precision.
    integer, parameter :: reference_auto = 1, reference_exact = 2, reference_quadruple = 3
    !> Their names in an input (work_precision.reference).
    character(*), parameter :: reference_names(3) = [character(9) :: 'auto', 'exact', 'quadruple']

    !> How the axes of a sweep combine into cases, by its place in `combination_names`: all combinations, the last
    !> axis varying fastest; the values of all axes side by side; and samples (see `spintop_sample_design`).
    integer, parameter :: combine_grid = 1, combine_zip = 2, combine_random = 3, combine_latin_hypercube = 4, &
        combine_sobol = 5, combine_saltelli = 6
    !> The words for these in an input (sweep.combine).
    character(*), parameter :: combination_names(6) = [character(15) :: 'grid', 'zip', 'random', 'latin_hypercube', &
        'sobol', 'saltelli']

end module spintop_scene_words
