!> Weights of step errors: what the tolerances admit of each component of the state. The norms of the errors belong to the
!> methods: `try_step` in ode45.f90, dop853_error.h, `length_of_step` in series_terms.h for one body by Taylor series, and
!> `choose_durations` in lane_steps.f90 for many.
!>
!> An absolute tolerance is in radians for the attitude, and relative to the largest rate and the largest
!> momentum of the motion for those: `formulation_t%scale`. Step control therefore does not depend on the
!> units of mass, length and time. An angle that counts its turns and on which the motion does not depend,
!> such as phi, counts as one radian, for any number of turns, until rounding leaves no digit of it.
module spintop_error_tolerances
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states
    implicit none
    private
    public :: error_weight_t

    !> The admissible errors, prepared for a run.
    type :: error_weight_t
        !> Absolute part of the admissible error of each component, and the part relative to its magnitude.
        real(dp) :: absolute(max_states) = 0, relative(max_states) = 0
        !> Scale of each component.
        real(dp) :: scale(max_states) = 1
        !> MATLAB's rule: the magnitude below which the error of a component is absolute.
        real(dp) :: threshold(max_states) = 0
        !> Number of components in use.
        integer :: states = 0
        logical, private :: cyclic(max_states) = .false.
    contains
        procedure :: set
        procedure :: allowed
        procedure :: matlab_magnitude
    end type error_weight_t

    !> Smallest error that can be required, relative to a number.
    real(dp), parameter :: rounding = 8 * epsilon_dp

contains

    !> Prepares for a motion, for which the formulation has been prepared.
    pure subroutine set(self, formulation, relative, absolute)
        class(error_weight_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
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
        self%states = info%states
        self%threshold = absolute / relative
        ! The formulations of the paper have angles as a state, and no quaternion. For them MATLAB's rule has
        ! its original meaning, in SI units.
        if (info%quaternion > 0) self%threshold = self%threshold * self%scale
    end subroutine set

    !> Admissible error of each component in a step between two states.
    pure function allowed(self, y, y_new)
        class(error_weight_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), y_new(max_states) !! states at the beginning and at the end of the step
        real(dp) :: allowed(max_states)
        allowed = self%absolute + self%relative * max(abs(y), abs(y_new))
    end function allowed

    !> Magnitude by which MATLAB's step control divides an error, before it compares the ratio with the
    !> relative tolerance (Shampine and Reichelt, SIAM J. Sci. Comput. 18, 1997).
    pure function matlab_magnitude(self, y, y_new) result(magnitude)
        class(error_weight_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), y_new(max_states) !! states at the beginning and at the end of the step
        real(dp) :: magnitude(max_states)
        magnitude = max(abs(y), abs(y_new), self%threshold)
    end function matlab_magnitude

end module spintop_error_tolerances
