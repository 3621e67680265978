!> Texts between C and Fortran: a C text ends with a null character, and lives as long as the object that has it.
module spintop_c_text
    use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_loc, c_null_char, c_null_ptr, c_ptr, c_size_t, &
        c_associated
    use spintop_text, only: string_t
    implicit none
    private
    public :: c_text_t, is_any_null, is_empty, read_c_text, read_c_texts

    !> A text for C.
    type :: c_text_t
        character(c_char), allocatable :: letters(:)
    contains
        procedure :: set
        procedure :: at
    end type c_text_t

    interface
        !> Length of a C text.
        pure integer(c_size_t) function c_length(text) bind(C, name='strlen')
            import :: c_ptr, c_size_t
            type(c_ptr), value :: text
        end function c_length
    end interface

contains

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

end module spintop_c_text
