!> Options of the command line for studies.
module spintop_options
    use spintop_ranks, only: ranks_t
    use spintop_shard, only: shard_t
    use spintop_text, only: string_t
    implicit none
    private
    public :: options_t, shell_word

    !> Options of the command line for all inputs, and the processes of the run.
    type :: options_t
        !> Folder for results.
        character(:), allocatable :: output
        !> Overrides `group.key=value`, in the given order.
        type(string_t), allocatable :: overrides(:)
        !> Number of threads; 0 for all cores.
        integer :: threads = 0
        logical :: quiet = .false.
        logical :: progress = .false.
        !> The part of a sweep, and whether an interrupted sweep is resumed or discarded.
        type(shard_t) :: shard
        logical :: resume = .false., restart = .false.
        !> Whether the inputs are tables, whose headers have them, to be verified; and whether each number must be proved.
        logical :: verifies = .false., strict = .false.
        !> The program and its options in the syntax of a shell, without the inputs and those two options.
        character(:), allocatable :: command
        type(ranks_t) :: ranks
    end type options_t

contains

    !> A text as a word of the shell.
    pure function shell_word(text) result(word)
        character(*), intent(in) :: text !! the text
        character(:), allocatable :: word
        character(*), parameter :: plain = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=,:+@%-'
        integer :: i
        word = text
        if (text /= '' .and. verify(text, plain) == 0) return
        word = ''''
        do i = 1, len(text)
            if (text(i:i) == '''') then
                word = word // '''\'''''
            else
                word = word // text(i:i)
            end if
        end do
        word = word // ''''
    end function shell_word

end module spintop_options
