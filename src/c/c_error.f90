!> Texts, arguments and errors of C. A text for C ends with a null character, and lives as long as the object that has it; an
!> error is a structure that the library makes and deletes, and that C reads. `include/spintop.h` describes it.
module spintop_c_error
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_int, c_loc, c_null_char, c_null_ptr, c_ptr, &
        c_size_t
    use spintop_errors, only: error_t, exit_input, exit_ok
    use spintop_kinds, only: dp
    use spintop_status, only: code_of, is_refusal, status_meanings, status_names
    use spintop_text, only: string_t
    implicit none
    private
    public :: is_empty, read_c_text, read_c_texts, read_input, take_pointers
    public :: refuse, failed, hand_status, describe_status, longest_message

    !> `spintop_error` of the header.
    type, bind(C) :: c_error_t
        integer(c_int) :: code = exit_ok, line = 0, column = 0, reserved = 0
        type(c_ptr) :: status = c_null_ptr, message = c_null_ptr, source = c_null_ptr, owner = c_null_ptr
    end type c_error_t

    !> An error, and the texts to which it points.
    type :: owner_t
        type(c_error_t) :: error
        character(:), allocatable :: status, message, source
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

    !> Makes an error of a wrong argument. No text is made by a function, here and in what follows, so several threads may call
    !> it at once: see `status_names`.
    subroutine refuse(is_wrong, message, error)
        logical, intent(in) :: is_wrong !! whether it is wrong
        character(*), intent(in) :: message !! what is wrong
        type(error_t), allocatable, intent(inout) :: error !! set, unless there is one
        if (is_wrong .and. .not. allocated(error)) error = error_t(exit_input, message)
    end subroutine refuse

    !> Whether there is an error, which C gets then.
    logical function failed(error, place)
        type(error_t), allocatable, intent(in) :: error !! the error
        type(c_ptr), intent(in) :: place !! where C wants its pointer to the error; may be null
        failed = allocated(error)
        if (failed) call hand_over(error, '', place)
    end function failed

    !> Hands a status to C, and returns its code: 0, and no error, for a good end.
    integer(c_int) function hand_status(status, t, place) result(code)
        integer, intent(in) :: status !! how a motion ended
        real(dp), intent(in) :: t !! the time then, s
        type(c_ptr), intent(in) :: place !! where C wants its pointer to the error; may be null
        character(longest_message) :: message

        code = merge(exit_input, code_of(status), is_refusal(status))
        if (code == exit_ok) return
        call describe_status(status, t, message)
        call hand_over(error_t(int(code), message), status_names(status), place)
    end function hand_status

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

    !> Makes an error that C owns.
    subroutine hand_over(error, status, place)
        type(error_t), intent(in) :: error
        character(*), intent(in) :: status
        type(c_ptr), intent(in) :: place
        type(owner_t), pointer :: owner
        type(c_ptr), pointer :: slot

        if (.not. c_associated(place)) return
        allocate (owner)
        owner%status = trim(status) // c_null_char
        owner%message = trim(error%message) // c_null_char
        owner%source = c_null_char
        if (allocated(error%source)) owner%source = error%source // c_null_char
        owner%error = c_error_t(int(error%code, c_int), int(error%line, c_int), int(error%column, c_int), 0_c_int, &
                                c_loc(owner%status), c_loc(owner%message), c_loc(owner%source), c_loc(owner))
        call c_f_pointer(place, slot)
        slot = c_loc(owner%error)
    end subroutine hand_over

    !> Copies a text of C; '' for a null pointer.
    subroutine read_c_text(from, text)
        type(c_ptr), intent(in) :: from !! where it is
        character(:), allocatable, intent(out) :: text !! a copy of it
        character(c_char), pointer :: letters(:)
        integer(c_size_t) :: length, i

        length = 0
        if (c_associated(from)) length = c_length(from)
        if (length > 0) call c_f_pointer(from, letters, [length])
        allocate (character(length) :: text)
        do i = 1, length
            text(i:i) = letters(i)
        end do
    end subroutine read_c_text

    !> Copies an input and its name in messages, which is `input` where C has none.
    subroutine read_input(input, name, text, name_of_text, error)
        type(c_ptr), intent(in) :: input, name !! where they are; only the name may be null
        character(:), allocatable, intent(out) :: text, name_of_text !! copies of them
        type(error_t), allocatable, intent(inout) :: error !! an argument is wrong
        call refuse(.not. c_associated(input), 'the input is a null pointer', error)
        call refuse(is_empty(name), 'the name of the input is empty', error)
        call read_c_text(input, text)
        call read_c_text(name, name_of_text)
        if (.not. c_associated(name)) name_of_text = 'input'
    end subroutine read_input

    !> Whether there is a text, and it is empty.
    logical function is_empty(text)
        type(c_ptr), intent(in) :: text !! where it is; may be null
        is_empty = c_associated(text)
        if (is_empty) is_empty = c_length(text) == 0
    end function is_empty

    !> Takes an array of pointers, none of which may be null.
    subroutine take_pointers(places, n, what, pointers, error)
        type(c_ptr), intent(in) :: places !! where they are; may be null if there are none
        integer(c_int), intent(in) :: n !! their number
        character(*), intent(in) :: what !! what a null pointer would be
        type(c_ptr), pointer, intent(out) :: pointers(:) !! the pointers, if there are any
        type(error_t), allocatable, intent(inout) :: error !! one of them is null
        integer :: i

        nullify (pointers)
        call refuse(n > 0 .and. .not. c_associated(places), what // ' is a null pointer', error)
        if (n <= 0 .or. .not. c_associated(places)) return
        call c_f_pointer(places, pointers, [n])
        call refuse(.not. all([(c_associated(pointers(i)), i=1, n)]), what // ' is a null pointer', error)
    end subroutine take_pointers

    !> Copies an array of texts of C.
    subroutine read_c_texts(places, n, what, texts, error)
        type(c_ptr), intent(in) :: places !! where the pointers to them are
        integer(c_int), intent(in) :: n !! their number
        character(*), intent(in) :: what !! what one of them is
        type(string_t), allocatable, intent(out) :: texts(:) !! the texts; none of them is set after an error
        type(error_t), allocatable, intent(inout) :: error !! one of them is null
        type(c_ptr), pointer :: pointers(:)
        integer :: i

        allocate (texts(max(0, n)))
        call take_pointers(places, n, what, pointers, error)
        if (allocated(error)) return
        do i = 1, size(texts)
            call read_c_text(pointers(i), texts(i)%text)
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
