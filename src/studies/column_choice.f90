!> The columns that a scene asks for.
module spintop_column_choice
    use spintop_case, only: case_t
    use spintop_columns, only: trajectory_columns, default_trajectory_columns, needs_exact_motion
    use spintop_kinds, only: degree
    use spintop_precision_table, only: precision_columns
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t
    use spintop_sweep_columns, only: sweep_columns, costly_groups
    use spintop_text, only: string_t, nearest_word, to_text
    implicit none
    private
    public :: choose_columns

    !> The columns of a study: their names and units.
    type :: known_columns_t
        type(string_t), allocatable :: name(:), unit(:)
    contains
        procedure :: take
        procedure :: place_of
    end type known_columns_t

    !> How a column would be called that is in degrees.
    character(*), parameter :: degrees = '_deg'

contains

    !> The columns named, all of them, or the default set, by their place in the list of all columns of the
    !> study; with what is wrong about them.
    subroutine choose_columns(scene, case, is_exact, columns, problems)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        logical, intent(in) :: is_exact !! the exact motion itself is computed
        integer, allocatable, intent(out) :: columns(:)
        type(problems_t), intent(inout) :: problems
        type(known_columns_t) :: known
        integer :: i

        if (scene%kind == 'stability' .or. scene%kind == 'work_precision') then
            if (any(scene%columns /= '')) then
                call problems%add('output.columns', 'the table of this study has columns of its own', 'leave it out')
            end if
            return
        end if
        if (scene%kind == 'sweep') then
            call known%take(sweep_columns%name, sweep_columns%unit)
        else
            call known%take(trajectory_columns%name, trajectory_columns%unit)
        end if
        columns = [(i, i=1, size(known%name))]
        if (all(scene%columns == '')) then
            if (scene%kind == 'sweep') then
                columns = pack(columns, [(all(sweep_columns(i)%group /= costly_groups), i=1, size(columns))])
            else
                columns = [(known%place_of(trim(default_trajectory_columns(i))), i=1, size(default_trajectory_columns))]
                columns = pack(columns, can_have(case, columns))
            end if
            ! The exact motion compared with itself says nothing.
            if (is_exact) columns = pack(columns, columns /= known%place_of('orientation_error'))
            ! Nor does the end of the span where nothing may end it sooner.
            if (scene%stop_at == '') columns = pack(columns, columns /= known%place_of('t_end'))
        else if (scene%columns(1) == 'all') then
            if (scene%kind /= 'sweep') columns = pack(columns, can_have(case, columns))
        else
            columns = [integer ::]
            do i = 1, size(scene%columns)
                if (scene%columns(i) == '') cycle
                call take_column(scene, case, known, i, columns, problems)
            end do
        end if
    end subroutine choose_columns

    !> Adds the column that element `i` of the scene's list names.
    subroutine take_column(scene, case, known, i, columns, problems)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(known_columns_t), intent(in) :: known
        integer, intent(in) :: i
        integer, allocatable, intent(inout) :: columns(:)
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: name, key
        integer :: place

        name = trim(scene%columns(i))
        key = 'output.columns(' // to_text(i) // ')'
        place = known%place_of(name)
        if (place == 0) then
            call refuse_unknown(scene, known, key, name, problems)
        else if (any(columns == place)) then
            call problems%add(key, "column '" // name // "' is named twice", 'name it once')
        else
            if (scene%kind /= 'sweep' .and. .not. problems%any()) then
                if (.not. can_have(case, place)) then
                    call problems%add(key, "column '" // name // "' compares with the exact &
                        &motion, and this body has none", 'leave it out')
                end if
            end if
            columns = [columns, place]
        end if
    end subroutine take_column

    !> Tells whose column it is, what unit the column has that is meant, or which is like it.
    subroutine refuse_unknown(scene, known, key, name, problems)
        type(scene_t), intent(in) :: scene
        type(known_columns_t), intent(in) :: known
        character(*), intent(in) :: key, name
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: study, others, hint
        integer :: place, base

        study = 'a ' // trim(scene%kind)
        others = owners_of(name)
        if (others /= '') then
            call problems%add(key, study // " has no column '" // name // "': " // others // ' have it', &
                              "leave it out, or set another study.kind; `spintop list columns` shows each study's")
            return
        end if
        base = len(name) - len(degrees)
        hint = ''
        if (base > 0) then
            place = 0
            if (name(base + 1:) == degrees) place = known%place_of(name(:base))
            if (place > 0) then
                if (index(known%unit(place)%text, 'rad') == 1) hint = "'" // name(:base) // "' is in " &
                    // known%unit(place)%text // ': 1 rad = ' // to_text(1 / degree) // ' deg'
            end if
        end if
        if (hint == '') then
            hint = nearest_word(name, known%name)
            if (hint /= '') hint = "did you mean '" // hint // "'?"
        end if
        if (hint == '') hint = '`spintop list columns` shows them all'
        call problems%add(key, "there is no column '" // name // "'", hint)
    end subroutine refuse_unknown

    !> The kinds of study that have a column of that name, for a reader; '' if none has.
    function owners_of(name) result(owners)
        character(*), intent(in) :: name
        character(:), allocatable :: owners
        owners = ''
        if (any(trajectory_columns%name == name)) call add('trajectories')
        if (any(sweep_columns%name == name)) call add('sweeps')
        if (any(precision_columns%name == name)) call add('work-precision studies')

    contains

        subroutine add(owner)
            character(*), intent(in) :: owner
            if (owners /= '') owners = owners // ' and '
            owners = owners // owner
        end subroutine add

    end function owners_of

    !> Takes names and units of the columns of a study.
    subroutine take(self, names, units)
        class(known_columns_t), intent(inout) :: self
        character(*), intent(in) :: names(:), units(:)
        integer :: i
        allocate (self%name(size(names)), self%unit(size(names)))
        do i = 1, size(names)
            self%name(i)%text = trim(names(i))
            self%unit(i)%text = trim(units(i))
        end do
    end subroutine take

    !> Place of a column among those of the study, 0 if there is none of that name.
    integer function place_of(self, name)
        class(known_columns_t), intent(in) :: self
        character(*), intent(in) :: name
        do place_of = size(self%name), 1, -1
            if (self%name(place_of)%text == name) return
        end do
    end function place_of

    !> Whether a trajectory of the case can have a column: some compare with an exact motion.
    elemental logical function can_have(case, place)
        type(case_t), intent(in) :: case
        integer, intent(in) :: place
        can_have = case%body%is_lagrange() .or. .not. needs_exact_motion(trajectory_columns(place))
    end function can_have

end module spintop_column_choice
