#ifdef SPINTOP_NETCDF
!> Statistics as NetCDF by netcdf-fortran.
submodule(spintop_statistics_netcdf) statistics_netcdf_written
    use, intrinsic :: iso_fortran_env, only: int64
    use netcdf, only: nf90_64bit_offset, nf90_clobber, nf90_close, nf90_create, nf90_def_dim, nf90_def_var, nf90_double, &
        nf90_ebaddim, nf90_enddef, nf90_enotatt, nf90_get_att, nf90_get_var, nf90_global, nf90_inq_dimid, nf90_inq_varid, &
        nf90_inquire_attribute, nf90_inquire_dimension, nf90_noerr, nf90_nowrite, nf90_open, nf90_put_att, nf90_put_var, &
        nf90_strerror
    use spintop_checksum, only: add_to_checksum, checksum_t, checksum_text
    use spintop_errors, only: output_error
    use spintop_files, only: output_file_t
    use spintop_histogram, only: histogram_t, make_histogram
    use spintop_kinds, only: dp
    use spintop_netcdf_file, only: close_netcdf, confirm_netcdf
    use spintop_netcdf_grid, only: netcdf_name, netcdf_unit
    use spintop_statistics_result, only: columns_before, index_cells, index_row, result_columns, result_row
    use spintop_table_column, only: table_column_t
    use spintop_text, only: split, string_t
    implicit none

    character, parameter :: nl = new_line('a')
    !> Prefix of the variables of all cases.
    character(*), parameter :: of_all = 'all_'

    !> The variables of the Sobol' indices of a column, the place of each in a row of them, and whether it is an interval,
    !> or one number for all factors.
    character(*), parameter :: index_variables(*) = [character(19) :: '_first_order', '_first_order_bounds', &
        '_total', '_total_bounds', '_groups', '_groups_left_out']
    integer, parameter :: index_place(*) = [1, 2, 4, 5, 7, 8]
    logical, parameter :: is_interval(*) = [.false., .true., .false., .true., .false., .false.]
    logical, parameter :: is_count(*) = [.false., .false., .false., .false., .true., .true.]

    !> The file, and the numbers of its dimensions and variables. What is put to it is read in its place, if it is there
    !> already: the checksum is that of what is put, or of what is read.
    type :: netcdf_file_t
        integer :: id = -1, status = nf90_noerr
        logical :: is_read = .false.
        type(checksum_t) :: checksum
        !> Of each column of the result: over the bins (-1: none), and of all cases.
        integer, allocatable :: of_bins(:), of_all(:)
        !> Of each binned quantity: the middles, and the ends.
        integer, allocatable :: middles(:), ends(:)
        !> Of each column of numbers: numbers of cases in its intervals, and the ends of these.
        integer, allocatable :: counts(:), intervals(:)
        !> The factors of Sobol' indices; the variables of each column, as `index_variables` names them.
        integer :: factor = -1
        integer, allocatable :: indices(:, :)
    end type netcdf_file_t

contains

    module procedure write_statistics_netcdf
        type(netcdf_file_t) :: file, found
        type(table_column_t), allocatable :: columns(:)
        type(histogram_t), allocatable :: histograms(:)
        type(output_file_t) :: output
        integer :: i

        allocate (histograms(size(plan%numbers)))
        do i = 1, size(histograms)
            call make_histogram(accumulators, i, histograms(i))
        end do
        columns = result_columns(plan)
        call output%create(path // '.new', error)
        if (allocated(error)) return
        file%status = nf90_create(output%path, ior(nf90_clobber, nf90_64bit_offset), file%id)
        call write_contents(file)
        call close_netcdf(output%path, file%id, file%status, .false., error)
        if (.not. allocated(error)) then
            found%is_read = .true.
            found%status = nf90_open(output%path, nf90_nowrite, found%id)
            call write_contents(found)
            if (found%status /= nf90_noerr) then
                error = output_error('cannot read ' // output%path // ': ' // trim(nf90_strerror(found%status)))
            end if
            found%status = nf90_close(found%id)
        end if
        if (.not. allocated(error)) then
            call confirm_netcdf(output%path, checksum_text(file%checksum) == checksum_text(found%checksum), error)
        end if
        if (.not. allocated(error)) call output%finish_as(path, -1_int64, error)
        call output%discard()

    contains

        subroutine write_contents(file)
            type(netcdf_file_t), intent(inout) :: file
            call add_facts(file, head)
            call define(file, plan, columns, histograms)
            if (file%status == nf90_noerr .and. .not. file%is_read) file%status = nf90_enddef(file%id)
            call write_all(file, plan, columns, accumulators, histograms)
        end subroutine write_contents

    end procedure write_statistics_netcdf

    !> The metadata of the header as attributes of the file.
    subroutine add_facts(file, head)
        type(netcdf_file_t), intent(inout) :: file
        character(*), intent(in) :: head
        type(string_t), allocatable :: lines(:)
        character(:), allocatable :: input
        integer :: i, colon

        call add_text(file, nf90_global, 'Conventions', 'CF-1.8')
        call split(head, nl, lines, keeps_blanks=.true.)
        do i = 1, size(lines)
            if (lines(i)%text == '# input:') exit
            colon = index(lines(i)%text, ': ')
            if (colon > 0) call add_text(file, nf90_global, lines(i)%text(len('# ') + 1:colon - 1), lines(i)%text(colon + 2:))
        end do
        input = ''
        do i = i + 1, size(lines)
            if (lines(i)%text == '# columns:') exit
            input = input // lines(i)%text(min(len('#     '), len(lines(i)%text)) + 1:) // nl
        end do
        if (input /= '') call add_text(file, nf90_global, 'input', input(:len(input) - 1))
    end subroutine add_facts

    !> Defines dimensions and variables.
    subroutine define(file, plan, columns, histograms)
        type(netcdf_file_t), intent(inout) :: file
        type(statistics_plan_t), intent(in) :: plan
        type(table_column_t), intent(in) :: columns(:)
        type(histogram_t), intent(in) :: histograms(:)
        character(:), allocatable :: name
        integer :: bins(size(plan%over)), ends, intervals, i

        allocate (file%of_bins(size(columns)), file%of_all(size(columns)), source=-1)
        allocate (file%middles(size(bins)), file%ends(size(bins)), file%counts(size(histograms)), &
                  file%intervals(size(histograms)), source=-1)
        call add_dimension(file, 'end', 2, ends)
        ! The first varies fastest, and stands last in the file.
        do i = size(bins), 1, -1
            call add_dimension(file, netcdf_name(plan%over(i)%column%name), plan%over(i)%bins%count(), bins(i))
        end do
        do i = 1, size(bins)
            associate (column => plan%over(i)%column)
                call add_variable(file, netcdf_name(column%name), [bins(i)], column, file%middles(i))
                call add_text(file, file%middles(i), 'bounds', netcdf_name(column%name) // '_bounds')
                call add_variable(file, netcdf_name(column%name) // '_bounds', [ends, bins(i)], column, file%ends(i))
            end associate
        end do
        do i = columns_before(plan) + 1, size(columns)
            if (size(bins) > 0 .and. (plan%by_bin .or. index(columns(i)%name, '_q') == 0 .or. &
                                      columns(i)%what(:len('quantile')) /= 'quantile')) then
                call add_variable(file, netcdf_name(columns(i)%name), bins, columns(i), file%of_bins(i))
            end if
            call add_variable(file, of_all // netcdf_name(columns(i)%name), bins(:0), columns(i), file%of_all(i))
        end do
        do i = 1, size(histograms)
            if (size(histograms(i)%counts) == 0) cycle
            name = trim(netcdf_name(plan%numbers(i)%name))
            call add_dimension(file, name // '_interval', size(histograms(i)%counts), intervals)
            call add_variable(file, name // '_interval_bounds', [ends, intervals], plan%numbers(i), file%intervals(i))
            call add_variable(file, name // '_histogram', [intervals], columns(columns_before(plan) + 1), file%counts(i))
        end do
        if (plan%has_indices()) call define_indices(file, plan, ends)
    end subroutine define

    !> Defines the variables of the Sobol' indices: those of each column over the factors, whose names are the meanings
    !> of their numbers.
    subroutine define_indices(file, plan, ends)
        type(netcdf_file_t), intent(inout) :: file
        type(statistics_plan_t), intent(in) :: plan
        integer, intent(in) :: ends !! the dimension of the ends of an interval
        type(table_column_t) :: column
        character(:), allocatable :: names, name
        integer :: i, k, factor

        call add_dimension(file, 'factor', size(plan%factors), factor)
        column%name = 'factor'
        column%what = 'the parameter of an axis'
        call add_variable(file, 'factor', [factor], column, file%factor)
        names = ''
        do i = 1, size(plan%factors)
            names = names // ' ' // trim(plan%factors(i)%name)
        end do
        if (file%status == nf90_noerr .and. .not. file%is_read) then
            file%status = nf90_put_att(file%id, file%factor, 'flag_values', [(real(i - 1, dp), i=1, size(plan%factors))])
        end if
        call add_text(file, file%factor, 'flag_meanings', names(2:))
        allocate (file%indices(size(index_variables), size(plan%numbers)), source=-1)
        do k = 1, size(plan%numbers)
            do i = 1, size(index_variables)
                name = netcdf_name(plan%numbers(k)%name)
                name = trim(name) // trim(index_variables(i))
                column%name = plan%numbers(k)%name
                column%what = what_of(i, trim(plan%numbers(k)%name))
                if (is_count(i)) then
                    call add_variable(file, name, [integer ::], column, file%indices(i, k))
                else if (is_interval(i)) then
                    call add_variable(file, name, [ends, factor], column, file%indices(i, k))
                else
                    call add_variable(file, name, [factor], column, file%indices(i, k))
                    call add_text(file, file%indices(i, k), 'bounds', name // '_bounds')
                end if
            end do
        end do
    end subroutine define_indices

    !> What a variable of Sobol' indices is.
    pure function what_of(variable, name) result(what)
        integer, intent(in) :: variable
        character(*), intent(in) :: name
        character(:), allocatable :: what
        select case (variable)
        case (1)
            what = 'share of the variance of ' // name // ' that is due to a factor alone'
        case (3)
            what = 'share of the variance of ' // name // ' that is due to a factor with all its interactions'
        case (5)
            what = 'groups of cases that have values of ' // name
        case (6)
            what = 'groups with a case that has no value of ' // name
        case default
            what = 'interval of 95 %'
        end select
    end function what_of

    !> Writes the variables of the Sobol' indices.
    subroutine write_indices(file, plan, accumulators)
        type(netcdf_file_t), intent(inout) :: file
        type(statistics_plan_t), intent(in) :: plan
        type(accumulators_t), intent(in) :: accumulators
        real(dp) :: cells(index_cells, size(plan%factors)), values(size(plan%factors)), high(size(plan%factors))
        integer :: i, k, n

        n = size(plan%factors)
        call write_or_read_box(file, file%factor, [(real(i - 1, dp), i=1, n)], [1], [n])
        do k = 1, size(plan%numbers)
            do i = 1, n
                call index_row(accumulators, k, i, cells(:, i))
            end do
            do i = 1, size(index_variables)
                values = cells(index_place(i), :)
                if (is_interval(i)) then
                    high = cells(index_place(i) + 1, :)
                    call write_ends(file, file%indices(i, k), values, high)
                else if (is_count(i)) then
                    call write_or_read_box(file, file%indices(i, k), values(:1), [1], [1])
                else
                    call write_or_read_box(file, file%indices(i, k), values, [1], [n])
                end if
            end do
        end do
    end subroutine write_indices

    !> Writes all variables.
    subroutine write_all(file, plan, columns, accumulators, histograms)
        type(netcdf_file_t), intent(inout) :: file
        type(statistics_plan_t), intent(in) :: plan
        type(table_column_t), intent(in) :: columns(:)
        type(accumulators_t), intent(inout) :: accumulators
        type(histogram_t), intent(in) :: histograms(:)
        real(dp), allocatable :: cells(:, :), row(:)
        integer :: i, k, n, line, lines

        allocate (row(size(columns)))
        call result_row(plan, accumulators, 0_int64, row)
        do i = columns_before(plan) + 1, size(columns)
            call write_or_read_box(file, file%of_all(i), row(i:i), [1], [1])
        end do
        do i = 1, size(histograms)
            if (file%counts(i) < 0) cycle
            associate (histogram => histograms(i))
                call write_or_read_box(file, file%counts(i), real(histogram%counts, dp), [1], [size(histogram%counts)])
                call write_ends(file, file%intervals(i), histogram%from, histogram%to)
            end associate
        end do
        if (plan%has_indices()) call write_indices(file, plan, accumulators)
        if (size(plan%over) == 0) return
        do i = 1, size(plan%over)
            associate (bins => plan%over(i)%bins)
                n = bins%count()
                call write_or_read_box(file, file%middles(i), bins%value, [1], [n])
                call write_ends(file, file%ends(i), bins%edge(:n), bins%edge(2:))
            end associate
        end do
        n = plan%over(1)%bins%count()
        lines = int(plan%bin_count() / n)
        allocate (cells(n, size(columns)))
        do line = 1, lines
            do k = 1, n
                call result_row(plan, accumulators, (line - 1_int64) * n + k, row)
                cells(k, :) = row
            end do
            do i = columns_before(plan) + 1, size(columns)
                if (file%of_bins(i) < 0) cycle
                if (size(plan%over) == 1) then
                    call write_or_read_box(file, file%of_bins(i), cells(:, i), [1], [n])
                else
                    call write_or_read_box(file, file%of_bins(i), cells(:, i), [1, line], [n, 1])
                end if
            end do
        end do
    end subroutine write_all

    !> Writes the ends of bins or intervals.
    subroutine write_ends(file, variable, from, to)
        type(netcdf_file_t), intent(inout) :: file
        integer, intent(in) :: variable
        real(dp), intent(in) :: from(:), to(:)
        real(dp) :: both(2, size(from))
        both(1, :) = from
        both(2, :) = to
        call write_or_read_box(file, variable, reshape(both, [size(both)]), [1, 1], shape(both))
    end subroutine write_ends

    !> Writes a box of a variable; or reads it.
    subroutine write_or_read_box(file, variable, values, start, extent)
        type(netcdf_file_t), intent(inout) :: file
        integer, intent(in) :: variable, start(:), extent(:)
        real(dp), intent(in) :: values(:)
        real(dp) :: cells(size(values))

        if (file%status /= nf90_noerr) return
        cells = values
        if (file%is_read) then
            file%status = nf90_get_var(file%id, variable, cells, start, extent)
        else
            file%status = nf90_put_var(file%id, variable, cells, start, extent)
        end if
        call add_to_checksum(file%checksum, transfer(cells, repeat(' ', size(cells) * (storage_size(cells) / 8))))
    end subroutine write_or_read_box

    subroutine add_dimension(file, name, length, dimension)
        type(netcdf_file_t), intent(inout) :: file
        character(*), intent(in) :: name
        integer, intent(in) :: length
        integer, intent(out) :: dimension
        integer :: found
        dimension = -1
        if (file%status /= nf90_noerr) return
        if (.not. file%is_read) then
            file%status = nf90_def_dim(file%id, name, length, dimension)
            return
        end if
        file%status = nf90_inq_dimid(file%id, name, dimension)
        if (file%status == nf90_noerr) file%status = nf90_inquire_dimension(file%id, dimension, len=found)
        if (file%status == nf90_noerr .and. found /= length) file%status = nf90_ebaddim
    end subroutine add_dimension

    !> Defines a variable that tells of a column.
    subroutine add_variable(file, name, dimensions, column, variable)
        type(netcdf_file_t), intent(inout) :: file
        character(*), intent(in) :: name
        integer, intent(in) :: dimensions(:)
        type(table_column_t), intent(in) :: column
        integer, intent(out) :: variable
        variable = -1
        if (file%status == nf90_noerr) then
            if (file%is_read) then
                file%status = nf90_inq_varid(file%id, name, variable)
            else
                file%status = nf90_def_var(file%id, name, nf90_double, dimensions, variable)
            end if
        end if
        call add_text(file, variable, 'column', trim(column%name))
        call add_text(file, variable, 'long_name', trim(column%what))
        call add_text(file, variable, 'units', netcdf_unit(column%unit))
    end subroutine add_variable

    !> Adds an attribute, unless it is empty; or reads it.
    subroutine add_text(file, variable, name, text)
        type(netcdf_file_t), intent(inout) :: file
        integer, intent(in) :: variable
        character(*), intent(in) :: name, text
        character(:), allocatable :: found
        integer :: length

        if (file%status /= nf90_noerr .or. text == '') return
        found = text
        if (.not. file%is_read) then
            file%status = nf90_put_att(file%id, variable, name, text)
        else
            file%status = nf90_inquire_attribute(file%id, variable, name, len=length)
            if (file%status == nf90_noerr .and. length /= len(text)) file%status = nf90_enotatt
            if (file%status == nf90_noerr) file%status = nf90_get_att(file%id, variable, name, found)
        end if
        call add_to_checksum(file%checksum, found)
    end subroutine add_text

end submodule statistics_netcdf_written
#endif
