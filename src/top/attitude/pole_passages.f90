!> Passages of body z through a pole, and what phi and psi do there.
!>
!> Where body z passes through a pole, phi and psi jump by half a turn, and nobody can tell which way: a way that misses
!> the pole on one side has phi + pi behind it, on the other side phi - pi. The convention (manual, theory, "At a pole"):
!> phi gains half a turn where a pole is passed for the first time, loses it where it is passed for the second time, and
!> so on, for each pole by itself; phi + psi at the upper pole and phi - psi at the lower one go on continuously. So angles
!> of a plane motion neither precess nor depend on rounding errors, on the method or on the azimuth of the start.
!>
!> All ways of following the angles decide passages here: the counter of turns, and lanes. The closed form of a top counts its
!> passages (`symmetric_attitude`).
module spintop_pole_passages
    use spintop_attitude, only: angles_from_quaternion, nearest_turn, to_space
    use spintop_kinds, only: dp, pi, cross
    use spintop_motion, only: motion_t, passages_t
    implicit none
    private
    public :: way_t, half_turns, in_pole, pass_pole, settle_passage, through_pole

    !> A pole that is passed at a smaller distance is passed through, rad: beyond the rounding errors of long motions.
    real(dp), parameter :: through_pole = 2.0_dp**(-35)
    !> A place is in a pole, where its azimuth tells nothing, if it is no farther from the nearest point of its way than
    !> so many times the distance at which the way misses the pole, or up to which all ways pass through it.
    real(dp), parameter :: in_pole = 10
    !> A way is straight if it turns by no more than this, rad, within the distance that is in a pole.
    real(dp), parameter :: straight = 0.1_dp
    !> Ways are looked at up to this distance, and over rotations up to this one, rad.
    real(dp), parameter :: nearby = 0.5_dp, largest_turn = 1.0_dp

    !> Body z in the horizontal plane: its place sin(theta) exp(i phi), its velocity, rad/s, and acceleration, rad/s^2; and
    !> whether it is nearer to the upper pole.
    type :: way_t
        complex(dp) :: place = 0, velocity = 0, acceleration = 0
        logical :: is_up = .true.
    end type way_t

contains

    !> Half turns that passages added so far to phi and to psi.
    pure function half_turns(passed) result(added)
        type(passages_t), intent(in) :: passed !! the passages
        integer :: added(2), up, down
        up = merge(1, 0, passed%odd(1))
        down = merge(1, 0, passed%odd(2))
        added = [down + up, down - up]
    end function half_turns

    !> The way of body z at an instant of a motion, whose acceleration is given.
    pure type(way_t) function way_of(motion) result(way)
        type(motion_t), intent(in) :: motion !! the motion
        real(dp), parameter :: body_z(3) = [0, 0, 1]
        real(dp) :: e(3), v(3)
        e = to_space(motion%quaternion, body_z)
        way%place = cmplx(-e(2), e(1), dp)
        way%is_up = e(3) > 0
        v = cross(motion%omega, body_z)
        e = to_space(motion%quaternion, v)
        way%velocity = cmplx(-e(2), e(1), dp)
        e = to_space(motion%quaternion, cross(motion%omega, v) + cross(motion%omega_rate, body_z))
        way%acceleration = cmplx(-e(2), e(1), dp)
    end function way_of

    !> Continues phi over a time in which body z may pass through a pole. Undecided are ways that are not nearly straight,
    !> or miss the pole by more than the reach: they go round the pole, on a certain side.
    pure subroutine settle_passage(here, there, time, reach, passed, phi, is_decided)
        type(way_t), intent(in) :: here, there !! the ways at both ends of the time
        real(dp), intent(in) :: time, reach !! the time, s; the distance up to which the pole is passed through, rad
        type(passages_t), intent(inout) :: passed !! the passages before it on entry, after it on return
        real(dp), intent(inout) :: phi !! phi before it on entry, after it on return, rad
        logical, intent(out) :: is_decided !! whether phi was continued
        complex(dp) :: along, from, to
        real(dp) :: length, miss, bow, within, azimuth
        logical :: leaves, arrives
        integer :: pole

        is_decided = .false.
        if (here%is_up .neqv. there%is_up) return
        if (.not. max(abs(here%place), abs(there%place)) <= nearby) return
        length = abs(there%place - here%place)
        if (.not. length > 0) return
        along = (there%place - here%place) / length
        if (.not. min(real(conjg(along) * here%velocity) * time, real(conjg(along) * there%velocity) * time) > 0) return
        from = conjg(along) * here%place
        to = conjg(along) * there%place
        miss = max(abs(aimag(from)), abs(aimag(to)))
        bow = time**2 / 8 * max(abs(aimag(conjg(along) * here%acceleration)), abs(aimag(conjg(along) * there%acceleration)))
        if (.not. miss + bow <= reach) return
        within = in_pole * max(miss + bow, through_pole)
        leaves = abs(real(from)) <= within
        arrives = abs(real(to)) <= within
        if (leaves .or. arrives) then
            if (.not. is_straight(there, within)) return
        end if
        is_decided = .true.
        if (arrives) then
            ! phi stays as it was. A motion that begins in a pole does not pass it.
            passed%arrived = passed%arrived .or. .not. leaves
            return
        end if
        azimuth = atan2(aimag(there%place), real(there%place))
        if (abs(nearest_turn(azimuth, phi) - phi) > pi / 2 .and. (passed%arrived .or. .not. leaves)) then
            pole = merge(1, 2, there%is_up)
            phi = phi + merge(-pi, pi, passed%odd(pole))
            passed%odd(pole) = .not. passed%odd(pole)
        end if
        phi = nearest_turn(azimuth, phi)
        passed%arrived = .false.
    end subroutine settle_passage

    !> Whether a way is nearly straight over a distance, rad.
    pure logical function is_straight(way, distance)
        type(way_t), intent(in) :: way
        real(dp), intent(in) :: distance
        is_straight = abs(aimag(conjg(way%velocity) * way%acceleration)) * distance <= straight * abs(way%velocity)**3
    end function is_straight

    !> Continues phi and psi between two instants of a motion, whose accelerations are given, if body z passes through a pole
    !> between them, or is in one.
    pure subroutine pass_pole(last, next, reach, passed, angle, is_decided)
        type(motion_t), intent(in) :: last, next !! the instants
        real(dp), intent(in) :: reach !! the distance up to which the pole is passed through, rad
        type(passages_t), intent(inout) :: passed !! the passages before the first on entry, before the second on return
        real(dp), intent(inout) :: angle(3) !! phi, theta, psi at the first on entry; at the second if decided, rad
        logical, intent(out) :: is_decided !! whether the angles were continued
        real(dp) :: phi, near(3), side
        type(way_t) :: way
        is_decided = .false.
        if (.not. abs(next%t - last%t) * max(norm2(last%omega), norm2(next%omega)) <= largest_turn) return
        way = way_of(next)
        phi = angle(1)
        call settle_passage(way_of(last), way, next%t - last%t, reach, passed, phi, is_decided)
        if (.not. is_decided) return
        ! phi + psi, or phi - psi, is continuous.
        side = merge(1.0_dp, -1.0_dp, way%is_up)
        near = angles_from_quaternion(next%quaternion, [phi, angle(2), angle(3) - side * (phi - angle(1))])
        ! In the pole phi stays, and the attitude tells the sum alone. What it seems to tell of phi are rounding errors: half a
        ! turn of them may as well be a turn of the sum.
        if (passed%arrived) near = [phi, near(2), nearest_turn(near(3) + side * (near(1) - phi), angle(3))]
        angle = near
    end subroutine pass_pole

end module spintop_pole_passages
