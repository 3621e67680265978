!> Rows of a study that is a list of items, such as problems or cases, which do not depend on each other. The items of
!> a part are dealt out to the ranks in turn. The writer puts their rows to the table in the order of the items.
module spintop_dealt_rows
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_clock, only: pause_for
    use spintop_errors, only: error_t, input_error
    use spintop_kinds, only: dp
    use spintop_ranks, only: ranks_t
    use spintop_row_block, only: row_block_t
    use spintop_table_file, only: table_file_t
    use spintop_table_head, only: compare_heads
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: row_source_t, write_dealt, compare_with_writer

    !> What makes the rows of an item.
    type, abstract :: row_source_t
    contains
        procedure(make_i), deferred :: make
    end type row_source_t

    abstract interface
        !> Makes the rows of an item as text.
        subroutine make_i(self, number, rows, error)
            import :: row_source_t, int64, error_t
            implicit none
            class(row_source_t), intent(inout) :: self
            integer(int64), intent(in) :: number !! of the item, in the whole study
            character(:), allocatable, intent(out) :: rows !! the rows as text; may be empty
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine make_i
    end interface

    !> Pause between two looks for a message, s.
    real(dp), parameter :: between_looks = 1.0e-3_dp

contains

    !> Makes the items from `first` to `last`, each in one of the ranks. All ranks call it. An error in one of
    !> them is that of all.
    subroutine write_dealt(source, first, last, ranks, file, error)
        class(row_source_t), intent(inout) :: source !! makes the rows
        integer(int64), intent(in) :: first, last !! first and last item; none if last < first
        type(ranks_t), intent(in) :: ranks !! the ranks of the run
        type(table_file_t), intent(inout) :: file !! the table, which the writer has begun
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(string_t), allocatable :: rows(:)
        integer(int64) :: number
        integer :: i

        allocate (rows(max(0_int64, last - first + 1)))
        do i = 1, size(rows)
            rows(i)%text = ''
            if (owner(i, ranks) /= ranks%number .or. allocated(error)) cycle
            number = first + i - 1
            call source%make(number, rows(i)%text, error)
            if (ranks%count == 1 .and. .not. allocated(error)) call file%append(rows(i)%text, error)
        end do
        if (ranks%count > 1) then
            if (ranks%is_writer()) then
                call gather(ranks, rows)
                do i = 1, size(rows)
                    if (.not. allocated(error)) call file%append(rows(i)%text, error)
                end do
            else
                call send(ranks, rows)
            end if
        end if
        call ranks%agree(error)
    end subroutine write_dealt

    !> The rank that makes an item.
    pure integer function owner(i, ranks)
        integer, intent(in) :: i
        type(ranks_t), intent(in) :: ranks
        owner = mod(i - 1, ranks%count)
    end function owner

    !> Sends the rows of this rank to the writer, those of an item at a time; an item that failed has none.
    subroutine send(ranks, rows)
        type(ranks_t), intent(in) :: ranks
        type(string_t), intent(in) :: rows(:)
        type(row_block_t) :: block
        integer(int64) :: number
        integer :: i

        call block%reserve(1, 1)
        do i = 1, size(rows)
            if (owner(i, ranks) /= ranks%number) cycle
            call block%clear()
            call block%text%append(rows(i)%text)
            number = i
            call ranks%exchange(number, block)
        end do
    end subroutine send

    !> Receives the rows of the items of all other ranks.
    subroutine gather(ranks, rows)
        type(ranks_t), intent(in) :: ranks
        type(string_t), intent(inout) :: rows(:)
        type(row_block_t) :: block
        integer(int64) :: number
        integer :: i, missing, rank
        logical :: is_there

        missing = count([(owner(i, ranks) /= ranks%number, i=1, size(rows))])
        do while (missing > 0)
            call ranks%receive(rank, number, block, is_there)
            if (.not. is_there) then
                call pause_for(between_looks)
                cycle
            end if
            rows(number)%text = block%text%contents()
            call ranks%answer(rank, number)
            missing = missing - 1
        end do
    end subroutine gather

    !> Checks that all ranks have the same build and input: their tables must have equal headers. All ranks call it.
    subroutine compare_with_writer(ranks, head, error)
        type(ranks_t), intent(in) :: ranks !! the ranks of the run
        character(*), intent(in) :: head !! the header of this rank
        type(error_t), allocatable, intent(out) :: error !! the same in all ranks; not allocated if they are alike
        character(:), allocatable :: head_of_writer, problem
        head_of_writer = head
        call ranks%broadcast(head_of_writer)
        problem = compare_heads(head_of_writer, 'rank 0', head, 'rank ' // to_text(ranks%number))
        if (problem /= '') error = input_error('the ranks have different builds or inputs' // problem)
        call ranks%agree(error)
    end subroutine compare_with_writer

end module spintop_dealt_rows
