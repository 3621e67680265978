!> The rows of a trajectory table, and the quantities of events: values of chosen columns.
module spintop_row_maker
    use spintop_case, only: case_t
    use spintop_certificate, only: proof_words
    use spintop_compare, only: is_finite
    use spintop_exact_motion, only: exact_motion_t
    use spintop_kinds, only: dp
    use spintop_loads, only: works
    use spintop_motion, only: motion_t
    use spintop_motion_view, only: motion_view_t
    use spintop_row_proof, only: wanted_proofs
    use spintop_scene_keys, only: scene_t
    use spintop_study_column, only: categorical, off_poles, proof_group, study_column_t
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trajectory_columns, only: angle_group, longest, fill_vector, vectors
    use spintop_uncertainties, only: data_radii
    implicit none
    private
    public :: row_maker_t

    !> Gives the values of columns, motion by motion.
    type :: row_maker_t
        private
        type(study_column_t), allocatable :: columns(:)
        !> The vectors by their numbers, and the numbers of those of which the columns are components.
        real(dp) :: vectors(longest, vectors) = 0
        integer, allocatable :: needed(:)
        type(motion_view_t) :: view
        !> Whether the angles and their rates are enough for all columns.
        logical :: needs_angles_only = .false.
        !> Whether some columns are in other units than their own.
        logical :: has_converted = .false.
    contains
        procedure :: set
        procedure :: row
        procedure :: wants_angles_of
        procedure :: find_exact_row
        procedure :: is_defined
        procedure :: write_row
        procedure :: proof_summary
        procedure :: close
    end type row_maker_t

contains

    !> Sets the columns of the rows, and the case. Columns that need an exact motion are for bodies that have one. The scene
    !> says what is to be proved, and of which data.
    subroutine set(self, columns, case, scene)
        class(row_maker_t), intent(inout) :: self
        type(study_column_t), intent(in) :: columns(:) !! the columns
        type(case_t), intent(in) :: case !! the case whose motions are shown, in the axes in which its body was given
        type(scene_t), intent(in), optional :: scene !! contents of the input, if numbers may be proved
        integer :: i
        call self%close()
        self%columns = columns
        self%needed = pack([(i, i=1, vectors)], [(any(columns%source == i), i=1, vectors)])
        self%has_converted = any(columns%is_converted())
        call self%view%set(case)
        self%needs_angles_only = .not. case%turn%is_turned() .and. all(columns%group == angle_group)
        if (.not. present(scene)) return
        call self%view%proof%open(wanted_proofs(columns%quantity(), scene%certified), scene%certified, case%given_body, &
                                  case%given_start, data_radii(scene))
    end subroutine set

    !> The row of a motion, which is in the axes of the computation; all but the errors are those of the
    !> body as it was given. That at the start is told as it was given.
    function row(self, computed, as_computed, work) result(values)
        class(row_maker_t), intent(inout) :: self
        type(motion_t), intent(in) :: computed !! the motion in the axes of the computation
        logical, intent(in), optional :: as_computed !! whether the start, too, is shown as it was computed
        real(dp), intent(in), optional :: work(works) !! of effects, J; that of the last motion if it is not given
        real(dp) :: values(size(self%columns))
        if (present(work)) self%view%work = work
        call self%view%set_motion(computed, as_computed)
        call find_values(self, values)
    end function row

    !> Whether the angles and their rates at an instant are enough for a row, which `find_exact_row` then gives: no turns are
    !> to be counted, and no number is to be proved.
    pure logical function wants_angles_of(self, exact)
        class(row_maker_t), intent(in) :: self
        type(exact_motion_t), intent(in) :: exact !! the exact motion of the case
        wants_angles_of = self%needs_angles_only .and. .not. exact%has_to_follow() .and. .not. any(self%view%proof%wanted)
    end function wants_angles_of

    !> The row at a time t of the exact motion, which is much faster than `row` and has the same values.
    subroutine find_exact_row(self, exact, t, values)
        class(row_maker_t), intent(inout) :: self
        type(exact_motion_t), intent(in) :: exact !! the exact motion of the case
        real(dp), intent(in) :: t !! time, s
        real(dp), intent(out) :: values(:) !! the row, one value per column
        real(dp) :: angle(3), rate(3)
        call exact%find_angles(t, angle, rate)
        call self%view%set_angles(t, angle, rate)
        call find_values(self, values)
    end subroutine find_exact_row

    !> The values of the columns for the current motion. A vector is computed once for all of its columns.
    subroutine find_values(self, values)
        class(row_maker_t), intent(inout) :: self
        real(dp), intent(out) :: values(:)
        integer :: i
        do i = 1, size(self%needed)
            call fill_vector(self%needed(i), self%view, self%vectors(:, self%needed(i)))
        end do
        do i = 1, size(self%columns)
            values(i) = self%vectors(self%columns(i)%component, self%columns(i)%source)
        end do
        if (self%has_converted) values = values / self%columns%size
    end subroutine find_values

    !> Whether the last row, given, is finite, but for bounds and for what does not exist at a pole.
    pure logical function is_defined(self, values)
        class(row_maker_t), intent(in) :: self
        real(dp), intent(in) :: values(:) !! the last row, one value per column
        logical :: at_pole
        integer :: i
        is_defined = all(abs(values) <= huge(1.0_dp)) ! faster than calls of is_finite
        if (is_defined) return
        at_pole = abs(sin(self%view%near(2))) <= 4 * epsilon(1.0_dp)
        do i = 1, size(values)
            if (is_finite(values(i)) .or. self%columns(i)%group == proof_group) cycle
            if (.not. (at_pole .and. self%columns(i)%is(off_poles))) return
        end do
        is_defined = .true.
    end function is_defined

    !> Adds the values of a row to a text, those of words as words.
    subroutine write_row(self, values, text)
        class(row_maker_t), intent(in) :: self
        real(dp), intent(in) :: values(:) !! the row, one value per column
        type(text_buffer_t), intent(inout) :: text !! the cells are added
        integer :: i
        do i = 1, size(values)
            if (self%columns(i)%is(categorical)) then
                call text%add_text(trim(proof_words(nint(values(i)))))
            else
                call text%add_reals(values(i:i))
            end if
        end do
    end subroutine write_row

    !> How many rows are proved, and why others are not; empty if no proof was wanted.
    function proof_summary(self) result(text)
        class(row_maker_t), intent(in) :: self
        character(:), allocatable :: text
        text = ''
        if (any(self%view%proof%wanted)) text = self%view%proof%summary()
    end function proof_summary

    !> Gives back the memory of the proof.
    subroutine close(self)
        class(row_maker_t), intent(inout) :: self
        call self%view%proof%close()
    end subroutine close

end module spintop_row_maker
