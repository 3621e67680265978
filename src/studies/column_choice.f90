!> Selects the columns of a table from the names in a scene.
module spintop_column_choice
    use spintop_case, only: case_t
    use spintop_certificate, only: balls_hint, balls_missing, has_balls
    use spintop_job, only: job_t
    use spintop_kinds, only: degree
    use spintop_problems, only: problems_t
    use spintop_sensitivity, only: is_sensitivity, split_name
    use spintop_studies, only: create_study, listed_studies
    use spintop_study, only: study_info_t, study_t
    use spintop_study_column, only: listed_column_t, place_of, proof_group
    use spintop_text, only: append, did_you_mean, join, string_t, to_text
    use spintop_uncertainties, only: check_uncertainties
    implicit none
    private
    public :: choose_columns

    !> Suffix of the name of a column in degrees.
    character(*), parameter :: degrees = '_deg'

contains

    !> Selects the columns of a job: the named ones, all, or the default set, as indices in the list of all
    !> columns of the study; problems are reported.
    subroutine choose_columns(study, job, is_whole, problems)
        class(study_t), intent(in) :: study !! the kind of study
        type(job_t), target, intent(inout) :: job !! with a plan
        logical, intent(in) :: is_whole !! whether the scene is all that the input says: it could be read without errors
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(study_info_t) :: info
        type(listed_column_t), allocatable :: known(:)
        integer, allocatable :: columns(:)
        integer :: i

        info = study%info()
        if (job%scene%certified) call check_certified(info, problems)
        if (allocated(job%axes%axis)) then
            if (job%axes%varies('uncertainty')) call problems%add('sweep', 'radii are the same in all cases', &
                                                                  'give them in the group uncertainty')
        end if
        associate (named => job%scene%columns)
            if (.not. info%takes_columns) then
                call check_uncertainties(job%scene, .false., problems)
                if (any(named /= '')) then
                    call problems%add('output.columns', 'the columns of this study are fixed', 'omit it')
                end if
                return
            end if
            allocate (known, source=study%columns())
            if (all(named == '')) then
                columns = pack([(i, i=1, size(known))], known%is_default .and. can_have(known, job%case))
                ! The exact solution is not compared with itself.
                if (job%plan%exact) columns = pack(columns, .not. known(columns)%compares)
                ! The end of the span is omitted if no event may end the motion earlier.
                if (job%scene%stop_at == '') columns = pack(columns, .not. known(columns)%ends)
            else if (named(1) == 'all') then
                columns = pack([(i, i=1, size(known))], known%group /= proof_group .and. can_have(known, job%case))
            else
                columns = [integer ::]
                do i = 1, size(named)
                    if (is_sensitivity(named(i))) then
                        call add_sensitivity(study, job, known, i, is_whole, problems)
                    else if (named(i) /= '') then
                        call add_column(study, job, known, i, columns, is_whole, problems)
                    end if
                end do
            end if
        end associate
        call check_uncertainties(job%scene, any(known(columns)%group == proof_group), problems)
        call move_alloc(columns, job%columns)
    end subroutine choose_columns

    !> Reports what prevents certified numbers.
    subroutine check_certified(info, problems)
        type(study_info_t), intent(in) :: info
        type(problems_t), intent(inout) :: problems
        if (.not. info%takes_columns) then
            call problems%add('output.certified', info%phrase // ' has no certified numbers', 'omit it')
        else if (.not. has_balls()) then
            call problems%add('output.certified', balls_missing, balls_hint)
        end if
    end subroutine check_certified

    !> Adds the column that element `i` of the list in the scene names.
    subroutine add_column(study, job, known, i, columns, is_whole, problems)
        class(study_t), intent(in) :: study
        type(job_t), intent(in) :: job
        type(listed_column_t), intent(in) :: known(:) !! all columns of the study
        integer, intent(in) :: i
        integer, allocatable, intent(inout) :: columns(:)
        logical, intent(in) :: is_whole
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: name, key
        integer :: place

        name = trim(job%scene%columns(i))
        key = 'output.columns(' // to_text(i) // ')'
        place = place_of(known, name)
        if (place == 0) then
            call refuse_unknown(study, known, key, name, problems)
        else if (any(columns == place)) then
            call problems%add(key, "column '" // name // "' is named twice", 'name it once')
        else if (known(place)%group == proof_group .and. .not. has_balls()) then
            call problems%add(key, "column '" // name // "': " // balls_missing, balls_hint)
        else
            if (is_whole) call check_column(job, key, known(place), 'omit it', problems)
            columns = [columns, place]
        end if
    end subroutine add_column

    !> Adds the derivative of a column that element `i` of the list in the scene names.
    subroutine add_sensitivity(study, job, known, i, is_whole, problems)
        class(study_t), intent(in) :: study
        type(job_t), target, intent(inout) :: job
        type(listed_column_t), intent(in) :: known(:) !! all columns of the study
        integer, intent(in) :: i
        logical, intent(in) :: is_whole
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: column, name_of_key, key, problem, hint
        integer :: place, place_of_key
        logical :: is_new

        key = 'output.columns(' // to_text(i) // ')'
        call split_name(trim(job%scene%columns(i)), column, name_of_key)
        place = place_of(known, column)
        if (place == 0) then
            call refuse_unknown(study, known, key, column, problems)
        else if (known(place)%words .or. known(place)%group == proof_group) then
            call problems%add(key, "column '" // column // "' has no derivatives", 'name a column of numbers')
            place = 0
        else if (is_whole) then
            call check_column(job, key, known(place), 'omit its derivative', problems)
        end if
        call job%sensitivities%find_key(name_of_key, job%table, job%axes, place_of_key, problem, hint)
        if (problem /= '') call problems%add(key, problem, hint)
        if (place == 0 .or. place_of_key == 0) return
        call job%sensitivities%add(place, known(place), place_of_key, is_new)
        if (.not. is_new) call problems%add(key, "column '" // trim(job%scene%columns(i)) // "' is named twice", 'name it once')
    end subroutine add_sensitivity

    !> Reports a column that the case cannot have, unless other problems leave open what it is.
    subroutine check_column(job, key, column, hint, problems)
        type(job_t), intent(in) :: job
        character(*), intent(in) :: key, hint
        type(listed_column_t), intent(in) :: column
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: need
        if (problems%any()) return
        if (can_have(column, job%case)) return
        need = 'the exact solution'
        if (column%needs_effects) need = 'effects'
        call problems%add(key, "column '" // trim(column%name) // "' needs " // need // ', which this body does not have', hint)
    end subroutine check_column

    !> Whether the table of a case can have a column.
    elemental logical function can_have(column, case)
        type(listed_column_t), intent(in) :: column
        type(case_t), intent(in) :: case
        can_have = (case%body%has_closed_form() .or. .not. column%needs_exact_motion) .and. &
                   (allocated(case%given_body%effects) .or. .not. column%needs_effects)
    end function can_have

    !> Reports an unknown column: the study that has it, its unit, or a similar name.
    subroutine refuse_unknown(study, known, key, name, problems)
        class(study_t), intent(in) :: study
        type(listed_column_t), intent(in) :: known(:) !! all columns of the study
        character(*), intent(in) :: key, name
        type(problems_t), intent(inout) :: problems
        type(study_info_t) :: info
        character(:), allocatable :: owners, hint
        integer :: place, base

        info = study%info()
        owners = owners_of(name)
        if (owners /= '') then
            call problems%add(key, info%phrase // " has no column '" // name // "': " // owners // ' have it', &
                              "omit it, or set another study.kind; `spintop list columns` shows each study's")
            return
        end if
        base = len(name) - len(degrees)
        hint = ''
        if (base > 0) then
            place = 0
            if (name(base + 1:) == degrees) place = place_of(known, name(:base))
            if (place > 0) then
                if (index(known(place)%unit, 'rad') == 1) hint = "'" // name(:base) // "' is in " &
                    // trim(known(place)%unit) // ': 1 rad = ' // to_text(1 / degree) // ' deg'
            end if
        end if
        if (hint == '') hint = did_you_mean(name, known%name)
        if (hint == '') hint = '`spintop list columns` shows them all'
        call problems%add(key, "there is no column '" // name // "'", hint)
    end subroutine refuse_unknown

    !> The kinds of study that have a column of that name, as text; '' if there is none.
    function owners_of(name) result(owners)
        character(*), intent(in) :: name
        character(:), allocatable :: owners
        class(study_t), allocatable :: study
        type(study_info_t) :: info
        type(string_t), allocatable :: plurals(:)
        integer :: i, n

        allocate (plurals(0))
        do i = 1, size(listed_studies)
            call create_study(listed_studies(i), study)
            info = study%info()
            if (place_of(study%columns(), name) > 0) call append(plurals, info%plural)
        end do
        n = size(plurals)
        owners = join(plurals(:n - 1), ', ')
        if (n > 1) owners = owners // ' and '
        if (n > 0) owners = owners // plurals(n)%text
    end function owners_of

end module spintop_column_choice
