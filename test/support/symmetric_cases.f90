!> Reads the tables in test/reference, and reference motions of symmetric tops: body, start and rows of NAME.csv.
module symmetric_cases
    use tested
    use spintop_loaded_table, only: read_table, table_t
    implicit none
    private
    public :: symmetric_case_t, read_symmetric_case, case_names, exact_of, nutation_of, random_top, known_rows_t, read_reference

    !> All the reference cases: to 30 digits, by elliptic functions and by Taylor series.
    character(*), parameter :: case_names(*) = [character(24) :: 'a1_slow_top', &
        'a1b_slow_top_l1', 'a2_wheel_corrected_lam1', 'a2_wheel_corrected_lam10', &
        'a2_wheel_paper_lam0.5', 'a2_wheel_paper_lam1', 'a2_wheel_paper_lam2', &
        'b_exact_pole_0', 'b_gimbal_0_1e-3', 'b_gimbal_0_1e-6', 'b_gimbal_pi_1e-6', &
        'c_homoclinic_out', 'c_sleep_stable_th1e-6', 'c_sleep_th1e-3', &
        'd_fast_corrected_lam100', 'e_near_regular', 'e_regular_fast_60deg', &
        'e_regular_slow_60deg', 'f_cusp', 'f_loop', 'g_plane_libration', 'g_spherical', &
        'h_slow_top_long', 'i_oblate', 'i_rod', 'j_regular_fast_120deg']

    !> A table of numbers: values(row, column).
    type, extends(table_t) :: known_rows_t
        real(dp), allocatable :: values(:, :)
    end type known_rows_t

    !> A reference motion. Quantities that a case does not have are huge.
    type :: symmetric_case_t
        type(body_t) :: body
        type(motion_t) :: start
        real(dp) :: period = huge(1.0_dp), precession = huge(1.0_dp), spin = huge(1.0_dp)
        type(known_rows_t) :: table
    contains
        procedure :: row
        procedure :: floor_of
    end type symmetric_case_t

contains

    !> Reads test/reference/NAME.csv; the tests run in the root of the checkout.
    subroutine read_reference(name, table)
        character(*), intent(in) :: name
        type(known_rows_t), intent(out) :: table
        type(error_t), allocatable :: error
        integer :: k
        call read_table('test/reference/' // name // '.csv', table%table_t, error)
        if (allocated(error)) error stop 'symmetric_cases: no such table'
        allocate (table%values(table%rows, size(table%names)))
        do k = 1, size(table%names)
            table%values(:, k) = table%column(table%names(k)%text)
        end do
    end subroutine read_reference

    !> Reads a case, whose numbers stand in the head of its table.
    subroutine read_symmetric_case(name, known)
        character(*), intent(in) :: name
        type(symmetric_case_t), intent(out) :: known
        character(*), parameter :: keys(*) = [character(24) :: 'I1', 'I3', 'm', 'g', 'l', 'theta', 'phidot', 'thetadot', &
            'psidot', 'nutation_period', 'precession_per_nutation', 'spin_per_nutation']
        real(dp) :: v(size(keys))
        integer :: k, first, length
        call read_reference(trim(name), known%table)
        v(:9) = 0
        v(10:) = huge(v)
        associate (text => known%table%text)
            do k = 1, size(keys)
                first = index(text, '# ' // trim(keys(k)) // ' = ') + len_trim(keys(k)) + 5
                if (first == len_trim(keys(k)) + 5) cycle
                length = index(text(first:), new_line(text)) - 1
                read (text(first:first + length - 1), *) v(k)
            end do
        end associate
        known%body = body_t(mass=v(3), inertia=v([1, 1, 2]), centre_of_mass=[0.0_dp, 0.0_dp, v(5)], gravity=v(4))
        known%start = motion_from_angles(0.0_dp, [0.0_dp, v(6), 0.0_dp], v(7:9))
        known%period = v(10)
        known%precession = v(11)
        known%spin = v(12)
    end subroutine read_symmetric_case

    !> The exact motion of a body, with a rotor on its axis or not, where it must exist.
    type(exact_motion_t) function exact_of(body, start, rotor) result(exact)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in), optional :: rotor
        integer :: status
        if (present(rotor)) then
            call prepare_exact_motion(body, start, exact, status, [0.0_dp, 0.0_dp, rotor])
        else
            call prepare_exact_motion(body, start, exact, status)
        end if
        if (.not. is_ok(status)) error stop 'symmetric_cases: there is no exact motion'
    end function exact_of

    !> The nutation of a body, where it must exist.
    type(nutation_t) function nutation_of(body, start) result(nutation)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        integer :: status
        call find_nutation(body, start, nutation, status)
        if (.not. is_ok(status)) error stop 'symmetric_cases: there is no nutation'
    end function nutation_of

    !> Body, start, and the time and attitude known of the top in a row of test/reference/random_tops.csv: time, quaternion,
    !> omega1, omega2.
    subroutine random_top(table, i, body, start, known)
        type(known_rows_t), intent(in) :: table
        integer, intent(in) :: i
        type(body_t), intent(out) :: body
        type(motion_t), intent(out) :: start
        real(dp), intent(out), optional :: known(7)
        real(dp) :: v(16)
        v = table%values(i, :)
        body = body_t(mass=v(3), inertia=v([1, 1, 2]), centre_of_mass=[0.0_dp, 0.0_dp, v(5)], gravity=v(4))
        start = motion_from_angles(0.0_dp, [0.3_dp, v(6), -0.9_dp], v(7:9))
        if (present(known)) known = v(10:16)
    end subroutine random_top

    !> The motion of a row; accelerations are left zero.
    type(motion_t) function row(self, i)
        class(symmetric_case_t), intent(in) :: self
        integer, intent(in) :: i
        associate (v => self%table%values(i, :))
            row%t = v(1)
            row%angle = v([3, 2, 4])
            row%rate = v([6, 5, 7])
            row%omega = v(8:10)
            row%quaternion = v(14:17)
        end associate
    end function row

    !> How far rounding of the data turns the attitude in a row, rad.
    real(dp) function floor_of(self, i)
        class(symmetric_case_t), intent(in) :: self
        integer, intent(in) :: i
        floor_of = self%table%values(i, size(self%table%values, 2))
    end function floor_of

end module symmetric_cases
