!> Errors and warnings of a scene, with the names of the parameters concerned instead of places in a file.
module spintop_problems
    use spintop_diagnostics, only: diagnostics_t
    use spintop_parameters, only: parameter_table_t
    implicit none
    private
    public :: problems_t

    type :: problem_t
        !> The parameter (or group) concerned.
        character(:), allocatable :: name
        character(:), allocatable :: message
        character(:), allocatable :: hint
        logical :: is_error = .true.
        !> It follows from no other problem of the input.
        logical :: is_certain = .false.
    end type problem_t

    !> Problems in the order in which they were found.
    type :: problems_t
        private
        type(problem_t), allocatable :: list(:)
    contains
        procedure :: add
        procedure :: warn
        procedure :: any => has_errors
        procedure :: any_warning
        procedure :: first
        procedure :: report_to
        procedure :: add_all
        procedure :: add_warnings
    end type problems_t

contains

    !> Adds an error: the parameter concerned, what is wrong, what is expected.
    subroutine add(self, name, message, hint, is_certain)
        class(problems_t), intent(inout) :: self
        character(*), intent(in) :: name, message, hint !! parameter or group concerned; what is wrong; what is expected
        logical, intent(in), optional :: is_certain !! whether it is one whatever the rest of the input is (default: no)
        type(problem_t) :: problem
        problem = problem_t(name, message, hint, .true.)
        if (present(is_certain)) problem%is_certain = is_certain
        call append(self, problem)
    end subroutine add

    !> Adds a warning.
    subroutine warn(self, name, message, hint)
        class(problems_t), intent(inout) :: self
        character(*), intent(in) :: name, message, hint !! parameter or group concerned; what is wrong; what is expected
        call append(self, problem_t(name, message, hint, .false.))
    end subroutine warn

    subroutine append(self, problem)
        class(problems_t), intent(inout) :: self
        type(problem_t), intent(in) :: problem
        type(problem_t), allocatable :: longer(:)
        integer :: n
        n = 0
        if (allocated(self%list)) n = size(self%list)
        allocate (longer(n + 1))
        if (n > 0) longer(:n) = self%list
        longer(n + 1) = problem
        call move_alloc(longer, self%list)
    end subroutine append

    !> Whether there is an error among them.
    pure logical function has_errors(self)
        class(problems_t), intent(in) :: self
        has_errors = .false.
        if (allocated(self%list)) has_errors = any(self%list%is_error)
    end function has_errors

    !> Whether there is a warning among them.
    pure logical function any_warning(self)
        class(problems_t), intent(in) :: self
        any_warning = .false.
        if (allocated(self%list)) any_warning = .not. all(self%list%is_error)
    end function any_warning

    !> Adds other problems.
    subroutine add_all(self, other, before)
        class(problems_t), intent(inout) :: self
        class(problems_t), intent(in) :: other !! they are added
        character(*), intent(in), optional :: before !! prefix of each message
        type(problem_t) :: problem
        integer :: i
        if (.not. allocated(other%list)) return
        do i = 1, size(other%list)
            problem = other%list(i)
            if (present(before)) problem%message = before // problem%message
            call append(self, problem)
        end do
    end subroutine add_all

    !> Adds the warnings among other problems, with a prefix and a suffix for each message.
    subroutine add_warnings(self, other, before, after)
        class(problems_t), intent(inout) :: self
        class(problems_t), intent(in) :: other !! their warnings are added
        character(*), intent(in) :: before, after !! prefix and suffix of each message
        integer :: i
        if (.not. allocated(other%list)) return
        do i = 1, size(other%list)
            if (other%list(i)%is_error) cycle
            call self%warn(other%list(i)%name, before // other%list(i)%message // after, other%list(i)%hint)
        end do
    end subroutine add_warnings

    !> The first error in one line, for a table; empty if there is none.
    pure function first(self) result(text)
        class(problems_t), intent(in) :: self
        character(:), allocatable :: text
        integer :: i
        text = ''
        if (.not. allocated(self%list)) return
        do i = size(self%list), 1, -1
            if (self%list(i)%is_error) text = self%list(i)%name // ': ' // self%list(i)%message
        end do
    end function first

    !> Shows the problems at the places where the input gave their parameters. If the input could not be read
    !> completely, those that may follow from that are omitted.
    subroutine report_to(self, table, diagnostics)
        class(problems_t), intent(in) :: self
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        logical :: is_read
        integer :: i
        if (.not. allocated(self%list)) return
        is_read = .not. diagnostics%has_errors()
        do i = 1, size(self%list)
            associate (problem => self%list(i))
                if (.not. (is_read .or. problem%is_certain)) cycle
                if (problem%is_error) then
                    call diagnostics%error(table%place_of(problem%name), problem%message, problem%hint)
                else
                    call diagnostics%warning(table%place_of(problem%name), problem%message, problem%hint)
                end if
            end associate
        end do
    end subroutine report_to

end module spintop_problems
