!> The axes of a sweep: the values that each takes, and how they combine into cases.
!> Any case is computed by itself, at a cost and in a memory that do not grow with the number of cases.
!> The values of a case are put into a copy of the scene.
module spintop_sweep_axes
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t
    use spintop_sample_design, only: design_latin_hypercube, design_random, design_saltelli, design_sobol, &
        sample_design_t
    use spintop_scene_keys, only: describe_scene, scene_t, combine_grid, combine_latin_hypercube, combine_random, &
        combine_saltelli, combine_sobol, combine_zip
    use spintop_sweep_axis, only: law_lognormal, law_normal, law_sphere, law_uniform, normal_value, axis_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: axes_t, axis_t, base_of, case_scene_t

    !> Designs of the samples, by combination from `combine_random`.
    integer, parameter :: designs(combine_random:combine_saltelli) = [design_random, design_latin_hypercube, design_sobol, &
        design_saltelli]

    !> Largest number of cases: every number of a case is exact as a real number.
    real(dp), parameter :: most_cases = 1.0e15_dp

    !> Points of a sample that are found together.
    integer, parameter :: strip = 64

    !> Axes and their combination.
    type :: axes_t
        type(axis_t), allocatable :: axis(:)
        integer(int64) :: cases = 0
        integer :: combination = combine_grid
        integer(int64) :: seed = 1
        !> The points of a sample; the coordinate of each axis, the first of several.
        type(sample_design_t) :: design
        integer, allocatable, private :: coordinate(:)
        !> The axes with normal values, or whose logarithms are normal, and the factor of their covariance.
        integer, allocatable, private :: normal(:)
        real(dp), allocatable, private :: factor(:, :)
    contains
        procedure :: combine
        procedure :: correlate
        procedure :: out_of_range
        procedure :: values_of
        procedure :: find_block
        procedure :: place_of
        procedure :: varies
        procedure :: last_of
        procedure :: in_words
    end type axes_t

    !> A copy of the scene that describes some axes, which takes the values of one case after another. Its
    !> slots point into the scene, so it must not be copied.
    type :: case_scene_t
        type(scene_t), allocatable :: scene
        !> Where the value of each axis goes.
        type(number_slot_t), allocatable, private :: slots(:)
    contains
        procedure :: copy => copy_scene
        procedure :: set_values
    end type case_scene_t

contains

    !> Sets the number of cases: that of a grid is the product of the numbers of values, that of a zip the
    !> common number. A grid with too many cases to count has none.
    pure subroutine combine(self, combination, cases, seed)
        class(axes_t), intent(inout) :: self
        integer, intent(in) :: combination !! one of the combination constants
        integer(int64), intent(in) :: cases, seed !! number of cases, and seed of random samples

        self%combination = combination
        self%seed = seed
        self%cases = cases
        select case (combination)
        case (combine_grid)
            self%cases = 0
            if (product(real(self%axis%count, dp)) <= most_cases) then
                self%cases = product(int(self%axis%count, int64))
            end if
        case (combine_zip)
            self%cases = self%axis(1)%count
        case default
            call start_design(self)
        end select
    end subroutine combine

    !> Gives each axis its coordinates in the points of a sample, and starts the sample. Each axis is a factor, or all
    !> components of a vector together.
    pure subroutine start_design(self)
        type(axes_t), intent(inout) :: self
        logical :: whole(sum(self%axis%dimensions()))
        integer :: factor(size(whole)), i, last, factors

        allocate (self%coordinate(size(self%axis)), source=0)
        last = 0
        factors = 0
        do i = 1, size(self%axis)
            associate (axis => self%axis(i), first => last + 1)
                if (axis%component == 1) factors = factors + 1
                self%coordinate(i) = first
                last = last + axis%dimensions()
                whole(first:last) = axis%is_discrete()
                factor(first:last) = factors
            end associate
        end do
        call self%design%start(designs(self%combination), self%cases, self%seed, whole, factor)
        call self%correlate(reshape([real(dp) ::], [0, 0]))
    end subroutine start_design

    !> Sets the axes with normal values, and the lower triangular factor of their covariance; with an empty one their
    !> values are independent.
    pure subroutine correlate(self, factor)
        class(axes_t), intent(inout) :: self
        real(dp), intent(in) :: factor(:, :) !! as many rows and columns as there are such axes, or none
        integer :: i
        self%normal = pack([(i, i=1, size(self%axis))], self%axis%law == law_normal .or. self%axis%law == law_lognormal)
        if (allocated(self%factor)) deallocate (self%factor)
        if (size(factor) > 0) then
            self%factor = factor
            return
        end if
        allocate (self%factor(size(self%normal), size(self%normal)), source=0.0_dp)
        do i = 1, size(self%normal)
            self%factor(i, i) = self%axis(self%normal(i))%deviation
        end do
    end subroutine correlate

    !> The values of the axes in case `number`, from 1.
    pure function values_of(self, number) result(values)
        class(axes_t), intent(in) :: self
        integer(int64), intent(in) :: number !! number of the case, from 1
        real(dp) :: values(size(self%axis)), block(size(values), 1)
        call self%find_block(number, block)
        values = block(:, 1)
    end function values_of

    !> The values of consecutive cases.
    pure subroutine find_block(self, number, values)
        class(axes_t), intent(in) :: self
        integer(int64), intent(in) :: number !! number of the first case
        real(dp), intent(out) :: values(:, :) !! of each case: one value for each axis
        integer :: k

        select case (self%combination)
        case (combine_grid)
            call find_block_of_grid(self, number, values)
        case (combine_zip)
            do k = 1, size(values, 2)
                values(:, k) = self%axis%value(int(number) + k - 1)
            end do
        case default
            call find_block_of_sample(self, number, values)
        end select
    end subroutine find_block

    !> The same on a grid: as far as the last axis goes, then the first value of it with the next of the others.
    pure subroutine find_block_of_grid(self, number, values)
        type(axes_t), intent(in) :: self
        integer(int64), intent(in) :: number
        real(dp), intent(out) :: values(:, :)
        integer(int64) :: rest
        integer :: last, run, first, i, k, n

        last = size(self%axis)
        n = size(values, 2)
        k = 1
        do while (k <= n)
            rest = number + k - 2
            do i = last, 1, -1
                values(i, k) = self%axis(i)%value(int(mod(rest, int(self%axis(i)%count, int64))) + 1)
                rest = rest / self%axis(i)%count
            end do
            associate (axis => self%axis(last))
                first = int(mod(number + k - 2, int(axis%count, int64))) + 1
                run = min(axis%count - first, n - k)
                values(last, k + 1:k + run) = axis%value([(first + i, i=1, run)])
            end associate
            values(:last - 1, k + 1:k + run) = spread(values(:last - 1, k), 2, run)
            k = k + run + 1
        end do
    end subroutine find_block_of_grid

    !> The same of a sample.
    pure subroutine find_block_of_sample(self, number, values)
        type(axes_t), intent(in) :: self
        integer(int64), intent(in) :: number
        real(dp), intent(out) :: values(:, :)
        real(dp) :: fractions(self%design%dimensions, strip)
        integer :: first, last, k

        do first = 1, size(values, 2), strip
            last = min(first + strip - 1, size(values, 2))
            call self%design%find_block(number + first - 1, fractions(:, :last - first + 1))
            do k = first, last
                call draw_values(self, fractions(:, k - first + 1), values(:, k))
            end do
        end do
    end subroutine find_block_of_sample

    !> The values at a point of a sample.
    pure subroutine draw_values(self, fractions, values)
        type(axes_t), intent(in) :: self
        real(dp), intent(in) :: fractions(:)
        real(dp), intent(out) :: values(:)
        real(dp) :: standard(size(self%normal))
        integer :: i, k

        do i = 1, size(self%axis)
            associate (axis => self%axis(i), first => self%coordinate(i))
                if (axis%law == law_uniform) then
                    values(i) = axis%draw(fractions(first))
                else if (axis%law == law_sphere .and. axis%component == 1) then
                    call axis%draw_on_sphere(fractions(first:first + axis%dimensions() - 1), &
                                             values(i:i + axis%components - 1))
                end if
            end associate
        end do
        if (size(self%normal) == 0) return
        standard = normal_value(fractions(self%coordinate(self%normal)))
        do k = 1, size(self%normal)
            i = self%normal(k)
            values(i) = self%axis(i)%mean + dot_product(self%factor(k, :k), standard(:k))
            if (self%axis(i)%law == law_lognormal) values(i) = exp(values(i))
        end do
    end subroutine draw_values

    !> Number of the first axis whose value in a case is not in the range of its parameter, which a normal distribution
    !> does not know; 0 if there is none.
    pure integer function out_of_range(self, values)
        class(axes_t), intent(in) :: self
        real(dp), intent(in) :: values(:) !! one value for each axis
        integer :: k
        out_of_range = 0
        if (.not. allocated(self%normal)) return
        do k = 1, size(self%normal)
            out_of_range = self%normal(k)
            if (.not. self%axis(out_of_range)%slot%accepts(values(out_of_range))) return
        end do
        out_of_range = 0
    end function out_of_range

    !> Index of the parameter of an axis in a table.
    integer function place_of(self, i, table)
        class(axes_t), intent(in) :: self
        integer, intent(in) :: i !! number of the axis
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        place_of = table%find(base_of(self%axis(i)%key))
    end function place_of

    !> Name of a parameter without its subscript.
    pure function base_of(name) result(base)
        character(*), intent(in) :: name !! as `top.inertia(2)`
        character(:), allocatable :: base
        base = name(:index(name // '(', '(') - 1)
    end function base_of

    !> Whether a parameter of a group varies.
    pure logical function varies(self, group)
        class(axes_t), intent(in) :: self
        character(*), intent(in) :: group !! name of the group, as `top`
        integer :: i
        varies = any([(index(self%axis(i)%key, group // '.') == 1, i=1, size(self%axis))])
    end function varies

    !> The last axis whose parameter, or the vector of which it is an element, has one of these names; 0 if there is none.
    pure integer function last_of(self, names)
        class(axes_t), intent(in) :: self
        character(*), intent(in) :: names(:) !! the names
        do last_of = size(self%axis), 1, -1
            if (any(names == base_of(self%axis(last_of)%key))) return
        end do
    end function last_of

    !> Description of the cases.
    function in_words(self) result(text)
        class(axes_t), intent(in) :: self
        character(:), allocatable :: text, scrambling
        scrambling = 'not scrambled'
        if (self%seed /= 0) scrambling = 'scrambled with seed ' // to_text(self%seed)
        text = to_text(self%cases) // ' cases: '
        if (self%cases == 1) text = '1 case: '
        select case (self%combination)
        case (combine_grid)
            text = text // 'all combinations, the last axis varying fastest'
        case (combine_zip)
            text = text // 'the values of all axes side by side'
        case (combine_random)
            text = text // 'a random sample with seed ' // to_text(self%seed)
        case (combine_latin_hypercube)
            text = text // 'a Latin hypercube sample with seed ' // to_text(self%seed)
        case (combine_sobol)
            text = text // "points of a Sobol' sequence, " // scrambling
        case (combine_saltelli)
            text = text // to_text(self%cases / (self%design%factors + 2)) // ' groups of ' // &
                   to_text(self%design%factors + 2) // " for sensitivity indices, from a Sobol' sequence, " // scrambling
        end select
    end function in_words

    !> Makes it a copy of the scene that describes the axes.
    subroutine copy_scene(self, scene, axes)
        class(case_scene_t), target, intent(inout) :: self
        type(scene_t), intent(in) :: scene !! the scene
        type(axes_t), intent(in) :: axes !! the axes
        type(parameter_table_t) :: table
        character(:), allocatable :: problem
        integer :: i, number, row, column
        allocate (self%scene, source=scene)
        call describe_scene(self%scene, table)
        allocate (self%slots(size(axes%axis)))
        do i = 1, size(self%slots)
            call table%locate(axes%axis(i)%key, number, row, column, problem)
            call table%unset_twin(number, row, column, column)
            call table%find_number(axes%axis(i)%key, self%slots(i), problem)
            self%slots(i)%size = axes%axis(i)%slot%size
        end do
    end subroutine copy_scene

    !> Sets the values of a case, in the order of the axes, in the scene: those from the first that may have changed.
    subroutine set_values(self, values, first)
        class(case_scene_t), target, intent(inout) :: self
        real(dp), intent(in) :: values(:) !! one value for each axis
        integer, intent(in), optional :: first !! number of that axis; all are set if it is absent
        integer :: begin
        begin = 1
        if (present(first)) begin = first
        call self%slots(begin:)%set(values(begin:))
    end subroutine set_values

end module spintop_sweep_axes
