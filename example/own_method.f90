!> A method by its formula: Heun's, a type that extends `fixed_step_t`.
module heun
    use spintop, only: dp, fixed_step_t, max_states, status_ok
    implicit none
    private
    public :: heun_t

    type, extends(fixed_step_t) :: heun_t
    contains
        procedure :: step
    end type heun_t

contains

    !> The change of the state over a time h; `self` has the time t, the state y and its slope.
    subroutine step(self, h, change, status)
        class(heun_t), intent(inout) :: self
        real(dp), intent(in) :: h
        real(dp), intent(out) :: change(max_states)
        integer, intent(out) :: status
        real(dp) :: slope(max_states)
        change = 0
        call self%evaluate(self%t + h, self%y + h * self%slope, slope, status)
        if (status == status_ok) change = h * (self%slope + slope) / 2
    end subroutine step

end module heun

!> Methods of your own, by a formula, by a Butcher table and by the text of one, join the registry, and a study compares them: their
!> errors for some numbers of steps.
program own_method
    use heun, only: heun_t
    use spintop
    implicit none
    character(*), parameter :: ralston = 'order 2' // new_line('a') // '0 |' // new_line('a') // '2/3 | 2/3' // new_line('a') // &
        '| 1/4 3/4'
    type(error_t), allocatable :: error
    type(tableau_t) :: tableau
    class(stepper_t), allocatable :: stepper
    type(table_t) :: table
    type(string_t), allocatable :: methods(:), settings(:)
    character(:), allocatable :: path, problem
    integer :: unit, i

    call add(heun_t(info=method_info_t('heun', "Heun's method", order=2, fixed_step=.true.)))
    call add(runge_kutta_t(table=explicit_table(3, [1 / 3.0_dp, 0.0_dp, 2 / 3.0_dp], [0.25_dp, 0.0_dp, 0.75_dp]), &
        info=method_info_t('heun_3', "Heun's method of order 3", order=3, fixed_step=.true.)))
    call parse_tableau(ralston, tableau, problem)
    if (problem /= '') error stop 'the table was refused'
    call create_tableau_stepper(tableau, stepper)
    stepper%info%name = 'ralston'
    call add(stepper)

    open (newunit=unit, file='heun.nml', status='replace', action='write')
    write (unit, '(a)') "&study  kind = 'work_precision' /", &
        '&top  mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.8660254037844387 /', &
        '&initial  theta_deg = 30  omega3 = 10 /', &
        '&span  t_end = 1 /', &
        "&work_precision  methods = 'heun', 'heun_3', 'ralston'  steps = 400, 800  repeats = 1 /"
    close (unit)
    call run_study('heun.nml', 'results', path, error)
    if (.not. allocated(error)) call read_table(path, table, error)
    if (allocated(error)) error stop 'the study failed'
    allocate (methods, source=table%words('method'))
    allocate (settings, source=table%words('setting'))
    associate (errors => table%column('orientation_error'))
        do i = 1, size(errors)
            print '(4a, es10.3, a)', methods(i)%text, ', ', settings(i)%text, ':', errors(i), ' rad'
        end do
    end associate

contains

    subroutine add(method)
        class(stepper_t), intent(in) :: method
        call register_method(method, error)
        if (allocated(error)) error stop 'the method was refused'
    end subroutine add

end program own_method
