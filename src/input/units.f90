!> Units of numbers: what '2000 rpm' or '3 g cm^2' is in the unit of a key, rad/s or kg m^2.
!>
!>     call convert_unit('rpm', 'rad/s', factor, problem)           ! 2 pi/60
!>     call find_unit('deg', 'rad/s', unit, factor, problem)        ! deg/s, pi/180: the unit of phi_rate_deg
!>
!> A unit is a product of words with exponents, divided by others: `kg m^2`, `g*cm^2`, `deg/s`, `m/s^2`, `1/s`. A solidus divides
!> by the next word.
module spintop_units
    use spintop_kinds, only: dp, pi
    use spintop_text, only: append, join, lower_case, nearest_word, string_t, strings_of, to_text
    implicit none
    private
    public :: convert_unit, find_unit, suffixes_of, units_of, is_unit_word, own_spelling

    !> A word: its size in the units of the SI, and the exponents of kg, m, s and rad. An angle is a dimension of its own here, so
    !> that degrees are not taken for numbers.
    type :: word_t
        character(8) :: name
        real(dp) :: size
        integer :: exponents(4)
    end type word_t

    integer, parameter :: mass(4) = [1, 0, 0, 0], length(4) = [0, 1, 0, 0], time(4) = [0, 0, 1, 0], angle(4) = [0, 0, 0, 1]
    integer, parameter :: rate(4) = angle - time, force(4) = mass + length - 2 * time, energy(4) = force + length

    !> The words that are known.
    type(word_t), parameter :: words(*) = [ &
        word_t('kg', 1.0_dp, mass), word_t('g', 1.0e-3_dp, mass), word_t('mg', 1.0e-6_dp, mass), word_t('t', 1.0e3_dp, mass), &
        word_t('lb', 0.45359237_dp, mass), word_t('oz', 0.028349523125_dp, mass), &
        word_t('m', 1.0_dp, length), word_t('cm', 1.0e-2_dp, length), word_t('mm', 1.0e-3_dp, length), &
        word_t('um', 1.0e-6_dp, length), word_t('km', 1.0e3_dp, length), word_t('in', 0.0254_dp, length), &
        word_t('ft', 0.3048_dp, length), &
        word_t('s', 1.0_dp, time), word_t('ms', 1.0e-3_dp, time), word_t('us', 1.0e-6_dp, time), word_t('ns', 1.0e-9_dp, time), &
        word_t('min', 60.0_dp, time), &
        word_t('h', 3600.0_dp, time), word_t('d', 86400.0_dp, time), &
        word_t('rad', 1.0_dp, angle), word_t('mrad', 1.0e-3_dp, angle), word_t('deg', pi / 180, angle), &
        word_t('mdeg', 1.0e-3_dp * pi / 180, angle), &
        word_t('rev', 2 * pi, angle), word_t('turn', 2 * pi, angle), word_t('turns', 2 * pi, angle), &
        word_t('rpm', 2 * pi / 60, rate), word_t('rps', 2 * pi, rate), &
        word_t('N', 1.0_dp, force), word_t('mN', 1.0e-3_dp, force), word_t('kN', 1.0e3_dp, force), &
        word_t('g0', 9.80665_dp, length - 2 * time), word_t('mg0', 9.80665e-3_dp, length - 2 * time), &
        word_t('J', 1.0_dp, energy), word_t('mJ', 1.0e-3_dp, energy), word_t('kJ', 1.0e3_dp, energy), &
        word_t('1', 1.0_dp, [0, 0, 0, 0])]

    !> Their names, for messages.
    character(*), parameter :: unit_words = 'kg, g, m, cm, mm, s, ms, min, h, rad, deg, rev, rpm, N, J'

    !> What a number of degrees may have, as UTF-8.
    character(*), parameter :: degree_sign = char(194) // char(176)
    character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz'

    !> Each `other=unit`: what is written elsewhere, in small letters, and the unit here.
    character(*), parameter :: other_words(*) = [character(18) :: &
        'hz=rev/s', 'cycle=rev', 'cycles=rev', 'revs=rev', 'revolution=rev', 'revolutions=rev', 'u=rev', 'r=rev', &
        'dps=deg/s', 'mdps=mdeg/s', &
        'degree=deg', 'degrees=deg', 'radian=rad', 'radians=rad', &
        'sec=s', 'secs=s', 'second=s', 'seconds=s', 'msec=ms', 'millis=ms', 'milliseconds=ms', 'usec=us', 'micros=us', &
        'microseconds=us', 'nanoseconds=ns', 'minute=min', 'minutes=min', 'hr=h', 'hour=h', 'hours=h', 'day=d', 'days=d', &
        'meter=m', 'metre=m', 'meters=m', 'metres=m', 'inch=in', 'gram=g', 'grams=g', &
        'newton=N', 'joule=J', 'kgm=kg m', 'gcm=g cm', 'nm=N m', 'nms=N m s', 'ncm=N cm', 'js=J s']

contains

    !> The unit that is meant by a word which is none: one that differs in capitals, or is of another name; '' for others.
    pure function meant_unit(word) result(unit)
        character(*), intent(in) :: word
        character(:), allocatable :: unit
        integer :: i, equals
        unit = ''
        do i = 1, size(other_words)
            equals = index(other_words(i), '=')
            if (other_words(i)(:equals - 1) == lower_case(word)) unit = trim(other_words(i)(equals + 1:))
        end do
        if (unit /= '') return
        do i = 1, size(words)
            if (lower_case(trim(words(i)%name)) == lower_case(word)) unit = trim(words(i)%name)
        end do
    end function meant_unit

    !> The unit most similar to a word, also by its other names; '' if none is.
    pure function similar_unit(word) result(unit)
        character(*), intent(in) :: word
        character(:), allocatable :: unit
        type(string_t) :: names(size(words) + size(other_words))
        integer :: i
        names = strings_of([character(18) :: words%name, other_words])
        do i = 1, size(names)
            names(i)%text = names(i)%text(:index(names(i)%text // '=', '=') - 1)
        end do
        unit = nearest_word(word, names)
        if (meant_unit(unit) /= '') unit = meant_unit(unit)
    end function similar_unit

    !> The unit that other programs mean, in the words here: `deg/s` of `dps` and of a degree sign with `/sec`, `m/s^2` of `m/s2`,
    !> `g0` of `g` where an acceleration is wanted. What is not known stays as it is.
    pure function own_spelling(text, wanted) result(unit)
        character(*), intent(in) :: text !! in ASCII, UTF-8 or Latin-1
        character(*), intent(in) :: wanted !! the unit of the quantity
        character(:), allocatable :: unit, piece
        integer :: i, at, after

        unit = ''
        do i = 1, len_trim(text)
            piece = text(i:i)
            select case (iachar(piece))
            case (194, 206, 226, 129) ! the first bytes of the signs below
                cycle
            case (176, 186) ! degree signs
                piece = 'deg'
            case (178, 179) ! exponents 2 and 3
                piece = achar(iachar(piece) - 128)
            case (185) ! exponent 1
                piece = '1'
            case (187) ! exponent -
                piece = '-'
            case (181, 188) ! Greek mu
                piece = 'u'
            case (183) ! product
                piece = ' '
            end select
            at = len(unit)
            if (at > 0) then
                if (piece == '*' .and. unit(at:) == '*') then
                    unit(at:) = '^'
                    cycle
                end if
                if (scan(piece, '+-123456789') > 0 .and. scan(lower_case(unit(at:)), letters) > 0) piece = '^' // piece
            end if
            unit = unit // piece
        end do
        at = 1
        do while (at <= len(unit))
            after = at - 1 + scan(unit(at:) // ' ', ' */^')
            piece = unit(at:after - 1)
            if (all(words%name /= piece)) piece = meant_unit(piece)
            if (piece == '') piece = unit(at:after - 1)
            unit = unit(:at - 1) // piece // unit(after:)
            at = at + len(piece) + 1
        end do
        if (wanted == 'm/s^2' .and. any(unit == ['g ', 'mg'])) unit = unit // '0'
    end function own_spelling

    !> The factor by which a number in one unit is a number in another; `problem` says why there is none, or is ''.
    subroutine convert_unit(given, wanted, factor, problem)
        character(*), intent(in) :: given !! the unit of the number
        character(*), intent(in) :: wanted !! the unit of the key or column
        real(dp), intent(out) :: factor !! 1 if there is a problem
        character(:), allocatable, intent(out) :: problem !! why it cannot be converted
        real(dp) :: size_given, size_wanted
        integer :: of_given(4), of_wanted(4), per_angle(4)

        factor = 1
        call parse(trim(adjustl(given)), size_given, of_given, problem)
        if (problem /= '') return
        call parse(trim(adjustl(wanted)), size_wanted, of_wanted, problem)
        ! A torque per power of a rate, such as that of damping, has an angle too: N m s/rad for N m s.
        per_angle = of_wanted
        if (all(of_wanted([1, 2, 4]) == [1, 2, 0])) per_angle(4) = -(of_wanted(3) + 2)
        if (problem /= '' .or. wanted == '') then
            problem = 'a number without a unit is wanted'
            if (wanted /= '') problem = 'a number in ' // trim(wanted) // ' is wanted, without a unit'
        else if (any(of_given /= of_wanted) .and. any(of_given /= per_angle)) then
            problem = trim(adjustl(given)) // ' is no unit of a quantity in ' // trim(wanted)
            if (all(of_given(:3) == of_wanted(:3)) .and. of_given(4) == 0) problem = problem // ': an angle is missing in it'
        else
            factor = size_given / size_wanted
        end if
    end subroutine convert_unit

    !> The unit that a suffix of the name of a quantity stands for: a word of its dimension, as `rpm` of rad/s, or a word in the
    !> place of the first one of its unit, as `deg` of rad/s, which is deg/s.
    subroutine find_unit(suffix, wanted, unit, factor, problem)
        character(*), intent(in) :: suffix !! a word
        character(*), intent(in) :: wanted !! the unit of the quantity
        character(:), allocatable, intent(out) :: unit !! that of the suffix
        real(dp), intent(out) :: factor !! the quantity is the number in the unit of the suffix times this; 1 if there is a problem
        character(:), allocatable, intent(out) :: problem !! why it is no unit of the quantity, or ''
        character(:), allocatable :: rest, other_problem

        unit = suffix
        call convert_unit(suffix, wanted, factor, problem)
        if (problem == '' .or. .not. is_unit_word(suffix)) return
        rest = trim(wanted(scan(wanted // ' ', ' */^'):))
        if (rest == '') return
        call convert_unit(suffix // rest, wanted, factor, other_problem)
        if (other_problem /= '') return
        unit = suffix // rest
        problem = ''
    end subroutine find_unit

    !> The suffixes that the name of a quantity can have, and the unit of each.
    subroutine suffixes_of(wanted, suffixes, units)
        character(*), intent(in) :: wanted !! the unit of the quantity
        type(string_t), allocatable, intent(out) :: suffixes(:) !! in the order of the table; none of a number without a unit
        type(string_t), allocatable, intent(out), optional :: units(:) !! as many
        character(:), allocatable :: unit, problem
        real(dp) :: factor
        integer :: i

        allocate (suffixes(0))
        if (present(units)) allocate (units(0))
        do i = 1, size(words)
            call find_unit(trim(words(i)%name), wanted, unit, factor, problem)
            if (problem /= '') cycle
            call append(suffixes, trim(words(i)%name))
            if (present(units)) call append(units, unit)
        end do
    end subroutine suffixes_of

    !> Units of a quantity, for messages.
    function units_of(wanted) result(text)
        character(*), intent(in) :: wanted !! the unit of the quantity
        character(:), allocatable :: text
        character(*), parameter :: of_many(2) = [character(5) :: 'rad/s', 'm/s^2'] ! of which there are words, as rpm
        type(string_t), allocatable :: suffixes(:), units(:)
        character(:), allocatable :: unit, problem
        real(dp) :: factor
        integer :: i

        unit = wanted
        do i = 1, size(of_many)
            call convert_unit(wanted, trim(of_many(i)), factor, problem)
            if (problem == '') unit = trim(of_many(i))
        end do
        call suffixes_of(unit, suffixes, units)
        if (size(units) == 0) call append(units, wanted)
        text = 'units are ' // join(units, ', ')
        if (wanted == '') text = 'write it without a unit'
    end function units_of

    !> Whether a text is the name of a unit.
    pure logical function is_unit_word(text)
        character(*), intent(in) :: text !! any text
        integer :: i
        is_unit_word = any([(words(i)%name == text .and. any(words(i)%exponents /= 0), i=1, size(words))])
    end function is_unit_word

    !> Size and dimension of a unit.
    subroutine parse(text, total, exponents, problem)
        character(*), intent(in) :: text
        real(dp), intent(out) :: total
        integer, intent(out) :: exponents(4)
        character(:), allocatable, intent(out) :: problem
        character(:), allocatable :: name
        integer :: at, after, power, sign_of_power, status, i
        logical :: is_known

        total = 1
        exponents = 0
        problem = ''
        at = 1
        sign_of_power = 1
        do while (at <= len(text))
            if (scan(text(at:at), ' *') > 0) then
                at = at + 1
                cycle
            else if (text(at:at) == '/') then
                sign_of_power = -1
                at = at + 1
                cycle
            end if
            after = scan(text(at:) // ' ', ' */^') + at - 1
            name = text(at:after - 1)
            if (name == degree_sign) name = 'deg'
            power = 1
            at = after
            if (text(at:min(at, len(text))) == '^') then
                ! One digit, with a sign or without.
                after = verify(text(at + 1:) // ' ', '+-0123456789') + at
                read (text(at + 1:after - 1), *, iostat=status) power
                if (status /= 0 .or. after == at + 1 .or. abs(power) > 9) problem = "'" // text // &
                    "' has no whole exponent at " // to_text(at)
                at = after
            end if
            if (problem /= '') return
            is_known = .false.
            do i = 1, size(words)
                if (words(i)%name /= name) cycle
                is_known = .true.
                total = total * words(i)%size**(sign_of_power * power)
                exponents = exponents + sign_of_power * power * words(i)%exponents
            end do
            if (.not. is_known) then
                problem = "'" // name // "' is not a unit"
                if (meant_unit(name) /= '') then
                    problem = problem // ': write ' // meant_unit(name)
                else if (similar_unit(name) /= '') then
                    problem = problem // "; did you mean '" // similar_unit(name) // "'?"
                else
                    problem = problem // ' (' // unit_words // ' and products of these are)'
                end if
                return
            end if
            sign_of_power = 1
        end do
    end subroutine parse

end module spintop_units
