!> Weights of step errors: the one place where tolerances are applied to the state.
!>
!> An absolute tolerance is in radians for the attitude, and in units of the motion's largest rate and
!> largest momentum for those: `formulation_t%scale`. So step control does not depend on the units of
!> mass, length and time. An angle that counts its turns and on which nothing depends, phi for one,
!> counts as one radian, however often it has gone round, until rounding leaves it no digit.
module spintop_error_weight
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states
    implicit none
    private
    public :: error_weight_t

    !> The errors allowed, prepared for a run.
    type :: error_weight_t
        !> Error allowed for each component whatever its magnitude, and beyond it as a share of that.
        real(dp) :: absolute(max_states) = 0, relative(max_states) = 0
        !> How large each component may become.
        real(dp) :: scale(max_states) = 1
        !> MATLAB's rule: the magnitude below which a component's error counts absolutely.
        real(dp) :: threshold(max_states) = 0
        logical, private :: cyclic(max_states) = .false.
    contains
        procedure :: set
        procedure :: allowed
        procedure :: magnitude
        procedure :: matlab_magnitude
    end type error_weight_t

    !> Smallest error that can be asked for, as a share of a number.
    real(dp), parameter :: rounding = 8 * epsilon_dp

contains

    !> Prepares for a motion of a formulation that was set up for it.
    pure subroutine set(self, formulation, relative, absolute)
        class(error_weight_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: relative, absolute !! tolerances
        type(formulation_info_t) :: info

        self%scale = formulation%scale
        self%absolute = absolute * self%scale
        self%relative = relative
        self%cyclic = formulation%cyclic
        where (self%cyclic)
            self%absolute = (absolute + relative) * self%scale
            self%relative = rounding
        end where
        info = formulation%info()
        self%threshold = absolute / relative
        ! The paper's formulations have angles for a state, and none a quaternion: with them MATLAB's
        ! rule has MATLAB's meaning, in SI units.
        if (info%quaternion > 0) self%threshold = self%threshold * self%scale
    end subroutine set

    !> Error allowed for each component in a step from a state to another.
    pure function allowed(self, y, y_new)
        class(error_weight_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), y_new(max_states)
        real(dp) :: allowed(max_states)
        allowed = self%absolute + self%relative * max(abs(y), abs(y_new))
    end function allowed

    !> Magnitude of each component of a state by which its error is judged.
    pure function magnitude(self, y)
        class(error_weight_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp) :: magnitude(max_states)
        magnitude = merge(self%scale, abs(y), self%cyclic)
    end function magnitude

    !> Magnitude by which MATLAB's step control divides an error, before it compares it with the
    !> relative tolerance (Shampine and Reichelt, SIAM J. Sci. Comput. 18, 1997).
    pure function matlab_magnitude(self, y, y_new) result(magnitude)
        class(error_weight_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), y_new(max_states)
        real(dp) :: magnitude(max_states)
        magnitude = max(abs(y), abs(y_new), self%threshold)
    end function matlab_magnitude

end module spintop_error_weight
