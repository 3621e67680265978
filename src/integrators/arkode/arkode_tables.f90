!> The Butcher tables of SUNDIALS ARKODE, by name.
module spintop_arkode_tables
    use, intrinsic :: iso_c_binding, only: c_double, c_int, c_null_ptr, c_ptr
    use farkode_arkstep_mod, only: FARKStepSetTables
    use farkode_mod, only: FARKodeButcherTable_Create, FARKodeButcherTable_Free
    use spintop_tableau, only: tableau_t
    use spintop_text, only: string_t
    use farkode_mod, only: &
        ARKODE_HEUN_EULER_2_1_2, ARKODE_BOGACKI_SHAMPINE_4_2_3, ARKODE_ARK324L2SA_ERK_4_2_3, &
        ARKODE_ZONNEVELD_5_3_4, ARKODE_ARK436L2SA_ERK_6_3_4, ARKODE_SAYFY_ABURUB_6_3_4, &
        ARKODE_ARK437L2SA_ERK_7_3_4, ARKODE_CASH_KARP_6_4_5, ARKODE_FEHLBERG_6_4_5, &
        ARKODE_DORMAND_PRINCE_7_4_5, ARKODE_ARK548L2SA_ERK_8_4_5, ARKODE_ARK548L2SAb_ERK_8_4_5, &
        ARKODE_VERNER_8_5_6, ARKODE_FEHLBERG_13_7_8, ARKODE_SDIRK_2_1_2, &
        ARKODE_BILLINGTON_3_3_2, ARKODE_TRBDF2_3_3_2, ARKODE_KVAERNO_4_2_3, &
        ARKODE_ARK324L2SA_DIRK_4_2_3, ARKODE_ESDIRK324L2SA_4_2_3, ARKODE_ESDIRK325L2SA_5_2_3, &
        ARKODE_ESDIRK32I5L2SA_5_2_3, ARKODE_CASH_5_2_4, ARKODE_CASH_5_3_4, ARKODE_SDIRK_5_3_4, &
        ARKODE_KVAERNO_5_3_4, ARKODE_ARK436L2SA_DIRK_6_3_4, ARKODE_ARK437L2SA_DIRK_7_3_4, &
        ARKODE_ESDIRK436L2SA_6_3_4, ARKODE_ESDIRK43I6L2SA_6_3_4, ARKODE_QESDIRK436L2SA_6_3_4, &
        ARKODE_ESDIRK437L2SA_7_3_4, ARKODE_KVAERNO_7_4_5, ARKODE_ARK548L2SA_DIRK_8_4_5, &
        ARKODE_ARK548L2SAb_DIRK_8_4_5, ARKODE_ESDIRK547L2SA_7_4_5, ARKODE_ESDIRK547L2SA2_7_4_5
    implicit none
    private
    public :: arkode_table_t, arkode_tables, arkode_table_names, find_arkode_table
    public :: default_arkode_table, set_own_table

    !> Length of the longest name.
    integer, parameter :: name_length = 32

    !> A table. Its name is that of SUNDIALS in lower case.
    type :: arkode_table_t
        character(name_length) :: name = ''
        !> Identifier of the table in ARKODE.
        integer(c_int) :: id = -1
        logical :: implicit = .false.
        integer :: stages = 0
        !> Order of the solution, and of the embedded solution that step control compares it with.
        integer :: order = 0
        integer :: embedded_order = 0
    end type arkode_table_t

    !> The tables: explicit ones first, each group in increasing order.
    !>
    !> ARKODE_KNOTH_WOLKE_3_3 is omitted, because it has no embedded method for step control.
    type(arkode_table_t), parameter :: arkode_tables(*) = [ &
        arkode_table_t('arkode_heun_euler_2_1_2', ARKODE_HEUN_EULER_2_1_2, .false., 2, 2, 1), &
        arkode_table_t('arkode_bogacki_shampine_4_2_3', ARKODE_BOGACKI_SHAMPINE_4_2_3, .false., 4, 3, 2), &
        arkode_table_t('arkode_ark324l2sa_erk_4_2_3', ARKODE_ARK324L2SA_ERK_4_2_3, .false., 4, 3, 2), &
        arkode_table_t('arkode_zonneveld_5_3_4', ARKODE_ZONNEVELD_5_3_4, .false., 5, 4, 3), &
        arkode_table_t('arkode_ark436l2sa_erk_6_3_4', ARKODE_ARK436L2SA_ERK_6_3_4, .false., 6, 4, 3), &
        arkode_table_t('arkode_sayfy_aburub_6_3_4', ARKODE_SAYFY_ABURUB_6_3_4, .false., 6, 4, 3), &
        arkode_table_t('arkode_ark437l2sa_erk_7_3_4', ARKODE_ARK437L2SA_ERK_7_3_4, .false., 7, 4, 3), &
        arkode_table_t('arkode_cash_karp_6_4_5', ARKODE_CASH_KARP_6_4_5, .false., 6, 5, 4), &
        arkode_table_t('arkode_fehlberg_6_4_5', ARKODE_FEHLBERG_6_4_5, .false., 6, 5, 4), &
        arkode_table_t('arkode_dormand_prince_7_4_5', ARKODE_DORMAND_PRINCE_7_4_5, .false., 7, 5, 4), &
        arkode_table_t('arkode_ark548l2sa_erk_8_4_5', ARKODE_ARK548L2SA_ERK_8_4_5, .false., 8, 5, 4), &
        arkode_table_t('arkode_ark548l2sab_erk_8_4_5', ARKODE_ARK548L2SAb_ERK_8_4_5, .false., 8, 5, 4), &
        arkode_table_t('arkode_verner_8_5_6', ARKODE_VERNER_8_5_6, .false., 8, 6, 5), &
        arkode_table_t('arkode_fehlberg_13_7_8', ARKODE_FEHLBERG_13_7_8, .false., 13, 8, 7), &
        arkode_table_t('arkode_sdirk_2_1_2', ARKODE_SDIRK_2_1_2, .true., 2, 2, 1), &
        arkode_table_t('arkode_billington_3_3_2', ARKODE_BILLINGTON_3_3_2, .true., 3, 2, 3), &
        arkode_table_t('arkode_trbdf2_3_3_2', ARKODE_TRBDF2_3_3_2, .true., 3, 2, 3), &
        arkode_table_t('arkode_kvaerno_4_2_3', ARKODE_KVAERNO_4_2_3, .true., 4, 3, 2), &
        arkode_table_t('arkode_ark324l2sa_dirk_4_2_3', ARKODE_ARK324L2SA_DIRK_4_2_3, .true., 4, 3, 2), &
        arkode_table_t('arkode_esdirk324l2sa_4_2_3', ARKODE_ESDIRK324L2SA_4_2_3, .true., 4, 3, 2), &
        arkode_table_t('arkode_esdirk325l2sa_5_2_3', ARKODE_ESDIRK325L2SA_5_2_3, .true., 5, 3, 2), &
        arkode_table_t('arkode_esdirk32i5l2sa_5_2_3', ARKODE_ESDIRK32I5L2SA_5_2_3, .true., 5, 3, 2), &
        arkode_table_t('arkode_cash_5_2_4', ARKODE_CASH_5_2_4, .true., 5, 4, 2), &
        arkode_table_t('arkode_cash_5_3_4', ARKODE_CASH_5_3_4, .true., 5, 4, 3), &
        arkode_table_t('arkode_sdirk_5_3_4', ARKODE_SDIRK_5_3_4, .true., 5, 4, 3), &
        arkode_table_t('arkode_kvaerno_5_3_4', ARKODE_KVAERNO_5_3_4, .true., 5, 4, 3), &
        arkode_table_t('arkode_ark436l2sa_dirk_6_3_4', ARKODE_ARK436L2SA_DIRK_6_3_4, .true., 6, 4, 3), &
        arkode_table_t('arkode_ark437l2sa_dirk_7_3_4', ARKODE_ARK437L2SA_DIRK_7_3_4, .true., 7, 4, 3), &
        arkode_table_t('arkode_esdirk436l2sa_6_3_4', ARKODE_ESDIRK436L2SA_6_3_4, .true., 6, 4, 3), &
        arkode_table_t('arkode_esdirk43i6l2sa_6_3_4', ARKODE_ESDIRK43I6L2SA_6_3_4, .true., 6, 4, 3), &
        arkode_table_t('arkode_qesdirk436l2sa_6_3_4', ARKODE_QESDIRK436L2SA_6_3_4, .true., 6, 4, 3), &
        arkode_table_t('arkode_esdirk437l2sa_7_3_4', ARKODE_ESDIRK437L2SA_7_3_4, .true., 7, 4, 3), &
        arkode_table_t('arkode_kvaerno_7_4_5', ARKODE_KVAERNO_7_4_5, .true., 7, 5, 4), &
        arkode_table_t('arkode_ark548l2sa_dirk_8_4_5', ARKODE_ARK548L2SA_DIRK_8_4_5, .true., 8, 5, 4), &
        arkode_table_t('arkode_ark548l2sab_dirk_8_4_5', ARKODE_ARK548L2SAb_DIRK_8_4_5, .true., 8, 5, 4), &
        arkode_table_t('arkode_esdirk547l2sa_7_4_5', ARKODE_ESDIRK547L2SA_7_4_5, .true., 7, 5, 4), &
        arkode_table_t('arkode_esdirk547l2sa2_7_4_5', ARKODE_ESDIRK547L2SA2_7_4_5, .true., 7, 5, 4)]

contains

    !> Names of the explicit or of the implicit tables.
    pure function arkode_table_names(implicit_tables) result(names)
        logical, intent(in) :: implicit_tables !! true for the implicit tables, false for the explicit ones
        type(string_t), allocatable :: names(:)
        integer :: i, last
        allocate (names(count(arkode_tables%implicit .eqv. implicit_tables)))
        last = 0
        do i = 1, size(arkode_tables)
            if (arkode_tables(i)%implicit .neqv. implicit_tables) cycle
            last = last + 1
            names(last)%text = trim(arkode_tables(i)%name)
        end do
    end function arkode_table_names

    !> Name of the default table of a method.
    pure function default_arkode_table(implicit_table) result(name)
        logical, intent(in) :: implicit_table !! whether a diagonally implicit table is requested
        character(name_length) :: name
        name = 'arkode_fehlberg_13_7_8'
        if (implicit_table) name = 'arkode_esdirk547l2sa2_7_4_5'
    end function default_arkode_table

    !> The explicit or implicit table of a name ('' for the default); `found` reports whether it exists.
    pure subroutine find_arkode_table(name, implicit_table, table, found)
        character(*), intent(in) :: name !! name of the table; '' for the default
        logical, intent(in) :: implicit_table !! whether a diagonally implicit table is requested
        type(arkode_table_t), intent(out) :: table !! the table, if it was found
        logical, intent(out) :: found !! whether it was found
        ! Of fixed length, because runs in several threads call this.
        character(max(len(name), name_length)) :: wanted
        integer :: i

        wanted = name
        if (wanted == '') wanted = default_arkode_table(implicit_table)
        found = .false.
        do i = 1, size(arkode_tables)
            found = arkode_tables(i)%name == wanted &
                .and. (arkode_tables(i)%implicit .eqv. implicit_table)
            if (.not. found) cycle
            table = arkode_tables(i)
            return
        end do
    end subroutine find_arkode_table

    !> Gives ARKODE a copy of a table that is not of its own.
    integer(c_int) function set_own_table(integrator, own) result(flag)
        type(c_ptr), intent(in) :: integrator !! memory of ARKStep
        type(tableau_t), intent(in) :: own !! the table, explicit or diagonally implicit
        type(c_ptr) :: table, tables(2)
        real(c_double), dimension(own%stages) :: b, embedded, c
        real(c_double) :: a(own%stages, own%stages)
        integer(c_int) :: order, lower_order

        order = int(own%order, c_int)
        lower_order = int(own%embedded_order, c_int)
        ! Row by row, as C has it.
        a = transpose(own%a(:own%stages, :own%stages))
        b = own%b(:own%stages)
        c = own%c(:own%stages)
        embedded = own%embedded(:own%stages)
        table = FARKodeButcherTable_Create(int(own%stages, c_int), order, lower_order, c, a, b, embedded)
        tables = [c_null_ptr, table]
        if (.not. own%is_explicit()) tables = [table, c_null_ptr]
        flag = FARKStepSetTables(integrator, order, lower_order, tables(1), tables(2))
        call FARKodeButcherTable_Free(table)
    end function set_own_table

end module spintop_arkode_tables
