!> Selects the columns of a table from the names in a scene.
module spintop_column_choice
    use spintop_case, only: case_t
    use spintop_certificate, only: balls_hint, balls_missing, has_balls
    use spintop_job, only: job_t
    use spintop_problems, only: problems_t
    use spintop_sensitivity, only: is_sensitivity, split_name
    use spintop_studies, only: create_study, listed_studies
    use spintop_study, only: study_t
    use spintop_study_column, only: by_default, categorical, compares, find_column, is_end, needs_effects, needs_exact, &
        proof_group, study_column_t
    use spintop_text, only: append, join, string_t, to_text
    use spintop_uncertainties, only: check_uncertainties
    implicit none
    private
    public :: choose_columns

contains

    !> Selects the columns of a job: the named ones, all, or the default set; problems are reported.
    subroutine choose_columns(study, job, problems)
        class(study_t), intent(in) :: study !! the kind of study
        type(job_t), target, intent(inout) :: job !! with a plan
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(study_column_t), allocatable :: chosen(:)
        integer :: i

        if (job%input%scene%certified) then
            if (.not. study%info%takes_columns) then
                call problems%add('output.certified', study%info%phrase // ' has no certified numbers', 'omit it')
            else if (.not. has_balls()) then
                call problems%add('output.certified', balls_missing, balls_hint)
            end if
        end if
        if (allocated(job%axes%axis)) then
            if (job%axes%varies('uncertainty')) call problems%add('sweep', 'radii are the same in all cases', &
                                                                  'give them in the group uncertainty')
        end if
        associate (named => job%input%scene%columns)
            if (.not. study%info%takes_columns) then
                call check_uncertainties(job%input%scene, .false., problems)
                if (any(named /= '')) then
                    call problems%add('output.columns', 'the columns of this study are fixed', 'omit it')
                end if
                return
            end if
            chosen = pack(study%columns, can_have(study%columns, job%case))
            if (all(named == '')) then
                ! The exact solution is not compared with itself, and the span ends where no event may end the motion earlier.
                chosen = pack(chosen, chosen%is(by_default) .and. .not. (job%plan%exact .and. chosen%is(compares)) .and. &
                              .not. (job%input%scene%stop_at == '' .and. chosen%is(is_end)))
            else
                chosen = pack(chosen, named(1) == 'all' .and. chosen%group /= proof_group)
                do i = merge(2, 1, named(1) == 'all'), size(named)
                    if (is_sensitivity(named(i))) then
                        call add_sensitivity(study, job, i, problems)
                    else if (named(i) /= '') then
                        call add_column(study, job, i, chosen, problems)
                    end if
                end do
            end if
        end associate
        call check_uncertainties(job%input%scene, any(chosen%group == proof_group), problems)
        call move_alloc(chosen, job%columns)
    end subroutine choose_columns

    !> Adds the column that element `i` of the list in the scene names.
    subroutine add_column(study, job, i, columns, problems)
        class(study_t), intent(in) :: study
        type(job_t), intent(in) :: job
        integer, intent(in) :: i
        type(study_column_t), allocatable, intent(inout) :: columns(:)
        type(problems_t), intent(inout) :: problems
        type(study_column_t) :: found
        character(:), allocatable :: name, key

        name = trim(job%input%scene%columns(i))
        key = 'output.columns(' // to_text(i) // ')'
        call find_named(study, job, key, name, found, problems)
        if (found%place == 0) return
        if (any(columns%name == found%name)) then
            call problems%add(key, "column '" // name // "' is named twice", 'name it once')
        else if (found%group == proof_group .and. .not. has_balls()) then
            call problems%add(key, "column '" // name // "': " // balls_missing, balls_hint)
        else
            call check_column(job, key, found, 'omit it', problems)
            columns = [columns, found]
        end if
    end subroutine add_column

    !> Adds the derivative of a column that element `i` of the list in the scene names.
    subroutine add_sensitivity(study, job, i, problems)
        class(study_t), intent(in) :: study
        type(job_t), target, intent(inout) :: job
        integer, intent(in) :: i
        type(problems_t), intent(inout) :: problems
        type(study_column_t) :: found
        character(:), allocatable :: column, name_of_key, key, problem, hint
        integer :: place_of_key
        logical :: is_new

        key = 'output.columns(' // to_text(i) // ')'
        call split_name(trim(job%input%scene%columns(i)), column, name_of_key)
        call find_named(study, job, key, column, found, problems)
        if (found%place > 0) then
            if (found%is(categorical) .or. found%group == proof_group) then
                call problems%add(key, "column '" // column // "' has no derivatives", 'name a column of numbers')
                found%place = 0
            else
                call check_column(job, key, found, 'omit its derivative', problems)
            end if
        end if
        call job%sensitivities%find_key(name_of_key, job%input%table, job%axes, place_of_key, problem, hint)
        if (problem /= '') call problems%add(key, problem, hint)
        if (found%place == 0 .or. place_of_key == 0) return
        call job%sensitivities%add(found, place_of_key, is_new)
        if (.not. is_new) call problems%add(key, "column '" // trim(job%input%scene%columns(i)) // "' is named twice", &
                                            'name it once')
    end subroutine add_sensitivity

    !> Reports a column that the case cannot have, unless other problems leave open what it is.
    subroutine check_column(job, key, column, hint, problems)
        type(job_t), intent(in) :: job
        character(*), intent(in) :: key, hint
        type(study_column_t), intent(in) :: column
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: need
        if (problems%any()) return
        if (can_have(column, job%case)) return
        need = 'the exact solution'
        if (column%is(needs_effects)) need = 'effects'
        call problems%add(key, "column '" // trim(column%quantity()) // "' needs " // need // &
                          ', which this body does not have', hint)
    end subroutine check_column

    !> Whether the table of a case can have a column.
    elemental logical function can_have(column, case)
        type(study_column_t), intent(in) :: column
        type(case_t), intent(in) :: case
        can_have = (case%body%has_closed_form() .or. .not. column%is(needs_exact)) .and. &
                   (allocated(case%given_body%effects) .or. .not. column%is(needs_effects))
    end function can_have

    !> The column of a name; a problem if there is none: the study that has it, its unit, or a similar name. Numbers that are
    !> proved are so in their own unit only.
    subroutine find_named(study, job, key, name, found, problems)
        class(study_t), intent(in) :: study
        type(job_t), intent(in) :: job
        character(*), intent(in) :: key, name
        type(study_column_t), intent(out) :: found !! its place is 0 if there is a problem
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: ending = '_bound'
        class(study_t), allocatable :: other
        type(study_column_t) :: theirs
        type(string_t), allocatable :: owners(:)
        character(:), allocatable :: problem, hint, ignored, ignored_hint
        integer :: last, i

        call find_column(study%columns, name, found, problem, hint)
        if (found%place > 0) then
            if (.not. found%is_converted()) return
            if (.not. job%input%scene%certified .and. found%group /= proof_group) return
            call problems%add(key, "column '" // name // "': a number is proved in the unit of the column only", &
                              "use '" // trim(found%quantity()) // "', which is in " // &
                              trim(study%columns(found%place)%unit))
            found%place = 0
            return
        end if
        allocate (owners(0))
        do i = 1, size(listed_studies)
            call create_study(listed_studies(i), other)
            call find_column(other%columns, name, theirs, ignored, ignored_hint)
            if (theirs%place > 0) call append(owners, other%info%plural)
        end do
        if (size(owners) > 0) then
            last = size(owners)
            if (last > 1) owners(last)%text = join(owners(:last - 1), ', ') // ' and ' // owners(last)%text
            call problems%add(key, study%info%phrase // " has no column '" // name // "': " // owners(last)%text // ' have it', &
                              "omit it, or set another study.kind; `spintop list columns` shows each study's")
            return
        end if
        if (hint == '') hint = '`spintop list columns` shows them all'
        ! Proofs enclose the motion at a time.
        last = max(0, len(name) - len(ending))
        if (name(last + 1:) == ending .and. any(study%columns%name == name(:last))) then
            problem = "column '" // name // "': proofs bound the attitude and the angular velocity at a time, not " // name(:last)
            hint = 'omit it; `spintop list columns` shows the bounds that there are'
        end if
        call problems%add(key, problem, hint, is_certain=.true.)
    end subroutine find_named

end module spintop_column_choice
