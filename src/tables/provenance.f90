!> Provenance of a result: program, build and input, the metadata in the header of every table.
module spintop_provenance
    use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_null_char, c_ptr
    use, intrinsic :: iso_fortran_env, only: compiler_options, compiler_version
    use spintop_files, only: utc_now
    use spintop_process, only: processor_level_name
    use spintop_table_column, only: column_t
    use spintop_table_head, only: format_key, table_format, table_head
    use spintop_text, only: append, string_t
    implicit none
    private
    public :: fact_t, fact_count, program_version, program_revision, gather_facts, header_of

    !> Number of items of the metadata of a table.
    integer, parameter :: fact_count = 11

    !> A key and its value.
    type :: fact_t
        character(:), allocatable :: key, value
    end type fact_t

    !> Version of the program.
    character(*), parameter :: program_version = '0.1.0'

    interface
        !> The git revision of the sources, terminated by a null character.
        function c_revision() bind(C, name='spintop_revision')
            import :: c_ptr
            type(c_ptr) :: c_revision
        end function c_revision
    end interface

contains

    !> The git revision of the build, or 'unknown'.
    function program_revision() result(revision)
        character(:), allocatable :: revision
        integer, parameter :: longest = 128
        character(c_char), pointer :: letters(:)
        integer :: i

        revision = ''
        call c_f_pointer(c_revision(), letters, [longest])
        do i = 1, longest
            if (letters(i) == c_null_char) exit
            revision = revision // letters(i)
        end do
    end function program_revision

    !> Compiler options without folders and macros, which do not change numbers: a build with MPI writes the
    !> same tables as one without, wherever it is made.
    pure function options_that_matter(options) result(text)
        character(*), intent(in) :: options !! each begins with ` -`, except the first
        character(:), allocatable :: text
        integer :: first, next

        text = ''
        first = 1
        do while (first <= len(options))
            next = first + index(options(first:) // ' -', ' -')
            select case (options(first:min(first + 2, len(options))))
            case ('-I ', '-J ', '-D ')
            case default
                text = text // ' ' // options(first:next - 2)
            end select
            first = next
        end do
        text = trim(adjustl(text))
    end function options_that_matter

    !> The metadata of a table, in this order; a value may be empty.
    subroutine gather_facts(title, model, method, dated, facts, body)
        character(*), intent(in) :: title !! title of the study
        character(*), intent(in) :: model, method !! computation of the table
        logical, intent(in) :: dated              !! whether to include the date
        type(fact_t), intent(out) :: facts(fact_count) !! items of the metadata
        character(*), intent(in), optional :: body !! mass properties, if all rows belong to one body
        integer :: n

        n = 0
        call add('title', trim(title))
        call add('program', 'spintop ' // program_version)
        call add(format_key, table_format)
        call add('revision', program_revision())
        call add('compiler', compiler_version())
        call add('options', options_that_matter(compiler_options()))
        call add('processor', processor_level_name())
        call add('date', '')
        if (dated) facts(n)%value = utc_now()
        call add('model', model)
        call add('method', method)
        call add('body', '')
        if (present(body)) facts(n)%value = body

    contains

        subroutine add(key, value)
            character(*), intent(in) :: key, value
            n = n + 1
            facts(n)%key = key
            facts(n)%value = value
        end subroutine add

    end subroutine gather_facts

    !> The header of a table: the line that names a part, `key: value` for each fact, the input, the columns, and remarks.
    function header_of(part, facts, input, columns, remarks) result(head)
        character(*), intent(in) :: part !! '' for the whole
        type(fact_t), intent(in) :: facts(:) !! items of the metadata
        type(string_t), intent(in) :: input(:) !! the resolved namelist
        class(column_t), intent(in) :: columns(:) !! columns of the table
        type(string_t), intent(in), optional :: remarks(:)
        character(:), allocatable :: head, unit
        type(string_t), allocatable :: lines(:)
        integer :: i

        if (part /= '') call append(lines, part)
        do i = 1, size(facts)
            if (facts(i)%value /= '') call append(lines, facts(i)%key // ': ' // facts(i)%value)
        end do
        call append(lines, 'input:')
        do i = 1, size(input)
            call append(lines, '    ' // input(i)%text)
        end do
        call append(lines, 'columns:')
        do i = 1, size(columns)
            unit = ''
            if (columns(i)%unit /= '') unit = ' [' // trim(columns(i)%unit) // ']'
            call append(lines, '    ' // trim(columns(i)%name) // unit // ': ' // trim(columns(i)%what))
        end do
        if (present(remarks)) then
            do i = 1, size(remarks)
                call append(lines, remarks(i)%text)
            end do
        end if
        head = table_head(lines, columns%name)
    end function header_of

end module spintop_provenance
