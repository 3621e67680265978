!> A sweep over the spin from a Fortran program: an input is written and run, and its table is read back.
program sweep
    use spintop
    implicit none
    type(error_t), allocatable :: error
    type(table_t) :: table
    character(:), allocatable :: path
    integer :: unit, i

    open (newunit=unit, file='spins.nml', status='replace', action='write')
    write (unit, '(a)') "&study  kind = 'sweep' /", &
        '&top  mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.8660254037844387 /', &
        '&initial  theta_deg = 30 /', &
        '&span  nutations = 1 /', &
        "&sweep  parameter(1) = 'initial.spin_ratio'  values(1,:) = 0.5, 1, 2, 4 /", &
        "&output  columns = 'theta_max' /"
    close (unit)
    call run_study('spins.nml', 'results', path, error)
    if (.not. allocated(error)) call read_table(path, table, error)
    if (allocated(error)) error stop 'the sweep failed'
    associate (ratio => table%column('initial.spin_ratio'), theta_max => table%column('theta_max'), &
               status => table%words('status'))
        do i = 1, size(ratio)
            print '(a, f4.1, a, f10.7, 3a)', 'spin ratio', ratio(i), ': theta up to', theta_max(i), &
                ' rad (', status(i)%text, ')'
        end do
    end associate
end program sweep
