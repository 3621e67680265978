!> The contents of an input file as plain data, and the table that describes them.
!>
!> The default initialisation of a component is the default of the parameter. The table binds each component
!> to its name, unit, range and meaning; the range of theta_deg, for example, is checked by it. Reading,
!> checking, printing the resolved input and `spintop list parameters` use the table.
module spintop_scene_keys
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_arkode, only: tableau_t
    use spintop_checksum, only: checksum_width
    use spintop_sweep_axis, only: law_names
    use spintop_effects_keys, only: describe_effects, effects_scene_t
    use spintop_formulations, only: formulation_infos
    use spintop_kinds, only: dp
    use spintop_residuals, only: loss_names
    use spintop_methods, only: method_infos, method_aliases
    use spintop_parameters, only: parameter_table_t, unset, unset_integer, any_elements, leading_elements, &
        is_set, one_per_group
    use spintop_parts, only: describe_parts, parts_t
    use spintop_stepper, only: projection_names, project_nothing
    use spintop_shapes, only: shape_infos, shape_by_inertia
    use spintop_table_column, only: column_length
    use spintop_text, only: join
    implicit none
    private
    public :: scene_t, describe_scene, fit_scene_t, sensors_t, most_columns, most_runs, table_prefix, key_length, max_axes, &
        max_list_axes, max_over
    public :: study_kinds, kind_trajectory, kind_sweep, kind_precision, kind_stability, kind_benchmark, kind_fit
    public :: reference_names, reference_auto, reference_exact, reference_quadruple
    public :: combination_names, combine_grid, combine_zip, combine_random, combine_latin_hypercube, combine_sobol, &
        combine_saltelli

    !> Maximum length of the name of a key with its subscripts.
    integer, parameter :: key_length = 40

    !> Kinds of study: indices of `study_kinds`.
    integer, parameter :: kind_trajectory = 1, kind_sweep = 2, kind_precision = 3, kind_stability = 4, &
        kind_benchmark = 5, kind_fit = 6
    !> Their names in an input (study.kind).
    character(*), parameter :: study_kinds(6) = [character(14) :: 'trajectory', 'sweep', 'work_precision', 'stability', &
        'benchmark', 'fit']

    !> Kinds of reference motion: indices of `reference_names`. `auto` is the exact solution where it exists,
    !> else a motion in quadruple precision.
    integer, parameter :: reference_auto = 1, reference_exact = 2, reference_quadruple = 3
    !> Their names in an input (work_precision.reference).
    character(*), parameter :: reference_names(3) = [character(9) :: 'auto', 'exact', 'quadruple']

    !> How the axes of a sweep combine into cases, by its place in `combination_names`: all combinations, the last
    !> axis varying fastest; the values of all axes side by side; and samples (see `spintop_sample_design`).
    integer, parameter :: combine_grid = 1, combine_zip = 2, combine_random = 3, combine_latin_hypercube = 4, &
        combine_sobol = 5, combine_saltelli = 6
    !> The words for these in an input (sweep.combine).
    character(*), parameter :: combination_names(6) = [character(15) :: 'grid', 'zip', 'random', 'latin_hypercube', &
        'sobol', 'saltelli']

    !> The contents of the group, in the units of the keys; nothing has a value unless the input gives it.
    type :: uncertainty_scene_t
        real(dp) :: mass = unset, gravity = unset, length = unset
        real(dp) :: inertia(3) = unset, inertia_tensor(3, 3) = unset, centre_of_mass(3) = unset, damping(3) = unset
        real(dp) :: angle(3) = unset, angle_deg(3) = unset, rate(3) = unset
        real(dp) :: omega3 = unset, omega(3) = unset
    end type uncertainty_scene_t

    !> Maximum number of sought parameters, of columns of measurements, and of runs of one body.
    integer, parameter :: most_unknown = 16, most_columns = 16, most_runs = 32

    !> The groups &sensor: what is known of a measured column, one element each.
    type :: sensors_t
        character(key_length) :: column(most_columns) = ''
        real(dp) :: sigma(most_columns) = unset
        !> The reading is the offset and the scale times the quantity.
        real(dp) :: offset(most_columns) = unset, scale(most_columns) = unset
    contains
        procedure :: place_of
    end type sensors_t

    !> The contents of the group &fit.
    type :: fit_scene_t
        character(256) :: data(most_runs) = ''
        !> The sought parameters that all runs have in common, and those of each run.
        character(key_length) :: unknown(most_unknown) = '', unknown_each(most_unknown) = ''
        !> Where the search of those of each run begins: parameters, runs.
        real(dp) :: start_each(most_unknown, most_runs) = unset
        !> Where the sought parameters are searched, if the search is to be global.
        real(dp) :: from(most_unknown) = unset, to(most_unknown) = unset
        character(128) :: columns(most_columns) = ''
        real(dp) :: sigma(most_columns) = unset
        character(key_length) :: wrapped(most_columns) = ''
        character(32) :: loss = ''
        logical :: profile = .true., windows = .true.
        integer :: searches = 12
        real(dp) :: time_offset = unset, averaged = unset, mounting(3) = unset, lever_arm(3) = unset
        type(sensors_t) :: sensors
    contains
        procedure :: set_defaults
    end type fit_scene_t

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

    !> Maximum number of axes of a sweep and of those with listed values, and of listed values of an axis. (More lists would
    !> make scenes too large for small stacks.)
    integer, parameter :: max_axes = 16, max_list_axes = 4, max_axis_values = 1000
    integer, parameter :: word = 32, line = 256
    !> What precedes the file of a Butcher table in place of the name of a method.
    character(*), parameter :: table_prefix = 'table:'
    !> Maximum number of quantities over which statistics have bins.
    integer, parameter :: max_over = 2
    !> Maximum length of the text of an event.
    integer, parameter :: event_length = 64

    !> The contents of an input file.
    type :: scene_t
        ! &study
        character(word) :: kind = study_kinds(kind_trajectory)
        character(line) :: title = ''
        ! &top
        character(word) :: shape = shape_by_inertia
        real(dp) :: mass = unset, inertia(3) = unset, inertia_tensor(3, 3) = unset
        character(word) :: inertia_about = 'pivot'
        real(dp) :: centre_of_mass(3) = unset, length = unset
        real(dp) :: density = unset, radius = unset, inner_radius = unset, thickness = unset, rod_length = unset
        real(dp) :: gravity = 9.81_dp, damping(3) = 0
        ! &part
        type(parts_t) :: parts
        ! &effects
        type(effects_scene_t) :: effects
        ! &initial
        real(dp) :: angle(3) = unset, angle_deg(3) = unset, rate(3) = unset
        real(dp) :: omega3 = unset, spin_ratio = unset, quaternion(4) = unset, omega(3) = unset
        character(word) :: steady_precession = 'none'
        ! &span
        real(dp) :: t_end = unset, nutations = unset, precessions = unset
        integer :: samples = unset_integer
        character(event_length) :: stop_at = ''
        integer :: stop_after = unset_integer
        ! &integration
        character(word) :: formulation = 'auto'
        character(line) :: method = 'auto'
        !> The Butcher tables in files that are named as methods.
        type(tableau_t), allocatable :: tableaus(:)
        character(word) :: table = ''
        integer :: steps = unset_integer
        real(dp) :: step = unset, relative_tolerance = unset, absolute_tolerance = unset
        integer :: max_steps = 1000000
        character(word) :: solver = 'newton'
        character(word) :: project = projection_names(project_nothing)
        ! &output
        character(line) :: file = ''
        character(column_length) :: columns(64) = ''
        character(word) :: format = 'csv'
        integer :: compression = unset_integer
        character(event_length) :: events(32) = ''
        character(word) :: rows = ''
        logical :: certified = .false.
        ! &uncertainty
        type(uncertainty_scene_t) :: uncertainty
        ! &sweep
        character(key_length) :: parameter(max_axes) = ''
        real(dp) :: values(max_list_axes, max_axis_values) = unset
        real(dp) :: from(max_axes) = unset, to(max_axes) = unset
        integer :: count(max_axes) = unset_integer
        character(word) :: spacing(max_axes) = '', distribution(max_axes) = ''
        real(dp) :: mean(max_axes) = unset, deviation(max_axes) = unset, covariance(max_axes, max_axes) = unset
        character(word) :: combine = combination_names(combine_grid)
        integer(int64) :: cases = unset_integer
        integer :: seed = 1
        character(line) :: sweep_table = ''
        character(checksum_width) :: sweep_table_checksum = ''
        ! &statistics
        character(column_length) :: statistics_columns(64) = ''
        character(key_length) :: over(max_over) = ''
        integer :: bins(max_over) = unset_integer
        real(dp) :: bins_from(max_over) = unset, bins_to(max_over) = unset
        character(word) :: bins_spacing(max_over) = ''
        real(dp) :: quantiles(32) = unset
        character(word) :: quantiles_of = '', indices = ''
        ! &work_precision
        character(3 * word) :: precision_methods(64) = ''
        character(word) :: precision_formulations(16) = ''
        real(dp) :: precision_tolerances(64) = unset
        integer :: precision_steps(64) = unset_integer, precision_repeats = unset_integer
        character(line) :: precision_reference = reference_names(reference_auto)
        ! &stability
        character(word) :: stability_cases(64) = ''
        character(3 * word) :: stability_methods(64) = ''
        ! &benchmark
        character(word) :: benchmark_cases(64) = ''
        character(3 * word) :: benchmark_methods(64) = ''
        ! &fit
        type(fit_scene_t) :: fit
    end type scene_t

contains

    !> Binds every component of a scene to its row of the parameter table.
    subroutine describe_scene(scene, table)
        type(scene_t), target, intent(inout) :: scene !! its components are bound; it must exist as long as the table
        type(parameter_table_t), intent(out) :: table !! bound to the components of the scene

        table%aliases = key_aliases
        call table%add('study.kind', scene%kind, join(study_kinds, '|'), 'what to compute')
        call table%add('study.title', scene%title, what='title of the scene, for tables and figures')
        call describe_top(scene, table)
        call describe_computation(scene, table)
        call describe_uncertainty(scene%uncertainty, table)
        call describe_cases(scene, table)
        call describe_comparisons(scene, table)
        call describe_fit(scene%fit, table)
    end subroutine describe_scene

    !> The body, by its mass properties, a shape or parts, and what acts on it; the start: attitude and angular velocity; and
    !> how long the motion is followed, and what ends it.
    subroutine describe_top(scene, table)
        type(scene_t), target, intent(inout) :: scene
        type(parameter_table_t), intent(inout) :: table
        character(*), parameter :: angles(3) = [character(16) :: 'precession angle', 'inclination', 'spin angle']

        call table%add('top.shape', scene%shape, shape_by_inertia // '|' // join(shape_infos%name, '|'), &
                       'description of the body: by its mass properties or by a shape')
        call table%add('top.mass', scene%mass, 'kg', '> 0', 'mass of the body')
        call table%add('top.inertia', scene%inertia, 'kg m^2', '> 0', 'principal moments of inertia about body x, y, z')
        call table%add('top.inertia_tensor', scene%inertia_tensor, 'kg m^2', '', &
                       'inertia tensor in body axes, instead of top.inertia; its elements below the diagonal may be omitted', &
                       elements=any_elements)
        call table%add('top.inertia_about', scene%inertia_about, 'pivot|centre_of_mass', &
                       'reference point of top.inertia and top.inertia_tensor')
        call table%add('top.centre_of_mass', scene%centre_of_mass, 'm', '', 'centre of mass from the pivot in body axes')
        call table%add('top.length', scene%length, 'm', '', 'distance of the centre of mass from the pivot along body z')
        call table%add('top.density', scene%density, 'kg/m^3', '> 0', 'density of a shape, or give top.mass')
        call table%add('top.radius', scene%radius, 'm', '> 0', 'outer radius of a shape')
        call table%add('top.inner_radius', scene%inner_radius, 'm', '>= 0', 'inner radius of a ring')
        call table%add('top.thickness', scene%thickness, 'm', '>= 0', 'extent of a shape along its axis')
        call table%add('top.rod_length', scene%rod_length, 'm', '>= 0', 'distance from the pivot to the centre of a shape on a rod')
        call table%add('top.gravity', scene%gravity, 'm/s^2', '>= 0', 'acceleration of gravity')
        call table%add('top.damping', scene%damping, 'N m s', '>= 0', 'viscous damping coefficients about body x, y, z')
        call describe_parts(scene%parts, table)
        call describe_effects(scene%effects, table)

        call add_each(table, 'initial.', '', scene%angle, 'rad', ['       ', '[0, pi]', '       '], angles)
        call add_each(table, 'initial.', '_deg', scene%angle_deg, 'deg', ['        ', '[0, 180]', '        '], angles)
        call add_each(table, 'initial.', '_rate', scene%rate, 'rad/s', [' ', ' ', ' '], &
                      ['precession rate', 'nutation rate  ', 'spin rate      '])
        call table%add('initial.omega3', scene%omega3, 'rad/s', '', 'angular velocity about body z, instead of psi_rate')
        call table%add('initial.spin_ratio', scene%spin_ratio, '', '', 'omega3 over sqrt(4 m g l/I3), instead of psi_rate')
        call table%add('initial.quaternion', scene%quaternion, '', '', &
                       'attitude, scalar first, body to space, instead of the angles')
        call table%add('initial.omega', scene%omega, 'rad/s', '', 'angular velocity in body axes, instead of the rates')
        call table%add('initial.steady_precession', scene%steady_precession, 'none|slow|fast', &
                       'computes phi_rate for a constant inclination')
        call table%add('span.t_end', scene%t_end, 's', '> 0', 'time span')
        call table%add('span.nutations', scene%nutations, '', '> 0', 'time span in nutation periods')
        call table%add('span.precessions', scene%precessions, '', '> 0', 'time span in periods 2 pi I3 omega3/(m g l)')
        call table%add('span.samples', scene%samples, '', '>= 2', &
                       'number of rows, equally spaced in time, both ends included (1001; fixed step size: every step)')
        call table%add('span.stop_at', scene%stop_at, what='the event that ends the motion, as in output.events')
        call table%add('span.stop_after', scene%stop_after, '', '>= 1', 'which of these events ends the motion (1)')
    end subroutine describe_top

    !> Formulation, method, and what the method takes; and the tables.
    subroutine describe_computation(scene, table)
        type(scene_t), target, intent(inout) :: scene
        type(parameter_table_t), intent(inout) :: table

        associate (forms => formulation_infos(), methods => method_infos())
            call table%add('integration.formulation', scene%formulation, 'auto|' // join(forms%name, '|'), &
                           'form of the equations of motion')
            call table%add('integration.method', scene%method, &
                           'auto|exact|' // join(methods%name, '|') // '|' // table_prefix // 'FILE', &
                           'integrator, or the exact solution', aliases=method_aliases)
        end associate
        call table%add('integration.table', scene%table, what='Butcher table of an ARKODE method')
        call table%add('integration.steps', scene%steps, '', '>= 1', 'number of steps of fixed size')
        call table%add('integration.step', scene%step, 's', '> 0', 'largest fixed step size, instead of steps')
        call table%add('integration.relative_tolerance', scene%relative_tolerance, '', '[0, 1]', &
                       'relative error per step of adaptive methods (1e-9; ode45: 1e-3); 0: the finest of the method')
        call table%add('integration.absolute_tolerance', scene%absolute_tolerance, '', '> 0', &
                       'absolute error per step, in radians and in units of the largest rate or momentum (1e-12, ode45 1e-6; at &
                       &most a thousandth of a relative_tolerance given)')
        call table%add('integration.max_steps', scene%max_steps, '', '>= 1', &
                       'maximum number of steps per case, where steps and step do not determine it')
        call table%add('integration.solver', scene%solver, 'newton|fixed_point', 'solver of the equations of implicit steps')
        call table%add('integration.project', scene%project, join(projection_names, '|'), &
                       'projection after each step: onto unit quaternions, or onto all invariants')
        call table%add('output.file', scene%file, what='name of the table (default: that of the input)')
        call table%add('output.columns', scene%columns, &
                       what='columns of the table, or all; also in a unit, as theta_deg, and derivatives COLUMN__KEY')
        call table%add('output.format', scene%format, 'csv|netcdf', &
                       'format of the table; netcdf: sweeps and trajectories, in builds with NetCDF')
        call table%add('output.compression', scene%compression, '', '[0, 9]', &
                       'compression of a NetCDF table, which then has the format NetCDF-4 (default: none, classic format)')
        call table%add('output.events', scene%events, what='events for the table of events; see `spintop list events`')
        call table%add('output.rows', scene%rows, 'all|none', &
                       'whether a sweep writes the rows of its cases, or only their statistics (all)')
        call table%add('output.certified', scene%certified, &
                       'whether proved numbers are printed, correct to the last digit, in builds with FLINT')
    end subroutine describe_computation

    !> The axes of a sweep, or the table of its cases; and the statistics of these.
    subroutine describe_cases(scene, table)
        type(scene_t), target, intent(inout) :: scene
        type(parameter_table_t), intent(inout) :: table
        character(*), parameter :: of_over = 'of statistics.over', of_parameter = 'of sweep.parameter'

        call table%add('sweep.parameter', scene%parameter, &
                       what='numeric keys to vary, such as initial.spin_ratio or top.inertia(2)')
        call table%add('sweep.values', scene%values, of_parameter, '', 'values of one of the first axes, one by one')
        call table%add('sweep.from', scene%from, of_parameter, '', 'first value of an axis', elements=any_elements)
        call table%add('sweep.to', scene%to, of_parameter, '', 'last value of an axis', elements=any_elements)
        call table%add('sweep.count', scene%count, '', '>= 1', 'number of values of an axis', elements=any_elements)
        call table%add('sweep.spacing', scene%spacing, 'linear|log', &
                       'spacing of the values, or of the range of random values (linear)', elements=any_elements)
        call table%add('sweep.distribution', scene%distribution, join(law_names, '|'), &
                       'distribution of random values; sphere: a random attitude or direction (uniform)', elements=any_elements)
        call table%add('sweep.mean', scene%mean, of_parameter, '', &
                       'mean of a normal value, or of the logarithm of a log-normal one; magnitude of a vector of random &
                       &direction', elements=any_elements)
        call table%add('sweep.deviation', scene%deviation, of_parameter, '> 0', 'standard deviation of the same', &
                       elements=any_elements)
        call table%add('sweep.covariance', scene%covariance, '', '', 'covariance of the normal values of two axes', &
                       elements=any_elements)
        call table%add('sweep.combine', scene%combine, join(combination_names, '|'), &
                       'combination of the axes: all combinations, side by side, or a sample')
        call table%add('sweep.cases', scene%cases, '', '[1, 1e15]', 'number of cases of a sample')
        call table%add('sweep.seed', scene%seed, '', '', "seed of a sample; 0: a Sobol' sequence without scrambling")
        call table%add('sweep.table', scene%sweep_table, &
                       what='CSV file instead of axes: parameters as columns, one case per row (path from the input)')
        call table%add('sweep.table_checksum', scene%sweep_table_checksum, &
                       what='checksum of the table; a table with another checksum is refused (computed)')
        call table%add('statistics.columns', scene%statistics_columns, what='columns of the sweep of which statistics are computed')
        call table%add('statistics.over', scene%over, &
                       what='one or two swept parameters or columns over which the cases are binned', elements=leading_elements)
        call table%add('statistics.bins', scene%bins, '', '>= 1', 'number of bins (the values of a grid axis, else 50)', &
                       elements=any_elements)
        call table%add('statistics.from', scene%bins_from, of_over, '', &
                       'lower end of the first bin (of a parameter: that of its axis)', elements=any_elements)
        call table%add('statistics.to', scene%bins_to, of_over, '', &
                       'upper end of the last bin (of a parameter: that of its axis)', elements=any_elements)
        call table%add('statistics.spacing', scene%bins_spacing, 'linear|log', &
                       'spacing of the ends of the bins (that of the axis, else linear)', elements=any_elements)
        call table%add('statistics.quantiles', scene%quantiles, '', '[0, 1]', 'quantiles (0.05, 0.25, 0.5, 0.75, 0.95)', &
                       elements=leading_elements)
        call table%add('statistics.quantiles_of', scene%quantiles_of, 'all|bins', &
                       'cases of which quantiles are computed: all, or those of each bin as well (all)')
        call table%add('statistics.indices', scene%indices, 'sobol', &
                       "first-order and total Sobol' indices of the columns, with sweep.combine = 'saltelli'")
    end subroutine describe_cases

    !> What work-precision and stability studies and benchmarks compare.
    subroutine describe_comparisons(scene, table)
        type(scene_t), target, intent(inout) :: scene
        type(parameter_table_t), intent(inout) :: table

        call table%add('work_precision.methods', scene%precision_methods, &
                       what='methods, including exact, by name or as method/formulation (all)')
        call table%add('work_precision.formulations', scene%precision_formulations, &
                       what='formulations for methods given by name (the one that suits the body)')
        call table%add('work_precision.tolerances', scene%precision_tolerances, '', '[1e-31, 1]', &
                       'relative tolerances of adaptive methods (1e-3 to 1e-14)', elements=leading_elements)
        call table%add('work_precision.steps', scene%precision_steps, '', '>= 1', &
                       'numbers of fixed steps of the other methods; without tolerances, of all that can (100 to 25600)', &
                       elements=leading_elements)
        call table%add('work_precision.repeats', scene%precision_repeats, '', '>= 1', &
                       'number of timed runs; the fastest counts (5; fewer if they take seconds)')
        call table%add('work_precision.reference', scene%precision_reference, &
                       what='reference of the errors: ' // join(reference_names, ', ') // ', or a table with t, q0 to q3, omega1 &
                       &to omega3')
        call table%add('stability.cases', scene%stability_cases, &
                       what="cases of the catalogue, or 'input' for the case of this file (all but long ones)")
        call table%add('stability.methods', scene%stability_methods, &
                       what='methods, by name or as method/formulation (all, some with several formulations)')
        call table%add('benchmark.cases', scene%benchmark_cases, what='benchmarks of the catalogue (all)')
        call table%add('benchmark.methods', scene%benchmark_methods, &
                       what='methods, by name or as method/formulation (the fastest of each family)')
    end subroutine describe_comparisons

    !> One row for each Euler angle, or its rate.
    subroutine add_each(table, group, suffix, vector, unit, ranges, whats)
        type(parameter_table_t), intent(inout) :: table
        character(*), intent(in) :: group, suffix, unit, ranges(3), whats(3)
        real(dp), target, intent(inout) :: vector(3)
        character(*), parameter :: names(3) = [character(5) :: 'phi', 'theta', 'psi']
        integer :: i
        do i = 1, 3
            call table%add(group // trim(names(i)) // suffix, vector(i), unit, trim(ranges(i)), trim(whats(i)))
        end do
    end subroutine add_each

    !> Adds the keys to the table of an input.
    subroutine describe_uncertainty(scene, table)
        type(uncertainty_scene_t), target, intent(inout) :: scene !! the group; it must exist as long as the table
        type(parameter_table_t), intent(inout) :: table !! the keys are added
        character(*), parameter :: top = 'uncertainty.top.', initial = 'uncertainty.initial.', range = '>= 0'
        character(*), parameter :: ranges(3) = range

        call table%add(top // 'mass', scene%mass, 'kg', range, 'radius of the mass')
        call table%add(top // 'gravity', scene%gravity, 'm/s^2', range, 'radius of gravity')
        call table%add(top // 'length', scene%length, 'm', range, 'radius of the length')
        call table%add(top // 'inertia', scene%inertia, 'kg m^2', range, 'radii of the moments of inertia')
        call table%add(top // 'inertia_tensor', scene%inertia_tensor, 'kg m^2', range, 'radii of the inertia tensor', &
                       elements=any_elements)
        call table%add(top // 'centre_of_mass', scene%centre_of_mass, 'm', range, 'radii of the centre of mass')
        call table%add(top // 'damping', scene%damping, 'N m s', range, 'radii of the damping coefficients')
        call add_each(table, initial, '', scene%angle, 'rad', ranges, spread('radius of that angle', 1, 3))
        call add_each(table, initial, '_deg', scene%angle_deg, 'deg', ranges, spread('radius of that angle', 1, 3))
        call add_each(table, initial, '_rate', scene%rate, 'rad/s', ranges, spread('radius of that rate', 1, 3))
        call table%add(initial // 'omega3', scene%omega3, 'rad/s', range, 'radius of omega3')
        call table%add(initial // 'omega', scene%omega, 'rad/s', range, 'radii of omega')
    end subroutine describe_uncertainty

    !> Adds the keys to the table of an input.
    subroutine describe_fit(scene, table)
        type(fit_scene_t), target, intent(inout) :: scene !! the group; it must exist as long as the table
        type(parameter_table_t), intent(inout) :: table !! the keys are added

        call table%add('fit.data', scene%data, &
                       what='CSV tables of measurements, one for each run: t, and columns of trajectories')
        call table%add('fit.unknown', scene%unknown, what='sought parameters; their values are where the search begins')
        call table%add('fit.unknown_each', scene%unknown_each, what='sought parameters of which each run has its own')
        call table%add('fit.start_each', scene%start_each, 'of fit.unknown_each', '', &
                       'their values in the first run, the second ... where the search begins (those of the input)')
        call table%add('fit.from', scene%from, 'of fit.unknown', '', &
                       'lower ends of the ranges in which the parameters are sought, in their units (near their values)', &
                       elements=any_elements)
        call table%add('fit.to', scene%to, 'of fit.unknown', '', 'upper ends of these ranges', elements=any_elements)
        call table%add('fit.columns', scene%columns, what='measured columns, and with = their names in the table (all but t)')
        call table%add('fit.sigma', scene%sigma, 'of fit.columns', '> 0', &
                       'standard deviations of the measured columns, in their units (one that is common to all columns, from the &
                       &residuals)', elements=leading_elements)
        call table%add('fit.wrapped', scene%wrapped, what='measured angles that are known but for whole turns')
        call table%add('fit.loss', scene%loss, join(loss_names, '|'), 'least squares, or a robust loss (squares)')
        call table%add('fit.profile', scene%profile, 'compute profile intervals')
        call table%add('fit.windows', scene%windows, 'begin with the first rows, and double their span step by step')
        call table%add('fit.searches', scene%searches, '', '>= 1', 'starts of the search at most, where the first is poor')
        call table%add('fit.time_offset', scene%time_offset, 's', '', 'time of the motion at t = 0 of the table (0)')
        call table%add('fit.averaged', scene%averaged, 's', '>= 0', 'width of the interval of which a reading is the mean (0)')
        call table%add('fit.mounting', scene%mounting, 'rad', '', &
                       'rotation vector from body axes to those of the sensor of omega1 to omega3 and accelerometer1 to &
                       &accelerometer3 (0)')
        call table%add('fit.lever_arm', scene%lever_arm, 'm', '', &
                       'place of the accelerometers relative to the centre of mass, in body axes (0)')
        associate (sensors => scene%sensors)
            call table%add('sensor.column', sensors%column, what='measured column; one group for each sensor', &
                           elements=one_per_group)
            call table%add('sensor.sigma', sensors%sigma, 'of sensor.column', '> 0', &
                           'standard deviation of its readings, in their unit', elements=one_per_group)
            call table%add('sensor.offset', sensors%offset, 'of sensor.column', '', 'reading where the quantity is 0 (0)', &
                           elements=one_per_group)
            call table%add('sensor.scale', sensors%scale, '', '', 'change of the reading with the quantity (1)', &
                           elements=one_per_group)
        end associate
    end subroutine describe_fit

    !> The number of the group of a column, which is taken if there is none yet; 0 if there are too many.
    integer function place_of(self, column) result(place)
        class(sensors_t), intent(inout) :: self
        character(*), intent(in) :: column !! name of a measured column
        do place = 1, size(self%column)
            if (self%column(place) == column .or. self%column(place) == '') exit
        end do
        if (place > size(self%column)) place = 0
        if (place > 0) self%column(place) = column
    end function place_of

    !> Sets what is not given, but for standard deviations and ranges.
    subroutine set_defaults(self)
        class(fit_scene_t), intent(inout) :: self
        if (.not. is_set(self%time_offset)) self%time_offset = 0
        if (.not. is_set(self%averaged)) self%averaged = 0
        where (.not. is_set(self%mounting)) self%mounting = 0
        where (.not. is_set(self%lever_arm)) self%lever_arm = 0
        where (.not. is_set(self%sensors%offset)) self%sensors%offset = 0
        where (.not. is_set(self%sensors%scale)) self%sensors%scale = 1
    end subroutine set_defaults

end module spintop_scene_keys
