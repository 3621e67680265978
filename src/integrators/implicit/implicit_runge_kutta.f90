!> Implicit Runge-Kutta methods with a fixed step size: Gauss-Legendre and theta methods (the paper's Appendix D).
!>
!> The increments z of the stages over the state are solved to rounding: by fixed-point iteration, or by Newton's method with
!> one matrix over all stages, whose Jacobian is taken in their middle and kept while it serves. Where that fails, every stage
!> has its own Jacobian, and the solution is followed from step size zero.
module spintop_implicit_runge_kutta
    use spintop_kinds, only: dp, xp, epsilon_dp, is_equal
    use spintop_fixed_step, only: fixed_step_t, begin_on_grid
    use spintop_formulation, only: formulation_info_t, max_states
    use spintop_status, only: is_ok, status_non_finite, status_not_converged, status_ok, status_outside
    implicit none
    private
    public :: implicit_runge_kutta_t, implicit_table_t, max_implicit_stages, gauss_table, theta_table
    public :: find_residual, follow_stages

    !> Maximum numbers of stages of a table, and of unknowns.
    integer, parameter :: max_implicit_stages = 4, most = max_states * max_implicit_stages

    !> A collocation method for y' = f(t, y). Its stages lie at t + node_i h and y + z_i,
    !> z_i = h (first f(t, y) + sum_j a_ij f(t + node_j h, y + z_j)),
    !> and its polynomial of the step goes through y and all of them.
    type :: implicit_table_t
        integer :: stages = 0
        real(dp) :: node(max_implicit_stages) = 0, a(max_implicit_stages, max_implicit_stages) = 0
        !> Weight of the slope at the beginning of the step.
        real(dp) :: first = 0
        !> The change of the state is sum_i last(i) z_i, the polynomial at the end of the step. In this form, without slopes,
        !> nothing cancels (Hairer, Lubich and Wanner, Geometric Numerical Integration, VIII.6).
        real(dp) :: last(max_implicit_stages) = 0
        !> Continuation of the polynomial into the next step of the same size: z_j is about sum_i ahead(i, j) z_i of this one.
        real(dp) :: ahead(max_implicit_stages, max_implicit_stages) = 0
    end type implicit_table_t

    !> An implicit method given by its table.
    type, extends(fixed_step_t) :: implicit_runge_kutta_t
        type(implicit_table_t) :: table
        !> Increments of the stages of the last step, and its size, s; 0 before the first step.
        real(dp) :: z(max_states, max_implicit_stages) = 0, h_stages = 0
        !> Inverse of Newton's matrix, and the step size to which it belongs, s; 0 if there is none.
        real(dp) :: inverse(most, most) = 0, h_inverse = 0
    contains
        procedure :: begin
        procedure :: step
    end type implicit_runge_kutta_t

    !> Number of iterations after which a step has not converged.
    integer, parameter :: newton_limit = 30, fixed_point_limit = 200
    !> An iteration has converged to rounding if its correction, in units of the stages, is below the first value, or if it no
    !> longer decreases and is below the second. Larger ones, up to the third, may be due to the Jacobian.
    real(dp), parameter :: negligible = epsilon_dp / 128, rounding = 64 * epsilon_dp, acceptable = 1.0e-10_dp
    !> The corrections of fixed-point iteration may alternate: the smallest of them, and growth that rounding errors may cause.
    real(dp), parameter :: rounding_of_insertion = 1.0e-12_dp, jitter = 10
    !> Contraction above which a new Jacobian is worthwhile; contraction that shows that the solution is the nearby one.
    real(dp), parameter :: slow = 0.05_dp, sure = 0.5_dp
    !> Largest increments of stages, in their units, that can approximate a motion: the range of an inclination is pi, that of
    !> a component of a quaternion 4, that of a rate 2.
    real(dp), parameter :: farthest = 2
    !> Smallest increment of the step size where a solution is followed, as a share of it, and maximum number of increments.
    real(dp), parameter :: shortest = 2.0_dp**(-12)
    integer, parameter :: most_stretches = 200

contains

    !> The Gauss-Legendre method of order 2 s with s stages (Kuntzmann 1961, Butcher 1964). a_ij is the integral up to node i of
    !> the polynomial that is 1 at node j and 0 at the others, which the nodes of the method integrate exactly. One stage gives
    !> the implicit midpoint rule.
    type(implicit_table_t) function gauss_table(stages) result(table)
        integer, intent(in) :: stages !! number of stages, at most `max_implicit_stages`
        !> Nodes on [-1, 1], and their weights, of the outer and the inner pair; a node in the middle has the weight left.
        real(xp), parameter :: outer(4) = [0.0_xp, sqrt(1 / 3.0_xp), sqrt(0.6_xp), sqrt((3 + sqrt(4.8_xp)) / 7)], &
            inner = sqrt((3 - sqrt(4.8_xp)) / 7), share(4) = [2.0_xp, 1.0_xp, 5 / 9.0_xp, (18 - sqrt(30.0_xp)) / 36]
        real(xp) :: c(stages), b(stages)
        integer :: i, j, k

        c = 0
        if (stages == 4) c(2:3) = [-inner, inner]
        c(1) = -outer(stages)
        c(stages) = outer(stages)
        c = (1 + c) / 2
        b = (1 - share(stages)) / max(stages - 2, 1)
        b(1) = share(stages) / 2
        b(stages) = b(1)
        call lay_polynomial(table, c)
        do i = 1, stages
            do j = 1, stages
                table%a(i, j) = real(c(i) * sum([(b(k) * basis(c, j, c(i) * c(k)), k=1, stages)]), dp)
            end do
        end do
    end function gauss_table

    !> The theta method y+ = y + h [(1-alpha) f(y) + alpha f(y+)], 0 < alpha <= 1, whose only stage is at the end of the step.
    type(implicit_table_t) function theta_table(alpha) result(table)
        real(dp), intent(in) :: alpha !! weight of the slope at the end of the step
        call lay_polynomial(table, [1.0_xp])
        table%a(1, 1) = alpha
        table%first = 1 - alpha
    end function theta_table

    !> Sets the nodes, and the polynomial that is zero at the beginning of the step and interpolates the stages.
    pure subroutine lay_polynomial(table, node)
        type(implicit_table_t), intent(inout) :: table
        real(xp), intent(in) :: node(:)
        integer :: i, j
        table%stages = size(node)
        table%node(:size(node)) = real(node, dp)
        do i = 1, size(node)
            table%last(i) = real(basis(node, i, 1.0_xp) / node(i), dp)
            do j = 1, size(node)
                table%ahead(i, j) = real(((1 + node(j)) * basis(node, i, 1 + node(j)) - basis(node, i, 1.0_xp)) / node(i), dp)
            end do
        end do
    end subroutine lay_polynomial

    !> The polynomial that is 1 at node i and 0 at the others.
    pure real(xp) function basis(node, i, place)
        real(xp), intent(in) :: node(:), place
        integer, intent(in) :: i
        integer :: k
        basis = 1
        do k = 1, size(node)
            if (k /= i) basis = basis * (place - node(k)) / (node(i) - node(k))
        end do
    end function basis

    !> First slope; data of an earlier run are discarded.
    subroutine begin(self, status)
        class(implicit_runge_kutta_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        self%h_stages = 0
        self%h_inverse = 0
        call begin_on_grid(self, status)
    end subroutine begin

    !> One step of the method. The initial guess of the stages is the polynomial of the last step. If it fails, the slope is
    !> the guess, with a new Jacobian; if that fails too, the solution is followed.
    subroutine step(self, h, change, status)
        class(implicit_runge_kutta_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: z(max_states, max_implicit_stages)
        integer :: i

        change = 0
        status = status_not_converged
        if (is_equal(self%h_stages, h)) then
            z = matmul(self%z, self%table%ahead)
            call solve(self, h, z, status)
        end if
        if (.not. is_ok(status)) then
            self%h_inverse = 0
            do i = 1, max_implicit_stages
                z(:, i) = self%table%node(i) * h * self%slope
            end do
            call solve(self, h, z, status)
            if (.not. self%controls%fixed_point .and. all(status /= [status_ok, status_outside])) then
                call follow_stages(self, h, z, status)
            end if
        end if
        if (.not. is_ok(status)) return
        self%z = z
        self%h_stages = h
        change = matmul(z, self%table%last)
    end subroutine step

    !> Follows the solution from step size zero: the required one is connected to the state (Deuflhard, Newton Methods for
    !> Nonlinear Problems, 2004, 5.1). From the solution of a shorter step the first correction, with the matrix there, is the
    !> prediction along the tangent; the step size grows by so little that the others contract at once. The status is
    !> `status_not_converged` if the solution ends, or turns back, before the full size.
    subroutine follow_stages(self, h, z, status)
        class(implicit_runge_kutta_t), intent(inout) :: self !! state and slope at the beginning of the step
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: z(max_states, max_implicit_stages) !! increments of the stages
        integer, intent(out) :: status !! `status_ok`, or `status_not_converged`
        real(dp) :: trial(max_states, max_implicit_stages), share, stretch
        integer :: attempt

        z = 0
        share = 0
        stretch = 1
        do attempt = 1, most_stretches
            stretch = min(stretch, 1 - share)
            trial = z
            call solve(self, (share + stretch) * h, trial, status, share * h)
            if (is_ok(status)) then
                if (maxval(maxval(abs(trial), dim=2) / self%formulation%scale, mask=.not. self%formulation%cyclic) > farthest) exit
                z = trial
                if (.not. share + stretch < 1) return
                share = share + stretch
                stretch = 2 * stretch
            else
                stretch = stretch / 4
                if (stretch < shortest) exit
            end if
        end do
        status = status_not_converged
    end subroutine follow_stages

    !> Solves the equations of the stages from the guess in z. Newton's corrections must be smaller than the guess, and each
    !> smaller than the last one, by half with a new Jacobian: an iteration without contraction may find a solution, but rarely
    !> the one that is connected to the state. Cyclic variables follow from the others and are ignored in this test.
    subroutine solve(self, h, z, status, shorter)
        class(implicit_runge_kutta_t), intent(inout) :: self
        real(dp), intent(in) :: h
        real(dp), intent(inout) :: z(max_states, max_implicit_stages)
        integer, intent(out) :: status
        real(dp), intent(in), optional :: shorter !! size of the step of which the guess is; then every stage has its own Jacobian
        real(dp) :: correction(max_states, max_implicit_stages), units(max_states)
        real(dp) :: size, previous, smallest, core, core_previous, h_matrix
        integer :: iteration, idle, n
        logical :: newton, each, is_new

        newton = .not. self%controls%fixed_point
        each = present(shorter)
        is_new = each
        ! The scale of the motion or, if they are larger, the increments or the variable itself.
        units = max(self%formulation%scale, maxval(abs(z), dim=2), merge(0.0_dp, abs(self%y), self%formulation%cyclic))
        core_previous = huge(core)
        if (.not. each) core_previous = maxval(maxval(abs(z), dim=2) / units, mask=.not. self%formulation%cyclic)
        smallest = huge(size)
        idle = 0
        do iteration = 1, merge(newton_limit, fixed_point_limit, newton)
            call find_residual(self, h, z, correction, status)
            if (status == status_non_finite) exit
            if (.not. is_ok(status)) return
            h_matrix = h
            if (present(shorter) .and. iteration == 1) h_matrix = shorter
            if (newton .and. abs(h_matrix) > 0) then
                if (.not. is_equal(self%h_inverse, h_matrix) .or. each .and. iteration > 1) then
                    is_new = .true.
                    call invert_matrix(self, h_matrix, z, each, status)
                    if (.not. is_ok(status)) return
                end if
                n = max_states * self%table%stages
                correction = reshape(matmul(self%inverse(:n, :n), reshape(correction, [n])), shape(correction), pad=[0.0_dp])
            end if
            z = z + correction
            size = maxval(maxval(abs(correction), dim=2) / units)
            if (size <= negligible) return
            core = maxval(maxval(abs(correction), dim=2) / units, mask=.not. self%formulation%cyclic)
            if (newton .and. core > acceptable .and. &
                .not. core < merge(sure, 1.0_dp, is_new .and. iteration > 1) * core_previous) exit
            if (newton .and. iteration > 1) then
                ! This is the expected magnitude of the next correction.
                if (size * (size / previous) <= negligible) return
                if (size > slow * previous) self%h_inverse = 0
            end if
            idle = merge(0, idle + 1, size < smallest)
            smallest = min(smallest, size)
            if (newton .and. idle > 0 .and. size <= acceptable) then
                if (each .or. size <= rounding) return
                each = .true.
            end if
            if (idle > 1 .and. smallest <= rounding_of_insertion .and. size <= jitter * smallest) return
            previous = size
            core_previous = core
        end do
        status = status_not_converged
    end subroutine solve

    !> What the equations of the stages lack.
    subroutine find_residual(self, h, z, residual, status)
        class(implicit_runge_kutta_t), intent(inout) :: self !! state and slope at the beginning of the step
        real(dp), intent(in) :: h, z(max_states, max_implicit_stages) !! step size, s, and increments of the stages
        real(dp), intent(out) :: residual(max_states, max_implicit_stages) !! of each stage
        integer, intent(out) :: status !! that of the right-hand side
        real(dp) :: slope(max_states)
        integer :: i, j

        residual = 0
        associate (table => self%table)
            do j = 1, table%stages
                call self%evaluate(self%t + table%node(j) * h, self%y + z(:, j), slope, status)
                if (.not. is_ok(status)) return
                do i = 1, table%stages
                    residual(:, i) = residual(:, i) + table%a(i, j) * slope
                end do
            end do
            do i = 1, table%stages
                residual(:, i) = h * (residual(:, i) + table%first * self%slope) - z(:, i)
            end do
        end associate
    end subroutine find_residual

    !> Finds the inverse of 1 - h a x J, with the Jacobian of each stage or with one in their middle.
    subroutine invert_matrix(self, h, z, each, status)
        class(implicit_runge_kutta_t), intent(inout) :: self
        real(dp), intent(in) :: h, z(max_states, max_implicit_stages)
        logical, intent(in) :: each
        integer, intent(out) :: status
        real(dp) :: jacobian(max_states, max_states), unit(most), place, moved(max_states)
        integer, parameter :: n = max_states
        integer :: i, j
        logical :: is_regular

        self%h_inverse = 0
        status = status_ok
        associate (s => self%table%stages, inverse => self%inverse)
            do j = 1, s
                place = merge(self%table%node(j), sum(self%table%node) / s, each)
                moved = merge(z(:, j), sum(z, dim=2) / s, each)
                if (each .or. j == 1) call find_jacobian(self, self%t + place * h, self%y + moved, jacobian, status)
                if (.not. is_ok(status)) return
                do i = 1, s
                    inverse((i - 1) * n + 1:i * n, (j - 1) * n + 1:j * n) = -h * self%table%a(i, j) * jacobian
                end do
            end do
            do i = 1, n * s
                inverse(i, i) = inverse(i, i) + 1
            end do
            call invert(inverse, n * s, is_regular)
            if (.not. is_regular) status = status_not_converged
            if (.not. is_regular) return
            unit = reshape(self%formulation%units(), [most], pad=self%formulation%units())
            do j = 1, n * s
                inverse(:n * s, j) = inverse(:n * s, j) * unit(:n * s) / unit(j)
            end do
        end associate
        self%h_inverse = h
    end subroutine invert_matrix

    !> Inverts a matrix in place, by the method of Gauss and Jordan. An inverse is found as fast as factors, and applied faster:
    !> they are solved with one number after another. Its rounding errors only delay the iteration.
    pure subroutine invert(a, n, is_regular)
        real(dp), intent(inout) :: a(most, most)
        integer, intent(in) :: n
        logical, intent(out) :: is_regular
        real(dp) :: column(n), row(n), pivot
        integer :: at(n), i, j, k

        is_regular = .false.
        do k = 1, n
            at(k) = k - 1 + maxloc(abs(a(k:n, k)), dim=1)
            row = a(at(k), :n)
            if (at(k) /= k) a(at(k), :n) = a(k, :n)
            column = a(:n, k)
            pivot = row(k)
            if (.not. abs(pivot) > 0) return ! also for what is no number
            row(k) = 1
            row = row / pivot
            column(k) = 0
            a(:n, k) = 0
            do j = 1, n
                if (.not. abs(row(j)) > 0) cycle
                do i = 1, n, max_states
                    a(i:i + max_states - 1, j) = a(i:i + max_states - 1, j) - row(j) * column(i:i + max_states - 1)
                end do
            end do
            a(k, :n) = row
        end do
        do k = n, 1, -1
            column = a(:n, k)
            a(:n, k) = a(:n, at(k))
            a(:n, at(k)) = column
        end do
        is_regular = .true.
    end subroutine invert

    !> The Jacobian df/dy in units of the state, by forward differences, accurate to several digits also where a component is
    !> zero. The equations do not depend on cyclic variables.
    subroutine find_jacobian(self, t, y, jacobian, status)
        class(implicit_runge_kutta_t), intent(inout) :: self
        real(dp), intent(in) :: t, y(max_states)
        real(dp), intent(out) :: jacobian(max_states, max_states) !! column j is df/dy_j, in `formulation%units()`, 1/s
        integer, intent(out) :: status
        !> Increment of a component relative to its magnitude, and the smallest magnitude used for this, relative to its scale.
        real(dp), parameter :: share = sqrt(epsilon_dp), least = sqrt(sqrt(epsilon_dp))
        real(dp), dimension(max_states) :: moved, slope, slope_moved, unit
        type(formulation_info_t) :: info
        integer :: j

        info = self%formulation%info()
        unit = self%formulation%units()
        self%counts%jacobians = self%counts%jacobians + 1
        jacobian = 0
        call self%evaluate(t, y, slope, status)
        do j = 1, info%states
            if (.not. is_ok(status)) return
            if (self%formulation%cyclic(j)) cycle
            moved = y
            moved(j) = y(j) + share * max(abs(y(j)), least * self%formulation%scale(j))
            call self%evaluate(t, moved, slope_moved, status)
            jacobian(:, j) = (slope_moved - slope) / unit / ((moved(j) - y(j)) / unit(j))
        end do
    end subroutine find_jacobian

end module spintop_implicit_runge_kutta
