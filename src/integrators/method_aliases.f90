!> Names of the methods in other programs and in textbooks.
module spintop_method_aliases
    implicit none
    private
    public :: method_aliases

    !> Each `other=own`: another name, and the name here.
    character(*), parameter :: method_aliases(*) = [character(40) :: &
        'rk45=ode45', 'rkdp=ode45', 'rkdp45=ode45', 'dopri=ode45', 'dopri5=ode45', 'dormand_prince=ode45', &
        'dp5=ode45', 'rkf45=ode45', 'dop8=dop853', 'dopri8=dop853', 'dopri853=dop853', 'rk8=dop853', &
        'dp8=dop853', 'ode78=dop853', 'ode89=dop853', 'ode87=dop853', &
        'euler=euler_forward', 'explicit_euler=euler_forward', 'forward_euler=euler_forward', &
        'implicit_euler=euler_backward', 'backward_euler=euler_backward', &
        'rk=rk4', 'runge_kutta=rk4', 'runge_kutta_4=rk4', 'classical=rk4', 'midpoint=rk2', &
        'crank_nicolson=crank_nicolson_1', 'cn=crank_nicolson_1', 'cn1=crank_nicolson_1', &
        'cn2=crank_nicolson_2', 'trapezoidal=crank_nicolson_1', 'trapezoid=crank_nicolson_1', &
        'implicit_midpoint=crank_nicolson_2', 'gauss_2=crank_nicolson_2', 'gauss=gauss_4', &
        'gauss_legendre=gauss_4', 'gl4=gauss_4', 'gl6=gauss_6', 'gl8=gauss_8', 'rkmk=rkmk_4', 'rkmk4=rkmk_4', &
        'verlet=splitting_2', 'leapfrog=splitting_2', 'stoermer=splitting_2', 'strang=splitting_2', &
        'dirk=arkode_dirk', 'sdirk=arkode_dirk', 'erk=arkode_erk', 'arkode=arkode_erk', 'closed_form=exact', &
        'analytic=exact', 'analytical=exact', 'default=auto', 'automatic=auto']

end module spintop_method_aliases
