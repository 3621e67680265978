!> A column of a trajectory table: its description, and the vector with its value.
module spintop_trajectory_column
    use spintop_kinds, only: dp
    use spintop_motion_view, only: motion_view_t
    use spintop_stop_lanes, only: passing_nothing
    use spintop_study_column, only: study_column_t
    use spintop_trajectory_vectors, only: longest, put_vector
    implicit none
    private
    public :: trajectory_column_t, angle_group

    !> The group of the columns of the time, the angles and their rates, which need nothing else of a motion.
    character(*), parameter :: angle_group = 'angles'
    !> Groups of columns that need no angles nor their rates.
    character(*), parameter :: groups_free_of_angles(*) = [character(8) :: 'rates', 'attitude', 'energy', 'momenta']

    !> A column of a trajectory.
    type, extends(study_column_t) :: trajectory_column_t
        !> The number of a vector (`of_...`), and the component of it that is the value of the column.
        integer :: vector = 0, component = 1
        !> What passes a value of the column in a polynomial of each step, if anything does (spintop_stop_lanes).
        integer :: passing = passing_nothing
        !> It is in the table when the input names no columns.
        logical :: is_default = .false.
        !> It compares with the exact motion.
        logical :: needs_exact_motion = .false.
        !> It is for bodies with effects.
        logical :: needs_effects = .false.
        !> It contains the work of effects, which is known in the rows of a motion only.
        logical :: needs_work = .false.
        !> Near a pole it may vary much faster than the attitude turns: it depends on phi or psi.
        logical :: varies_near_poles = .false.
        !> At a pole it does not exist.
        logical :: ends_at_poles = .false.
        !> Its cells are words: `unproved` and `proved` for the values 0 and 1.
        logical :: is_proof = .false.
    contains
        procedure :: is_free_of_angles
        procedure :: value
    end type trajectory_column_t

contains

    !> Whether the value follows from the attitude, the angular velocity and its rate.
    elemental logical function is_free_of_angles(self)
        class(trajectory_column_t), intent(in) :: self
        is_free_of_angles = any(groups_free_of_angles == self%group)
    end function is_free_of_angles

    !> The value of the column for the motion that is looked at.
    real(dp) function value(self, now)
        class(trajectory_column_t), intent(in) :: self
        type(motion_view_t), intent(inout) :: now !! the motion
        real(dp) :: vector(longest)
        call put_vector(self%vector, now, vector)
        value = vector(self%component)
    end function value

end module spintop_trajectory_column
