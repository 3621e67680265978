!> Texts and errors for C. A text ends with a null character, and lives as long as the object that has it; an error is a
!> structure that the library makes and deletes, and that C reads. `include/spintop.h` describes it.
module spintop_c_error
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_int, c_loc, c_null_char, c_null_ptr, c_ptr, &
        c_size_t
    use spintop_errors, only: error_t
    use spintop_exit_codes, only: exit_input, exit_ok
    use spintop_kinds, only: dp
    use spintop_status, only: code_of, is_refusal, status_meanings, status_names
    use spintop_text, only: string_t
    implicit none
    private
    public :: c_text_t, is_any_null, is_empty, read_c_text, read_c_texts
    public :: hand_error, hand_status, is_wrong, describe_status, longest_message

    !> A text for C.
    type :: c_text_t
        character(c_char), allocatable :: letters(:)
    contains
        procedure :: set
        procedure :: at
    end type c_text_t

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

    interface
        !> Length of a C text.
        pure integer(c_size_t) function c_length(text) bind(C, name='strlen')
            import :: c_ptr, c_size_t
            type(c_ptr), value :: text
        end function c_length
    end interface

    !> Longest message on a status.
    integer, parameter :: longest_message = 256

contains

    !> Hands an error to C.
    subroutine hand_error(error, place)
        type(error_t), intent(in) :: error !! the error that C gets
        type(c_ptr), intent(in) :: place !! where C wants its pointer to the error; may be null
        call hand_over(error%code, '', error%message, [error%line, error%column], place, error%source)
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
        call hand_over(int(code), trim(status_names(status)), message, [0, 0], place)
    end function hand_status

    !> Whether an argument is wrong: that is an error, which it hands over. No text is made by a function here either.
    logical function is_wrong(found, message, place)
        logical, intent(in) :: found !! whether it is
        character(*), intent(in) :: message !! what is wrong
        type(c_ptr), intent(in) :: place !! where C wants its pointer to the error; may be null
        is_wrong = found
        if (found) call hand_over(exit_input, '', message, [0, 0], place)
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

    !> Makes an error that C owns. An unallocated `source` is an absent one.
    subroutine hand_over(code, status, message, at, place, source)
        integer, intent(in) :: code
        character(*), intent(in) :: status, message
        integer, intent(in) :: at(2) !! line and column
        type(c_ptr), intent(in) :: place
        character(*), intent(in), optional :: source
        type(owner_t), pointer :: owner
        type(c_ptr), pointer :: slot

        if (.not. c_associated(place)) return
        allocate (owner)
        call owner%status%set(status)
        call owner%message%set(message)
        call owner%source%set('')
        if (present(source)) call owner%source%set(source)
        owner%error = c_error_t(int(code, c_int), int(at(1), c_int), int(at(2), c_int), 0_c_int, owner%status%at(), &
                                owner%message%at(), owner%source%at(), c_loc(owner))
        call c_f_pointer(place, slot)
        slot = c_loc(owner%error)
    end subroutine hand_over

    !> Sets the text; blanks at its end are left out.
    pure subroutine set(self, text)
        class(c_text_t), intent(inout) :: self
        character(*), intent(in) :: text !! the text to copy
        integer :: i
        self%letters = [character(c_char) :: (text(i:i), i=1, len_trim(text)), c_null_char]
    end subroutine set

    !> Where the text is; null if it was not set.
    type(c_ptr) function at(self)
        class(c_text_t), target, intent(in) :: self
        at = c_null_ptr
        if (allocated(self%letters)) at = c_loc(self%letters)
    end function at

    !> Copies a text of C; '' for a null pointer.
    subroutine read_c_text(from, text)
        type(c_ptr), intent(in) :: from !! where it is
        character(:), allocatable, intent(out) :: text !! a copy of it
        character(c_char), pointer :: letters(:)
        integer(c_size_t) :: i

        text = ''
        if (.not. c_associated(from)) return
        call c_f_pointer(from, letters, [c_length(from)])
        deallocate (text)
        allocate (character(size(letters, kind=c_size_t)) :: text)
        do i = 1, size(letters, kind=c_size_t)
            text(i:i) = letters(i)
        end do
    end subroutine read_c_text

    !> Whether there is a text, and it is empty.
    logical function is_empty(text)
        type(c_ptr), intent(in) :: text !! where it is; may be null
        is_empty = c_associated(text)
        if (is_empty) is_empty = c_length(text) == 0
    end function is_empty

    !> Whether an array of pointers is null, or one of them is.
    logical function is_any_null(places, n)
        type(c_ptr), intent(in) :: places !! where the pointers are
        integer, intent(in) :: n !! their number
        type(c_ptr), pointer :: each(:)
        integer :: i

        is_any_null = .false.
        if (n <= 0) return
        is_any_null = .not. c_associated(places)
        if (is_any_null) return
        call c_f_pointer(places, each, [n])
        do i = 1, n
            is_any_null = is_any_null .or. .not. c_associated(each(i))
        end do
    end function is_any_null

    !> Copies an array of texts of C.
    subroutine read_c_texts(from, n, texts)
        type(c_ptr), intent(in) :: from !! where the pointers to them are
        integer, intent(in) :: n !! their number
        type(string_t), allocatable, intent(out) :: texts(:) !! the texts
        type(c_ptr), pointer :: each(:)
        integer :: i

        allocate (texts(n))
        if (n == 0) return
        call c_f_pointer(from, each, [n])
        do i = 1, n
            call read_c_text(each(i), texts(i)%text)
        end do
    end subroutine read_c_texts

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
