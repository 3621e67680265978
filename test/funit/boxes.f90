!> Boxes for the stand-in's asserts: any value that may be compared, of rank 0 to 2, in one type.
!! So each assert exists once, not once for every type, kind and rank.
module funit_boxes
    use, intrinsic :: iso_fortran_env, only: int32, int64, real64
    implicit none
    private
    public :: box_t, boxed, element

    !> One of several texts.
    type :: text_t
        character(:), allocatable :: trimmed
    end type text_t

    !> A value on its way into an assert: its type (integer, integer(int64), real, logical or text),
    !! its shape, which is empty for a scalar, and its elements in the component for the type.
    type :: box_t
        character(14) :: type_name
        integer, allocatable :: extents(:)
        real(real64), allocatable :: reals(:)
        integer(int64), allocatable :: integers(:)
        logical, allocatable :: truths(:)
        type(text_t), allocatable :: texts(:)
    end type box_t

    !> Put a value into a box. pf2f90.py writes this around what stands in an assert.
    interface boxed
        module procedure boxed_real, boxed_reals, boxed_real_matrix
        module procedure boxed_integer, boxed_integers
        module procedure boxed_long, boxed_longs
        module procedure boxed_truth, boxed_truths
        module procedure boxed_text, boxed_texts
    end interface boxed

contains

    pure function boxed_reals(x) result(box)
        real(real64), intent(in) :: x(:)
        type(box_t) :: box
        box = box_t('real', shape(x), reals=x)
    end function boxed_reals

    pure function boxed_real(x) result(box)
        real(real64), intent(in) :: x
        type(box_t) :: box
        box = scalar(boxed_reals([x]))
    end function boxed_real

    pure function boxed_real_matrix(x) result(box)
        real(real64), intent(in) :: x(:, :)
        type(box_t) :: box
        box = shaped(boxed_reals(reshape(x, [size(x)])), shape(x))
    end function boxed_real_matrix

    pure function boxed_integers(x) result(box)
        integer(int32), intent(in) :: x(:)
        type(box_t) :: box
        box = box_t('integer', shape(x), integers=int(x, int64))
    end function boxed_integers

    pure function boxed_integer(x) result(box)
        integer(int32), intent(in) :: x
        type(box_t) :: box
        box = scalar(boxed_integers([x]))
    end function boxed_integer

    pure function boxed_longs(x) result(box)
        integer(int64), intent(in) :: x(:)
        type(box_t) :: box
        box = box_t('integer(int64)', shape(x), integers=x)
    end function boxed_longs

    pure function boxed_long(x) result(box)
        integer(int64), intent(in) :: x
        type(box_t) :: box
        box = scalar(boxed_longs([x]))
    end function boxed_long

    pure function boxed_truths(x) result(box)
        logical, intent(in) :: x(:)
        type(box_t) :: box
        box = box_t('logical', shape(x), truths=x)
    end function boxed_truths

    pure function boxed_truth(x) result(box)
        logical, intent(in) :: x
        type(box_t) :: box
        box = scalar(boxed_truths([x]))
    end function boxed_truth

    pure function boxed_texts(x) result(box)
        character(*), intent(in) :: x(:)
        type(box_t) :: box
        type(text_t) :: texts(size(x))
        integer :: i
        do i = 1, size(x)  ! pFUnit compares texts without the blanks at both ends
            texts(i)%trimmed = trim(adjustl(x(i)))
        end do
        box = box_t('text', shape(x), texts=texts)
    end function boxed_texts

    pure function boxed_text(x) result(box)
        character(*), intent(in) :: x
        type(box_t) :: box
        box = scalar(boxed_texts([x]))
    end function boxed_text

    pure function scalar(vector) result(box)
        type(box_t), intent(in) :: vector
        type(box_t) :: box
        box = shaped(vector, [integer ::])
    end function scalar

    pure function shaped(vector, extents) result(box)
        type(box_t), intent(in) :: vector
        integer, intent(in) :: extents(:)
        type(box_t) :: box
        box = vector
        box%extents = extents
    end function shaped

    !> One element as a text for a message.
    pure function element(box, i) result(text)
        type(box_t), intent(in) :: box
        integer, intent(in) :: i
        character(:), allocatable :: text
        character(64) :: buffer
        if (allocated(box%texts)) then
            text = '"' // box%texts(i)%trimmed // '"'
            return
        end if
        if (allocated(box%reals)) write (buffer, '(g0)') box%reals(i)
        if (allocated(box%integers)) write (buffer, '(i0)') box%integers(i)
        if (allocated(box%truths)) write (buffer, '(l1)') box%truths(i)
        text = trim(buffer)
    end function element

end module funit_boxes
