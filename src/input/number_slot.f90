!> One numeric element of an input, whose value the axes of a sweep change.
module spintop_number_slot
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_intptr_t, c_loc, c_ptr
    use spintop_compare, only: is_equal, is_finite
    use spintop_kinds, only: dp, no_number
    use spintop_ranges, only: range_t
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
        procedure :: lies_in
        procedure :: in_copy
        procedure :: put
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

    !> Whether the number is a part of a variable. An element of an allocatable component of it is not: that has
    !> memory of its own.
    logical function lies_in(self, variable, bits)
        class(number_slot_t), intent(in) :: self
        type(c_ptr), intent(in) :: variable !! where the variable begins
        integer, intent(in) :: bits !! its storage size
        lies_in = .false.
        if (associated(self%real_value)) lies_in = is_inside(c_loc(self%real_value), storage_size(self%real_value))
        if (associated(self%integer_value)) then
            lies_in = is_inside(c_loc(self%integer_value), storage_size(self%integer_value))
        end if

    contains

        !> Whether so many bits at an address are bits of the variable.
        pure logical function is_inside(place, width)
            type(c_ptr), intent(in) :: place
            integer, intent(in) :: width
            integer(c_intptr_t) :: offset
            offset = transfer(place, offset) - transfer(variable, offset)
            is_inside = offset >= 0 .and. offset <= (bits - width) / 8
        end function is_inside

    end function lies_in

    !> The number at the same place in a copy of the variable that this one is a part of: as far from the
    !> beginning of the copy. So a variable need not be described again to set numbers in copies of it. If the
    !> number does not lie in the variable, the result is bound to nothing.
    function in_copy(self, original, copy, bits) result(slot)
        class(number_slot_t), intent(in) :: self
        type(c_ptr), intent(in) :: original, copy !! where the variable and its copy begin
        integer, intent(in) :: bits !! storage size of either
        type(number_slot_t) :: slot
        slot%rule = self%rule
        slot%range = self%range
        if (.not. self%lies_in(original, bits)) return
        if (associated(self%real_value)) call c_f_pointer(counterpart(c_loc(self%real_value)), slot%real_value)
        if (associated(self%integer_value)) call c_f_pointer(counterpart(c_loc(self%integer_value)), slot%integer_value)

    contains

        !> The address in the copy of what has an address in the original.
        type(c_ptr) function counterpart(place)
            type(c_ptr), intent(in) :: place
            integer(c_intptr_t) :: address
            address = transfer(copy, address) + (transfer(place, address) - transfer(original, address))
            counterpart = transfer(address, counterpart)
        end function counterpart

    end function in_copy

    !> Sets the variable, if there is one. The value must have an empty `refusal`.
    subroutine put(self, value)
        class(number_slot_t), intent(in) :: self
        real(dp), intent(in) :: value !! the value
        if (associated(self%real_value)) then
            self%real_value = value
        else if (associated(self%integer_value)) then
            self%integer_value = nint(value)
        end if
    end subroutine put

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
        real(dp), intent(in) :: value !! the value
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
        real(dp), intent(in) :: value !! the value
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
