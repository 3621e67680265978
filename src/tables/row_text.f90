!> The rows of a block as the text of a table.
module spintop_row_text
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_row_block, only: row_block_t
    use spintop_table_column, only: column_of_integers, column_of_notes, column_of_reals, column_of_words, &
        table_column_t
    implicit none
    private
    public :: format_rows

contains

    !> Makes the text of the rows from their cells, which then have done their work.
    subroutine format_rows(columns, rows)
        type(table_column_t), intent(in) :: columns(:)
        type(row_block_t), intent(inout) :: rows
        integer :: last(size(columns)), i, k

        ! Reals are written fastest many at once: where the reals that begin with a column end.
        do i = size(columns), 1, -1
            last(i) = i
            if (columns(i)%kind /= column_of_reals .or. i == size(columns)) cycle
            if (columns(i + 1)%kind == column_of_reals) last(i) = last(i + 1)
        end do
        do k = 1, rows%rows
            i = 1
            do while (i <= size(columns))
                select case (columns(i)%kind)
                case (column_of_reals)
                    call rows%text%put_reals(rows%cells(i:last(i), k))
                case (column_of_integers)
                    call rows%text%put_integer(nint(rows%cells(i, k), int64))
                case (column_of_words)
                    call rows%text%put_text(columns(i)%words(nint(rows%cells(i, k)) + 1)%text)
                case (column_of_notes)
                    if (allocated(rows%notes(k)%text)) then
                        call rows%text%put_text(rows%notes(k)%text)
                    else
                        call rows%text%put_text('')
                    end if
                end select
                i = last(i) + 1
            end do
            call rows%text%end_row()
        end do
        rows%rows = 0
    end subroutine format_rows

end module spintop_row_text
