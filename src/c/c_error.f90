!> Errors for C: a structure that the library makes and deletes, and that C reads. `include/spintop.h` describes it.
module spintop_c_error
    use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_int, c_loc, c_null_ptr, c_ptr
    use spintop_c_text, only: c_text_t
    use spintop_errors, only: error_t
    use spintop_exit_codes, only: exit_input, exit_ok
    use spintop_kinds, only: dp
    use spintop_status, only: code_of, is_refusal, status_meanings, status_names
    implicit none
    private
    public :: hand_error, hand_status, is_null, is_wrong, describe_status, longest_message

    !> `spintop_error` of the header.
    type, bind(C) :: c_error_t
        integer(c_int) :: code = exit_ok, line = 0, column = 0, reserved = 0
        type(c_ptr) :: status = c_null_ptr, message = c_null_ptr, source = c_null_ptr, owner = c_null_ptr
    end type c_error_t

    !> An error, and the texts to which it points.
    type :: owner_t
        type(c_error_t) :: error
        type(c_text_t) :: status, message, source
    end type owner_t

    !> Longest message on a status.
    integer, parameter :: longest_message = 256

contains

    !> Hands an error to C.
    subroutine hand_error(error, place)
        type(error_t), intent(in) :: error !! the error that C gets
        type(c_ptr), intent(in) :: place !! where C wants its pointer to the error; may be null
        if (allocated(error%source)) then
            call hand_over(error%code, '', error%message, error%source, [error%line, error%column], place)
        else
            call hand_over(error%code, '', error%message, '', [0, 0], place)
        end if
    end subroutine hand_error

    !> Hands a status to C, and returns its code: 0, and no error, for a good end. No text is made by a function, so
    !> several threads may call it at once: see `status_names`.
    integer(c_int) function hand_status(status, t, place) result(code)
        integer, intent(in) :: status !! how a motion ended
        real(dp), intent(in) :: t !! the time then, s
        type(c_ptr), intent(in) :: place !! where C wants its pointer to the error; may be null
        character(longest_message) :: message

        code = merge(exit_input, code_of(status), is_refusal(status))
        if (code == exit_ok) return
        call describe_status(status, t, message)
        call hand_over(int(code), trim(status_names(status)), message, '', [0, 0], place)
    end function hand_status

    !> Whether C gave a null pointer where something has to be: that is an error, which it hands over. No text is made
    !> by a function here either.
    logical function is_null(pointer, what, place)
        type(c_ptr), intent(in) :: pointer !! what C gave
        character(*), intent(in) :: what !! what it should be, for the message
        type(c_ptr), intent(in) :: place !! where C wants its pointer to the error; may be null
        is_null = is_wrong(.not. c_associated(pointer), what // ' is a null pointer', place)
    end function is_null

    !> Whether an argument is wrong: that is an error, which it hands over. No text is made by a function here either.
    logical function is_wrong(found, message, place)
        logical, intent(in) :: found !! whether it is
        character(*), intent(in) :: message !! what is wrong
        type(c_ptr), intent(in) :: place !! where C wants its pointer to the error; may be null
        is_wrong = found
        if (found) call hand_over(exit_input, '', message, '', [0, 0], place)
    end function is_wrong

    !> Describes how a motion ended.
    subroutine describe_status(status, t, message)
        integer, intent(in) :: status !! how it ended
        real(dp), intent(in) :: t !! the time then, s
        character(longest_message), intent(out) :: message !! name and meaning of the status
        character(40) :: reached
        reached = ''
        if (.not. is_refusal(status)) write (reached, '(ss, a, es23.16e3, a)') ' (reached t =', t, ' s)'
        message = trim(status_names(status)) // ': ' // trim(status_meanings(status)) // reached
    end subroutine describe_status

    subroutine hand_over(code, status, message, source, at, place)
        integer, intent(in) :: code
        character(*), intent(in) :: status, message, source
        integer, intent(in) :: at(2) !! line and column
        type(c_ptr), intent(in) :: place
        type(owner_t), pointer :: owner
        type(c_ptr), pointer :: slot

        if (.not. c_associated(place)) return
        allocate (owner)
        call owner%status%set(status)
        call owner%message%set(message)
        call owner%source%set(source)
        owner%error = c_error_t(int(code, c_int), int(at(1), c_int), int(at(2), c_int), 0_c_int, owner%status%at(), &
                                owner%message%at(), owner%source%at(), c_loc(owner))
        call c_f_pointer(place, slot)
        slot = c_loc(owner%error)
    end subroutine hand_over

    !> Deletes an error.
    subroutine delete_error(handle) bind(C, name='spintop_error_delete')
        type(c_ptr), value :: handle !! the error; may be null
        type(c_error_t), pointer :: error
        type(owner_t), pointer :: owner
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, error)
        call c_f_pointer(error%owner, owner)
        deallocate (owner)
    end subroutine delete_error

end module spintop_c_error
