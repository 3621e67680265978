!> Cases of a symmetric top that differ in numbers of their body, start and span alone, as those of most maps do. They go
!> from the values of the axes to the lanes of the exact solution, without a scene and a case for each of them. Cases
!> with anything to refuse or to note are left to those who make them one by one.
module spintop_sweep_tops
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_attitude, only: circular_of_attitude, omega_from_circular
    use spintop_case, only: case_t, span_of_precessions
    use spintop_distributions, only: law_uniform
    use spintop_exact_block, only: block_size, exact_block_t
    use spintop_job, only: job_t
    use spintop_kinds, only: degree, dp
    use spintop_parameters, only: is_set
    use spintop_scene, only: scene_t
    use spintop_shapes, only: shape_by_inertia
    use spintop_status, only: status_ok
    use spintop_sweep_axes, only: axes_t
    use spintop_sweep_column, only: sweep_column_t
    use spintop_sweep_exact, only: kernel_runs, unload_lane
    use spintop_sweep_notes, only: note_t
    use spintop_sweep_quantities, only: precession_period
    use spintop_sweep_result, only: kinds_of_work, of_details, of_end, of_energy, of_free, of_growth, of_inherent, &
        of_multiplier, of_period, of_proof, sweep_result_t, &
        value_count
    implicit none
    private
    public :: sweep_tops_t

    !> The numbers of a start and its span, and those of the body that an axis may give: mass, gravity, height of the centre
    !> of mass and I3.
    integer, parameter :: phi = 1, theta = 2, psi = 3, phi_rate = 4, theta_rate = 5, spin = 6, span = 7, mass = 8, gravity = 9, &
        arm = 10, inertia3 = 11

    !> The parameters that are such a number, but for a factor, and the number.
    character(*), parameter :: names(*) = [character(21) :: 'initial.phi', 'initial.theta', 'initial.psi', &
        'initial.phi_deg', 'initial.theta_deg', 'initial.psi_deg', 'initial.phi_rate', 'initial.theta_rate', &
        'initial.psi_rate', 'initial.omega3', 'initial.spin_ratio', 'span.t_end', 'top.mass', 'top.gravity', 'top.length', &
        'top.centre_of_mass(3)', 'top.inertia(3)']
    integer, parameter :: number_of(size(names)) = [phi, theta, psi, phi, theta, psi, phi_rate, theta_rate, &
                                                    spin, spin, spin, span, mass, gravity, arm, arm, inertia3]

    !> The energy of a motion with larger numbers may be outside the range of numbers.
    real(dp), parameter :: moderate = 1.0e60_dp

    !> A top, and which of its numbers the axes give.
    type :: sweep_tops_t
        !> Whether the cases of a sweep are such cases.
        logical :: applies = .false.
        !> The top, in the case at hand.
        type(case_t), private :: case
        !> Of each axis: its number, and the factor.
        integer, allocatable, private :: place(:)
        real(dp), allocatable, private :: factor(:)
        !> Whether the spin is given as omega3, or as a ratio; else it is the rate of psi.
        logical, private :: by_omega3 = .true., by_ratio = .false.
        !> Whether the body is another in each case, and m g l of those of a block.
        logical, private :: many_bodies = .false.
        real(dp), private :: mgl(block_size) = 0
        !> The span as a number of precession periods, where it depends on the case; else 0.
        real(dp), private :: precessions = 0
        !> Whether the values of the axes may be outside the ranges of their parameters.
        logical, private :: checks_ranges = .false.
        !> The numbers of the first case, and of those of a block.
        real(dp), private :: constant(phi:inertia3) = 0, numbers(block_size, phi:inertia3) = 0
    contains
        procedure :: prepare
        procedure :: compute
        procedure, private :: load
        procedure, private :: take_body
        procedure, private :: find_ordinary
    end type sweep_tops_t

contains

    !> Finds whether the cases of a job are of this kind, if its quantities are.
    subroutine prepare(self, job, wanted)
        class(sweep_tops_t), intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        integer :: i

        self%applies = .false.
        self%case = job%case
        if (.not. (is_plain_top(job) .and. come_from_kernel(wanted))) return
        self%by_omega3 = self%case%start%gives_omega3
        self%by_ratio = is_set(job%scene%spin_ratio)
        associate (start => self%case%start, body => self%case%body)
            self%constant = [start%angle, start%rate(1:2), merge(start%omega(3), start%rate(3), self%by_omega3), self%case%t_end, &
                             body%mass, body%gravity, body%centre_of_mass(3), body%inertia(3)]
        end associate
        if (self%by_ratio) self%constant(spin) = job%scene%spin_ratio
        allocate (self%place(size(job%axes%axis)), self%factor(size(job%axes%axis)))
        do i = 1, size(self%place)
            associate (name => job%axes%axis(i)%name)
                self%place(i) = sum(number_of, mask=names == name)
                if (self%place(i) == 0) return
                self%factor(i) = 1
                if (index(name, '_deg') > 0) self%factor(i) = degree
                if (name == 'initial.spin_ratio') self%by_ratio = .true.
            end associate
        end do
        self%many_bodies = any(self%place >= mass)
        if (self%many_bodies .and. .not. numbers_are_those_of_body(job%scene)) return
        if (is_set(job%scene%nutations) .and. (wanted(of_end) .or. wanted(of_energy))) return
        if (is_set(job%scene%precessions)) self%precessions = job%scene%precessions
        self%checks_ranges = any(job%axes%axis%law /= law_uniform)
        self%applies = .true.
    end subroutine prepare

    !> Whether the first case of a job is a heavy symmetric top in the axes of the computation that starts with
    !> angles and rates, and whose span no event ends.
    logical function is_plain_top(job)
        type(job_t), intent(in) :: job
        associate (case => job%case)
            is_plain_top = job%plan%exact .and. case%body%is_lagrange() .and. size(job%events) == 0
            if (.not. is_plain_top) return
            is_plain_top = case%body%mgl() > 0 .and. minval(case%body%inertia) > 0 &
                .and. maxval(case%body%inertia) <= moderate &
                .and. .not. (case%turn%is_turned() .or. allocated(case%given_body%effects)) &
                .and. .not. (case%start%gives_quaternion .or. case%start%gives_omega) &
                .and. job%scene%steady_precession == 'none'
        end associate
    end function is_plain_top

    !> Whether mass, gravity, length and inertia of a scene are those of its body, about the pivot.
    pure logical function numbers_are_those_of_body(scene)
        type(scene_t), intent(in) :: scene
        numbers_are_those_of_body = scene%shape == shape_by_inertia .and. .not. scene%parts%any() &
            .and. scene%inertia_about == 'pivot' .and. all(is_set(scene%inertia))
    end function numbers_are_those_of_body

    !> Whether all quantities come from the kernel, or from the inclination and the spin.
    pure logical function come_from_kernel(wanted)
        logical, intent(in) :: wanted(kinds_of_work)
        come_from_kernel = kernel_runs(wanted) .and. &
            .not. (any(wanted([of_details, of_inherent, of_free, of_proof])) .or. any(wanted(of_growth:of_multiplier)))
    end function come_from_kernel

    !> Computes the cases of a block. A case is done if its row is complete and without notes.
    subroutine compute(self, axes, columns, wanted, parameters, block, values, is_done)
        class(sweep_tops_t), intent(inout) :: self
        type(axes_t), intent(in) :: axes !! the axes of the job
        type(sweep_column_t), intent(in) :: columns(:) !! the columns of the table
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        real(dp), intent(in) :: parameters(:, :) !! of each case: a value for each axis
        type(exact_block_t), intent(inout) :: block !! memory for the lanes
        type(sweep_result_t), intent(inout) :: values(:) !! the quantities of the cases that are done
        logical, intent(out) :: is_done(:) !! for each case
        type(note_t) :: note
        integer(int64) :: no_steps
        real(dp) :: listed(value_count)
        integer :: place(size(columns)), k, n, status

        n = size(is_done)
        no_steps = 0
        place = columns%place
        block%n = n
        call self%load(parameters, wanted, block)
        call self%find_ordinary(axes, parameters, block, is_done)
        where (.not. is_done)
            block%inertia3(:n) = self%constant(inertia3)
            block%mgl(:n) = self%constant(mass) * self%constant(gravity) * self%constant(arm)
        end where
        call block%compute(wanted(of_end) .or. wanted(of_energy), wanted(of_period))
        do k = 1, n
            if (.not. is_done(k)) cycle
            if (self%many_bodies) call self%take_body(k)
            self%case%start%angle(2) = block%theta(k)
            self%case%start%omega(3) = block%omega3(k)
            self%case%t_end = block%t_end(k)
            call unload_lane(self%case, block, k, wanted, no_steps, values(k), status, note)
            if (status == status_ok .and. note%flags == 0) then
                listed = values(k)%list()
                is_done(k) = all(abs(listed(place)) <= huge(listed))
            else
                is_done(k) = .false.
                call note%clear()
            end if
        end do
    end subroutine compute

    !> Puts the cases into lanes, with the numbers that `make_case` gives.
    subroutine load(self, parameters, wanted, block)
        class(sweep_tops_t), intent(inout) :: self
        real(dp), intent(in) :: parameters(:, :)
        logical, intent(in) :: wanted(kinds_of_work)
        type(exact_block_t), intent(inout) :: block
        real(dp) :: omega(3)
        integer :: i, k

        associate (n => block%n, start => self%case%start)
            do i = phi, inertia3
                self%numbers(:n, i) = self%constant(i)
            end do
            do i = 1, size(self%place)
                self%numbers(:n, self%place(i)) = self%factor(i) * parameters(i, :)
            end do
            block%inertia1(:n) = self%case%body%inertia(1)
            self%mgl(:n) = self%numbers(:n, mass) * self%numbers(:n, gravity) * self%numbers(:n, arm)
            if (self%by_ratio) then
                self%numbers(:n, spin) = self%numbers(:n, spin) * sqrt(4 * max(self%mgl(:n), 0.0_dp) / self%numbers(:n, inertia3))
            end if
            block%inertia3(:n) = self%numbers(:n, inertia3)
            block%mgl(:n) = self%mgl(:n)
            block%phi(:n) = self%numbers(:n, phi)
            block%theta(:n) = self%numbers(:n, theta)
            block%psi(:n) = self%numbers(:n, psi)
            block%phi_rate(:n) = self%numbers(:n, phi_rate)
            block%theta_rate(:n) = self%numbers(:n, theta_rate)
            block%omega3(:n) = self%numbers(:n, spin)
            block%t_end(:n) = self%numbers(:n, span)
            block%t_period(:n) = 0
            if (.not. self%by_omega3) then
                do k = 1, n
                    omega = omega_from_circular(circular_of_attitude(self%numbers(k, phi:psi)), self%numbers(k, phi_rate:spin))
                    block%omega3(k) = omega(3)
                end do
            end if
            if (self%precessions > 0) then
                block%t_end(:n) = span_of_precessions(self%precessions, block%inertia3(:n) * block%omega3(:n), self%mgl(:n))
            end if
            if (.not. wanted(of_period)) return
            do k = 1, n
                if (self%many_bodies) call self%take_body(k)
                start%omega(3) = block%omega3(k)
                block%t_period(k) = precession_period(self%case%body, start)
            end do
        end associate
    end subroutine load

    !> Gives the case at hand the body of the k-th case.
    subroutine take_body(self, k)
        class(sweep_tops_t), intent(inout) :: self
        integer, intent(in) :: k
        associate (body => self%case%body)
            body%mass = self%numbers(k, mass)
            body%gravity = self%numbers(k, gravity)
            body%centre_of_mass(3) = self%numbers(k, arm)
            body%inertia(3) = self%numbers(k, inertia3)
            self%case%given_body = body
        end associate
    end subroutine take_body

    !> Finds the cases that `make_case` does not refuse: those with values in range, with moderate numbers, with a
    !> spin, without which there are no precession periods, and with a body that exists and is pulled down from above its pivot.
    subroutine find_ordinary(self, axes, parameters, block, is_ordinary)
        class(sweep_tops_t), intent(in) :: self
        type(axes_t), intent(in) :: axes
        real(dp), intent(in) :: parameters(:, :)
        type(exact_block_t), intent(in) :: block
        logical, intent(out) :: is_ordinary(:)
        integer :: k

        associate (n => block%n)
            is_ordinary = max(abs(block%phi_rate(:n)), abs(block%theta_rate(:n)), abs(block%omega3(:n))) <= moderate &
                          .and. abs(block%inertia3(:n) * block%omega3(:n)) > 0
            if (self%many_bodies) then
                is_ordinary = is_ordinary .and. min(block%mgl(:n), block%inertia3(:n)) >= 1 / moderate &
                    .and. max(block%mgl(:n), block%inertia3(:n)) <= moderate .and. self%numbers(:n, arm) > 0 &
                    .and. block%inertia3(:n) <= 2 * block%inertia1(:n)
            end if
        end associate
        if (.not. self%checks_ranges) return
        do k = 1, size(is_ordinary)
            if (axes%out_of_range(parameters(:, k)) > 0) is_ordinary(k) = .false.
        end do
    end subroutine find_ordinary

end module spintop_sweep_tops
