!> One numeric element of an input, whose value the axes of a sweep change.
module spintop_number_slot
    use spintop_compare, only: is_equal, is_finite
    use spintop_kinds, only: dp, no_number
    use spintop_range_rule, only: range_t
    implicit none
    private
    public :: number_slot_t

    !> A real or an integer variable, with real values.
    type :: number_slot_t
        character(:), allocatable :: rule !! the range as written
        type(range_t), private :: range
        real(dp), pointer, private :: real_value => null()
        integer, pointer, private :: integer_value => null()
    contains
        procedure :: bind_real
        procedure :: bind_integer
        procedure :: set
        procedure :: get
        procedure :: is_whole
        procedure :: is_same
        procedure :: refusal
        procedure :: accepts
        procedure :: nearest => nearest_in_slot
        procedure :: ends => ends_of_slot
    end type number_slot_t

contains

    !> Binds the slot to a real variable and its range.
    subroutine bind_real(self, variable, range)
        class(number_slot_t), intent(inout) :: self
        real(dp), pointer, intent(in) :: variable !! the variable
        type(range_t), intent(in) :: range !! range of valid values
        self%real_value => variable
        self%range = range
    end subroutine bind_real

    !> Binds the slot to an integer variable and its range.
    subroutine bind_integer(self, variable, range)
        class(number_slot_t), intent(inout) :: self
        integer, pointer, intent(in) :: variable !! the variable
        type(range_t), intent(in) :: range !! range of valid values
        self%integer_value => variable
        self%range = range
    end subroutine bind_integer

    !> Sets the variable, if there is one. The value must have an empty `refusal`.
    subroutine set(self, value)
        class(number_slot_t), intent(in) :: self
        real(dp), intent(in) :: value !! the value that the variable gets, or would get
        if (associated(self%real_value)) then
            self%real_value = value
        else if (associated(self%integer_value)) then
            self%integer_value = nint(value)
        end if
    end subroutine set

    !> The value of the variable; NaN if there is none.
    real(dp) function get(self)
        class(number_slot_t), intent(in) :: self
        get = no_number
        if (associated(self%real_value)) then
            get = self%real_value
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
    pure logical function is_same(self, other)
        class(number_slot_t), intent(in) :: self
        type(number_slot_t), intent(in) :: other !! the other slot
        is_same = associated(self%real_value, other%real_value) &
                  .or. associated(self%integer_value, other%integer_value)
    end function is_same

    !> Whether the variable can have a value: it has no `refusal`.
    pure logical function accepts(self, value)
        class(number_slot_t), intent(in) :: self
        real(dp), intent(in) :: value !! the value that the variable gets, or would get
        accepts = is_finite(value) .and. self%range%contains(value)
        if (accepts .and. associated(self%integer_value)) then
            accepts = is_equal(value, anint(value)) .and. abs(value) < huge(1)
        end if
    end function accepts

    !> The value in the range that is nearest to another; beyond an open end that value itself.
    pure real(dp) function nearest_in_slot(self, value) result(nearest_value)
        class(number_slot_t), intent(in) :: self
        real(dp), intent(in) :: value !! the other value
        nearest_value = self%range%nearest(value)
    end function nearest_in_slot

    !> The ends of the range, open or not; -huge and huge where there is none.
    pure function ends_of_slot(self) result(ends)
        class(number_slot_t), intent(in) :: self
        real(dp) :: ends(2)
        ends = self%range%ends()
    end function ends_of_slot

    !> The reason why the variable cannot have a value ('must be > 0'), or ''.
    function refusal(self, value) result(reason)
        class(number_slot_t), intent(in) :: self
        real(dp), intent(in) :: value !! the value that the variable gets, or would get
        character(:), allocatable :: reason

        reason = ''
        if (.not. is_finite(value)) then
            reason = 'must be finite'
        else if (.not. self%range%contains(value)) then
            reason = 'must be ' // self%rule
            if (scan(self%rule, '[(') == 1) reason = 'must be in ' // self%rule
        else if (associated(self%integer_value)) then
            if (.not. is_equal(value, anint(value))) then
                reason = 'must be a whole number'
            else if (abs(value) >= huge(1)) then
                reason = 'is too large for an integer'
            end if
        end if
    end function refusal

end module spintop_number_slot
