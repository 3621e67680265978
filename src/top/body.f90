!> A rigid body with one fixed point under gravity. What kind of body it is, is asked for every case of a sweep: zeros are
!> compared in place.
module spintop_body
    use spintop_kinds, only: dp, is_equal, cross
    use spintop_effects, only: effects_t
    use spintop_given_axes, only: given_axes_t
    implicit none
    private
    public :: body_t

    !> Mass properties about the fixed point O, in principal body axes.
    type :: body_t
        !> kg
        real(dp) :: mass = 1
        !> Principal moments of inertia about O, kg m^2.
        real(dp) :: inertia(3) = 1
        !> Elements 23, 31 and 12 of the inertia tensor about O, kg m^2: zero in principal axes, which all methods need.
        !> Other axes are those of a body as it was given; `inertia` then has the diagonal of the tensor.
        real(dp) :: products(3) = 0
        !> Centre of mass from O in body axes, m.
        real(dp) :: centre_of_mass(3) = 0
        !> m/s^2, downwards along space z.
        real(dp) :: gravity = 9.81_dp
        !> Viscous damping coefficients d_i of the torque -d_i omega_i in body axes, N m s.
        real(dp) :: damping(3) = 0
        !> Effects beside gravity and damping; not allocated if there are none.
        type(effects_t), allocatable :: effects
        !> The axes in which the body was given, where they differ from these.
        type(given_axes_t) :: given = given_axes_t()
    contains
        procedure :: mgl
        procedure :: weight_moment
        procedure :: is_symmetric
        procedure :: is_lagrange
        procedure :: has_closed_nutation
        procedure :: is_free
        procedure :: has_closed_form
        procedure :: symmetry_axis
        procedure :: torque
        procedure :: momentum
        procedure :: has_products
    end type body_t

contains

    !> Weight times the height of the centre of mass along body z, N m ("m g l").
    pure real(dp) function mgl(self)
        class(body_t), intent(in) :: self
        mgl = self%mass * self%gravity * self%centre_of_mass(3)
    end function mgl

    !> Weight times the centre of mass from O in body axes, N m.
    pure function weight_moment(self) result(moment)
        class(body_t), intent(in) :: self
        real(dp) :: moment(3)
        moment = self%mass * self%gravity * self%centre_of_mass
    end function weight_moment

    !> Whether inertia and weight are symmetric about body z, whatever the damping.
    pure logical function is_symmetric(self)
        class(body_t), intent(in) :: self
        is_symmetric = is_equal(self%inertia(1), self%inertia(2)) .and. all(abs(self%centre_of_mass(1:2)) <= 0) &
                       .and. all(abs(self%products) <= 0)
    end function is_symmetric

    !> Whether this is a symmetric undamped top about body z with its centre of mass on or above O, without effects:
    !> the Lagrange top, whose motion has a closed-form solution.
    pure logical function is_lagrange(self)
        class(body_t), intent(in) :: self
        is_lagrange = .not. allocated(self%effects)
        if (is_lagrange) is_lagrange = is_symmetric(self) .and. mgl(self) >= 0 .and. all(abs(self%damping) <= 0)
    end function is_lagrange

    !> Whether the nutation of body z, as it was given, has a closed form: it is the symmetry axis of a Lagrange top.
    pure logical function has_closed_nutation(self)
        class(body_t), intent(in) :: self
        has_closed_nutation = is_lagrange(self) .and. .not. self%given%differ
    end function has_closed_nutation

    !> Whether the body moves freely: without damping, gravitational torque and effects.
    pure logical function is_free(self)
        class(body_t), intent(in) :: self
        is_free = .not. allocated(self%effects)
        if (is_free) is_free = all(abs(self%damping) <= 0) .and. all(abs(weight_moment(self)) <= 0)
    end function is_free

    !> Whether its motion has a closed form: that of a Lagrange top, or of a free body.
    pure logical function has_closed_form(self)
        class(body_t), intent(in) :: self
        has_closed_form = self%is_lagrange() .or. self%is_free()
    end function has_closed_form

    !> Unit vector of an axis about which inertia, weight and damping are symmetric; zero if there is none.
    !> For a sphere it points to the centre of mass.
    pure function symmetry_axis(self) result(axis)
        class(body_t), intent(in) :: self
        real(dp) :: axis(3), moment(3)
        integer :: i, j, k
        axis = 0
        moment = self%weight_moment()
        if (norm2(moment) > 0 .and. alike(1, 2) .and. alike(2, 3)) then
            axis = moment / norm2(moment)
            return
        end if
        do i = 3, 1, -1
            j = mod(i, 3) + 1
            k = mod(j, 3) + 1
            if (.not. alike(j, k) .or. .not. all(abs(moment([j, k])) <= 0)) cycle
            axis(i) = 1
            return
        end do

    contains

        !> Whether two body axes have the same inertia and damping.
        pure logical function alike(a, b)
            integer, intent(in) :: a, b
            alike = is_equal(self%inertia(a), self%inertia(b)) .and. is_equal(self%damping(a), self%damping(b))
        end function alike

    end function symmetry_axis

    !> Whether the body axes are not principal axes.
    pure logical function has_products(self)
        class(body_t), intent(in) :: self
        has_products = .not. all(abs(self%products) <= 0)
    end function has_products

    !> Angular momentum about O in body axes, kg m^2/s.
    pure function momentum(self, omega)
        class(body_t), intent(in) :: self
        real(dp), intent(in) :: omega(3) !! angular velocity in body axes, rad/s
        real(dp) :: momentum(3)
        momentum = self%inertia * omega
        if (self%has_products()) then
            momentum = momentum + cshift(self%products, 2) * cshift(omega, 1) + cshift(self%products, 1) * cshift(omega, 2)
        end if
    end function momentum

    !> Gravitational torque about O in body axes, N m: m g Gamma x r (`gamma` is the upward
    !> vertical in body axes).
    pure function torque(self, gamma) result(moment)
        class(body_t), intent(in) :: self
        real(dp), intent(in) :: gamma(3) !! upward vertical in body axes
        real(dp) :: moment(3)
        moment = self%mass * self%gravity * cross(gamma, self%centre_of_mass)
    end function torque

end module spintop_body
