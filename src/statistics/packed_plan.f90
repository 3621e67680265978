!> A plan of statistics as bytes, which the same build can read: with it the accumulators of parts can be merged,
!> and their result written, without the input, whose other files need not be there.
module spintop_packed_plan
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_archive, only: archive_t
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_table_column, only: table_column_t
    implicit none
    private
    public :: pack_plan, unpack_plan

    !> More groups than any sweep has: each number of them is a real.
    integer(int64), parameter :: most_groups = 2_int64**53
    !> Most columns of bins, and more characters than a word has.
    integer, parameter :: most_over = 2, longest_word = 1000

contains

    !> The bytes of a plan.
    function pack_plan(plan) result(bytes)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        character(:), allocatable :: bytes
        type(statistics_plan_t) :: copy
        type(archive_t) :: archive
        copy = plan
        call store_or_restore(archive, copy)
        bytes = archive%bytes()
    end function pack_plan

    !> The plan of some bytes; it does not know the cells of a row.
    subroutine unpack_plan(bytes, plan, is_valid)
        character(*), intent(in) :: bytes !! as `pack_plan` makes them
        type(statistics_plan_t), intent(out) :: plan !! what is gathered
        logical, intent(out) :: is_valid !! whether the bytes are a plan
        type(archive_t) :: archive
        integer :: i

        call archive%load(bytes)
        plan%is_wanted = .true.
        call store_or_restore(archive, plan)
        is_valid = archive%has_restored_all() .and. size(plan%over) <= most_over
        do i = 1, size(plan%over)
            if (is_valid) is_valid = size(plan%over(i)%bins%edge) == size(plan%over(i)%bins%value) + 1
        end do
        if (is_valid .and. size(plan%factors) > 0) then
            is_valid = plan%has_indices() .and. plan%groups >= 1 .and. plan%groups <= most_groups
        end if
    end subroutine unpack_plan

    !> Stores or restores a plan.
    subroutine store_or_restore(archive, plan)
        type(archive_t), intent(inout) :: archive
        type(statistics_plan_t), intent(inout) :: plan
        integer :: i, n

        n = 0
        if (allocated(plan%over)) n = size(plan%over)
        call archive%store_or_restore_count(n)
        if (archive%restores) allocate (plan%over(n))
        do i = 1, n
            call store_or_restore_column(archive, plan%over(i)%column)
            call archive%store_or_restore_list(plan%over(i)%bins%edge)
            call archive%store_or_restore_list(plan%over(i)%bins%value)
        end do
        call store_or_restore_columns(archive, plan%numbers)
        call store_or_restore_columns(archive, plan%categories)
        call archive%store_or_restore_list(plan%shares)
        call archive%store_or_restore(plan%by_bin)
        call archive%store_or_restore(plan%is_netcdf)
        call store_or_restore_columns(archive, plan%factors)
        call archive%store_or_restore(plan%groups)
    end subroutine store_or_restore

    !> Stores or restores a list of columns.
    subroutine store_or_restore_columns(archive, columns)
        type(archive_t), intent(inout) :: archive
        type(table_column_t), allocatable, intent(inout) :: columns(:)
        integer :: i, n
        n = 0
        if (allocated(columns)) n = size(columns)
        call archive%store_or_restore_count(n)
        if (archive%restores) allocate (columns(n))
        do i = 1, n
            call store_or_restore_column(archive, columns(i))
        end do
    end subroutine store_or_restore_columns

    !> Stores or restores the description of a column.
    subroutine store_or_restore_column(archive, column)
        type(archive_t), intent(inout) :: archive
        type(table_column_t), intent(inout) :: column
        integer :: k, n, length

        call archive%store_or_restore(column%name)
        call archive%store_or_restore(column%unit)
        call archive%store_or_restore(column%what)
        call archive%store_or_restore(column%kind)
        n = 0
        if (allocated(column%words)) n = size(column%words)
        call archive%store_or_restore_count(n)
        if (archive%restores) allocate (column%words(n))
        do k = 1, n
            length = 0
            if (.not. archive%restores) length = len(column%words(k)%text)
            call archive%store_or_restore(length)
            if (archive%restores) column%words(k)%text = repeat(' ', max(0, min(length, longest_word)))
            call archive%store_or_restore(column%words(k)%text)
        end do
    end subroutine store_or_restore_column

end module spintop_packed_plan
