#ifndef SPINTOP_MPI
!> Ranks in a build without MPI: there is one process only, and nothing to broadcast or receive.
submodule(spintop_ranks) ranks_alone
    implicit none

contains

    module procedure start_ranks
        ranks = ranks_t()
    end procedure start_ranks

    module procedure end_ranks
    end procedure end_ranks

    module procedure agree
    end procedure agree

    module procedure broadcast_numbers
    end procedure broadcast_numbers

    module procedure broadcast_text
    end procedure broadcast_text

    module procedure reduce
    end procedure reduce

    module procedure exchange
    end procedure exchange

    module procedure sign_off
    end procedure sign_off

    module procedure receive
        is_there = .false.
        rank = self%number
        number = 0
    end procedure receive

    module procedure answer
    end procedure answer

end submodule ranks_alone
#endif
