!> Part I of N of a study: its cases, and the first line of its table.
module spintop_shard
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_text, only: to_text
    implicit none
    private
    public :: shard_t, read_shard, read_shard_line, most_shards

    !> Maximum number of parts of a sweep.
    integer, parameter :: most_shards = 1000000

    !> Part `number` of `count`; by default the whole sweep.
    type :: shard_t
        integer :: number = 1, count = 1
    contains
        procedure :: is_part
        procedure :: first
        procedure :: last
        procedure :: suffix
        procedure :: line
        procedure :: beginning
    end type shard_t

contains

    !> Whether it is a part, and not the whole.
    pure logical function is_part(self)
        class(shard_t), intent(in) :: self
        is_part = self%count > 1
    end function is_part

    !> First case of the part, for a number of cases. The parts are consecutive, and their sizes differ by at
    !> most one case.
    pure integer(int64) function first(self, cases)
        class(shard_t), intent(in) :: self
        integer(int64), intent(in) :: cases !! number of cases of the whole sweep
        first = last_before(self%number, self%count, cases) + 1
    end function first

    !> Last case of the part; less than the first if there are more parts than cases.
    pure integer(int64) function last(self, cases)
        class(shard_t), intent(in) :: self
        integer(int64), intent(in) :: cases !! number of cases of the whole sweep
        last = last_before(self%number + 1, self%count, cases)
    end function last

    !> Number of cases before part `number`.
    pure integer(int64) function last_before(number, count, cases)
        integer, intent(in) :: number, count
        integer(int64), intent(in) :: cases
        last_before = (number - 1) * (cases / count) + min(number - 1_int64, mod(cases, int(count, int64)))
    end function last_before

    !> Suffix of the name of its table: `.2-of-3`.
    pure function suffix(self)
        class(shard_t), intent(in) :: self
        character(:), allocatable :: suffix
        suffix = ''
        if (self%is_part()) suffix = '.' // to_text(self%number) // '-of-' // to_text(self%count)
    end function suffix

    !> The first line of its table.
    pure function line(self, cases)
        class(shard_t), intent(in) :: self
        integer(int64), intent(in) :: cases !! of the whole
        character(:), allocatable :: line
        line = 'no cases'
        if (self%last(cases) >= self%first(cases)) then
            line = 'cases ' // to_text(self%first(cases)) // ' to ' // to_text(self%last(cases))
        end if
        line = 'part ' // to_text(self%number) // ' of ' // to_text(self%count) // ': ' // line // ' of ' // to_text(cases)
    end function line

    !> What its table begins with: the first line, or '' if it is the whole.
    pure function beginning(self, cases) result(text)
        class(shard_t), intent(in) :: self
        integer(int64), intent(in) :: cases !! of the whole
        character(:), allocatable :: text
        text = ''
        if (self%is_part()) text = self%line(cases)
    end function beginning

    !> Reads `I/N`.
    subroutine read_shard(text, shard, valid)
        character(*), intent(in) :: text !! `I/N`
        type(shard_t), intent(out) :: shard !! the part, if the text is valid
        logical, intent(out) :: valid !! whether it is valid
        integer :: slash, status

        slash = index(text, '/')
        valid = slash > 1 .and. slash < len(text) .and. verify(text, '0123456789/') == 0 &
                .and. index(text, '/', back=.true.) == slash
        if (.not. valid) return
        read (text(:slash - 1), *, iostat=status) shard%number
        if (status == 0) read (text(slash + 1:), *, iostat=status) shard%count
        valid = status == 0 .and. shard%number >= 1 .and. shard%number <= shard%count &
                .and. shard%count <= most_shards
    end subroutine read_shard

    !> Reads the first line of the table of a part.
    subroutine read_shard_line(text, shard, cases, valid)
        character(*), intent(in) :: text !! the first line, without its `# `
        type(shard_t), intent(out) :: shard !! the part, if the line is valid
        integer(int64), intent(out) :: cases !! of the whole
        logical, intent(out) :: valid !! whether it is valid
        character(32) :: words(4)
        integer :: status, status_of_cases

        cases = 0
        words = ''
        shard = shard_t()
        read (text, *, iostat=status) words ! part I of N:
        call read_shard(trim(words(2)) // '/' // words(4)(:index(words(4) // ':', ':') - 1), shard, valid)
        read (text(index(text, ' ', back=.true.) + 1:), *, iostat=status_of_cases) cases
        ! Only a line that this program would write is accepted.
        if (valid) valid = status == 0 .and. status_of_cases == 0 .and. shard%line(cases) == text
    end subroutine read_shard_line

end module spintop_shard
