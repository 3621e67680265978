!> Ranges of numbers, written as rules: `> 0`, `<= 1`, `[0, pi]`, `(0, 1]`; '' allows all numbers.
module spintop_range_rule
    use spintop_kinds, only: dp, pi
    implicit none
    private
    public :: range_t, parse_range

    !> An interval; an open end does not belong to it.
    type :: range_t
        real(dp) :: lower = -huge(1.0_dp), upper = huge(1.0_dp)
        logical :: lower_open = .false., upper_open = .false.
    contains
        procedure :: contains => range_contains
        procedure :: nearest => nearest_in_range
        procedure :: ends => ends_of_range
    end type range_t

contains

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

    !> The ends, open or not; -huge and huge where there is none.
    pure function ends_of_range(self) result(ends)
        class(range_t), intent(in) :: self
        real(dp) :: ends(2)
        ends = [self%lower, self%upper]
    end function ends_of_range

    !> Reads a rule. Numbers may be multiples of pi, or half of one: `2 pi`, `-pi/2`.
    subroutine parse_range(rule, range, valid)
        character(*), intent(in) :: rule !! the range as written
        type(range_t), intent(out) :: range !! the interval
        logical, intent(out) :: valid !! false if the rule cannot be read
        integer :: comma, last

        valid = .true.
        last = len_trim(rule)
        if (last == 0) return
        select case (rule(1:1))
        case ('>')
            range%lower_open = rule(2:min(2, last)) /= '='
            call read_bound(after_sign(rule(:last)), range%lower, valid)
        case ('<')
            range%upper_open = rule(2:min(2, last)) /= '='
            call read_bound(after_sign(rule(:last)), range%upper, valid)
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

    !> The number after `>`, `>=`, `<` or `<=`.
    pure function after_sign(rule) result(bound)
        character(*), intent(in) :: rule
        character(:), allocatable :: bound
        bound = rule(verify(rule // '0', '<>='):)
    end function after_sign

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

end module spintop_range_rule
