!> Unknown groups, keys and words: the error, with the most similar one that is known.
module spintop_suggestions
    use spintop_diagnostics, only: diagnostics_t, place_t
    use spintop_parameter, only: quoted
    use spintop_parameters, only: parameter_table_t, unit_hint
    use spintop_text, only: abbreviate, join, lower_case, nearest_word, string_t
    implicit none
    private
    public :: refuse_group, refuse_key, suggest_word, own_name, homes_of, names_file

contains

    !> Whether a text names a file by one of the choices, such as `table:FILE`.
    pure logical function names_file(choices, text)
        type(string_t), intent(in) :: choices(:) !! the choices
        character(*), intent(in) :: text !! a value of the input
        integer :: i, colon
        names_file = .false.
        do i = 1, size(choices)
            colon = index(choices(i)%text, ':')
            if (colon > 0 .and. len(text) > colon) names_file = names_file .or. text(:colon) == choices(i)%text(:colon)
        end do
    end function names_file

    !> The error of an unknown group, with the most similar one, or the list of all.
    subroutine refuse_group(table, name, place, diagnostics)
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        character(*), intent(in) :: name !! the unknown name
        type(place_t), intent(in) :: place !! where it stands
        type(diagnostics_t), intent(inout) :: diagnostics !! the error is added
        type(string_t) :: names(size(table%groups))
        character(:), allocatable :: begin
        integer :: i
        begin = name
        do i = 1, size(names)
            names(i)%text = '&' // table%groups(i)%name
            if (index(name, table%groups(i)%name) == 1) begin = table%groups(i)%name ! such as &sweeps_of_tops
        end do
        call diagnostics%error(place, 'unknown group &' // abbreviate(name), suggest_word('&' // begin, names))
    end subroutine refuse_group

    !> The error of an unknown key, with the key that another name stands for, the most similar one, or the list of all.
    subroutine refuse_key(table, group, key, written, place, diagnostics)
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        character(*), intent(in) :: group, key !! group and key in lower case
        character(*), intent(in) :: written !! the key as it stands in the input
        type(place_t), intent(in) :: place !! where it stands
        type(diagnostics_t), intent(inout) :: diagnostics !! the error is added
        type(string_t) :: keys(table%count)
        character(:), allocatable :: hint, own
        integer :: i, found

        hint = unit_hint(table, group // '.' // key)
        own = ''
        if (hint == '' .and. allocated(table%aliases)) own = own_name(key, table%aliases)
        if (own /= '') then
            i = index(own, '.')
            hint = 'did you mean ' // quoted(own(i + 1:))
            if (own(:i - 1) /= group) hint = hint // ' in group &' // own(:i - 1)
            hint = hint // '?'
        else if (hint == '') then
            found = 0
            do i = 1, size(keys)
                if (table%parameters(i)%group /= group) cycle
                found = found + 1
                keys(found)%text = table%parameters(i)%key
            end do
            hint = suggest_word(key, keys(:found))
        end if
        call diagnostics%error(place, 'unknown key ' // quoted(abbreviate(written)) // ' in group &' // group, hint)
    end subroutine refuse_key

    !> The groups that have a key: '&top or &span', '' if none has.
    function homes_of(table, key) result(homes)
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        character(*), intent(in) :: key !! the key as written
        character(:), allocatable :: homes
        integer :: i
        homes = ''
        do i = 1, size(table%groups)
            if (table%find(table%groups(i)%name // '.' // key) == 0) cycle
            if (homes /= '') homes = homes // ' or '
            homes = homes // '&' // table%groups(i)%name
        end do
    end function homes_of

    !> The most similar candidate, or the list of all. Each alias, `other=own`, stands for the candidate after
    !> its equals sign.
    function suggest_word(word, candidates, aliases) result(hint)
        character(*), intent(in) :: word !! the word that was written
        type(string_t), intent(in) :: candidates(:) !! possible words
        character(*), intent(in), optional :: aliases(:) !! each `other=own`
        character(:), allocatable :: hint
        hint = ''
        if (present(aliases)) hint = own_name(word, aliases)
        if (hint == '') hint = nearest_word(word, candidates)
        if (hint /= '') then
            hint = 'did you mean ' // quoted(hint) // '?'
        else
            hint = 'expected one of: ' // join(candidates, ', ')
        end if
    end function suggest_word

    !> The candidate that an alias stands for; '' for words that are not aliases.
    pure function own_name(word, aliases) result(name)
        character(*), intent(in) :: word !! the word that was written
        character(*), intent(in) :: aliases(:) !! each `other=own`
        character(:), allocatable :: name
        integer :: i, equals
        name = ''
        do i = 1, size(aliases)
            equals = index(aliases(i), '=')
            if (aliases(i)(:equals - 1) == lower_case(trim(word))) name = trim(aliases(i)(equals + 1:))
        end do
    end function own_name

end module spintop_suggestions
