!> CSV tables that are either complete or not there. The rows go to `NAME.part`, which takes the
!> name of the table when everything is on the disk.
!>
!>     call table%create('output/scene.csv', table_head(comments, ['t    ', 'theta']), error)
!>     call table%add_row([0.0_dp, 0.3_dp], error)    ! a row of numbers, or
!>     call table%put(text, error)                    ! rows made elsewhere
!>     call table%finish(trailer, error)
!>
!> After an error call `discard`, or `abandon` where the part is worth keeping.
module spintop_table_file
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_checksum, only: add_to_checksum, checksum_t
    use spintop_errors, only: error_t, output_error
    use spintop_files, only: is_folder, output_file_t, remove_file, rename_file, sync_folder_of
    use spintop_journal, only: remove_journal
    use spintop_kinds, only: dp
    use spintop_table_head, only: comment_lines
    use spintop_text, only: string_t
    use spintop_text_buffer, only: text_buffer_t
    implicit none
    private
    public :: table_file_t, part_of

    !> Bytes that are gathered before they are written.
    integer, parameter :: block_size = 1024 * 1024

    !> A CSV table that is being written.
    type :: table_file_t
        character(:), allocatable :: path     !! of the complete table
        integer(int64) :: bytes = 0           !! written so far, header included
        type(checksum_t) :: checksum          !! of the bytes written so far
        type(output_file_t), private :: file
        type(text_buffer_t), private :: pending
        logical, private :: unfinished = .false.
    contains
        procedure :: create
        procedure :: reserve
        procedure :: begin
        procedure :: go_on
        procedure :: add_row
        procedure :: put
        procedure :: write_pending
        procedure :: sync
        procedure :: finish
        procedure :: discard
        procedure :: abandon
    end type table_file_t

contains

    !> The name that a table has before it is complete.
    pure function part_of(path) result(part)
        character(*), intent(in) :: path
        character(:), allocatable :: part
        part = path // '.part'
    end function part_of

    !> Starts a table. A table of that name stays as it is until `finish`.
    subroutine create(self, path, head, error)
        class(table_file_t), intent(inout) :: self
        character(*), intent(in) :: path
        character(*), intent(in) :: head !! ready to write
        type(error_t), allocatable, intent(out) :: error
        call self%reserve(path, error)
        ! That of another kind of run would say more than the part has.
        if (.not. allocated(error)) call remove_journal(path, error)
        if (.not. allocated(error)) call self%begin(head, error)
        if (allocated(error)) call self%discard()
    end subroutine create

    !> Takes hold of the part, and leaves it as it is: no other run can write it meanwhile. It is
    !> made where it is missing.
    subroutine reserve(self, path, error)
        class(table_file_t), intent(inout) :: self
        character(*), intent(in) :: path
        type(error_t), allocatable, intent(out) :: error

        self%path = path
        self%bytes = 0
        self%checksum = checksum_t()
        call self%pending%clear()
        if (is_folder(path)) then
            error = output_error('cannot create ' // path // ': it is a folder')
            return
        end if
        call self%file%open(part_of(path), error)
        self%unfinished = .not. allocated(error)
    end subroutine reserve

    !> Empties the part, and writes the header. A place that is not writable is found now, not after the computation.
    subroutine begin(self, head, error)
        class(table_file_t), intent(inout) :: self
        character(*), intent(in) :: head
        type(error_t), allocatable, intent(out) :: error
        call self%file%truncate(0_int64, error)
        if (.not. allocated(error)) call self%put(head, error)
        if (.not. allocated(error)) call self%write_pending(error)
    end subroutine begin

    !> Cuts the part to its first `bytes`, of which the caller knows the checksum; writing continues there.
    subroutine go_on(self, bytes, checksum, error)
        class(table_file_t), intent(inout) :: self
        integer(int64), intent(in) :: bytes
        type(checksum_t), intent(in) :: checksum
        type(error_t), allocatable, intent(out) :: error
        self%bytes = bytes
        self%checksum = checksum
        call self%file%truncate(bytes, error)
    end subroutine go_on

    !> Adds a row of numbers.
    subroutine add_row(self, values, error)
        class(table_file_t), intent(inout) :: self
        real(dp), intent(in), contiguous :: values(:)
        type(error_t), allocatable, intent(out) :: error
        integer :: before

        before = self%pending%length
        call self%pending%put_reals(values)
        call self%pending%end_row()
        self%bytes = self%bytes + self%pending%length - before
        if (self%pending%length >= block_size) call self%write_pending(error)
    end subroutine add_row

    !> Adds rows made elsewhere.
    subroutine put(self, text, error)
        class(table_file_t), intent(inout) :: self
        character(*), intent(in) :: text
        type(error_t), allocatable, intent(out) :: error

        call self%pending%append(text)
        self%bytes = self%bytes + len(text)
        if (self%pending%length >= block_size) call self%write_pending(error)
    end subroutine put

    !> Hands all that was put to the system.
    subroutine write_pending(self, error)
        class(table_file_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        if (self%pending%length == 0) return
        call self%file%write(self%pending%room(:self%pending%length), error)
        call add_to_checksum(self%checksum, self%pending%room(:self%pending%length))
        call self%pending%clear()
    end subroutine write_pending

    !> Waits until all written bytes are on the disk. Other threads may continue to add rows.
    subroutine sync(self, error)
        class(table_file_t), intent(in) :: self
        type(error_t), allocatable, intent(out) :: error
        call self%file%sync(error)
    end subroutine sync

    !> Ends the table with comment lines, and gives it its name once it is on the disk.
    subroutine finish(self, trailer, error)
        class(table_file_t), intent(inout) :: self
        type(string_t), intent(in) :: trailer(:) !! comment lines, without the `#`
        type(error_t), allocatable, intent(out) :: error

        call self%put(comment_lines(trailer), error)
        if (.not. allocated(error)) call self%write_pending(error)
        if (.not. allocated(error)) call self%file%sync(error)
        ! Closed it would be free for another run, which might empty it under its new name.
        if (.not. allocated(error)) call rename_file(self%file%path, self%path, error)
        if (allocated(error)) return
        self%unfinished = .false.
        call self%file%close(error)
        if (.not. allocated(error)) call sync_folder_of(self%path, error)
    end subroutine finish

    !> Discards the table: what was written is removed, as far as that is possible.
    subroutine discard(self)
        class(table_file_t), intent(inout) :: self
        type(error_t), allocatable :: ignored
        if (.not. self%unfinished) return
        call remove_file(self%file%path, ignored)
        call self%abandon()
    end subroutine discard

    !> Keeps the part, so that a later run can resume it.
    subroutine abandon(self)
        class(table_file_t), intent(inout) :: self
        type(error_t), allocatable :: ignored
        self%unfinished = .false.
        call self%file%close(ignored)
    end subroutine abandon

end module spintop_table_file
