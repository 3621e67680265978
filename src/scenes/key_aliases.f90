!> Names of keys in other programs and in textbooks, for suggestions.
module spintop_key_aliases
    implicit none
    private
    public :: key_aliases

    !> Each `other=group.key`: another name, in small letters, and the key here.
    character(*), parameter :: key_aliases(*) = [character(40) :: &
        'rtol=integration.relative_tolerance', 'reltol=integration.relative_tolerance', &
        'rel_tol=integration.relative_tolerance', 'tol=integration.relative_tolerance', &
        'tolerance=integration.relative_tolerance', 'eps=integration.relative_tolerance', &
        'atol=integration.absolute_tolerance', 'abstol=integration.absolute_tolerance', &
        'abs_tol=integration.absolute_tolerance', &
        'dt=integration.step', 'h=integration.step', 'step_size=integration.step', 'stepsize=integration.step', &
        'nsteps=integration.steps', 'n_steps=integration.steps', 'num_steps=integration.steps', &
        'mxstep=integration.max_steps', 'maxiter=integration.max_steps', &
        'integrator=integration.method', 'ode_solver=integration.method', 'algorithm=integration.method', &
        'tspan=span.t_end', 't_span=span.t_end', 't_final=span.t_end', 'tfinal=span.t_end', 'tf=span.t_end', &
        't_max=span.t_end', 'tmax=span.t_end', 't_bound=span.t_end', 't1=span.t_end', 'duration=span.t_end', &
        't_eval=span.samples', 'npoints=span.samples', 'n_points=span.samples', 'rows=span.samples', &
        'm=top.mass', 'g=top.gravity', 'i=top.inertia', 'moi=top.inertia', 'moments=top.inertia', &
        'cg=top.centre_of_mass', 'cog=top.centre_of_mass', 'com=top.centre_of_mass', &
        'y0=initial.theta', 'x0=initial.theta', 'q0=initial.quaternion', 'w0=initial.omega', 'omega0=initial.omega', &
        'spin=initial.omega3', 'nutation=initial.theta', 'precession=initial.phi', &
        'friction=effects.friction_torque', 'drag=effects.drag_moment', 'torque=effects.torque_body']

end module spintop_key_aliases
