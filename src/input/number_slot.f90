!> One numeric element of an input, whose value the axes of a sweep change; and the rule of its range.
module spintop_number_slot
    use spintop_kinds, only: dp, pi, no_number, is_equal, is_finite
    implicit none
    private
    public :: number_slot_t, range_t, parse_range

    !> An interval; an open end does not belong to it.
    type :: range_t
        real(dp) :: lower = -huge(1.0_dp), upper = huge(1.0_dp)
        logical :: lower_open = .false., upper_open = .false.
        character(:), allocatable :: rule !! the range as written
    contains
        procedure :: contains => range_contains
        procedure :: nearest => nearest_in_range
        procedure :: demand
    end type range_t

    !> A real or an integer variable, with real values, which may be in another unit.
    type :: number_slot_t
        type(range_t) :: range !! of the variable
        real(dp) :: size = 1   !! of the unit of the values, in that of the variable
        real(dp), pointer :: real_value => null()
        integer, pointer :: integer_value => null()
    contains
        procedure :: set
        procedure :: get
        procedure :: is_whole
        procedure :: is_same
        procedure :: refusal
        procedure :: accepts
    end type number_slot_t

contains

    !> Sets the variable, if there is one. The value must have an empty `refusal`.
    impure elemental subroutine set(self, value)
        class(number_slot_t), intent(in) :: self
        real(dp), intent(in) :: value !! the value that the variable gets, or would get
        if (associated(self%real_value)) then
            self%real_value = value * self%size
        else if (associated(self%integer_value)) then
            self%integer_value = nint(value)
        end if
    end subroutine set

    !> The value of the variable; NaN if there is none.
    elemental real(dp) function get(self)
        class(number_slot_t), intent(in) :: self
        get = no_number
        if (associated(self%real_value)) then
            get = self%real_value / self%size
        else if (associated(self%integer_value)) then
            get = self%integer_value
        end if
    end function get

    !> Whether the variable is an integer.
    pure logical function is_whole(self)
        class(number_slot_t), intent(in) :: self
        is_whole = associated(self%integer_value)
    end function is_whole

    !> Whether both are the same variable.
    elemental logical function is_same(self, other)
        class(number_slot_t), intent(in) :: self
        type(number_slot_t), intent(in) :: other !! the other slot
        is_same = associated(self%real_value, other%real_value) &
                  .or. associated(self%integer_value, other%integer_value)
    end function is_same

    !> Whether the variable can have a value: it has no `refusal`.
    elemental logical function accepts(self, value)
        class(number_slot_t), intent(in) :: self
        real(dp), intent(in) :: value !! the value that the variable gets, or would get
        accepts = is_finite(value) .and. self%range%contains(value * self%size)
        if (accepts .and. associated(self%integer_value)) then
            accepts = is_equal(value, anint(value)) .and. abs(value) < huge(1)
        end if
    end function accepts

    !> The reason why the variable cannot have a value ('must be > 0'), or ''.
    function refusal(self, value) result(reason)
        class(number_slot_t), intent(in) :: self
        real(dp), intent(in) :: value !! the value that the variable gets, or would get
        character(:), allocatable :: reason

        reason = ''
        if (.not. is_finite(value)) then
            reason = 'must be finite'
        else if (.not. self%range%contains(value * self%size)) then
            reason = self%range%demand()
        else if (associated(self%integer_value)) then
            if (.not. is_equal(value, anint(value))) then
                reason = 'must be a whole number'
            else if (abs(value) >= huge(1)) then
                reason = 'is too large for an integer'
            end if
        end if
    end function refusal

    !> Whether a number lies in the range. A NaN does not.
    elemental logical function range_contains(self, x)
        class(range_t), intent(in) :: self
        real(dp), intent(in) :: x !! the number to test, in the unit of the parameter
        range_contains = x >= self%lower .and. x <= self%upper
        if (self%lower_open) range_contains = range_contains .and. x > self%lower
        if (self%upper_open) range_contains = range_contains .and. x < self%upper
    end function range_contains

    !> The number in the range that is nearest to another; beyond an open end the number itself.
    pure real(dp) function nearest_in_range(self, x) result(nearest)
        class(range_t), intent(in) :: self
        real(dp), intent(in) :: x !! any number, in the unit of the parameter
        nearest = x
        if (.not. self%lower_open) nearest = max(nearest, self%lower)
        if (.not. self%upper_open) nearest = min(nearest, self%upper)
    end function nearest_in_range

    !> What a number must be, as `must be > 0` or `must be in [0, pi]`.
    pure function demand(self) result(text)
        class(range_t), intent(in) :: self
        character(:), allocatable :: text
        text = 'must be '
        if (scan(self%rule, '[(') == 1) text = 'must be in '
        text = text // self%rule
    end function demand

    !> Reads a rule. Numbers may be multiples of pi, or half of one: `2 pi`, `-pi/2`.
    subroutine parse_range(rule, range, valid)
        character(*), intent(in) :: rule !! the range as written
        type(range_t), intent(out) :: range !! the interval
        logical, intent(out) :: valid !! false if the rule cannot be read
        integer :: comma, first, last

        range%rule = rule
        valid = .true.
        last = len_trim(rule)
        if (last == 0) return
        first = verify(rule // '0', '<>=') ! of the number after `>`, `>=`, `<` or `<=`
        select case (rule(1:1))
        case ('>')
            range%lower_open = rule(2:min(2, last)) /= '='
            call read_bound(rule(first:last), range%lower, valid)
        case ('<')
            range%upper_open = rule(2:min(2, last)) /= '='
            call read_bound(rule(first:last), range%upper, valid)
        case ('[', '(')
            comma = index(rule, ',')
            valid = comma > 0 .and. scan(rule(last:last), '])') > 0
            if (.not. valid) return
            range%lower_open = rule(1:1) == '('
            range%upper_open = rule(last:last) == ')'
            call read_bound(rule(2:comma - 1), range%lower, valid)
            if (valid) call read_bound(rule(comma + 1:last - 1), range%upper, valid)
        case default
            valid = .false.
        end select
    end subroutine parse_range

    !> Reads an end: a number, or a multiple of pi.
    subroutine read_bound(text, bound, valid)
        character(*), intent(in) :: text
        real(dp), intent(out) :: bound
        logical, intent(out) :: valid
        character(:), allocatable :: factor
        real(dp) :: number
        integer :: symbol, status

        bound = 1
        symbol = index(text, 'pi')
        factor = text
        if (symbol > 0) then
            factor = text(:symbol - 1)
            bound = pi
            if (index(text, 'pi/2') > 0) bound = pi / 2
            if (factor == '') factor = '1'
            if (adjustl(factor) == '-') factor = '-1'
        end if
        valid = factor /= '' .and. verify(trim(adjustl(factor)), '+-.0123456789eE') == 0
        if (.not. valid) return
        read (factor, *, iostat=status) number
        valid = status == 0
        if (valid) bound = bound * number
    end subroutine read_bound

end module spintop_number_slot
