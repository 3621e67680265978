!> A stand-in for pFUnit's module of this name, where pFUnit is not installed: the part that
!! scripts/pf2f90.py lets through, with the same meaning. Where pFUnit accepts a comparison and this
!! does not, the test fails to compile or fails; never the other way round.
module funit
    use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
    use, intrinsic :: iso_fortran_env, only: int64, output_unit, real64
    use funit_boxes, only: box_t, boxed, element
    implicit none
    private
    public :: assertOne, assertTwo, assertFail
    public :: SourceLocation, anyExceptions, boxed
    public :: begin_suite, run_test, end_suite

    !> Where an assert stands.
    type :: SourceLocation
        character(64) :: file
        integer :: line
    end type SourceLocation

    abstract interface
        subroutine test_procedure()
        end subroutine test_procedure
    end interface

    ! the suite that is running (a program runs one), and its running test
    character(64) :: suite_name, test_name
    integer :: passed, failed
    logical :: test_failed, is_verbose

contains

    !> Start counting. As in pFUnit, -d makes the program say which test begins, fails and ends.
    subroutine begin_suite(name)
        character(*), intent(in) :: name
        character(2) :: option
        call get_command_argument(1, option)
        is_verbose = option == '-d'
        suite_name = name
        passed = 0
        failed = 0
    end subroutine begin_suite

    !> Run one test. As in pFUnit, nothing more is called when `before` fails.
    subroutine run_test(name, test, before)
        character(*), intent(in) :: name
        procedure(test_procedure) :: test
        procedure(test_procedure), optional :: before
        test_name = name
        test_failed = .false.
        call tell('Start:')
        if (present(before)) call before()
        if (.not. test_failed) call test()
        if (test_failed) then
            failed = failed + 1
            call tell('Failure in')
        else
            passed = passed + 1
        end if
        call tell('  end:')
    end subroutine run_test

    !> Say what happens to the running test.
    subroutine tell(event)
        character(*), intent(in) :: event
        if (is_verbose) write (output_unit, '(1x, 4a)') event, ' <', trim(test_name), '>'
        flush (output_unit)
    end subroutine tell

    !> Report the counts on a line that scripts/test reads; any failure gives the exit code 1.
    subroutine end_suite()
        write (output_unit, '(2a, i0, a, i0, a)') &
            trim(suite_name), ': ', passed, ' passed, ', failed, ' failed'
        flush (output_unit)
        if (failed > 0) stop 1
    end subroutine end_suite

    !> Has the running test failed? Then it is over.
    function anyExceptions() result(any_failed)
        logical :: any_failed
        any_failed = test_failed
    end function anyExceptions

    subroutine assertFail(message, location)
        character(*), intent(in) :: message
        type(SourceLocation), intent(in) :: location
        call require(.false., 'called to fail', location, message)
    end subroutine assertFail

    !> Require what an assert of one value is named for.
    subroutine assertOne(name, value, message, location)
        character(*), intent(in) :: name
        type(box_t), intent(in) :: value
        character(*), intent(in), optional :: message
        type(SourceLocation), intent(in) :: location
        if ((name == 'IsNaN' .or. name == 'IsFinite') .neqv. allocated(value%reals)) then
            call require(.false., 'pFUnit has no such assert of ' // trim(value%type_name), location, message)
            return
        end if
        select case (name)
        case ('True', 'All')
            call require(all(value%truths), 'not true', location, message)
        case ('False')
            call require(.not. any(value%truths), 'not false', location, message)
        case ('Any')
            call require(any(value%truths), 'none is true', location, message)
        case ('IsNaN')
            call require(all(ieee_is_nan(value%reals)), element(value, 1) // ' is not NaN', location, message)
        case default
            call require(all(ieee_is_finite(value%reals)), element(value, 1) // ' is not finite', location, message)
        end select
    end subroutine assertOne

    !> Require `left relation right` of every element. `left` may be a scalar beside an array.
    subroutine assertTwo(relation, left, right, tolerance, message, location)
        type(box_t), intent(in) :: left, right
        character(*), intent(in) :: relation
        type(SourceLocation), intent(in) :: location
        real(real64), intent(in), optional :: tolerance
        character(*), intent(in), optional :: message
        character(:), allocatable :: what
        character(32) :: buffer
        integer :: i, j, step
        logical :: holds
        if (.not. comparable(left, relation, right, present(tolerance))) then
            what = trim(left%type_name) // ' ' // relation // ' ' // trim(right%type_name)
            call require(.false., 'pFUnit does not compare ' // what // ' so', location, message)
            return
        end if
        if (size(left%extents) > 0 .and. .not. same_shape(left%extents, right%extents)) then
            call require(.false., 'the shapes differ', location, message)
            return
        end if
        step = merge(1, 0, size(left%extents) > 0)
        do i = 1, product(right%extents)
            j = 1 + step * (i - 1)
            if (allocated(left%texts)) then
                holds = left%texts(j)%trimmed == right%texts(i)%trimmed
            else if (allocated(left%truths)) then
                holds = (left%truths(j) .eqv. right%truths(i)) .eqv. relation == '=='
            else if (allocated(right%reals) .and. allocated(left%reals)) then
                holds = real_holds(left%reals(j), relation, right%reals(i), tolerance)
            else if (allocated(right%reals)) then
                holds = real_holds(real(left%integers(j), real64), relation, right%reals(i), &
                    tolerance)
            else
                holds = integer_holds(left%integers(j), relation, right%integers(i))
            end if
            if (holds) cycle
            what = 'not ' // element(left, j) // ' ' // relation // ' ' // element(right, i)
            if (size(right%extents) > 0) then
                write (buffer, '(a, i0)') ' in element ', i
                what = what // trim(buffer)
            end if
            if (present(tolerance)) what = what // ', tolerance ' // element(boxed(tolerance), 1)
            call require(.false., what, location, message)
            return
        end do
    end subroutine assertTwo

    !> Does pFUnit have an assert for these types?
    pure function comparable(left, relation, right, has_tolerance) result(yes)
        type(box_t), intent(in) :: left, right
        character(*), intent(in) :: relation
        logical, intent(in) :: has_tolerance
        logical :: yes
        yes = left%type_name == right%type_name .or. (left%type_name == 'integer' &
            .and. (right%type_name == 'integer(int64)' .or. right%type_name == 'real'))
        if (.not. allocated(right%reals)) yes = yes .and. .not. has_tolerance
        select case (right%type_name)
        case ('text')
            yes = yes .and. relation == '==' .and. size(right%extents) <= 1
        case ('logical')
            yes = yes .and. (relation == '==' .or. relation == '/=')
        case default  ! numbers know every relation
            continue
        end select
    end function comparable

    pure function same_shape(left, right) result(same)
        integer, intent(in) :: left(:), right(:)
        logical :: same
        same = size(left) == size(right)
        if (same) same = all(left == right)
    end function same_shape

    !> Does `left relation right` hold for reals? Never when one is NaN.
    pure function real_holds(left, relation, right, tolerance) result(holds)
        real(real64), intent(in) :: left, right
        character(*), intent(in) :: relation
        real(real64), intent(in), optional :: tolerance
        logical :: holds
        real(real64) :: slack
        slack = 0
        if (present(tolerance)) slack = tolerance
        select case (relation)
        case ('==')  ! exact equality first: the difference of two infinities is NaN
            holds = (left <= right .and. left >= right) .or. abs(left - right) <= slack
        case ('/=')
            holds = abs(left - right) > slack
        case ('<')
            holds = left < right + slack
        case ('<=')
            holds = left <= right + slack
        case ('>')
            holds = left > right - slack
        case ('>=')
            holds = left >= right - slack
        case default  ! relatively equal, which pFUnit refuses beside an expected zero
            holds = abs(left) > 0 .and. abs(left - right) <= slack * abs(left)
        end select
    end function real_holds

    !> Does `left relation right` hold for integers?
    pure function integer_holds(left, relation, right) result(holds)
        integer(int64), intent(in) :: left, right
        character(*), intent(in) :: relation
        logical :: holds
        select case (relation)
        case ('==')
            holds = left == right
        case ('/=')
            holds = left /= right
        case ('<')
            holds = left < right
        case ('<=')
            holds = left <= right
        case ('>')
            holds = left > right
        case default
            holds = left >= right
        end select
    end function integer_holds

    !> Fail the running test, with the place and the message, unless a condition holds.
    subroutine require(condition, what, location, message)
        logical, intent(in) :: condition
        character(*), intent(in) :: what
        type(SourceLocation), intent(in) :: location
        character(*), intent(in), optional :: message
        if (condition) return
        test_failed = .true.
        write (output_unit, '(5a, i0, 2a)', advance='no') &
            '  FAILED ', trim(test_name), ' (', trim(location%file), ':', location%line, '): ', what
        if (present(message)) write (output_unit, '(2a)', advance='no') ' | ', message
        write (output_unit, '()')
    end subroutine require

end module funit
