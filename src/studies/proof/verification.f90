!> Verifies a table: its input is computed again with balls, and each number that can be is certified.
!>
!> A number is *proved* if its distance from the true value is at most what the table claims, *wrong* if it is certainly
!> more, else *unproved*. The claim is the bound beside the number; with `output.certified` 3/4 of the last place; for
!> the exact solution what the data allow (`inherent_error`). Other numbers have no claim.
module spintop_verification
    use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t, make_case
    use spintop_certificate, only: balls_hint, balls_missing, has_balls, last_reason, proof_count, proof_names, &
        proof_of_omega1, proof_of_orientation, proof_of_theta, proof_reasons, proved, proof_of_phi, proof_of_psi, &
        proof_of_q3
    use spintop_kinds, only: dp, no_number, is_finite
    use spintop_conditioning, only: inherent_error
    use spintop_errors, only: error_t, input_error, exit_failed, exit_ok
    use spintop_files, only: read_file
    use spintop_job, only: job_t
    use spintop_loaded_table, only: read_table, table_t
    use spintop_principal_axes, only: find_principal_axes
    use spintop_planning, only: sample_time
    use spintop_problems, only: problems_t
    use spintop_row_proof, only: row_proof_t
    use spintop_status, only: is_good_end, status_number
    use spintop_sweep_axes, only: case_scene_t
    use spintop_table_head, only: first_line_of, read_shard_line, shard_t
    use spintop_text, only: string_t, to_text, append, escaped
    use spintop_uncertainties, only: data_radii, has_radii
    implicit none
    private
    public :: verify_table

    character, parameter :: nl = new_line('a')
    integer, parameter :: largest_table = 2**30 - 1
    !> Relative difference of numbers that were computed from the same input by other versions of the program.
    real(dp), parameter :: same = 4 * epsilon(1.0_dp)

    !> Numbers of a table that have true values, and what was found.
    type :: verification_t
        type(table_t) :: table
        !> Printed numbers and bounds (quantity, row); NaN where there is none.
        real(dp), allocatable :: printed(:, :), bounds(:, :)
        !> Names of the columns.
        character(32) :: names(proof_count) = ''
        logical :: has_number(proof_count) = .false., has_bound(proof_count) = .false.
        !> Whether it is the table of a sweep, or one of events, whose rows are not known before.
        logical :: is_sweep = .false., has_events = .false.
        integer(int64) :: proved = 0, unproved = 0, wrong = 0
        !> The first that is wrong, as text; not allocated if nothing is.
        character(:), allocatable :: first_wrong
        !> Unproved cells by reason, and without a claim.
        integer(int64) :: reasons(0:last_reason) = 0
        !> The largest bound of each quantity.
        real(dp) :: largest(proof_count) = 0
    contains
        procedure :: add_wrong
    end type verification_t

    !> A number may differ from the true one by so many times the inherent error, and by this.
    real(dp), parameter :: allowed = 10, rounding = 1.0e-14_dp
    !> The same of a sweep, whose cases are computed in blocks.
    real(dp), parameter :: block_rounding = 5.0e-13_dp
    !> Relative size of b - a or b + a below which rounding decides on which side of a pole the axis passes.
    real(dp), parameter :: decided = 1.0e-13_dp

contains

    !> Verifies the table of a job, which was prepared from its header. `code` tells whether there is a wrong number or,
    !> if `strict`, one that is not proved.
    subroutine verify_table(job, strict, lines, code, error)
        type(job_t), target, intent(inout) :: job !! the job of the table
        logical, intent(in) :: strict !! whether all numbers must be proved
        type(string_t), allocatable, intent(out) :: lines(:) !! the result as text
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(verification_t) :: found
        type(row_proof_t) :: proof
        real(dp), allocatable :: times(:)
        integer :: row, k

        code = exit_ok
        if (.not. has_balls()) then
            error = input_error(escaped(job%input%path) // ': ' // balls_missing // '; ' // balls_hint)
            return
        end if
        call read_table(job%input%path, found%table, error, takes_damaged=.true.)
        if (.not. allocated(error)) call read_numbers(job, found, error)
        if (allocated(error)) return
        call check_proof_cells(found, job%input%scene%certified)
        if (found%is_sweep) then
            call verify_sweep(job, found, error)
        else
            call found%table%read_column('t', times, error)
            if (.not. (allocated(error) .or. found%has_events)) call check_times(job, times, found, error)
            if (allocated(error)) return
            call proof%open([(any(is_finite(found%printed(k, :))), k=1, proof_count)], .false., job%case%given_body, &
                            job%case%given_start, data_radii(job%input%scene))
            do row = 1, size(times)
                call check_cells(found, row, .true.)
                call verify_row(job, job%case, times(row), row, proof, found)
            end do
            call proof%close()
        end if
        if (allocated(error)) return
        ! What was found is what the checksum says, or part of it.
        if (found%table%damage /= '' .and. found%wrong == 0) call found%add_wrong('the table ' // found%table%damage)
        if (found%wrong > 0 .or. (strict .and. found%unproved > 0)) code = exit_failed
        call append(lines, job%input%path // ': ' // to_text(found%proved) // ' numbers proved, ' // to_text(found%unproved) &
                      // ' unproved, ' // to_text(found%wrong) // ' wrong')
        if (.not. found%table%has_end) call append(lines, '  note  the table does not end with the number and the checksum of &
            &its rows: it was cut, or written by an earlier version')
        if (allocated(found%first_wrong)) call append(lines, '  first wrong  ' // found%first_wrong)
        do k = 0, last_reason
            if (found%reasons(k) == 0) cycle
            if (k == proved) call append(lines, '  unproved  ' // to_text(found%reasons(k)) // ': nothing is claimed of them, or &
                &they are at the limit of the claim')
            if (k /= proved) call append(lines, '  unproved  ' // to_text(found%reasons(k)) // ': ' // trim(proof_reasons(k)))
        end do
        do k = 1, proof_count
            if (found%largest(k) > 0) call append(lines, '  largest bound  ' // trim(found%names(k)) // ' ' &
                                                    // to_text(found%largest(k)))
        end do
    end subroutine verify_table

    !> The numbers that have true values, and their bounds.
    subroutine read_numbers(job, found, error)
        type(job_t), intent(in) :: job
        type(verification_t), intent(inout) :: found
        type(error_t), allocatable, intent(out) :: error
        integer :: k, rows

        found%is_sweep = job%input%scene%kind == 'sweep'
        found%has_events = size(found%table%words('event')) > 0
        rows = found%table%rows
        allocate (found%printed(proof_count, rows), found%bounds(proof_count, rows))
        found%printed = no_number
        found%bounds = no_number
        do k = 1, proof_count
            if (k == proof_of_orientation .or. (found%is_sweep .and. k >= proof_of_omega1)) cycle
            found%names(k) = proof_names(k)
            if (found%is_sweep) found%names(k) = trim(proof_names(k)) // '_end'
            call read_column(found%table, trim(found%names(k)), found%printed(k, :), found%has_number(k), error)
            if (.not. allocated(error)) call read_column(found%table, trim(found%names(k)) // '_bound', found%bounds(k, :), &
                                                         found%has_bound(k), error)
            if (allocated(error)) return
        end do
    end subroutine read_numbers

    !> The numbers of a column, if there is one.
    subroutine read_column(table, name, values, is_there, error)
        type(table_t), intent(in) :: table
        character(*), intent(in) :: name
        real(dp), intent(inout) :: values(:)
        logical, intent(out) :: is_there
        type(error_t), allocatable, intent(out) :: error
        real(dp), allocatable :: numbers(:)
        integer :: i
        is_there = any([(table%names(i)%text == name, i=1, size(table%names))])
        if (.not. is_there) return
        call table%read_column(name, numbers, error)
        if (.not. allocated(error)) values = numbers
    end subroutine read_column

    !> The rows of a sweep: each has a case of its own.
    subroutine verify_sweep(job, found, error)
        type(job_t), target, intent(in) :: job
        type(verification_t), intent(inout) :: found
        type(error_t), allocatable, intent(out) :: error
        type(case_scene_t), allocatable, target :: swept
        type(row_proof_t) :: proof
        type(problems_t) :: problems
        type(case_t) :: case
        type(string_t), allocatable :: status(:)
        real(dp), allocatable :: cases(:), ends(:)
        real(dp) :: values(size(job%axes%axis)), printed(size(found%printed, 2), size(job%axes%axis))
        logical :: is_there(size(job%axes%axis)), has_end
        integer :: row, i

        call found%table%read_column('case', cases, error)
        if (.not. (allocated(error) .or. found%has_events)) call check_cases(job, cases, found, error)
        if (allocated(error)) return
        allocate (ends(size(cases)), source=no_number)
        call read_column(found%table, 't_end', ends, has_end, error)
        printed = no_number
        do i = 1, size(values)
            if (allocated(error)) return
            call read_column(found%table, job%axes%axis(i)%name, printed(:, i), is_there(i), error)
        end do
        if (allocated(error)) return
        allocate (status, source=found%table%words('status'))
        allocate (swept)
        call swept%copy(job%input%scene, job%axes)
        do row = 1, size(cases)
            if (.not. (cases(row) >= 1 .and. cases(row) <= job%axes%cases)) then
                error = input_error(escaped(job%input%path) // ': case ' // to_text(cases(row)) // ' is not a case &
                                    &of its input')
                return
            end if
            values = job%axes%values_of(int(cases(row), int64))
            do i = 1, size(values)
                if (.not. is_there(i) .or. abs(printed(row, i) - values(i)) <= same * abs(values(i))) cycle
                call found%add_wrong('row ' // to_text(row) // ', ' // job%axes%axis(i)%name // ' = ' // &
                                     to_text(printed(row, i)) // ': the case has ' // to_text(values(i)))
            end do
            if (size(status) > 0) call check_cells(found, row, is_good_end(status_number(status(row)%text)))
            if (.not. any(is_finite(found%printed(:, row)))) cycle
            call swept%set_values(values)
            call make_case(swept%scene, case, problems)
            if (problems%any()) then
                error = input_error('a row with numbers belongs to a case that its input refuses: ' // problems%first())
                return
            end if
            if (.not. is_finite(ends(row))) ends(row) = case%t_end
            call proof%open(is_finite(found%printed(:, row)), .false., case%given_body, case%given_start, &
                            data_radii(job%input%scene))
            call verify_row(job, case, ends(row), row, proof, found)
        end do
        call proof%close()
    end subroutine verify_sweep

    !> Cells of a row that have to be numbers, and are none: bounds, numbers with a finite bound, and the attitude. phi and
    !> psi do not exist on a pole.
    subroutine check_cells(found, row, has_ended_well)
        type(verification_t), intent(inout) :: found
        integer, intent(in) :: row
        logical, intent(in) :: has_ended_well
        logical :: has_to_be
        integer :: k

        do k = 1, proof_count
            associate (printed => found%printed(k, row), bound => found%bounds(k, row), name => found%names(k))
                if (found%has_bound(k) .and. ieee_is_nan(bound) .and. is_finite(printed)) then
                    call found%add_wrong('row ' // to_text(row) // ', ' // trim(name) // '_bound is nan')
                end if
                has_to_be = has_ended_well .and. k <= proof_of_theta
                if (found%has_bound(k)) has_to_be = has_to_be .or. is_finite(bound)
                if (found%has_number(k) .and. has_to_be .and. .not. is_finite(printed)) then
                    call found%add_wrong('row ' // to_text(row) // ', ' // trim(name) // ' = ' // to_text(printed) // &
                                         ': not a finite number')
                end if
            end associate
        end do
    end subroutine check_cells

    !> The numbers of a row.
    subroutine verify_row(job, case, t, row, proof, found)
        type(job_t), intent(in) :: job
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: t
        integer, intent(in) :: row
        type(row_proof_t), intent(inout) :: proof
        type(verification_t), intent(inout) :: found
        real(dp) :: printed(proof_count), floor, claim, half_place
        integer :: k

        printed = found%printed(:, row)
        proof%wanted = is_finite(printed)
        call proof%prove(t, printed)
        floor = no_number
        if (job%plan%exact .and. .not. has_radii(job%input%scene)) floor = inherent_error(case%body, case%start, t)
        do k = 1, proof_count
            if (.not. proof%wanted(k)) cycle
            if (proof%reasons(k) == proved) found%largest(k) = max(found%largest(k), proof%bounds(k))
            half_place = spacing(max(abs(printed(k)), epsilon(1.0_dp))) / 2
            claim = found%bounds(k, row)
            if (.not. is_finite(claim)) then
                if (job%input%scene%certified) claim = 1.5_dp * half_place
                if (.not. job%input%scene%certified) claim = claim_of(k, case, printed, floor, found%is_sweep)
            end if
            if (proof%reasons(k) /= proved .or. .not. is_finite(claim)) then
                found%unproved = found%unproved + 1
                found%reasons(proof%reasons(k)) = found%reasons(proof%reasons(k)) + 1
            else if (proof%bounds(k) <= claim) then
                found%proved = found%proved + 1
            else if (proof%bounds(k) - half_place > claim) then
                ! A ball is at most half of the last place wide.
                call found%add_wrong('row ' // to_text(row) // ', ' // trim(found%names(k)) // ' = ' // to_text(printed(k)) &
                    // ': off by up to ' // to_text(proof%bounds(k)) // ', claimed ' // to_text(claim))
            else
                found%unproved = found%unproved + 1
                found%reasons(proved) = found%reasons(proved) + 1
            end if
        end do
    end subroutine verify_row

    !> Counts what is wrong, and keeps the first.
    subroutine add_wrong(self, what)
        class(verification_t), intent(inout) :: self
        character(*), intent(in) :: what !! what is wrong
        if (self%wrong == 0) self%first_wrong = what
        self%wrong = self%wrong + 1
    end subroutine add_wrong

    !> The rows of a trajectory: all of them, at their times. Of a motion that ended early only their order is known.
    subroutine check_times(job, times, found, error)
        type(job_t), intent(in) :: job !! the job of the table
        real(dp), intent(in) :: times(:) !! its column t
        type(verification_t), intent(inout) :: found !! what is wrong is added
        type(error_t), allocatable, intent(out) :: error !! the table cannot be read
        character(:), allocatable :: text
        logical :: is_whole
        integer :: row

        call read_file(job%input%path, largest_table, text, error, is_text=.true.)
        if (allocated(error)) return
        if (index(text, nl // '# status: ') == 0) call found%add_wrong('the table is cut short: it has no status')
        is_whole = index(text, nl // '# status: ok' // nl) > 0 .and. job%input%scene%stop_at == ''
        if (size(times) == 0 .or. (is_whole .and. size(times) /= job%plan%samples)) then
            call found%add_wrong(to_text(size(times)) // ' rows, where the input asks for ' // to_text(job%plan%samples))
        end if
        do row = 2, size(times)
            if (.not. times(row) > times(row - 1)) call found%add_wrong('row ' // to_text(row) // ', t = ' // to_text(times(row)) &
                                                                  // ': not after the row before')
        end do
        if (.not. is_whole .or. size(times) /= job%plan%samples) return
        do row = 1, size(times)
            if (abs(times(row) - sample_time(job%case%t_end, job%plan%samples, row)) <= 1.0e-12_dp * job%case%t_end) cycle
            call found%add_wrong('row ' // to_text(row) // ', t = ' // to_text(times(row)) // ': not a time of its input')
        end do
    end subroutine check_times

    !> The rows of a sweep, or of a part of it: one for each case, in order.
    subroutine check_cases(job, cases, found, error)
        type(job_t), intent(in) :: job !! the job of the table
        real(dp), intent(in) :: cases(:) !! its column case
        type(verification_t), intent(inout) :: found !! what is wrong is added
        type(error_t), allocatable, intent(out) :: error !! the table cannot be read
        type(shard_t) :: part
        character(:), allocatable :: text
        integer(int64) :: whole, first, expected
        logical :: is_part
        integer :: row

        call read_file(job%input%path, largest_table, text, error, is_text=.true.)
        if (allocated(error)) return
        call read_shard_line(first_line_of(text(:index(text, nl))), part, whole, is_part)
        if (.not. is_part) part = shard_t()
        first = part%first(job%axes%cases)
        expected = part%last(job%axes%cases) - first + 1
        if (size(cases) /= expected) call found%add_wrong(to_text(size(cases)) // ' rows, where the input has ' // &
                                                    to_text(expected) // ' cases')
        do row = 1, size(cases)
            if (abs(cases(row) - real(first + row - 1, dp)) <= 0) cycle
            call found%add_wrong('row ' // to_text(row) // ', case = ' // to_text(cases(row)) // ': not the case ' &
                           // to_text(first + row - 1))
        end do
    end subroutine check_cases

    !> The column `proof` of a table with bounds: `proved` where all bounds of the row are finite, `unproved` where one is
    !> infinite. What a case does not have has no bound. Certified numbers without a bound count, too: then a row may be
    !> unproved though its bounds are finite.
    subroutine check_proof_cells(found, certified)
        type(verification_t), intent(inout) :: found !! what is wrong is added
        logical, intent(in) :: certified !! whether proved numbers replace the computed ones
        type(string_t), allocatable :: words(:)
        real(dp), allocatable :: numbers(:), largest(:)
        character(:), allocatable :: name
        integer :: i, row

        allocate (words, source=found%table%words('proof'))
        allocate (largest(size(words)), source=-1.0_dp)
        do i = 1, size(found%table%names)
            name = found%table%names(i)%text
            if (len(name) <= len('_bound') .or. size(words) == 0) cycle
            if (name(len(name) - len('_bound') + 1:) /= '_bound') cycle
            numbers = found%table%column(name)
            where (numbers > largest) largest = numbers
        end do
        do row = 1, size(words)
            if (largest(row) < 0) cycle
            name = words(row)%text
            if (name == 'proved' .and. is_finite(largest(row))) cycle
            if (name == 'unproved' .and. (certified .or. .not. is_finite(largest(row)))) cycle
            call found%add_wrong('row ' // to_text(row) // ', proof = ' // name // ': its bounds say otherwise')
        end do
    end subroutine check_proof_cells

    !> The largest error that a printed quantity should have; NaN where nothing is claimed: of phi and psi
    !> where rounding of the data decides them.
    pure real(dp) function claim_of(quantity, case, printed, inherent, in_block) result(claim)
        integer, intent(in) :: quantity !! number of the quantity (spintop_certificate)
        type(case_t), intent(in) :: case !! body and start
        real(dp), intent(in) :: printed(proof_count) !! the printed quantities, NaN for others
        real(dp), intent(in) :: inherent !! the inherent error of the attitude, rad; NaN if unknown
        logical, intent(in) :: in_block !! whether it is the number of a sweep
        real(dp) :: attitude, least, moments(3), axes(4)

        claim = no_number
        attitude = allowed * inherent + rounding
        if (in_block) then
            attitude = allowed * inherent + block_rounding * max(1.0_dp, abs(printed(proof_of_phi)) + abs(printed(proof_of_psi)))
            if (.not. is_finite(attitude)) return ! both angles are needed
        end if
        if (quantity <= proof_of_q3) claim = attitude
        if (quantity >= proof_of_omega1) then
            ! Times at least the angular velocity of the motion, in body axes and in those of the momentum.
            associate (body => case%given_body, omega => case%given_start%omega)
                call find_principal_axes(body%inertia, body%products, moments, axes)
                claim = sqrt((dot_product(omega, body%momentum(omega)) &
                              + 4 * abs(body%mass * body%gravity) * norm2(body%centre_of_mass)) / minval(moments))
                if (allocated(body%effects)) claim = claim + norm2(body%effects%rotor_momentum) / minval(moments)
            end associate
            claim = attitude * claim
        end if
        if (quantity == proof_of_theta) claim = attitude + spacing(printed(proof_of_theta))
        if (quantity /= proof_of_phi .and. quantity /= proof_of_psi) return
        least = min(sin(printed(proof_of_theta) / 2), cos(printed(proof_of_theta) / 2))
        if (.not. is_finite(least)) return
        if (attitude < 0.1_dp * least .and. is_decided(case)) claim = 2 * attitude / least + spacing(printed(quantity))
    end function claim_of

    !> Whether the data say on which side the axis passes each pole: phi turns by nearly pi there, one way or the other,
    !> as the signs of b - a and b + a are.
    pure logical function is_decided(case)
        type(case_t), intent(in) :: case
        real(dp) :: u, a, turn, ratio, rotor
        associate (body => case%given_body, start => case%given_start)
            u = cos(start%angle(2))
            ratio = body%inertia(3) / body%inertia(1)
            rotor = 0
            if (allocated(body%effects)) rotor = body%effects%rotor_momentum(3) / body%inertia(1)
            a = ratio * start%omega(3) + rotor
            turn = start%rate(1)
            is_decided = min(abs((1 + u) * turn - a), abs((1 - u) * turn + a)) &
                         > decided * (abs(start%rate(3)) * ratio + abs(turn) + abs(rotor))
        end associate
    end function is_decided

end module spintop_verification
