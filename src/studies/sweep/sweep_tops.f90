!> Cases of one symmetric top that differ in numbers of their start and span alone, as those of most maps do. They go
!> from the values of the axes to the lanes of the exact solution, without a scene and a case for each of them. Cases
!> with anything to refuse or to note are left to those who make them one by one.
module spintop_sweep_tops
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_attitude, only: circular_of_attitude, omega_from_circular
    use spintop_body_of_scene, only: is_set
    use spintop_case, only: case_t, span_of_precessions
    use spintop_distributions, only: law_uniform
    use spintop_exact_block, only: block_size, exact_block_t
    use spintop_job, only: job_t
    use spintop_kinds, only: degree, dp
    use spintop_status, only: status_ok
    use spintop_sweep_axes, only: axes_t
    use spintop_sweep_column, only: sweep_column_t
    use spintop_sweep_exact, only: kernel_runs, unload_lane
    use spintop_sweep_notes, only: note_t
    use spintop_sweep_quantities, only: precession_period
    use spintop_sweep_result, only: sweep_result_t, sweep_work_t
    implicit none
    private
    public :: sweep_tops_t

    !> The numbers of a start and its span.
    integer, parameter :: phi = 1, theta = 2, psi = 3, phi_rate = 4, theta_rate = 5, spin = 6, span = 7

    !> The parameters that are such a number, but for a factor, and the number.
    character(*), parameter :: names(*) = [character(18) :: 'initial.phi', 'initial.theta', 'initial.psi', &
        'initial.phi_deg', 'initial.theta_deg', 'initial.psi_deg', 'initial.phi_rate', 'initial.theta_rate', &
        'initial.psi_rate', 'initial.omega3', 'initial.spin_ratio', 'span.t_end']
    integer, parameter :: number_of(size(names)) = [phi, theta, psi, phi, theta, psi, phi_rate, theta_rate, &
                                                    spin, spin, spin, span]

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
        !> Whether the spin is given as omega3; else it is the rate of psi.
        logical, private :: by_omega3 = .true.
        !> I3 and m g l.
        real(dp), private :: inertia3 = 0, mgl = 0
        !> The span as a number of precession periods, where it depends on the case; else 0.
        real(dp), private :: precessions = 0
        !> Whether the values of the axes may be outside the ranges of their parameters.
        logical, private :: checks_ranges = .false.
        !> The numbers of the first case, and of those of a block; cells of a column.
        real(dp), private :: constant(phi:span) = 0, numbers(block_size, phi:span) = 0
        real(dp), private :: cells(block_size) = 0
    contains
        procedure :: prepare
        procedure :: compute
        procedure, private :: load
        procedure, private :: find_ordinary
    end type sweep_tops_t

contains

    !> Finds whether the cases of a job are of this kind, if its quantities are.
    subroutine prepare(self, job, wanted)
        class(sweep_tops_t), intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        type(sweep_work_t), intent(in) :: wanted !! selected groups of quantities
        integer :: i

        self%applies = .false.
        self%case = job%case
        if (.not. (is_plain_top(job) .and. come_from_kernel(wanted))) return
        self%by_omega3 = self%case%start%gives_omega3
        self%inertia3 = self%case%body%inertia(3)
        self%mgl = self%case%body%mgl()
        associate (start => self%case%start)
            self%constant = [start%angle, start%rate(1:2), merge(start%omega(3), start%rate(3), self%by_omega3), self%case%t_end]
        end associate
        allocate (self%place(size(job%axes%axis)), self%factor(size(job%axes%axis)))
        do i = 1, size(self%place)
            associate (name => job%axes%axis(i)%name)
                self%place(i) = sum(number_of, mask=names == name)
                if (self%place(i) == 0) return
                self%factor(i) = 1
                if (index(name, '_deg') > 0) self%factor(i) = degree
                if (name == 'initial.spin_ratio') self%factor(i) = sqrt(4 * self%mgl / self%inertia3)
            end associate
        end do
        if (is_set(job%scene%nutations) .and. (wanted%end .or. wanted%energy)) return
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

    !> Whether all quantities come from the kernel, or from the inclination and the spin.
    pure logical function come_from_kernel(wanted)
        type(sweep_work_t), intent(in) :: wanted
        come_from_kernel = kernel_runs(wanted) .and. &
            .not. (wanted%details .or. wanted%inherent .or. wanted%stability() .or. wanted%free .or. wanted%proof)
    end function come_from_kernel

    !> Computes the cases of a block. A case is done if its row is complete and without notes.
    subroutine compute(self, axes, columns, wanted, parameters, block, values, is_done)
        class(sweep_tops_t), intent(inout) :: self
        type(axes_t), intent(in) :: axes !! the axes of the job
        type(sweep_column_t), intent(in) :: columns(:) !! the columns of the table
        type(sweep_work_t), intent(in) :: wanted !! selected groups of quantities
        real(dp), intent(in) :: parameters(:, :) !! of each case: a value for each axis
        type(exact_block_t), intent(inout) :: block !! memory for the lanes
        type(sweep_result_t), intent(inout) :: values(:) !! the quantities of the cases that are done
        logical, intent(out) :: is_done(:) !! for each case
        type(note_t) :: note
        integer(int64) :: no_steps
        integer :: i, k, n, status

        n = size(is_done)
        no_steps = 0
        block%n = n
        call self%load(parameters, wanted, block)
        call self%find_ordinary(axes, parameters, block, is_done)
        call block%compute(wanted%end .or. wanted%energy, wanted%period)
        do k = 1, n
            if (.not. is_done(k)) cycle
            self%case%start%angle(2) = block%theta(k)
            self%case%start%omega(3) = block%omega3(k)
            self%case%t_end = block%t_end(k)
            call unload_lane(self%case, block, k, wanted, no_steps, values(k), status, note)
            if (status == status_ok .and. note%flags == 0) cycle
            is_done(k) = .false.
            call note%clear()
        end do
        do i = 1, size(columns)
            call columns(i)%fill(values(:n), self%cells(:n))
            is_done = is_done .and. abs(self%cells(:n)) <= huge(self%cells)
        end do
    end subroutine compute

    !> Puts the cases into lanes, with the numbers that `make_case` gives.
    subroutine load(self, parameters, wanted, block)
        class(sweep_tops_t), intent(inout) :: self
        real(dp), intent(in) :: parameters(:, :)
        type(sweep_work_t), intent(in) :: wanted
        type(exact_block_t), intent(inout) :: block
        real(dp) :: omega(3)
        integer :: i, k

        associate (n => block%n, start => self%case%start)
            do i = phi, span
                self%numbers(:n, i) = self%constant(i)
            end do
            do i = 1, size(self%place)
                self%numbers(:n, self%place(i)) = self%factor(i) * parameters(i, :)
            end do
            block%inertia1(:n) = self%case%body%inertia(1)
            block%inertia3(:n) = self%inertia3
            block%mgl(:n) = self%mgl
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
                block%t_end(:n) = span_of_precessions(self%precessions, self%inertia3 * block%omega3(:n), self%mgl)
            end if
            if (.not. wanted%period) return
            do k = 1, n
                start%omega(3) = block%omega3(k)
                block%t_period(k) = precession_period(self%case%body, start)
            end do
        end associate
    end subroutine load

    !> Finds the cases that `make_case` does not refuse: those with values in range, with moderate numbers, and with a
    !> spin, without which there are no precession periods.
    subroutine find_ordinary(self, axes, parameters, block, is_ordinary)
        class(sweep_tops_t), intent(in) :: self
        type(axes_t), intent(in) :: axes
        real(dp), intent(in) :: parameters(:, :)
        type(exact_block_t), intent(in) :: block
        logical, intent(out) :: is_ordinary(:)
        integer :: k

        associate (n => block%n)
            is_ordinary = max(abs(block%phi_rate(:n)), abs(block%theta_rate(:n)), abs(block%omega3(:n))) <= moderate &
                          .and. abs(self%inertia3 * block%omega3(:n)) > 0
        end associate
        if (.not. self%checks_ranges) return
        do k = 1, size(is_ordinary)
            if (axes%out_of_range(parameters(:, k)) > 0) is_ordinary(k) = .false.
        end do
    end subroutine find_ordinary

end module spintop_sweep_tops
