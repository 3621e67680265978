!> Methods whose Butcher tables are in files that a scene names: `table:FILE` in place of the name of a method.
!>
!> A file is read once; its name in the scene then ends in `@` and its checksum, so that the resolved input stands for these
!> coefficients, and a file that has changed is refused.
module spintop_own_butcher_tables
    use spintop_arkode, only: create_tableau_stepper, parse_tableau, tableau_info, tableau_t
    use spintop_checksum, only: checksum_of, checksum_width
    use spintop_errors, only: error_t
    use spintop_files, only: beside_input, path_from, read_file
    use spintop_formulation, only: formulation_info_t
    use spintop_formulations, only: formulation_infos
    use spintop_methods, only: create_stepper, method_infos
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t, table_prefix
    use spintop_stepper, only: method_info_t, stepper_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: read_tables, create_method, infos_of_methods, infos_of_tables, names_of_methods, path_of_table

    !> The key of the method of a scene, which has no room for a formulation.
    character(*), parameter :: own_method = 'integration.method'
    !> Maximum size of a file, bytes.
    integer, parameter :: most_bytes = 65536

contains

    !> Reads and checks the tables; problems are reported, and such a method is `auto` or left out.
    subroutine read_tables(input, scene, problems)
        character(*), intent(in) :: input !! path of the input: those of tables are relative to it
        type(scene_t), intent(inout) :: scene !! its tables are set, and the names of their methods get checksums
        type(problems_t), intent(inout) :: problems !! problems of the scene are added

        if (allocated(scene%tableaus)) deallocate (scene%tableaus)
        allocate (scene%tableaus(0))
        call read_one(own_method, scene%method)
        if (scene%method == '') scene%method = 'auto'
        call read_list('work_precision.methods', scene%precision_methods)
        call read_list('stability.methods', scene%stability_methods)
        call read_list('benchmark.methods', scene%benchmark_methods)

    contains

        !> Reads the tables among the methods of a list.
        subroutine read_list(key, names)
            character(*), intent(in) :: key
            character(*), intent(inout) :: names(:)
            integer :: i
            do i = 1, size(names)
                call read_one(key // '(' // to_text(i) // ')', names(i))
            end do
        end subroutine read_list

        !> Reads the table of a method, if it has one. The name becomes blank if there is a problem.
        subroutine read_one(key, name)
            character(*), intent(in) :: key
            character(*), intent(inout) :: name
            type(tableau_t) :: tableau
            type(error_t), allocatable :: error
            character(:), allocatable :: text, problem, hint, path, form, given
            integer :: i

            if (index(name, table_prefix) /= 1) return
            path = path_of_table(name)
            form = form_of(name)
            given = name(len(table_prefix) + len(path) + 1:len_trim(name) - len(form))
            if (form /= '' .and. key == own_method) then
                call problems%add(key, "'" // trim(name) // "' names a formulation as well", &
                                  "give it as integration.formulation = '" // form(2:) // "'")
                name = ''
                return
            end if
            name = ''
            call read_file(path_from(input, path), most_bytes, text, error, is_text=.true.)
            if (allocated(error)) then
                call problems%add(key, error%message, beside_input)
                return
            end if
            if (given /= '' .and. given /= '@' // checksum_of(text)) then
                call problems%add(key, 'the table of coefficients has changed: its checksum is ' // checksum_of(text), &
                                  'omit @ and the checksum to accept any table')
                return
            end if
            call parse_tableau(text, tableau, problem)
            call name_method(path, tableau, problem, hint)
            if (problem /= '') then
                call problems%add(key, problem, hint)
                return
            end if
            tableau%key = table_prefix // path // '@' // checksum_of(text)
            if (len_trim(tableau%key) + len(form) > len(name)) then
                call problems%add(key, "the path of the table is too long: '" // path // "'", &
                                  'at most ' // to_text(len(name) - checksum_width - 1 - len(table_prefix) - len(form)) // ' bytes')
                return
            end if
            name = trim(tableau%key) // form
            do i = 1, size(scene%tableaus)
                if (scene%tableaus(i)%key == tableau%key) return
                if (scene%tableaus(i)%name /= tableau%name) cycle
                call problems%add(key, "two tables are called '" // trim(tableau%name) // "'", 'rename one of the files')
                return
            end do
            scene%tableaus = [scene%tableaus, tableau]
        end subroutine read_one

    end subroutine read_tables

    !> Names the method of a table as its file, without the ending, or says what is wrong with it, or with its text.
    subroutine name_method(path, tableau, problem, hint)
        character(*), intent(in) :: path
        type(tableau_t), intent(inout) :: tableau
        character(:), allocatable, intent(inout) :: problem !! that of the text, and then of both; '' if there is none
        character(:), allocatable, intent(out) :: hint
        integer :: i
        hint = 'doc/methods.md, "Own tables", has an example'
        if (problem /= '') then
            problem = path // ', ' // problem
            return
        end if
        associate (base => path(index(path, '/', back=.true.) + 1:), most => len(tableau%name) - len(table_prefix))
            i = index(base, '.', back=.true.)
            if (i <= 1) i = len(base) + 1
            if (i - 1 > most) then
                problem = "the name of the file is too long for a method: '" // base(:i - 1) // "'"
                hint = 'at most ' // to_text(most) // ' bytes, without its ending'
            end if
            tableau%name = table_prefix // base(:i - 1)
        end associate
    end subroutine name_method

    !> The path in the name of a method, without the checksum.
    function path_of_table(name) result(path)
        character(*), intent(in) :: name !! begins with `table:`
        character(:), allocatable :: path
        integer :: at
        path = name(len(table_prefix) + 1:len_trim(name) - len(form_of(name)))
        at = index(path, '@', back=.true.)
        if (at > 0 .and. len(path) - at == checksum_width) path = path(:at - 1)
    end function path_of_table

    !> The formulation at the end of the name of a method, as `/lagrange`; '' if there is none.
    function form_of(name) result(form)
        character(*), intent(in) :: name
        character(:), allocatable :: form
        type(formulation_info_t), allocatable :: forms(:)
        allocate (forms, source=formulation_infos())
        form = trim(name(scan(name, '/', back=.true.) + 1:))
        if (scan(name, '/') > 0 .and. any(forms%name == form)) then
            form = '/' // form
        else
            form = ''
        end if
    end function form_of

    !> The method that a scene names: of the registry or of a table. Not allocated if there is none.
    subroutine create_method(scene, stepper)
        type(scene_t), intent(in) :: scene !! with its tables
        class(stepper_t), allocatable, intent(out) :: stepper !! with default settings
        integer :: i
        if (allocated(scene%tableaus)) then
            do i = 1, size(scene%tableaus)
                if (scene%method /= scene%tableaus(i)%key .and. scene%method /= scene%tableaus(i)%name) cycle
                call create_tableau_stepper(scene%tableaus(i), stepper)
                return
            end do
        end if
        call create_stepper(trim(scene%method), stepper)
    end subroutine create_method

    !> Names and properties of the methods that a scene may name: those of the registry, and of its tables.
    function infos_of_methods(scene) result(infos)
        type(scene_t), intent(in) :: scene !! with its tables
        type(method_info_t), allocatable :: infos(:)
        allocate (infos, source=[method_infos(), infos_of_tables(scene)])
    end function infos_of_methods

    !> Names and properties of the methods of the tables of a scene.
    function infos_of_tables(scene) result(infos)
        type(scene_t), intent(in) :: scene !! with its tables
        type(method_info_t), allocatable :: infos(:)
        integer :: i
        allocate (infos(0))
        if (.not. allocated(scene%tableaus)) return
        infos = [(tableau_info(scene%tableaus(i)), i=1, size(scene%tableaus))]
    end function infos_of_tables

    !> Names of methods with those of tables in place of their files.
    function names_of_methods(scene, given) result(names)
        type(scene_t), intent(in) :: scene !! with its tables
        character(*), intent(in) :: given(:) !! as in the input
        character(len(given)) :: names(size(given))
        integer :: i, k, length
        names = given
        if (.not. allocated(scene%tableaus)) return
        do i = 1, size(given)
            do k = 1, size(scene%tableaus)
                length = len_trim(scene%tableaus(k)%key)
                if (index(given(i), scene%tableaus(k)%key(:length)) /= 1) cycle
                names(i) = trim(scene%tableaus(k)%name) // given(i)(length + 1:)
            end do
        end do
    end function names_of_methods

end module spintop_own_butcher_tables
