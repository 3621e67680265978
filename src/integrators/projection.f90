!> Projection of a state onto the invariants of the motion, if the user requests it.
!>
!> The drift of an invariant is a measure of the quality of a computation, so nothing is projected without a
!> request.
module spintop_projection
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states, max_invariants
    use spintop_lapack, only: dgelsy
    implicit none
    private
    public :: projection_t, projection_names
    public :: project_nothing, project_unit, project_invariants

    !> Kinds of projection: none, onto unit quaternions, onto all invariants.
    integer, parameter :: project_nothing = 0, project_unit = 1, project_invariants = 2
    character(*), parameter :: projection_names(project_nothing:project_invariants) = &
        [character(10) :: 'none', 'unit', 'invariants']

    !> Maximum number of corrections in one projection.
    integer, parameter :: most_corrections = 3

    !> A projection of the states of one run.
    type :: projection_t
        integer :: kind = project_nothing
        !> The invariants at the start.
        real(dp) :: target(max_invariants) = 0
    contains
        procedure :: begin
        procedure :: apply
    end type projection_t

contains

    !> Stores the invariants of the start `y`.
    pure subroutine begin(self, kind, formulation, y)
        class(projection_t), intent(inout) :: self
        integer, intent(in) :: kind !! kind of projection
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        real(dp), intent(in) :: y(max_states) !! state at the start
        self%kind = kind
        if (kind == project_invariants) call formulation%invariants(y, self%target)
    end subroutine begin

    !> Projects a state; `changed` reports whether it changed.
    subroutine apply(self, formulation, y, changed)
        class(projection_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        real(dp), intent(inout) :: y(max_states) !! state, before and after the projection
        logical, intent(out) :: changed !! whether the state was changed
        type(formulation_info_t) :: info

        changed = self%kind /= project_nothing
        if (.not. changed) return
        info = formulation%info()
        if (self%kind == project_unit) then
            associate (quaternion => y(info%quaternion:info%quaternion + 3))
                quaternion = quaternion / norm2(quaternion)
            end associate
        else
            call restore_invariants(formulation, info, self%target, y)
        end if
    end subroutine apply

    !> The nearest state with the given invariants, by Newton's method, with each variable in units of its
    !> scale. Each correction is the minimum-norm solution of the linearised conditions (Hairer, Lubich and
    !> Wanner, Geometric Numerical Integration, IV.4). An invariant that is stationary at the state, such as
    !> the energy of a sleeping top, is not a condition.
    subroutine restore_invariants(formulation, info, wanted, y)
        class(formulation_t), intent(in) :: formulation
        type(formulation_info_t), intent(in) :: info
        real(dp), intent(in) :: wanted(max_invariants)
        real(dp), intent(inout) :: y(max_states)
        !> Conditions that are linearly dependent to this tolerance are not independent: at an extremum of the
        !> energy, for example.
        real(dp), parameter :: dependent = 1.0e-6_dp
        real(dp) :: values(max_invariants), matrix(max_invariants, max_states)
        real(dp) :: correction(max_states), noise(max_invariants), row_norm, work(64)
        integer :: iteration, i, columns(max_states), rank, failure

        do iteration = 1, most_corrections
            call formulation%invariants(y, values)
            call find_gradients(formulation, info%states, y, matrix, noise)
            correction(:max_invariants) = wanted - values
            do i = 1, info%invariants
                row_norm = norm2(matrix(i, :info%states))
                if (row_norm <= noise(i)) then
                    matrix(i, :) = 0
                    correction(i) = 0
                    cycle
                end if
                matrix(i, :) = matrix(i, :) / row_norm
                correction(i) = correction(i) / row_norm
            end do
            columns = 0
            call dgelsy(info%invariants, info%states, 1, matrix, max_invariants, correction, &
                        max_states, columns, dependent, rank, work, size(work), failure)
            if (failure /= 0) return
            y(:info%states) = y(:info%states) + correction(:info%states) * formulation%scale(:info%states)
            if (maxval(abs(correction(:info%states))) <= epsilon_dp) return
        end do
    end subroutine restore_invariants

    !> Gradients of the invariants with respect to the variables in units of their scales, one per row, by
    !> central differences; and a bound of the computed gradient of a stationary invariant, due to second
    !> derivatives and rounding errors.
    subroutine find_gradients(formulation, states, y, gradient, noise)
        class(formulation_t), intent(in) :: formulation
        integer, intent(in) :: states
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: gradient(max_invariants, max_states)
        real(dp), intent(out) :: noise(max_invariants)
        real(dp) :: moved(max_states), shift
        real(dp), dimension(max_invariants) :: here, above, below
        integer :: j

        gradient = 0
        noise = 0
        call formulation%invariants(y, here)
        do j = 1, states
            if (formulation%cyclic(j)) cycle
            shift = epsilon_dp**(1.0_dp / 3)
            moved = y
            moved(j) = y(j) + shift * formulation%scale(j)
            call formulation%invariants(moved, above)
            moved(j) = y(j) - shift * formulation%scale(j)
            call formulation%invariants(moved, below)
            gradient(:, j) = (above - below) / (2 * shift)
            noise = max(noise, (abs(above - 2 * here + below) + 8 * epsilon_dp * abs(here)) / (2 * shift))
        end do
    end subroutine find_gradients

end module spintop_projection
