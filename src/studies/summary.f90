!> The summary of a study on standard output.
module spintop_summary
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, degree, is_finite
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_free_motion, only: free_motion_t, prepare_free_motion
    use spintop_motion, only: motion_t
    use spintop_nutation, only: nutation_t, find_nutation, class_name, class_meanings
    use spintop_planning, only: plan_t
    use spintop_quantities, only: kinetic_energy, potential_energy, vertical_momentum
    use spintop_steady_motion, only: critical_omega3, fast_top_t, fast_top
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_status, only: count_failed, is_good_end, is_ok, last_status, status_meaning, status_name, status_step_limit
    use spintop_stepper, only: counts_t
    use spintop_sweep_axes, only: axes_t
    use spintop_terminal, only: output_width
    use spintop_text, only: append_wrapped, escaped, string_t, to_text
    implicit none
    private
    public :: summary_t, decimal, duration, rounded, slow_sleeper

    !> Indentation of a line, minimum width of its keyword, and the separator.
    character(*), parameter :: indent = '  '
    integer, parameter :: keyword_width = 10
    !> Blanks before the text of a line, which is below that of the line before it.
    integer, parameter :: text_column = len(indent) + keyword_width

    !> A line, and whether only --verbose prints it.
    type, extends(string_t) :: summary_line_t
        logical :: is_detail = .false.
    end type summary_line_t

    !> Lines of text, each with a keyword.
    type :: summary_t
        type(summary_line_t), allocatable :: lines(:)
    contains
        procedure :: headline
        procedure :: add
        procedure :: print
        procedure :: add_failures
        procedure :: sentence
        procedure :: describe_plan
        procedure :: describe_motion
        procedure :: describe_axes
        procedure :: describe_statistics
        procedure :: describe_cost
    end type summary_t

contains

    !> The first line. Names of files in it may hold anything.
    subroutine headline(self, text)
        class(summary_t), intent(inout) :: self
        character(*), intent(in) :: text !! the first line
        if (allocated(self%lines)) deallocate (self%lines)
        allocate (self%lines(1))
        self%lines(1)%text = escaped(text)
    end subroutine headline

    !> Adds a line with its keyword.
    subroutine add(self, keyword, text, is_detail)
        class(summary_t), intent(inout) :: self
        character(*), intent(in) :: keyword, text !! keyword, and text of the line
        logical, intent(in), optional :: is_detail !! whether only --verbose prints it
        type(summary_line_t) :: line
        character(max(keyword_width, len(keyword) + 1)) :: column
        column = keyword
        line%text = indent // column // escaped(text)
        if (present(is_detail)) line%is_detail = is_detail
        if (.not. allocated(self%lines)) allocate (self%lines(0))
        self%lines = [self%lines, line]
    end subroutine add

    !> The lines for the terminal, wrapped to its width, each behind `before`.
    subroutine print(self, before, verbose, lines)
        class(summary_t), intent(in) :: self
        character(*), intent(in) :: before !! what each line begins with
        logical, intent(in) :: verbose !! whether details are printed
        type(string_t), allocatable, intent(inout) :: lines(:) !! lines of text are added
        integer :: i
        if (.not. allocated(self%lines)) return
        do i = 1, size(self%lines)
            if (self%lines(i)%is_detail .and. .not. verbose) cycle
            call append_wrapped(lines, before, self%lines(i)%text, text_column, output_width())
        end do
    end subroutine print

    !> Says below the first line how many of the cases failed, with which statuses, and what helps; nothing where none failed.
    subroutine add_failures(self, what, counts)
        class(summary_t), intent(inout) :: self
        character(*), intent(in) :: what !! what was counted, in the plural
        integer(int64), intent(in) :: counts(0:last_status) !! number of them with each status
        type(summary_line_t), allocatable :: others(:)
        character(:), allocatable :: text
        character(2) :: separator
        integer :: i

        if (count_failed(counts) == 0) return
        text = to_text(count_failed(counts)) // ' of ' // to_text(sum(counts)) // ' ' // what
        if (count_failed(counts) == sum(counts)) text = 'all ' // to_text(sum(counts)) // ' ' // what
        separator = ': '
        do i = 0, last_status
            if (counts(i) == 0 .or. is_good_end(i)) cycle
            text = text // separator // to_text(counts(i)) // ' ' // status_name(i) // ' (' // status_meaning(i) // ')'
            separator = ', '
        end do
        if (counts(status_step_limit) > 0) text = text // '; increase integration.max_steps'
        allocate (others, source=self%lines(2:))
        self%lines = self%lines(:1)
        call self%add('failed', text)
        self%lines = [self%lines, others]
    end subroutine add_failures

    !> A line without indentation, with a colon after its keyword.
    function sentence(self, i) result(text)
        class(summary_t), intent(in) :: self
        integer, intent(in) :: i !! number of the line
        character(:), allocatable :: text
        integer, parameter :: first = len(indent) + 1, last = len(indent) + keyword_width
        associate (line => self%lines(i)%text)
            text = line(last + 1:)
            if (line(first:last) /= '') text = trim(line(first:last)) // ': ' // text
        end associate
    end function sentence

    !> Model and method, with the reasons.
    subroutine describe_plan(self, plan)
        class(summary_t), intent(inout) :: self
        type(plan_t), intent(in) :: plan !! model, method and settings
        call self%add('model', plan%model, is_detail=.true.)
        call self%add('method', plan%method)
    end subroutine describe_plan

    !> Quantities of the motion that are known without integration.
    subroutine describe_motion(self, case)
        class(summary_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! the case whose motion is described
        type(nutation_t) :: nutation
        type(fast_top_t) :: fast
        character(:), allocatable :: momentum, energy, text, name
        real(dp) :: spin
        integer :: status, axis

        if (case%turn%is_shifted()) call self%add('effects', 'the lines below are for the top without effects that has &
            &the rates phi_rate + ' // decimal(case%turn%phi_shift) // ' and psi_rate + ' // decimal(case%turn%psi_shift))
        if (case%turn%to_principal_axes) then
            call self%add('axes', 'the lines below are for the body in its principal axes')
        else if (case%turn%axis > 0) then
            call self%add('axes', 'the lines below are for the rotated body, with its centre of mass above the pivot')
        end if
        associate (body => case%body, start => case%start)
            momentum = decimal(vertical_momentum(body, start)) // ' J s'
            energy = decimal(kinetic_energy(body, start) + potential_energy(body, start)) // ' J'
            if (allocated(body%effects)) then
                call self%add('start', 'Lz = ' // momentum // ', E = ' // energy // '; the effects change them', is_detail=.true.)
            else if (any(body%damping > 0)) then
                call self%add('start', 'Lz = ' // momentum // ', E = ' // energy // '; the damping changes both', is_detail=.true.)
            else
                call self%add('constants', 'c1 = Lz = ' // momentum // ', c2 = E = ' // energy, is_detail=.true.)
            end if
            if (body%is_free() .and. .not. body%is_lagrange()) call describe_free_motion(self, case)
            if (.not. body%is_lagrange()) return
            call find_nutation(body, start, nutation, status)
            if (.not. is_ok(status)) return
            call self%add('motion', class_name(nutation%class) // ', theta from ' &
                // decimal(nutation%theta_min / degree) // ' to ' // decimal(nutation%theta_max / degree) &
                // ' deg, largest phi_rate ' // decimal(nutation%phi_rate_max) // ' rad/s')
            if (is_finite(nutation%period)) then
                call self%add('nutation', 'period ' // decimal(nutation%period) // ' s, precession ' &
                    // decimal(nutation%precession / degree) // ' deg and spin ' &
                    // decimal(nutation%spin / degree) // ' deg per nutation')
            else
                call self%add('nutation', 'none: ' // trim(class_meanings(nutation%class)))
            end if
            if (.not. body%mgl() > 0) return
            ! The threshold of a sleeping top, and the spin about its axis, in the axes of the input.
            axis = 3
            spin = start%omega(3)
            if (.not. case%turn%to_principal_axes) then
                if (case%turn%axis > 0) axis = case%turn%axis
                spin = case%given_start%omega(axis)
            end if
            name = 'omega' // to_text(axis) // ' = '
            text = 'a sleeping top is stable from ' // name // decimal(critical_omega3(body)) // ' rad/s; here ' // name // &
                decimal(spin)
            if (case%turn%is_shifted()) text = text // ', with the effects as one of ' // decimal(start%omega(3))
            call self%add('upright', text)
            if (.not. is_finite(nutation%period)) return
            fast = fast_top(body, start%angle(2), start%omega(3))
            call self%add('fast top', '(I3 omega3)^2/(2 I1 m g l) = ' // decimal(fast%ratio) &
                // ' (much greater than 1 for a fast top; the paper takes I3 omega3^2/(4 m g l) = ' &
                // decimal(fast%ratio_of_paper) // ')', is_detail=.true.)
        end associate
    end subroutine describe_motion

    !> A sentence on a top that sleeps with less spin than that of a sleeping top.
    function slow_sleeper(body, motion) result(text)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! the motion at an instant
        character(:), allocatable :: text
        text = 'the top stays upright only because nothing disturbs it: it spins with ' // rounded(abs(motion%omega(3))) &
            // ' rad/s, and a sleeping top is stable from ' // rounded(critical_omega3(body)) // ' rad/s'
    end function slow_sleeper

    !> Class, period and turn of a free body.
    subroutine describe_free_motion(self, case)
        class(summary_t), intent(inout) :: self
        type(case_t), intent(in) :: case
        type(free_motion_t) :: free
        integer :: status
        call prepare_free_motion(case%body, case%start, free, status)
        if (.not. is_ok(status)) return
        if (free%about == 0) then
            call self%add('motion', 'turns about one axis, at ' // decimal(norm2(case%start%omega)) // ' rad/s')
            return
        end if
        associate (inertia => case%body%inertia)
            call self%add('motion', 'the momentum circulates about body axis ' // to_text(free%about) // ', that of ' &
                // trim(merge('smallest', 'largest ', inertia(free%about) <= minval(inertia))) // ' inertia')
        end associate
        if (is_finite(free%period)) then
            call self%add('period', decimal(free%period) // ' s; meanwhile that axis turns by ' &
                // decimal(free%turn / degree) // ' deg about the momentum')
        else
            call self%add('period', 'none: on the separatrix the body tends to a rotation about its intermediate axis')
        end if
    end subroutine describe_free_motion

    !> The cases of a sweep, its axes, and the values of the first and the last case.
    subroutine describe_axes(self, axes)
        class(summary_t), intent(inout) :: self
        type(axes_t), intent(in) :: axes !! the axes
        real(dp) :: first(size(axes%axis)), last(size(axes%axis))
        integer :: i
        first = axes%values_of(1_int64)
        last = axes%values_of(axes%cases)
        call self%add('sweep', axes%in_words())
        do i = 1, size(axes%axis)
            call self%add('', axes%axis(i)%in_words() // '; first case ' // to_text(first(i)) &
                          // ', last case ' // to_text(last(i)))
        end do
    end subroutine describe_axes

    !> What statistics are gathered, and their memory.
    subroutine describe_statistics(self, plan)
        class(summary_t), intent(inout) :: self
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        character(:), allocatable :: text
        integer :: i

        text = 'over all cases'
        if (size(plan%over) > 0) text = to_text(plan%bin_count()) // ' bins'
        call self%add('statistics', text // ', ' // to_text(size(plan%numbers) + size(plan%categories)) &
                      // ' columns, about ' // rounded(plan%bytes() / 1.0e6_dp, 3) // ' MB of memory')
        do i = 1, size(plan%over)
            associate (bins => plan%over(i)%bins)
                call self%add('', trim(plan%over(i)%column%name) // ': ' // to_text(size(bins%value)) // ' bins from ' &
                              // to_text(bins%edge(1)) // ' to ' // to_text(bins%edge(size(bins%edge))))
            end associate
        end do
        if (plan%has_indices()) then
            call self%add('', "Sobol' indices of " // to_text(size(plan%factors)) // ' factors from ' // to_text(plan%groups) &
                          // ' groups of ' // to_text(size(plan%factors) + 2) // ' cases')
        end if
    end subroutine describe_statistics

    !> Steps and evaluations of a run; output points of a method with its own convention for them.
    subroutine describe_cost(self, counts, refine)
        class(summary_t), intent(inout) :: self
        type(counts_t), intent(in) :: counts !! cost of a run
        integer, intent(in) :: refine !! output points per step by the convention of the method; 0 if there is none
        character(:), allocatable :: text
        text = to_text(counts%steps) // ' steps, ' // to_text(counts%rejected) // ' rejected, ' &
               // to_text(counts%evaluations) // ' RHS evaluations'
        if (counts%jacobians > 0) text = text // ', ' // to_text(counts%jacobians) // ' Jacobians'
        if (counts%clipped > 0) text = text // ', ' // to_text(counts%clipped) // ' negative radicands clipped'
        if (refine > 0) text = text // ', ' // to_text(refine * counts%steps + 1) // ' output points, ' &
                               // to_text(refine) // ' per step'
        call self%add('cost', text, is_detail=.true.)
    end subroutine describe_cost

    !> A number with the letter of its exponent, which Fortran omits for three digits.
    pure function with_letter(number) result(text)
        character(*), intent(in) :: number
        character(:), allocatable :: text
        integer :: place
        text = number
        place = scan(number, '+-', back=.true.)
        if (place > 1 .and. index(number, 'E') == 0) text = number(:place - 1) // 'E' // number(place:)
    end function with_letter

    !> A number with readable precision, in decimal or scientific form.
    function decimal(value) result(text)
        real(dp), intent(in) :: value !! the number to show
        character(:), allocatable :: text
        character(40) :: buffer
        if (abs(value) > 0 .and. (abs(value) < 1.0e-3_dp .or. abs(value) >= 1.0e6_dp)) then
            write (buffer, '(ss, es16.9)') value
        else
            write (buffer, '(ss, f24.10)') value
        end if
        text = with_letter(trim(adjustl(buffer)))
    end function decimal

    !> A measured number with the precision of measurements, four digits by default.
    function rounded(value, digits) result(text)
        real(dp), intent(in) :: value !! the measured number
        integer, intent(in), optional :: digits !! number of significant digits
        character(:), allocatable :: text
        integer :: significant
        character(32) :: buffer
        integer :: exponent
        significant = 4
        if (present(digits)) significant = digits
        exponent = 0
        if (abs(value) > 0 .and. abs(value) <= huge(value)) exponent = floor(log10(abs(value)))
        if (exponent < -6 .or. exponent > 12) then
            write (buffer, '(ss, es32.' // to_text(significant - 1) // ')') value
        else
            write (buffer, '(ss, f32.' // to_text(max(0, significant - 1 - exponent)) // ')') value
        end if
        text = with_letter(trim(adjustl(buffer)))
        if (text(len(text):) == '.') text = text(:len(text) - 1)
    end function rounded

    !> A time in the unit that suits it.
    function duration(time, digits) result(text)
        real(dp), intent(in) :: time !! the time, s
        integer, intent(in) :: digits !! number of significant digits
        character(:), allocatable :: text
        real(dp), parameter :: sizes(*) = [1.0e-6_dp, 1.0e-3_dp, 1.0_dp, 60.0_dp, 3600.0_dp, 86400.0_dp]
        character(*), parameter :: units(*) = [character(7) :: 'us', 'ms', 's', 'minutes', 'hours', 'days']
        real(dp), parameter :: from(*) = [0.0_dp, 1.0e-3_dp, 1.0_dp, 180.0_dp, 10800.0_dp, 259200.0_dp]
        integer :: i
        i = max(1, count(time >= from))
        text = rounded(time / sizes(i), digits) // ' ' // trim(units(i))
    end function duration

end module spintop_summary
