!> CSV tables that are either complete or not there. The rows go to `NAME.part`, which takes the
!> name of the table when everything is on the disk.
!>
!>     call table%create('output/sweep.csv', header, [character(8) :: 't', 'theta'], error)
!>     call table%add_row([0.0_dp, 0.3_dp], error)    ! a row of numbers, or
!>     call table%put_block(rows, error)              ! any rows from a text_buffer_t
!>     call table%finish(trailer, error)
!>
!> After an error call `discard`.
module spintop_table_file
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, output_error
    use spintop_kinds, only: dp
    use spintop_system, only: is_folder, output_file_t, remove_file, rename_file, sync_folder_of
    use spintop_text, only: join, string_t
    use spintop_text_buffer, only: text_buffer_t
    implicit none
    private
    public :: table_file_t

    !> Bytes that are gathered before they are written.
    integer, parameter :: block_size = 1024 * 1024

    type :: table_file_t
        character(:), allocatable :: path !! of the complete table
        integer(int64) :: bytes = 0       !! put so far, header included
        type(output_file_t), private :: file
        type(text_buffer_t), private :: pending
        logical, private :: unfinished = .false.
    contains
        procedure :: create
        procedure :: add_row
        procedure :: put_block
        procedure :: finish
        procedure :: discard
        procedure, private :: add_comments
        procedure, private :: write_pending
    end type table_file_t

contains

    !> Starts a table. A table of that name stays as it is until `finish`.
    subroutine create(self, path, header, columns, error)
        class(table_file_t), intent(inout) :: self
        character(*), intent(in) :: path
        type(string_t), intent(in) :: header(:)  !! comment lines, without the `#`
        character(*), intent(in) :: columns(:)   !! names
        type(error_t), allocatable, intent(out) :: error

        self%path = path
        self%bytes = 0
        call self%pending%clear()
        if (is_folder(path)) then
            error = output_error('cannot create ' // path // ': it is a folder')
            return
        end if
        call self%file%create(path // '.part', error)
        self%unfinished = .not. allocated(error)
        if (allocated(error)) return
        call self%add_comments(header)
        call self%pending%append(join(columns, ',') // new_line('a'))
        self%bytes = self%pending%length
        ! An unwritable place shows now, not after the computation.
        call self%write_pending(error)
    end subroutine create

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
    subroutine put_block(self, rows, error)
        class(table_file_t), intent(inout) :: self
        type(text_buffer_t), intent(in) :: rows
        type(error_t), allocatable, intent(out) :: error

        call self%pending%append(rows%contents())
        self%bytes = self%bytes + rows%length
        if (self%pending%length >= block_size) call self%write_pending(error)
    end subroutine put_block

    !> Ends the table with comment lines, and gives it its name once it is on the disk.
    subroutine finish(self, trailer, error)
        class(table_file_t), intent(inout) :: self
        type(string_t), intent(in) :: trailer(:) !! comment lines, without the `#`
        type(error_t), allocatable, intent(out) :: error

        call self%add_comments(trailer)
        call self%write_pending(error)
        if (.not. allocated(error)) call self%file%sync(error)
        if (.not. allocated(error)) call self%file%close(error)
        if (.not. allocated(error)) call rename_file(self%file%path, self%path, error)
        if (allocated(error)) return
        self%unfinished = .false.
        call sync_folder_of(self%path, error)
    end subroutine finish

    !> Gives the table up: what was written is removed, as far as that is possible.
    subroutine discard(self)
        class(table_file_t), intent(inout) :: self
        type(error_t), allocatable :: ignored
        if (.not. self%unfinished) return
        self%unfinished = .false.
        call self%file%close(ignored)
        call remove_file(self%file%path, ignored)
    end subroutine discard

    subroutine add_comments(self, lines)
        class(table_file_t), intent(inout) :: self
        type(string_t), intent(in) :: lines(:)
        integer :: i
        do i = 1, size(lines)
            call self%pending%append(trim('# ' // lines(i)%text) // new_line('a'))
        end do
    end subroutine add_comments

    subroutine write_pending(self, error)
        class(table_file_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        call self%file%write(self%pending%contents(), error)
        call self%pending%clear()
    end subroutine write_pending

end module spintop_table_file
