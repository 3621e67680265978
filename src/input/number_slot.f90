!> One numeric element of an input, which the axes of a sweep set repeatedly.
module spintop_number_slot
    use spintop_compare, only: is_equal, is_finite
    use spintop_kinds, only: dp
    use spintop_ranges, only: range_t
    implicit none
    private
    public :: number_slot_t

    !> A real or an integer variable, seen as a real.
    type :: number_slot_t
        character(:), allocatable :: rule !! the range as written
        type(range_t), private :: range
        real(dp), pointer, private :: real_value => null()
        integer, pointer, private :: integer_value => null()
    contains
        procedure :: bind_real
        procedure :: bind_integer
        procedure :: put
        procedure :: get
        procedure :: is_whole
        procedure :: is_same
        procedure :: refusal
    end type number_slot_t

contains

    !> Makes this the place of a real number, with the range it must keep.
    subroutine bind_real(self, variable, range)
        class(number_slot_t), intent(inout) :: self
        real(dp), pointer, intent(in) :: variable
        type(range_t), intent(in) :: range
        self%real_value => variable
        self%range = range
    end subroutine bind_real

    !> Makes this the place of a whole number, with the range it must keep.
    subroutine bind_integer(self, variable, range)
        class(number_slot_t), intent(inout) :: self
        integer, pointer, intent(in) :: variable
        type(range_t), intent(in) :: range
        self%integer_value => variable
        self%range = range
    end subroutine bind_integer

    !> Sets the variable. The value must be one that `refusal` does not refuse.
    subroutine put(self, value)
        class(number_slot_t), intent(in) :: self
        real(dp), intent(in) :: value
        if (associated(self%real_value)) then
            self%real_value = value
        else
            self%integer_value = nint(value)
        end if
    end subroutine put

    !> The number there.
    real(dp) function get(self)
        class(number_slot_t), intent(in) :: self
        if (associated(self%real_value)) then
            get = self%real_value
        else
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
        type(number_slot_t), intent(in) :: other
        is_same = associated(self%real_value, other%real_value) &
                  .or. associated(self%integer_value, other%integer_value)
    end function is_same

    !> Why the variable cannot have a value ('must be > 0'), or ''.
    function refusal(self, value) result(reason)
        class(number_slot_t), intent(in) :: self
        real(dp), intent(in) :: value
        character(:), allocatable :: reason

        reason = ''
        if (.not. is_finite(value)) then
            reason = 'must be finite'
        else if (.not. self%range%contains(value)) then
            reason = 'must be ' // self%rule
        else if (associated(self%integer_value)) then
            if (.not. is_equal(value, anint(value))) then
                reason = 'must be a whole number'
            else if (abs(value) >= huge(1)) then
                reason = 'is too large for an integer'
            end if
        end if
    end function refusal

end module spintop_number_slot
