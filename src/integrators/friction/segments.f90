!> The span of a body with effects as segments in which its motion is smooth. The method steps through most of them. A
!> Runge-Kutta step leads across an instant at which the motion has no series; while dry friction holds the body, it lies
!> still.
!>
!> A segment ends at a knot of a table of torques, just beyond a row of one of friction, at rest, where the torques exceed the
!> friction, or before a vector reverses on whose direction the torques depend. What steps through the next one begins there.
module spintop_segments
    use spintop_dop853, only: dop853_t
    use spintop_dop853_table, only: dop853_table
    use spintop_event, only: occasion_none, occasion_slip, occasion_stuck
    use spintop_formulation, only: structure_none, structure_series
    use spintop_kinds, only: dp
    use spintop_rest, only: resting_t, rest_t
    use spintop_step_ends, only: end_at_row, check_direction, end_before_reversal, end_step_at, may_reverse
    use spintop_status, only: is_ok, status_non_finite, status_ok, status_step_too_small
    use spintop_stepper, only: method_info_t, stepper_t
    implicit none
    private
    public :: segments_t

    !> What leads through a segment: the method, a Runge-Kutta step, or rest.
    integer, parameter :: by_method = 0, by_runge_kutta = 1, by_rest = 2

    !> The segment of a run, and what leads through others.
    type :: segments_t
        type(rest_t) :: rest
        !> What happened at the end of the last step: the body came to rest, or began to move.
        integer :: occasion = occasion_none
        !> Whether the torques jumped at the end of the last step, whose time is that of the jump.
        logical :: passes_jump = .false.
        integer, private :: kind = by_method
        !> Whether the next segment must be a Runge-Kutta step: at its beginning there is no series.
        logical, private :: must_cross = .false.
        !> Whether the angular velocity surely kept its direction, and more than half of its magnitude, in the last step.
        logical, private :: keeps_direction = .false.
        type(resting_t), private :: lying
        type(dop853_t), private :: crossing
    contains
        procedure :: begin
        procedure :: advance
        procedure :: end_step
        procedure, private :: latest_end
    end type segments_t

    !> Tolerance of the steps where there is no series, if that of the method is not smaller; and the smallest, for steps in
    !> double precision.
    real(dp), parameter :: crossing_tolerance = 1.0e-12_dp, finest_tolerance = 1.0e-14_dp
    !> Part of its own first step that the Runge-Kutta method takes: its estimate may not see what a bend in the step errs.
    real(dp), parameter :: first_part = 0.1_dp

contains

    !> Looks at the start, at which the method is, and begins the first segment.
    subroutine begin(self, method, stepper, status)
        class(segments_t), target, intent(inout) :: self
        class(stepper_t), target, intent(inout) :: method !! the method, at the start
        class(stepper_t), pointer, intent(inout) :: stepper !! what takes the first step: the method, unless the body rests
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        logical :: has_series
        status = status_ok
        has_series = method%info%needs /= structure_none .and. method%controls%steps == 0
        call self%rest%begin(method, has_series)
        self%lying%formulation => method%formulation
        self%lying%controls = method%controls
        self%lying%t_begin = method%t_begin
        self%lying%t_end = method%t_end
        if (self%rest%is_resting) call go_over(self, by_rest, method, stepper, status)
        if (.not. has_series) return
        self%crossing = dop853_t(table=dop853_table(), info=method_info_t('dop853'))
        associate (own => self%crossing%controls, given => method%controls)
            own%relative_tolerance = max(finest_tolerance, min(crossing_tolerance, given%relative_tolerance))
            own%absolute_tolerance = max(finest_tolerance, min(crossing_tolerance, given%absolute_tolerance))
            own%max_steps = given%max_steps
        end associate
        self%crossing%formulation => method%formulation
        self%crossing%t_begin = method%t_begin
        self%crossing%projection = method%projection
    end subroutine begin

    !> Goes over to the next segment.
    subroutine go_over(self, kind, method, stepper, status)
        class(segments_t), target, intent(inout) :: self
        integer, intent(in) :: kind
        class(stepper_t), target, intent(inout) :: method
        class(stepper_t), pointer, intent(inout) :: stepper
        integer, intent(out) :: status
        class(stepper_t), pointer :: next

        self%must_cross = .false.
        if (kind /= self%kind) then
            self%kind = kind
            next => method
            if (kind == by_runge_kutta) next => self%crossing
            if (kind == by_rest) next => self%lying
            call next%go_on_from(stepper)
            stepper => next
        end if
        if (kind == by_runge_kutta) stepper%t_end = self%latest_end(stepper, method%t_end)
        call stepper%begin(status)
        if (kind == by_runge_kutta) stepper%h = first_part * stepper%h
    end subroutine go_over

    !> The time up to which a step may reach in which f is smooth: to a knot, or half-way to rest.
    real(dp) function latest_end(self, stepper, t_end)
        class(segments_t), intent(inout) :: self
        class(stepper_t), intent(in) :: stepper
        real(dp), intent(in) :: t_end
        latest_end = min(t_end, stepper%formulation%action%smooth_until(stepper%t))
        if (stepper%formulation%action%may_stick .or. (stepper%formulation%action%may_turn .and. self%rest%has_series)) then
            latest_end = min(latest_end, self%rest%latest_end(stepper%formulation, stepper%t, stepper%y))
        end if
    end function latest_end

    !> Takes a step in the segment. Where the method has no series, its segment ends, and a Runge-Kutta step follows.
    subroutine advance(self, method, stepper, status)
        class(segments_t), target, intent(inout) :: self
        class(stepper_t), target, intent(inout) :: method !! the method
        class(stepper_t), pointer, intent(inout) :: stepper !! what takes the step
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        self%keeps_direction = .false.
        if (self%kind /= by_method .or. method%controls%steps > 0) then
            call stepper%advance(status)
            return
        end if
        call limit_step(self, method, status)
        if (.not. (self%rest%has_series .and. (status == status_non_finite .or. status == status_step_too_small))) return
        call go_over(self, by_runge_kutta, method, stepper, status)
        if (is_ok(status)) call stepper%advance(status)
    end subroutine advance

    !> Takes a step of an adaptive method in which f is smooth. A step by series in double precision is looked at when it is
    !> done, which is cheap, as its state can be had at any time.
    subroutine limit_step(self, method, status)
        class(segments_t), intent(inout) :: self
        class(stepper_t), intent(inout) :: method
        integer, intent(out) :: status
        real(dp) :: t_end, latest, speed(2)
        logical :: looks_back

        t_end = method%t_end
        associate (action => method%formulation%action)
            looks_back = action%may_turn .and. method%info%needs == structure_series .and. .not. action%may_stick
            if (looks_back) then
                method%t_end = min(t_end, action%smooth_until(method%t))
            else
                method%t_end = self%latest_end(method, t_end)
            end if
        end associate
        call method%advance(status)
        if (is_ok(status) .and. looks_back) then
            call check_direction(method, self%keeps_direction, speed)
            if (self%keeps_direction) then
                call self%rest%note_turning(speed, method%t - method%t_last)
            else
                latest = self%rest%latest_end(method%formulation, method%t_last, method%y_last)
                if (latest < method%t) then
                    call end_step_at(method, latest, method%state_within(latest), status)
                end if
            end if
        end if
        if (is_ok(status) .and. self%rest%has_series .and. .not. self%keeps_direction) then
            if (may_reverse(method)) call end_before_reversal(method, self%must_cross, status)
        end if
        if (is_ok(status) .and. method%formulation%action%has_rows) call end_at_row(method, self%rest%has_series, status)
        method%t_end = t_end
    end subroutine limit_step

    !> Ends a step: finds out whether the body comes to rest, or begins to move, and goes over to the next segment if this one
    !> ends.
    subroutine end_step(self, method, stepper, status)
        class(segments_t), target, intent(inout) :: self
        class(stepper_t), target, intent(inout) :: method !! the method
        class(stepper_t), pointer, intent(inout) :: stepper !! what took the step, then what takes the next
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        logical :: was_resting, is_stopped
        real(dp) :: jump
        integer :: next

        status = status_ok
        was_resting = self%rest%is_resting
        jump = stepper%t
        if (method%controls%steps == 0) jump = min(stepper%formulation%action%after_jump(stepper%t), method%t_end)
        self%passes_jump = jump > stepper%t
        if (self%passes_jump) stepper%t = jump
        is_stopped = .false.
        if (stepper%formulation%action%may_stick .or. &
            (stepper%formulation%action%may_turn .and. self%rest%has_series .and. .not. self%keeps_direction)) then
            call self%rest%detect_rest(stepper, method%t_end, is_stopped)
        end if
        self%occasion = occasion_none
        if (self%rest%is_resting .and. .not. was_resting) self%occasion = occasion_stuck
        if (was_resting .and. .not. self%rest%is_resting) self%occasion = occasion_slip
        next = merge(by_runge_kutta, by_method, self%must_cross)
        if (self%rest%is_resting) next = by_rest
        if (next == self%kind .and. .not. (self%passes_jump .or. (is_stopped .and. next == by_method))) return
        if (stepper%t < method%t_end) call go_over(self, next, method, stepper, status)
    end subroutine end_step

end module spintop_segments
