!> A plan of statistics in the file of their state: with it the accumulators of parts can be merged, and their result written,
!> without the input, whose other files need not be there.
module spintop_carried_plan
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_state_stream, only: state_stream_t
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_table_column, only: table_column_t
    implicit none
    private
    public :: carry_plan

    !> More groups than any sweep has: each number of them is a real.
    integer(int64), parameter :: most_groups = 2_int64**53
    !> Most columns of bins.
    integer, parameter :: most_over = 2
    !> What a column and a count take in the file at least.
    type(table_column_t), parameter :: any_column = table_column_t()
    integer, parameter :: bytes_of_column = len(any_column%name) + len(any_column%unit) + len(any_column%what), &
        bytes_of_count = storage_size(most_groups) / 8

contains

    !> Writes a plan, or reads it: then it does not know the cells of a row.
    subroutine carry_plan(stream, plan)
        type(state_stream_t), intent(inout) :: stream !! the file
        type(statistics_plan_t), intent(inout) :: plan !! what is gathered
        integer(int64) :: groups(1)
        logical :: is_valid
        integer :: i, n

        n = 0
        if (allocated(plan%over)) n = size(plan%over)
        call stream%carry_count(n, bytes_of_column)
        if (stream%is_read) allocate (plan%over(n))
        do i = 1, n
            call carry_column(stream, plan%over(i)%column)
            call stream%carry_list(plan%over(i)%bins%edge)
            call stream%carry_list(plan%over(i)%bins%value)
        end do
        call carry_columns(stream, plan%numbers)
        call carry_columns(stream, plan%categories)
        call stream%carry_list(plan%shares)
        call stream%carry_flag(plan%by_bin)
        call stream%carry_flag(plan%is_netcdf)
        call carry_columns(stream, plan%factors)
        groups = plan%groups
        call stream%carry_numbers(1, groups)
        if (.not. stream%is_read .or. allocated(stream%error)) return
        plan%is_wanted = .true.
        plan%groups = groups(1)
        is_valid = size(plan%over) <= most_over
        do i = 1, size(plan%over)
            if (is_valid) is_valid = size(plan%over(i)%bins%edge) == size(plan%over(i)%bins%value) + 1
        end do
        if (is_valid .and. size(plan%factors) > 0) then
            is_valid = plan%has_indices() .and. plan%groups >= 1 .and. plan%groups <= most_groups
        end if
        ! A damaged number of bins must not ask for memory without end.
        if (is_valid) is_valid = plan%bytes_of_bins() <= stream%size
        if (.not. is_valid) call stream%refuse()
    end subroutine carry_plan

    subroutine carry_columns(stream, columns)
        type(state_stream_t), intent(inout) :: stream
        type(table_column_t), allocatable, intent(inout) :: columns(:)
        integer :: i, n
        n = 0
        if (allocated(columns)) n = size(columns)
        call stream%carry_count(n, bytes_of_column)
        if (stream%is_read) allocate (columns(n))
        do i = 1, n
            call carry_column(stream, columns(i))
        end do
    end subroutine carry_columns

    subroutine carry_column(stream, column)
        type(state_stream_t), intent(inout) :: stream
        type(table_column_t), intent(inout) :: column
        integer :: k, n, length

        call stream%carry_text(column%name)
        call stream%carry_text(column%unit)
        call stream%carry_text(column%what)
        call stream%carry_count(column%kind, 1)
        n = 0
        if (allocated(column%words)) n = size(column%words)
        call stream%carry_count(n, bytes_of_count)
        if (stream%is_read) allocate (column%words(n))
        do k = 1, n
            length = 0
            if (.not. stream%is_read) length = len(column%words(k)%text)
            call stream%carry_count(length, 1)
            if (stream%is_read) column%words(k)%text = repeat(' ', length)
            call stream%carry_text(column%words(k)%text)
        end do
    end subroutine carry_column

end module spintop_carried_plan
