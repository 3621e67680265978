!> Tables of loggers as they come, read as tables of measurements: columns with the names of those of trajectories, in their units.
!> The input maps a column to its name in the file, as in `omega1 = gx (dps)`; names of columns with a unit need no mapping.
!>
!>     call read_logger_table(path, 'fit.data(1)', scene%columns, table, problems)
!>     if (.not. problems%any()) call table%read_column('omega1', values, error)
module spintop_logger_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_dates, only: is_date, read_date
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: beside_input, read_file
    use spintop_kinds, only: dp, is_equal, is_finite
    use spintop_loaded_table, only: largest_table, table_t
    use spintop_logger_text, only: logger_column_t, logger_text_t, split_unit
    use spintop_problems, only: problems_t
    use spintop_study_column, only: find_column, place_of, study_column_t
    use spintop_summary, only: rounded
    use spintop_text, only: abbreviate, append, escaped, join, lower_case, replace_all, string_t, to_text
    use spintop_trajectory_columns, only: trajectory_columns
    use spintop_units, only: convert_unit, own_spelling
    implicit none
    private
    public :: logger_table_t, read_logger_table, sigma_mark, base_of, column_named, is_time

    !> What follows the name of a column in that of its standard deviations, row by row.
    character(*), parameter :: sigma_mark = '_sigma'

    !> So many columns at most are named in a message.
    integer, parameter :: most_names = 50

    !> A table of measurements.
    type, extends(table_t) :: logger_table_t
        !> The measured columns that the input names, or '', element by element.
        type(string_t), allocatable :: wanted(:)
        !> What the input may say of the columns, ready to be copied.
        character(:), allocatable :: mapping
        !> The column of the times.
        integer :: clock = 0
        type(logger_column_t), allocatable, private :: sources(:)
        type(logger_text_t), private :: form
    contains
        procedure :: read_column => read_in_own_unit
        procedure :: describe
        procedure, private :: map_columns
        procedure, private :: map
        procedure, private :: use_as
        procedure, private :: read_clock
    end type logger_table_t

contains

    !> Reads a table; what is wrong with it, or with the mapping, is a problem.
    subroutine read_logger_table(path, key, columns, table, problems)
        character(*), intent(in) :: path, key !! path of the file, and the element of the input that names it
        character(*), intent(in) :: columns(:) !! what the input names: `NAME`, or `NAME = NAME OF THE FILE (UNIT)`
        type(logger_table_t), intent(out) :: table !! the table
        type(problems_t), intent(inout) :: problems !! problems are added
        type(diagnostics_t) :: diagnostics
        type(error_t), allocatable :: error
        character(:), allocatable :: text
        integer :: i

        call read_file(path, largest_table, text, error, may_wait=.true., is_text=.true.)
        if (allocated(error)) then
            call problems%add(key, error%message, beside_input)
            return
        end if
        if (index(text, achar(0)) > 0) then
            call problems%add(key, escaped(path) // ': not a text file: it has NUL bytes', 'save it as text in UTF-8')
            return
        end if
        call table%form%find_names(text)
        if (table%form%is_empty) then
            call problems%add(key, escaped(path) // ': the table has no rows', &
                              'expected a line of names, such as t,theta, and below it a row for each time')
            return
        end if
        call move_alloc(table%form%columns, table%sources)
        table%mapping = suggest_mapping(table%sources)
        call table%map_columns(escaped(path), key, columns, problems)
        if (problems%any()) return
        call table%form%rewrite(escaped(path), table%sources, text, error)
        if (.not. allocated(error)) call table%table_t%open('', path, diagnostics, error, text=text)
        if (.not. (allocated(error) .or. diagnostics%has_errors())) then
            do i = 1, size(table%sources)
                table%names(i)%text = table%sources(i)%column
            end do
            call table%read_rows(diagnostics)
        end if
        if (.not. allocated(error)) call diagnostics%raise(error)
        if (allocated(error)) call problems%add(key, error%message, '')
    end subroutine read_logger_table

    !> Finds what the columns of the file are: those that the input maps, and those that are named as columns of trajectories.
    subroutine map_columns(self, path, key, columns, problems)
        class(logger_table_t), intent(inout) :: self
        character(*), intent(in) :: path, key, columns(:)
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: left, problem, hint
        type(study_column_t) :: found
        integer :: i, k, equals

        allocate (self%wanted(size(columns)))
        do i = 1, size(columns)
            self%wanted(i)%text = ''
            if (columns(i) == '') cycle
            equals = index(columns(i), '=')
            left = trim(columns(i))
            problem = ''
            if (equals > 0) then
                left = trim(adjustl(columns(i)(:equals - 1)))
                call self%map(left, trim(adjustl(columns(i)(equals + 1:))), problem, hint)
            end if
            if (equals == 0 .or. .not. (is_time(column_named(left)) .or. base_of(left) /= left)) self%wanted(i)%text = left
            if (problem /= '') call problems%add('fit.columns(' // to_text(i) // ')', problem, hint)
        end do
        if (problems%any()) return
        do i = 1, size(self%sources)
            associate (source => self%sources(i))
                if (source%is_mapped) cycle
                found = column_named(base_of(source%name))
                if (found%place > 0) source%stem = source%name
                found = column_named(base_of(source%stem))
                if (found%place == 0) cycle
                problem = ''
                k = findloc([(self%sources(k)%size > 0 .and. self%sources(k)%column == source%stem, k=1, size(self%sources))], &
                            .true., dim=1)
                if (k == 0 .and. is_time(found)) k = self%clock
                if (k == 0) then
                    call self%use_as(i, source%stem, source%unit, problem, hint)
                else if (self%sources(k)%is_mapped) then
                    source%column = ''
                else
                    problem = "two columns of the table are the same: '" // self%sources(k)%name // "' and '" // source%name // "'"
                    hint = 'map one of them in columns'
                end if
                if (problem /= '') call problems%add(key, path // ': ' // problem, hint)
            end associate
        end do
        if (self%clock > 0 .or. problems%any()) return
        call problems%add(key, path // ': no column of the table is the time', self%mapping)
    end subroutine map_columns

    !> Maps a column of the file.
    subroutine map(self, left, right, problem, hint)
        class(logger_table_t), intent(inout) :: self
        character(*), intent(in) :: left, right !! the name here; that of the file, with or without a unit
        character(:), allocatable, intent(out) :: problem, hint
        type(study_column_t) :: found
        character(:), allocatable :: stem, unit
        real(dp) :: sizes(2)
        logical, allocatable :: is_found(:)
        integer :: i, rule, place

        problem = ''
        hint = self%mapping
        found = column_named(base_of(left))
        if (found%place == 0) then
            call find_column(trajectory_columns, left, found, problem, hint)
            if (hint == '') hint = '`spintop list columns` shows those of trajectories'
            return
        end if
        call split_unit(right, stem, unit)
        do rule = 0, 4
            is_found = [(is_meant(self%sources(i), rule), i=1, size(self%sources))]
            if (any(is_found)) exit
        end do
        place = findloc(is_found, .true., dim=1)
        if (place == 0) then
            problem = "the table has no column '" // right // "'"
        else if (count(is_found) > 1) then
            problem = "the table has several columns '" // right // "'"
            hint = 'give the columns of the file different names'
        else if (any([(self%sources(i)%is_mapped .and. (i == place .or. self%sources(i)%column == left), &
                       i=1, size(self%sources))])) then
            problem = "'" // left // ' = ' // right // "' maps a column twice"
            hint = 'map it once'
        end if
        if (problem /= '') return
        associate (source => self%sources(place))
            if (mod(rule, 2) == 1 .or. rule == 0) unit = source%unit
            if (rule == 4) then
                call find_size(unit, found, sizes(1), problem)
                if (problem /= '') return
                call find_size(source%unit, found, sizes(2), problem)
                if (problem /= '' .or. .not. is_equal(sizes(1), sizes(2))) then
                    problem = "the unit of '" // source%name // "' is " // source%unit // ' in the table, and ' // unit // ' here'
                    hint = "where the table is wrong, write '" // left // ' = ' // source%name // ' (' // unit // ")'"
                    return
                end if
            end if
            source%is_mapped = .true.
            call self%use_as(place, left, unit, problem, hint)
        end associate

    contains

        !> Whether a column is meant: by its name as it stands; in other capitals; with a unit behind it; without its unit; with its
        !> unit written in another way.
        logical function is_meant(source, rule)
            type(logger_column_t), intent(in) :: source
            integer, intent(in) :: rule
            character(:), allocatable :: own, written
            own = source%name
            if (rule > 2) own = source%stem
            written = right
            if (any(rule == [2, 4])) written = stem
            is_meant = own == written .or. (rule > 0 .and. lower_case(own) == lower_case(written))
            if (any(rule == [2, 4])) is_meant = is_meant .and. unit /= ''
        end function is_meant

    end subroutine map

    !> Uses a column of the file as one of trajectories.
    subroutine use_as(self, i, name, given, problem, hint)
        class(logger_table_t), intent(inout) :: self
        integer, intent(in) :: i !! which column of the file
        character(*), intent(in) :: name, given !! its name here, and its unit; '' if none is known
        character(:), allocatable, intent(out) :: problem, hint
        type(study_column_t) :: found
        character(:), allocatable :: unit
        integer :: mark

        problem = ''
        hint = ''
        found = column_named(base_of(name))
        associate (source => self%sources(i))
            source%column = name
            source%size = 1
            if (is_time(found)) self%clock = i
            if (is_time(found) .and. is_date(source%cell)) then
                source%size = 1 / found%size
                source%unit = ''
                return
            end if
            unit = given
            if (unit == '' .and. source%is_mapped) then
                ! A suffix of the name in the file; else that of the name here.
                mark = index(source%name, '_', back=.true.)
                if (mark > 0) call find_size(source%name(mark + 1:), found, source%size, problem)
                if (mark > 0 .and. problem == '') unit = source%name(mark + 1:)
                problem = ''
            end if
            if (unit /= '') then
                call find_size(unit, found, source%size, problem)
                source%unit = own_spelling(unit, trim(found%unit))
            else
                source%size = 1
                if (source%is_mapped .and. found%unit /= '' .and. found%listed_as == '') problem = 'its unit is not known'
            end if
            if (problem == '') return
            problem = "'" // source%name // "': " // problem
            hint = "write it in the mapping, '" // name // ' = ' // source%name // ' (' // usual_unit(trim(found%unit)) // ")'"
        end associate
    end subroutine use_as

    !> The size of a unit in that of a column.
    subroutine find_size(unit, column, size, problem)
        character(*), intent(in) :: unit !! as other programs write it
        type(study_column_t), intent(in) :: column
        real(dp), intent(out) :: size
        character(:), allocatable, intent(out) :: problem
        character(:), allocatable :: own
        own = own_spelling(unit, trim(column%unit))
        if (own == '-') own = '1'
        if (own == '1' .and. column%unit == '') then
            size = 1
            problem = ''
        else
            call convert_unit(own, trim(column%unit), size, problem)
        end if
    end subroutine find_size

    !> A unit that sensors have, for a message.
    pure function usual_unit(unit) result(usual)
        character(*), intent(in) :: unit
        character(:), allocatable :: usual
        usual = unit
        if (unit == 'rad/s') usual = 'deg/s'
        if (unit == 'rad') usual = 'deg'
    end function usual_unit

    !> The name of a column without the mark of standard deviations.
    pure function base_of(name) result(base)
        character(*), intent(in) :: name !! such as `theta_deg_sigma`
        character(:), allocatable :: base
        integer :: mark
        base = name
        mark = len(name) - len(sigma_mark)
        if (mark < 1) return
        if (name(mark + 1:) == sigma_mark) base = name(:mark)
    end function base_of

    !> The column of trajectories of that name; its place is 0 if there is none.
    type(study_column_t) function column_named(name) result(found)
        character(*), intent(in) :: name !! such as `theta_deg`
        character(:), allocatable :: problem, hint
        call find_column(trajectory_columns, name, found, problem, hint)
    end function column_named

    !> Whether a column is the time, in some unit.
    pure logical function is_time(column)
        type(study_column_t), intent(in) :: column !! one of trajectories
        is_time = column%place > 0 .and. column%place == place_of(trajectory_columns, 't')
    end function is_time

    !> The line of the input that maps the columns whose meaning their names and units tell.
    function suggest_mapping(sources) result(mapping)
        type(logger_column_t), intent(in) :: sources(:)
        character(:), allocatable :: mapping, left, entry, unit, problem
        type(string_t), allocatable :: entries(:), lefts(:), names(:)
        type(study_column_t) :: found
        real(dp) :: size_of_unit
        integer :: i, k

        allocate (entries(0), lefts(0), names(0))
        do i = 1, min(size(sources), most_names)
            associate (source => sources(i))
                if (source%name /= '') call append(names, abbreviate(source%name))
                found = column_named(source%stem)
                left = source%stem
                if (found%place == 0) then
                    left = meaning_of(source)
                    found = column_named(left)
                else if (is_time(found)) then
                    left = ''
                end if
                if (left == '' .or. any([(lefts(k)%text == left, k=1, size(lefts))])) cycle
                call append(lefts, left)
                entry = left
                if (left /= source%stem) then
                    entry = left // ' = ' // replace_all(source%name, "'", "''")
                    unit = source%unit
                    if (unit == '') unit = source%name(index(source%name, '_', back=.true.) + 1:)
                    call find_size(unit, found, size_of_unit, problem)
                    if (is_time(found) .and. is_date(source%cell)) problem = ''
                    if (problem /= '') entry = entry // ' (' // usual_unit(trim(found%unit)) // ')'
                end if
                call append(entries, "'" // entry // "'")
            end associate
        end do
        if (size(entries) == 0) then
            mapping = "write as in columns = 't = TIME (ms)', 'omega1 = NAME (deg/s)', with names of the table: " // &
                      join(names, ', ')
        else
            mapping = 'write, with the right units and axes, columns = ' // join(entries, ', ')
        end if
    end function suggest_mapping

    !> The column of trajectories that the unit and the name of a column suggest; '' if none is.
    function meaning_of(source) result(column)
        type(logger_column_t), intent(in) :: source
        character(:), allocatable :: column
        character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz'
        character(*), parameter :: units(3) = [character(5) :: 's', 'rad/s', 'm/s^2'], &
            vectors(3) = [character(13) :: '', 'omega', 'accelerometer']
        character(len(source%stem) + 2) :: name
        character(:), allocatable :: problem
        real(dp) :: factor
        integer :: i, kind

        name = ' ' // lower_case(source%stem)
        kind = 0
        do i = 1, size(units)
            call convert_unit(own_spelling(source%unit, trim(units(i))), trim(units(i)), factor, problem)
            if (problem == '') kind = i
        end do
        column = ''
        if (kind == 0) then
            if (has(['time ', 'clock', 'stamp', 'secon', 'zeit ', 'datum', 'date ']) .or. is_date(source%cell)) kind = 1
            if (kind == 0 .and. name(2:2) == 'a') kind = 3
            if (kind /= 1 .and. (has(['gyr  ', 'omega', 'angul']) .or. scan(name(2:2), 'wg') > 0)) kind = 2
            if (kind == 0 .and. has(['theta', 'tilt ', 'incli'])) column = 'theta'
        end if
        if (kind == 1) column = 't'
        if (kind < 2) return
        do i = 2, len(name) - 1
            if (scan(name(i:i), 'xyz') == 0 .or. scan(name(i + 1:i + 1), letters) > 0) cycle
            column = trim(vectors(kind)) // to_text(index('xyz', name(i:i)))
        end do

    contains

        !> Whether one of some parts is in the name.
        logical function has(parts)
            character(*), intent(in) :: parts(:)
            integer :: k
            has = any([(index(name, trim(parts(k))) > 0, k=1, size(parts))])
        end function has

    end function meaning_of

    !> The numbers of a column in the unit of its name, as `read_column` of other tables.
    subroutine read_in_own_unit(self, name, values, error, takes_empty)
        class(logger_table_t), intent(in) :: self
        character(*), intent(in) :: name !! name of the column
        real(dp), allocatable, intent(out) :: values(:) !! its numbers
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        logical, intent(in), optional :: takes_empty !! whether an empty cell is NaN, and no error
        integer :: i

        i = 0
        if (allocated(self%names)) i = findloc([(self%names(i)%text == name, i=1, size(self%names))], .true., dim=1)
        if (i > 0 .and. i == self%clock) then
            call self%read_clock(values, error)
        else
            call self%table_t%read_column(name, values, error, takes_empty)
            if (i > 0) values = values * self%sources(i)%size
        end if
    end subroutine read_in_own_unit

    !> The times. A clock that the input maps, and dates, are 0 in the first row; counters and clocks of day go on where they wrap.
    subroutine read_clock(self, values, error)
        class(logger_table_t), intent(in) :: self
        real(dp), allocatable, intent(out) :: values(:)
        type(error_t), allocatable, intent(out) :: error
        real(dp), parameter :: day = 86400, counters(*) = [2.0_dp**16, 2.0_dp**32]
        type(string_t), allocatable :: cells(:)
        integer(int64) :: first_day, day_of_row
        integer :: i

        associate (source => self%sources(self%clock))
            if (is_date(source%cell)) then
                allocate (cells, source=self%words(source%column))
                allocate (values(size(cells)))
                do i = 1, size(cells)
                    call read_date(cells(i)%text, day_of_row, values(i))
                    if (i == 1) first_day = day_of_row
                    if (.not. is_finite(values(i))) then
                        error = input_error(self%place_of_row(i) // ": '" // escaped(abbreviate(cells(i)%text)) // "' of '" // &
                            source%name // "' is no date: write 2026-05-31T13:05:22.123 or 13:05:22.123, or give times as numbers")
                        return
                    end if
                    values(i) = values(i) + day * (day_of_row - first_day)
                end do
                if (first_day == 0) call unwrap(values, [day])
            else
                call self%table_t%read_column(source%column, values, error)
                if (allocated(error)) return
                if (source%is_mapped .and. all(is_equal(values, anint(values)))) call unwrap(values, counters)
            end if
            if (source%is_mapped .or. is_date(source%cell)) values = values - values(1)
            values = values * source%size
        end associate
    end subroutine read_clock

    !> Adds a period to what follows a fall, if all steps are then as others are: the first period that explains the falls.
    subroutine unwrap(values, periods)
        real(dp), intent(inout) :: values(:)
        real(dp), intent(in) :: periods(:)
        real(dp), parameter :: longest = 20 ! in mean steps
        real(dp) :: steps(size(values) - 1), step, mean
        integer :: i, k
        logical :: falls(size(values) - 1)

        steps = values(2:) - values(:size(values) - 1)
        falls = steps < 0
        if (.not. any(falls) .or. count(falls) == size(falls)) return
        mean = sum(steps, mask=.not. falls) / count(.not. falls)
        do k = 1, size(periods)
            if (any(values < 0 .or. values > periods(k))) cycle
            if (any(falls .and. (steps + periods(k) > longest * mean .or. steps + periods(k) <= 0))) cycle
            step = 0
            do i = 2, size(values)
                if (falls(i - 1)) step = step + periods(k)
                values(i) = values(i) + step
            end do
            return
        end do
    end subroutine unwrap

    !> What was understood, in two lines: the columns, and the clock.
    subroutine describe(self, columns, t, lines)
        class(logger_table_t), intent(in) :: self
        character(*), intent(in) :: columns(:) !! the measured columns
        real(dp), intent(in) :: t(:) !! the times, s
        type(string_t), intent(out) :: lines(2)
        type(string_t), allocatable :: parts(:)
        character(:), allocatable :: text
        integer :: i, k, n

        allocate (parts(0))
        do k = 1, size(columns)
            do i = 1, size(self%sources)
                if (self%sources(i)%column == columns(k)) call append(parts, trim(columns(k)) // origin(self%sources(i)))
            end do
        end do
        lines(1)%text = join(parts, ', ')
        n = size(t)
        associate (clock => self%sources(self%clock))
            text = trim(clock%column) // origin(clock) // ' from ' // clock%cell // ': ' // to_text(n) // ' rows'
        end associate
        if (n > 1) then
            text = text // ' over ' // rounded(t(n) - t(1)) // ' s, ' // rounded((t(n) - t(1)) / (n - 1)) // ' s apart'
            associate (longest => maxval(t(2:) - t(:n - 1)))
                if (longest > 1.5_dp * (t(n) - t(1)) / (n - 1)) text = text // ', at most ' // rounded(longest) // ' s'
            end associate
        end if
        lines(2)%text = text // '; ' // self%form%describe()

    contains

        !> The name and the unit in the file, where they are others.
        function origin(source) result(text)
            type(logger_column_t), intent(in) :: source
            character(:), allocatable :: text
            text = ''
            if (source%name /= source%column) text = ' = ' // source%name
            if (source%unit /= '' .and. index(source%name, source%unit) == 0) text = text // ' (' // source%unit // ')'
        end function origin

    end subroutine describe

end module spintop_logger_table
