!> Power series of the motion of a body with effects whose right-hand side is analytic: all but dry friction and tables.
!>
!> With U = I w_a = P - h instead of the momentum P,
!>
!>     U' = U x w_a + h x w_a + m (g G + a) x r - d w + M - sum of y z - h',   q' = q (0, w)/2,   row' = row x w
!>
!> (see `spintop_loads`); the rows of the rotation are G, the vertical, and where they are needed X and Y, or what is made of
!> them for a pivot that vibrates. The drag of the air is y z with y = (x.x)^b, where x and z are linear in w: z = k w with x = w,
!> and z = c r x (w x r) with x = w x r. Each term enters the next one by a matrix, its products with first terms: see
!> effects_series.h.
module spintop_smooth_effects_series
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_body, only: body_t
    use spintop_body_products, only: products_of
    use spintop_capabilities, only: max_series_order, max_states
    use spintop_compare, only: is_zero
    use spintop_effects, only: effects_t, kernel_effects
    use spintop_kernel_types, only: body_products_t, half, series_effects_t
    use spintop_kinds, only: dp
    use spintop_series_shares, only: share_rest, short_share
    use spintop_vectors, only: cross
    implicit none
    private
    public :: smooth_series_t

    !> The series of a body.
    type :: smooth_series_t
        private
        !> Whether the effects are analytic.
        logical, public :: holds = .false.
        type(series_effects_t) :: of
        real(dp) :: rotor_momentum(3) = 0
        !> Motion of the pivot, and W^k/k!.
        real(dp) :: amplitude(3) = 0, phase(3) = 0, rate = 0, rate_power(0:max_series_order) = 0
    contains
        procedure :: set
        procedure :: find
    end type smooth_series_t

    interface
        pure subroutine c_expand(order, effects, state, pivot, share, share_rest, c, exists) &
            bind(C, name='spintop_expand_effects')
            import :: c_double, c_int, series_effects_t
            integer(c_int), value :: order
            type(series_effects_t), intent(in) :: effects
            real(c_double), intent(in) :: state(*), pivot(*), share(*), share_rest(*)
            real(c_double), intent(out) :: c(*)
            integer(c_int), intent(out) :: exists
        end subroutine c_expand
    end interface

contains

    !> Sets the constants.
    pure subroutine set(self, body, effects)
        class(smooth_series_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(effects_t), intent(in) :: effects !! effects on the body
        type(body_products_t) :: products
        real(dp) :: v(3)
        integer :: k

        self%holds = effects%only(kernel_effects)
        if (.not. self%holds) return
        products = products_of(body)
        v = 1 / body%inertia
        self%rotor_momentum = effects%rotor_momentum
        self%amplitude = effects%vibration_amplitude
        self%phase = effects%vibration_phase
        self%rate = effects%vibration_rate
        self%of = series_effects_t()
        associate (of => self%of, o => effects%frame_rate, drive => effects%rotor_torque)
            of%coupling(:3) = products%first(:3)
            of%is_steady(:3) = products%is_steady(:3)
            of%damping(:3) = body%damping
            of%arm(:3) = body%mass * body%centre_of_mass
            of%gravity = body%gravity
            of%torque_body(:3) = effects%torque_body
            of%torque_space(:3) = effects%torque_space
            of%rotor_torque(:3) = drive
            of%first = products%first
            of%second = products%second
            of%third = products%third
            of%turn_first = [of%first(5:8), of%first(5:8)]
            of%turn_second = [of%second(5:8), of%second(5:8)]
            of%inverse_inertia(:3) = v
            of%frame_rate(:3) = o
            of%frame = reshape([1, -1, 1, -1, 1, -1, -1, 1, 1, 1, -1, -1], [half, 3]) * spread(o / 2, 1, half)
            of%side_frame(:3, 1) = o(3)
            of%side_frame(5:7, 1) = -o(3)
            of%side_frame(:3, 2) = -o(2)
            of%side_frame(5:7, 2) = o(1)
            of%turns = merge(1, 0, any(abs(o) > 0))
            of%is_driven = merge(1, 0, any(abs(drive) > 0))
            of%vibrates = merge(1, 0, any(abs(self%amplitude) > 0))
            of%has_sides = merge(1, 0, any(abs(o(:2)) > 0) .or. any(abs(effects%torque_space(:2)) > 0) &
                                 .or. any(abs(self%amplitude(:2)) > 0))
            if (any(abs(self%amplitude(:2)) > 0) .and. .not. (any(abs(o) > 0) .or. any(abs(effects%torque_space(:2)) > 0))) then
                of%vibrates = 0
                of%circle = self%rate
                of%side_frame(:3, 1) = self%rate
                of%side_frame(5:7, 1) = -self%rate
            end if
        end associate
        self%rate_power(0) = 1
        do k = 1, max_series_order
            self%rate_power(k) = self%rate_power(k - 1) * self%rate / k
        end do
        call set_drags(self, body, effects)
    end subroutine set

    !> Sets the drags. A moment that is linear in w is damping.
    pure subroutine set_drags(self, body, effects)
        class(smooth_series_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(effects_t), intent(in) :: effects
        real(dp) :: axis(3)
        integer :: i

        associate (n => self%of%drags, drag => self%of%drag, r => body%centre_of_mass)
            if (is_zero(effects%drag_exponent - 1)) then
                self%of%damping(:3) = self%of%damping(:3) + effects%drag_moment
            else if (any(effects%drag_moment > 0)) then
                n = n + 1
                drag(n)%power = (effects%drag_exponent - 1) / 2
                do i = 1, 3
                    drag(n)%speed(i, i) = 1
                    drag(n)%moment(i, i) = effects%drag_moment(i)
                end do
            end if
            if (effects%drag_force > 0 .and. any(abs(r) > 0)) then
                n = n + 1
                drag(n)%power = 0.5_dp
                do i = 1, 3
                    axis = 0
                    axis(i) = 1
                    drag(n)%speed(:3, i) = cross(axis, r)
                    drag(n)%moment(:3, i) = effects%drag_force * cross(r, cross(axis, r))
                end do
            end if
        end associate
    end subroutine set_drags

    !> Taylor coefficients of the motion. `exists` is false where a drag has no series because its speed is zero.
    pure subroutine find(self, t, y, order, coefficient, exists)
        class(smooth_series_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp), intent(in) :: y(max_states) !! state
        integer, intent(in) :: order !! order of the highest coefficient
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order) !! column k is the coefficient of h^k
        logical, intent(out) :: exists !! whether there is a series
        integer(c_int) :: has_series
        real(dp) :: h(3), excess, state(24), pivot(3, 0:max_series_order)

        h = self%rotor_momentum + self%of%rotor_torque(:3) * t
        state = 0
        state(1:4) = y(1:4)
        state(5:7) = y(5:7) - h
        associate (q0 => y(1), q1 => y(2), q2 => y(3), q3 => y(4))
            state(9:11) = [2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1), (q0**2 + q3**2) - (q1**2 + q2**2)]
            state(13:15) = [(q0**2 + q1**2) - (q2**2 + q3**2), 2 * (q1 * q2 - q0 * q3), 2 * (q1 * q3 + q0 * q2)]
            state(17:19) = [2 * (q1 * q2 + q0 * q3), (q0**2 + q2**2) - (q1**2 + q3**2), 2 * (q2 * q3 - q0 * q1)]
            ! Divided by the squared norm; see body_start.h.
            excess = (((q0**2 - 1) + q3**2) + q1**2) + q2**2
            if (abs(excess) < 0.5_dp) then
                state(9:19) = state(9:19) - excess / (1 + excess) * state(9:19)
            else
                state(9:19) = state(9:19) / ((q0**2 + q3**2) + (q1**2 + q2**2))
            end if
        end associate
        state(21:23) = h
        pivot(:, 0) = 0
        if (self%of%vibrates > 0) call expand_pivot(self, t, order, pivot)
        if (abs(self%of%circle) > 0) call set_pivot_acceleration(self, t, state, pivot(:, 0))
        call c_expand(order, self%of, state, pivot, short_share, share_rest, coefficient, has_series)
        exists = has_series > 0
        if (.not. exists) return
        coefficient(:, 0) = y
        coefficient(5:7, 1) = coefficient(5:7, 1) + self%of%rotor_torque(:3)
    end subroutine find

    !> Replaces X and Y by the acceleration B of the pivot and by C = (RB)'/W in body axes, where nothing else needs them:
    !> B' = B x w + W C, C' = C x w - W B. `pivot` are the factors of X and Y in the acceleration.
    pure subroutine set_pivot_acceleration(self, t, state, pivot)
        class(smooth_series_t), intent(in) :: self
        real(dp), intent(in) :: t
        real(dp), intent(inout) :: state(:), pivot(3)
        real(dp) :: rows(3, 3), space(3, 0:max_series_order)
        space = 0
        call expand_pivot(self, t, 1, space)
        rows = reshape([state(13:15), state(17:19), state(9:11)], [3, 3])
        state(13:15) = matmul(rows, space(:, 0))
        state(17:19) = matmul(rows, space(:, 1)) / self%rate
        pivot = [1, 0, 0]
    end subroutine set_pivot_acceleration

    !> Terms of the acceleration of the pivot in space axes, z'' + 2 O x z' + O x (O x z) with z = A cos(W t + f): the
    !> term k of cos(W t + f) is W^k/k! cos(W t + f + k pi/2).
    pure subroutine expand_pivot(self, t, order, pivot)
        class(smooth_series_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        integer, intent(in) :: order !! order of the highest term
        real(dp), intent(inout) :: pivot(3, 0:max_series_order) !! terms, m/s^2
        real(dp), dimension(3) :: cosine, sine, even, odd
        integer :: k
        cosine = 0
        sine = 0
        do k = 1, 3
            if (.not. abs(self%amplitude(k)) > 0) cycle
            cosine(k) = self%amplitude(k) * cos(self%rate * t + self%phase(k))
            sine(k) = self%amplitude(k) * sin(self%rate * t + self%phase(k))
        end do
        associate (o => self%of%frame_rate(:3))
            even = -self%rate**2 * cosine - 2 * self%rate * cross(o, sine) + cross(o, cross(o, cosine))
            odd = self%rate**2 * sine - 2 * self%rate * cross(o, cosine) - cross(o, cross(o, sine))
        end associate
        do k = 0, order
            if (mod(k, 2) == 0) then
                pivot(:, k) = merge(self%rate_power(k), -self%rate_power(k), mod(k, 4) == 0) * even
            else
                pivot(:, k) = merge(self%rate_power(k), -self%rate_power(k), mod(k, 4) == 1) * odd
            end if
        end do
    end subroutine expand_pivot

end module spintop_smooth_effects_series
