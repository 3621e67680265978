!> Reference motions of bodies of any kind: body, start and rows of test/reference/NAME.csv; and how far a method is off.
module reference_motions
    use mechanics
    implicit none
    private
    public :: reference_motion_t, read_reference_motion, worst_of, chaotic_body

    real(dp), parameter :: no_angles(3) = 0

    !> A reference motion; `floors` is how far rounding of the data turns the attitude in each row, rad.
    type, extends(known_rows_t) :: reference_motion_t
        type(body_t) :: body
        type(motion_t) :: start
        real(dp), allocatable :: floors(:)
    end type reference_motion_t

contains

    !> A body whose motion is chaotic, unless it is damped.
    pure type(body_t) function chaotic_body(damping) result(body)
        real(dp), intent(in), optional :: damping(3)
        body = unit_body([1.0_dp, 1.5_dp, 2.25_dp], [1.0_dp, 0.5_dp, 2.0_dp])
        if (present(damping)) body%damping = damping
    end function chaotic_body

    subroutine read_reference_motion(name, known)
        character(*), intent(in) :: name
        type(reference_motion_t), intent(out) :: known
        real(dp) :: q(4), omega(3)
        call read_reference(name, known%known_rows_t)
        q = [0.8_dp, 0.6_dp, 0.0_dp, 0.0_dp]
        omega = [0.5_dp, 0.5_dp, 1.0_dp]
        select case (name)
        case ('k_chaotic')
            known%body = chaotic_body()
            known%floors = [7.97e-17_dp, 1.02e-16_dp, 2.24e-16_dp, 3.51e-16_dp, 1.02e-15_dp, 2.11e-15_dp, 1.57e-15_dp, &
                            2.90e-15_dp, 1.12e-14_dp, 8.35e-15_dp, 8.38e-15_dp, 2.69e-14_dp, 3.62e-13_dp, 8.27e-13_dp]
        case ('k_kovalevskaya')
            known%body = unit_body([2.0_dp, 2.0_dp, 1.0_dp], [1.0_dp, 0.0_dp, 0.0_dp])
            q = [0.7704694597489228848773808922812746_dp, 0.5778520948116921636580356692109560_dp, &
                 0.2407717061715384015241815288378983_dp, -0.1203858530857692007620907644189492_dp]
            omega(2) = 0.25_dp
            known%floors = [4.57e-17_dp, 4.64e-17_dp, 5.94e-17_dp, 1.03e-16_dp, 2.06e-16_dp, 4.07e-16_dp, 8.79e-16_dp, 1.82e-15_dp]
        case ('k_poinsot_dzhanibekov')
            known%body = unit_body([1.0_dp, 2.0_dp, 3.0_dp], no_angles)
            q = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
            omega = [1.0e-3_dp, 1.0_dp, 1.0e-3_dp]
            known%floors = [5.45e-20_dp, 5.12e-20_dp, 5.74e-20_dp, 2.39e-19_dp, 4.20e-18_dp, 3.78e-18_dp, 2.74e-18_dp, 1.01e-16_dp]
        case ('damped_symmetric')
            known%body = unit_body([0.875_dp, 0.875_dp, 0.25_dp], [0.0_dp, 0.0_dp, 8.5_dp])
            known%body%damping = [0.0625_dp, 0.0625_dp, 0.015625_dp]
            q = [0.96_dp, 0.28_dp, 0.0_dp, 0.0_dp]
            omega = [0.5_dp, -0.25_dp, 30.0_dp]
        case ('damped_asymmetric')
            known%body = chaotic_body([0.0625_dp, 0.125_dp, 0.03125_dp])
            omega(3) = 6
        end select
        if (.not. allocated(known%floors)) known%floors = known%column('floor')
        known%start = motion_from_quaternion(0.0_dp, q, omega, no_angles)
    end subroutine read_reference_motion

    !> The largest error of a method over a bound for each row: of the attitude, of the vertical in the body, and of the
    !> momentum, which may be eightfold. Huge where the method fails.
    real(dp) function worst_of(known, method, tolerance, bounds) result(worst)
        type(reference_motion_t), intent(in) :: known
        character(*), intent(in) :: method
        real(dp), intent(in) :: tolerance, bounds(:)
        type(recorder_t) :: seen
        real(dp) :: row(11), shares(7)
        integer :: i
        worst = huge(worst)
        if (observe_motion(method, known%body, known%start, known%column('t'), tolerance, seen) /= status_ok) return
        if (seen%count /= known%rows .or. size(bounds) /= known%rows) return
        worst = 0
        do i = 1, known%rows
            row = known%values(i, :11)
            associate (motion => seen%motions(i))
                shares = [rotation_angle(row(8:11), motion%quaternion), row(2:4) / 8 - known%body%inertia * motion%omega / 8, &
                          row(5:7) - vertical_from_quaternion(motion%quaternion)] / bounds(i)
            end associate
            if (.not. all(abs(shares) < huge(worst))) shares = huge(worst)
            worst = max(worst, maxval(abs(shares)))
        end do
    end function worst_of

end module reference_motions
