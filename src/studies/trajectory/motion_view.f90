!> A motion as the columns of a trajectory see it: in the axes in which the body was given, beside the
!> start and the exact motion. What several columns need is computed once per motion, when one of them asks.
module spintop_motion_view
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_certificate, only: proof_count, proof_of_omega1, proof_of_omega3, proof_of_phi, proof_of_psi, &
        proof_of_q0, proof_of_q3, proof_of_theta
    use spintop_compare, only: is_finite, is_zero
    use spintop_conditioning, only: conditioning_t, prepare_conditioning
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_kinds, only: dp
    use spintop_loads, only: works
    use spintop_motion, only: motion_t
    use spintop_quantities, only: energy_scale, kinetic_energy, potential_energy, vertical_momentum, &
        support_force
    use spintop_row_proof, only: row_proof_t
    implicit none
    private
    public :: motion_view_t

    !> One motion after the other of a case.
    type :: motion_view_t
        !> The body as it was given, and that of the computation.
        type(body_t) :: body, turned_body
        !> The motion of the body as it was given, and as it was computed.
        type(motion_t) :: motion, computed
        !> Work of effects since the start by its parts, J.
        real(dp) :: work(works) = 0
        !> Energy and vertical momentum at the start, and the scale of the energy error.
        real(dp), private :: energy_of_start = 0, momentum_of_start = 0, energy_scale = 1
        type(case_t), private :: case
        !> Angles of the last motion.
        real(dp) :: near(3) = 0
        !> The proof of the numbers, where it is wanted.
        type(row_proof_t) :: proof
        type(exact_motion_t), allocatable, private :: oracle
        type(conditioning_t), allocatable, private :: conditioning
        !> What was computed of this motion when a column asked for it.
        logical, private :: has_energies = .false., has_force = .false.
        real(dp), private :: known_energies(2) = 0, known_force(3) = 0
    contains
        procedure :: set
        procedure :: set_motion
        procedure :: set_angles
        procedure :: energies
        procedure :: energy_change
        procedure :: energy_error
        procedure :: momentum_change
        procedure :: force
        procedure :: exact
        procedure :: inherent_error
    end type motion_view_t

contains

    !> Sets the case, and the invariants of its start.
    subroutine set(self, case)
        class(motion_view_t), intent(out) :: self
        type(case_t), intent(in) :: case !! the case whose motions are shown, in the axes in which its body was given
        self%case = case
        self%near = case%given_start%angle
        self%body = case%given_body
        self%turned_body = case%body
        associate (body => case%given_body, start => case%given_start)
            self%energy_of_start = kinetic_energy(body, start) + potential_energy(body, start)
            self%momentum_of_start = vertical_momentum(body, start)
            self%energy_scale = energy_scale(body, start)
        end associate
    end subroutine set

    !> Sets the current motion. That at the start, by its time, is shown as it was given.
    subroutine set_motion(self, computed, as_computed)
        class(motion_view_t), intent(inout) :: self
        type(motion_t), intent(in) :: computed !! in the axes of the computation
        logical, intent(in), optional :: as_computed !! whether the start, too, is shown as it was computed
        logical :: is_start
        is_start = is_zero(computed%t)
        if (present(as_computed)) is_start = is_start .and. .not. as_computed
        self%computed = computed
        self%motion = self%case%turn%back(computed, computed%given_angle)
        if (is_start) call use_given_start(self%case%given_start, self%motion)
        if (any(self%proof%wanted)) call prove(self%proof, self%motion)
        call forget(self)
    end subroutine set_motion

    !> Sets the time, the angles and their rates of the current motion alone. The axes are those of the computation, and no
    !> number is to be proved.
    subroutine set_angles(self, t, angle, rate)
        class(motion_view_t), intent(inout) :: self
        real(dp), intent(in) :: t, angle(3), rate(3) !! time, s; phi, theta, psi, rad; their rates, rad/s
        self%motion%t = t
        self%motion%angle = angle
        self%motion%rate = rate
        if (is_zero(t)) call use_given_start(self%case%given_start, self%motion)
        call forget(self)
    end subroutine set_angles

    !> Forgets what columns asked of the motion before.
    subroutine forget(self)
        type(motion_view_t), intent(inout) :: self
        self%near = self%motion%angle
        self%has_energies = .false.
        self%has_force = .false.
    end subroutine forget

    !> Replaces the attitude and the rates of a formulation by the given values. Rates that do not exist at a
    !> pole are not replaced.
    pure subroutine use_given_start(start, motion)
        type(motion_t), intent(in) :: start
        type(motion_t), intent(inout) :: motion
        motion%angle = start%angle
        where (is_finite(start%rate)) motion%rate = start%rate
        motion%omega = start%omega
        motion%quaternion = start%quaternion
    end subroutine use_given_start

    !> Proves the attitude and the angular velocity, and replaces them where they are to be certified.
    subroutine prove(proof, motion)
        type(row_proof_t), intent(inout) :: proof
        type(motion_t), intent(inout) :: motion
        real(dp) :: printed(proof_count)
        printed = 0
        printed(proof_of_q0:proof_of_q3) = motion%quaternion
        printed([proof_of_phi, proof_of_theta, proof_of_psi]) = motion%angle
        printed(proof_of_omega1:proof_of_omega3) = motion%omega
        call proof%prove(motion%t, printed)
        motion%quaternion = printed(proof_of_q0:proof_of_q3)
        motion%angle = printed([proof_of_phi, proof_of_theta, proof_of_psi])
        motion%omega = printed(proof_of_omega1:proof_of_omega3)
    end subroutine prove

    !> Kinetic and potential energy, J.
    function energies(self)
        class(motion_view_t), intent(inout) :: self
        real(dp) :: energies(2)
        if (.not. self%has_energies) self%known_energies = [kinetic_energy(self%body, self%motion), &
                                                            potential_energy(self%body, self%motion)]
        self%has_energies = .true.
        energies = self%known_energies
    end function energies

    !> Change of the energy since the start, J.
    real(dp) function energy_change(self)
        class(motion_view_t), intent(inout) :: self
        energy_change = sum(self%energies()) - self%energy_of_start
    end function energy_change

    !> The same without the work of effects, relative to the scale of the energies, which work may exceed.
    real(dp) function energy_error(self)
        class(motion_view_t), intent(inout) :: self
        energy_error = (self%energy_change() - sum(self%work)) / max(self%energy_scale, sum(abs(self%work)))
    end function energy_error

    !> Change of the vertical momentum since the start, J s.
    pure real(dp) function momentum_change(self)
        class(motion_view_t), intent(in) :: self
        momentum_change = vertical_momentum(self%body, self%motion) - self%momentum_of_start
    end function momentum_change

    !> The support force in space axes, N.
    function force(self)
        class(motion_view_t), intent(inout) :: self
        real(dp) :: force(3)
        if (.not. self%has_force) self%known_force = support_force(self%body, self%motion)
        self%has_force = .true.
        force = self%known_force
    end function force

    !> The exact motion at the same time, in the axes of the computation. The body must have one.
    type(motion_t) function exact(self)
        class(motion_view_t), intent(inout) :: self
        integer :: status
        if (.not. allocated(self%oracle)) then
            allocate (self%oracle)
            call prepare_exact_motion(self%case%body, self%case%start, self%oracle, status)
        end if
        exact = self%oracle%at(self%computed%t)
    end function exact

    !> The error of the attitude due to rounding of the data, rad. The body must have an exact motion.
    real(dp) function inherent_error(self)
        class(motion_view_t), intent(inout) :: self
        integer :: status
        if (.not. allocated(self%conditioning)) then
            allocate (self%conditioning)
            call prepare_conditioning(self%case%body, self%case%start, self%conditioning, status)
        end if
        inherent_error = self%conditioning%floor_at(self%motion%t)
    end function inherent_error

end module spintop_motion_view
