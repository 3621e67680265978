!> Integrates cases of a sweep together, in vector lanes: bodies without a closed form, of which the table
!> contains the end of the span, or what the watches in lanes measure.
module spintop_sweep_batch
    use spintop_kinds, only: dp
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_body_with_effects, only: body_with_effects_t
    use spintop_case, only: case_t
    use spintop_compare, only: is_equal, is_zero
    use spintop_exact_block, only: block_size
    use spintop_pole_passages, only: through_pole
    use spintop_poles, only: nearly_plane, swings_over_poles
    use spintop_integration, only: outcome_t
    use spintop_job, only: job_t
    use spintop_many_bodies, only: integrate_many
    use spintop_motion, only: motion_t
    use spintop_plan, only: plan_t
    use spintop_projection, only: project_nothing
    use spintop_rigid_body, only: rigid_body_t
    use spintop_status, only: is_good_end, status_meanings, status_non_finite, status_step_too_small
    use spintop_stepper, only: controls_t
    use spintop_sweep_notes, only: note_t
    use spintop_sweep_quantities, only: find_free_constants, put_fast_top, put_end
    use spintop_sweep_result, only: kinds_of_work, of_class, of_fast_top, of_fastest, of_force, of_inherent, &
        of_lyapunov, of_measured, of_nutation_rate, of_range, of_singular, of_turns, of_vertical_force, &
        sweep_result_t
    use spintop_sweep_stability, only: put_stability
    use spintop_sweep_watches, only: sweep_watches_t, ends_in_lanes
    use spintop_taylor, only: taylor_t
    implicit none
    private
    public :: sweep_batch_t, goes_in_batch

    !> Waiting cases, and their positions in their block.
    type :: sweep_batch_t
        integer :: n = 0
        !> The settings of each, and those for which the watches were made.
        type(controls_t), allocatable, private :: controls(:)
        type(controls_t), private :: watched
        integer, allocatable, private :: place(:)
        type(body_t), allocatable, private :: bodies(:)
        type(motion_t), allocatable, private :: starts(:)
        real(dp), allocatable, private :: t_end(:)
        !> Motions at the ends.
        type(motion_t), allocatable, private :: ends(:)
        type(outcome_t), allocatable, private :: outcomes(:)
        type(sweep_watches_t), private :: watches
        !> Positions of cases of the last call that are to be computed alone: in lanes a motion with effects came to a point
        !> where it has no series.
        integer :: left(block_size) = 0, n_left = 0
    contains
        procedure :: add
        procedure :: compute
        procedure, private :: integrate
        procedure, private :: take
    end type sweep_batch_t

contains

    !> Whether a case can be computed together with others: a body without a closed form, with Taylor's method
    !> for the equations of any body, with effects that have series and without, and with no event before the end that the
    !> watches in lanes do not find.
    logical function goes_in_batch(job, case, plan, wanted)
        type(job_t), intent(in) :: job !! the job
        type(case_t), intent(in) :: case !! body, start and span
        type(plan_t), intent(in) :: plan !! model, method and settings
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        goes_in_batch = .false.
        if (plan%exact .or. case%body%is_lagrange()) return
        ! Lanes count no turns in other axes, and measure nothing there.
        if (case%body%given%differ .and. (wanted(of_turns) .or. wanted(of_measured) .or. wanted(of_range))) return
        ! Nor do they find extremes in poles, or of a force that is constant.
        if (wanted(of_nutation_rate) .or. (wanted(of_fastest) .or. wanted(of_class))) then
            if (swings_over_poles(case%body, case%start, nearly_plane) .or. starts_beside_pole(case%start)) return
        end if
        if ((wanted(of_force) .or. wanted(of_vertical_force)) .and. all(is_zero(case%body%centre_of_mass))) return
        if (.not. ends_in_lanes(job%events, case)) return
        if (plan%stepper%controls%project /= project_nothing) return
        select type (stepper => plan%stepper)
        type is (taylor_t)
            select type (formulation => plan%formulation)
            type is (rigid_body_t)
                goes_in_batch = .true.
            type is (body_with_effects_t)
                goes_in_batch = case%body%effects%are_analytic() .and. .not. needs_plain_body(wanted)
            end select
        end select
    end function goes_in_batch

    !> Whether body z is so close to a pole that the extremes of its rates in passing it are lost in rounding errors of the
    !> polynomials. In a pole they are limits.
    pure logical function starts_beside_pole(start)
        type(motion_t), intent(in) :: start
        real(dp), parameter :: beside = 1.0e-6_dp
        real(dp) :: gamma(3), sine
        gamma = vertical_from_quaternion(start%quaternion)
        sine = norm2(gamma(1:2))
        starts_beside_pole = sine > through_pole .and. sine < beside
    end function starts_beside_pole

    !> Whether watches in lanes would find a quantity by equations that hold without effects.
    pure logical function needs_plain_body(wanted)
        logical, intent(in) :: wanted(kinds_of_work)
        needs_plain_body = wanted(of_inherent) .or. wanted(of_lyapunov) .or. wanted(of_singular) .or. wanted(of_nutation_rate) &
            .or. wanted(of_vertical_force) .or. wanted(of_force)
    end function needs_plain_body

    !> Adds a case, the k-th of its block.
    subroutine add(self, case, plan, k)
        class(sweep_batch_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! body, start and span
        type(plan_t), intent(in) :: plan !! model, method and settings
        integer, intent(in) :: k !! position of the case in its block
        if (.not. allocated(self%place)) then
            allocate (self%controls(block_size), self%place(block_size), self%bodies(block_size), self%starts(block_size), &
                      self%t_end(block_size), self%ends(block_size), self%outcomes(block_size))
        end if
        self%n = self%n + 1
        self%controls(self%n) = plan%stepper%controls
        self%place(self%n) = k
        self%bodies(self%n) = case%body
        self%starts(self%n) = case%start
        self%t_end(self%n) = case%t_end
    end subroutine add

    !> Computes the quantities of the waiting cases, at their positions in the block; the list is then empty, but
    !> for those that are `left`.
    subroutine compute(self, job, cases, wanted, values, status, note)
        class(sweep_batch_t), intent(inout) :: self
        type(job_t), intent(in) :: job !! the job, the same in every call
        type(case_t), intent(in) :: cases(:) !! cases of the block
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities, the same in every call
        type(sweep_result_t), intent(inout) :: values(:) !! the values
        integer, intent(inout) :: status(:) !! statuses of the cases of the block
        type(note_t), intent(inout) :: note(:) !! notes on the cases of the block
        logical :: waits(self%n), is_like(self%n)
        integer :: i, first

        self%n_left = 0
        waits = .true.
        do first = 1, self%n
            if (.not. waits(first)) cycle
            ! Cases with the same settings share lanes.
            is_like = are_like(self%controls(:self%n), self%controls(first))
            call self%integrate(job, wanted, pack([(i, i=1, self%n)], is_like), cases, values, status, note)
            waits = waits .and. .not. is_like
        end do
        self%n = 0
    end subroutine compute

    !> Whether the settings that concern lanes are the same.
    elemental logical function are_like(a, b)
        type(controls_t), intent(in) :: a, b
        are_like = is_equal(a%relative_tolerance, b%relative_tolerance) .and. a%max_steps == b%max_steps &
            .and. is_equal(a%absolute_tolerance, b%absolute_tolerance)
    end function are_like

    !> Integrates those of the waiting cases that have the same settings.
    subroutine integrate(self, job, wanted, like, cases, values, status, note)
        class(sweep_batch_t), intent(inout) :: self
        type(job_t), intent(in) :: job
        logical, intent(in) :: wanted(kinds_of_work)
        integer, intent(in) :: like(:)
        type(case_t), intent(in) :: cases(:)
        type(sweep_result_t), intent(inout) :: values(:)
        integer, intent(inout) :: status(:)
        type(note_t), intent(inout) :: note(:)
        logical, dimension(kinds_of_work) :: in_lanes, alone
        type(controls_t) :: controls
        logical :: is_new
        integer :: i

        in_lanes = wanted
        alone = wanted
        ! Perturbations are followed to the end of the motion: beside it only if no event ends it.
        if (size(job%events) > 0) then
            in_lanes(of_lyapunov) = .false.
            in_lanes(of_singular) = .false.
        else
            alone(of_lyapunov) = .false.
            alone(of_singular) = .false.
        end if
        controls = self%controls(like(1))
        is_new = .not. allocated(self%watches%slots)
        if (.not. is_new) is_new = .not. are_like(self%watched, controls)
        if (is_new) call self%watches%create(in_lanes, controls, job%events, job%stop_after)
        self%watched = controls
        associate (n => size(like))
            call integrate_many(controls, self%bodies(like), self%starts(like), self%t_end(like), self%ends(:n), &
                                self%outcomes(:n), self%watches%slots)
        end associate
        do i = 1, size(like)
            associate (k => self%place(like(i)))
                call self%take(cases(k), wanted, alone, i, like(i), values(k), status(k), note(k))
            end associate
        end do
    end subroutine integrate

    !> Takes the quantities of case `i` of those integrated, number `waiting` of those that waited.
    subroutine take(self, case, wanted, alone, i, waiting, values, status, note)
        class(sweep_batch_t), intent(inout) :: self
        type(case_t), intent(in) :: case
        logical, intent(in), dimension(kinds_of_work) :: wanted, alone
        integer, intent(in) :: i, waiting
        type(sweep_result_t), intent(inout) :: values
        integer, intent(inout) :: status
        type(note_t), intent(inout) :: note

        associate (ended => self%ends(i), outcome => self%outcomes(i))
            status = outcome%status
            if (allocated(self%bodies(waiting)%effects) .and. any(status == [status_non_finite, status_step_too_small])) then
                self%n_left = self%n_left + 1
                self%left(self%n_left) = self%place(waiting)
                return
            end if
            values = sweep_result_t()
            call note%clear()
            if (is_good_end(status)) call put_stability(case, ended%t, alone, self%controls(waiting)%max_steps, values, note)
            if (wanted(of_fast_top)) call put_fast_top(case, values, note)
            values%evaluations = real(outcome%counts%evaluations, dp)
            if (is_good_end(status)) then
                ! Without an energy error, which a watch measures if it is wanted.
                call put_end(case, ended, (values%energy_error_max), values)
                call self%watches%put(case, wanted, i, ended, values, status, note)
                call find_free_constants(case, wanted, values, note)
            else
                call note%explain(trim(status_meanings(status)))
            end if
        end associate
    end subroutine take

end module spintop_sweep_batch
