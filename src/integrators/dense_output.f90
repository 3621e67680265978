!> Dense output for Runge-Kutta methods that have none.
!>
!> The states and slopes at both ends of a step determine the cubic Hermite polynomial, with an error of order
!> h^4. Additional slopes increase the degree: level m uses m slopes inside the step, evaluated on the
!> polynomial of level m-1, and has an error of order h^(m+4) (Enright, Jackson, Norsett and Thomsen, ACM TOMS
!> 12, 1986). Up to level m this takes m(m+1)/2 function evaluations per step, for any number of samples.
module spintop_dense_output
    use spintop_kinds, only: dp
    use spintop_formulation, only: max_states
    use spintop_lapack, only: dgetrf, dgetrs
    use spintop_motions, only: instants
    use spintop_status, only: is_ok
    use spintop_stepper, only: run_state_t
    implicit none
    private
    public :: dense_output_t

    !> Highest level, and degree of its polynomial.
    integer, parameter :: max_level = 4, max_degree = max_level + 3
    !> Maximum number of coefficients that are determined by the conditions at the nodes and at the end of the
    !> step.
    integer, parameter :: max_unknowns = max_level + 2

    !> The polynomial of one step, and the factors for its computation.
    type :: dense_output_t
        private
        integer :: level = 0
        !> Factors of the conditions of each level.
        real(dp) :: factors(max_unknowns, max_unknowns, 0:max_level) = 0
        integer :: pivots(max_unknowns, 0:max_level) = 0
        !> The polynomial is sum_k coefficient(:, k) s^k, with s = 0 .. 1 over the step.
        real(dp) :: coefficient(max_states, 0:max_degree) = 0
        integer :: degree = 3
    contains
        procedure :: set_order
        procedure :: fit
        procedure :: at
        procedure :: at_several
    end type dense_output_t

contains

    !> Prepares for a method of an order: the error within a step gets the same order.
    subroutine set_order(self, order)
        class(dense_output_t), intent(inout) :: self
        integer, intent(in) :: order !! order of the method
        integer :: level, node, k, failure

        self%level = max(0, min(order - 4, max_level))
        do level = 0, self%level
            associate (conditions => self%factors(:, :, level))
                ! The unknowns are the coefficients of s^2, s^3, ...: row 1 is the value at the end, row 2 the
                ! slope at the end, the other rows are the slopes inside.
                conditions(1, 1:level + 2) = 1
                do k = 2, level + 3
                    conditions(2, k - 1) = k
                    do node = 1, level
                        conditions(node + 2, k - 1) = k * place(node, level)**(k - 1)
                    end do
                end do
            end associate
            call dgetrf(level + 2, level + 2, self%factors(:, :, level), max_unknowns, &
                        self%pivots(:, level), failure)
        end do
    end subroutine set_order

    !> Position of a node in the step. An odd number of nodes is shifted: for symmetric nodes the slopes alone
    !> would determine the value at the end (Simpson's rule), and the conditions would be dependent.
    pure real(dp) function place(node, level)
        integer, intent(in) :: node, level
        place = (node - mod(level, 2) / 3.0_dp) / (level + 1)
    end function place

    !> Computes the polynomial of the last step of `run`, which began with the slope `slope_last`. If a slope
    !> inside does not exist, the degree reached so far is kept.
    subroutine fit(self, run, slope_last)
        class(dense_output_t), intent(inout) :: self
        class(run_state_t), intent(inout) :: run !! state of the run
        real(dp), intent(in) :: slope_last(max_states) !! slope at the beginning of the step
        real(dp) :: h, slope(max_states), conditions(max_unknowns, max_states)
        integer :: level, node, status, failure

        h = run%t - run%t_last
        self%coefficient = 0
        self%coefficient(:, 0) = run%y_last
        self%coefficient(:, 1) = h * slope_last
        do level = 0, self%level
            conditions(1, :) = run%y - run%y_last - h * slope_last
            conditions(2, :) = h * (run%slope - slope_last)
            do node = 1, level
                call run%evaluate(run%t_last + h * place(node, level), &
                                   self%at(place(node, level)), slope, status)
                if (.not. is_ok(status)) return
                conditions(node + 2, :) = h * (slope - slope_last)
            end do
            call dgetrs('N', level + 2, max_states, self%factors(:, :, level), max_unknowns, &
                        self%pivots(:, level), conditions, max_unknowns, failure)
            self%degree = level + 3
            self%coefficient(:, 2:self%degree) = transpose(conditions(1:level + 2, :))
        end do
    end subroutine fit

    !> The state at a fraction of the step.
    pure function at(self, fraction) result(y)
        class(dense_output_t), intent(in) :: self
        real(dp), intent(in) :: fraction !! position in the step, from 0 to 1
        real(dp) :: y(max_states)
        integer :: k
        y = self%coefficient(:, self%degree)
        do k = self%degree - 1, 0, -1
            y = y * fraction + self%coefficient(:, k)
        end do
    end function at

    !> The states at several fractions of the step, all by the same instructions.
    pure subroutine at_several(self, fraction, y)
        class(dense_output_t), intent(in) :: self
        real(dp), intent(in) :: fraction(instants) !! positions in the step, from 0 to 1
        real(dp), intent(out) :: y(instants, max_states) !! the states
        integer :: k, m
        do m = 1, max_states
            y(:, m) = self%coefficient(m, self%degree)
            do k = self%degree - 1, 0, -1
                y(:, m) = y(:, m) * fraction + self%coefficient(m, k)
            end do
        end do
    end subroutine at_several

end module spintop_dense_output
