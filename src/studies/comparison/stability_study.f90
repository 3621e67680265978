!> The stability study: every method on motions that are difficult to integrate, of a catalogue or of the input.
!>
!> Every method runs every case. The motion is compared with the exact solution, or with a motion in quadruple
!> precision. One row per case and method contains the errors, the drifts of the invariants, the cost and a
!> verdict. A case of the catalogue has a description, the difficulty, and the settings as in an input, so that it can be run
!> separately; integration.steps is the number of steps for methods without step control.
module spintop_stability_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: make_case
    use spintop_comparison, only: add_methods, find_cases, method_choice_t, setting_t, attempt_t, comparison_t, &
        make_scene_of_settings, problem_t
    use spintop_errors, only: error_t, internal_error
    use spintop_formulation, only: structure_quadruple
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, no_number
    use spintop_lyapunov, only: find_lyapunov
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_own_butcher_tables, only: infos_of_methods, names_of_methods
    use spintop_parameters, only: is_set, unset_integer
    use spintop_planning, only: plan_t
    use spintop_problems, only: problems_t
    use spintop_relative_equilibrium, only: find_equilibrium_eigenvalues
    use spintop_row_block, only: text_buffer_t
    use spintop_scene_keys, only: scene_t, reference_auto
    use spintop_status, only: is_ok, status_meaning, status_names, status_meanings
    use spintop_stepper, only: method_info_t
    use spintop_study_column, only: categorical, column => study_column_t
    use spintop_summary, only: summary_t, rounded
    use spintop_text, only: append, to_text
    use spintop_trial, only: find_reference, error_energy, error_l3, error_lz, error_norm, error_orientation, run_trial, &
        trial_t
    implicit none
    private
    public :: hard_case_t, hard_cases, settings_of, stability_study_t, own_case, stability_columns, add_row, verdict_names, &
        verdict_meaning, judge_trial, explain_trial, verdict_accurate, verdict_drifts, verdict_wrong, verdict_failed, &
        verdict_unsuitable, verdict_no_reference

    !> A case of the catalogue.
    type :: hard_case_t
        character(24) :: name
        !> Description, and the difficulty.
        character(112) :: what
        !> Parameters in addition to those of `bodies`, separated by semicolons.
        character(176) :: settings
        !> Index in `bodies`.
        integer :: body = 1
        !> Whether it takes long, and is therefore run on request only.
        logical :: is_long = .false.
    end type hard_case_t

    integer, parameter :: slow = 1, wheel = 2, ball = 3, rod = 4, disc = 5, free = 6, kovalevskaya = 7, &
        goryachev = 8, skew = 9, benchmark = 10, shell = 11, damped = 12, almost = 13, needle = 14, plain = 15

    !> The bodies: the slow top of Example 1 of the paper, the wheel of Example 2, and others.
    character(*), parameter :: bodies(*) = [character(160) :: &
        'top.mass=1;top.inertia=0.875,0.875,0.25;top.length=0.86602540378443865', &
        'top.mass=2.450442269800039;top.inertia=2.4565887958267872,2.4565887958267872,0.012252211349000194;top.length=1', &
        'top.mass=1;top.inertia=1,1,1.9;top.length=1', &
        'top.mass=1;top.inertia=1,1,1e-4;top.length=1', &
        'top.mass=1;top.inertia=1,1,2;top.length=0', &
        'top.mass=1;top.inertia=1,2,3;top.length=0', &
        'top.mass=1;top.gravity=1;top.inertia=2,2,1;top.centre_of_mass=1,0,0', &
        'top.mass=1;top.gravity=1;top.inertia=4,4,1;top.centre_of_mass=1,0,0', &
        'top.mass=10;top.gravity=10;top.inertia=1,1.5,2.25;top.centre_of_mass=0.01,0.005,0.02', &
        'top.mass=15;top.inertia=0.234375,0.46875,0.234375;top.inertia_about=centre_of_mass;top.centre_of_mass=0,1,0', &
        'top.mass=1;top.gravity=20;top.inertia=5,5,1;top.length=1', &
        'top.mass=1;top.inertia=0.875,0.7,0.25;top.centre_of_mass=0.05,-0.03,0.86;top.damping=0.01,0.01,0.005', &
        'top.mass=1;top.inertia=0.875,0.8750001,0.25;top.length=0.86602540378443865', &
        'top.mass=0.12;top.inertia=1.7231e-4,6.58e-6,1.7243e-4;top.length=0', &
        'top.mass=1;top.inertia=0.9,0.9,0.3;top.length=0.5']

    !> The catalogue.
    type(hard_case_t), parameter :: hard_cases(*) = [ &
        hard_case_t('slow_top', 'Example 1 of the paper: falls through 164 degrees and turns fast at the bottom', &
            'initial.theta=0.19634954084936207;initial.psi_rate=1;span.nutations=5;integration.steps=4000', slow), &
        hard_case_t('pole_upright', 'passes the upright at 1e-6 rad: phi changes by half a turn at once', &
            'initial.theta=1e-6;initial.phi_rate=3.1e6;initial.omega3=5;span.nutations=4;integration.steps=4000', slow), &
        hard_case_t('pole_hanging', 'passes the hanging position at 1e-6 rad: phi changes by half a turn at once', &
            'initial.theta=3.1415916535897932;initial.phi_rate=-6.2e6;initial.omega3=5;span.nutations=4;' // &
            'integration.steps=4000', slow), &
        hard_case_t('through_upright', 'starts upright with a transverse velocity: phi and psi do not exist there', &
            'initial.quaternion=1,0,0,0;initial.omega=3,0,5;span.nutations=4;integration.steps=4000', slow), &
        hard_case_t('through_hanging', 'starts hanging with a transverse velocity: phi and psi do not exist there', &
            'initial.quaternion=0,1,0,0;initial.omega=4,0,-5;span.nutations=4;integration.steps=4000', slow), &
        hard_case_t('sleeping_above', '1e-6 rad from the upright, 1 percent above the threshold spin', &
            'initial.theta=1e-6;initial.omega3=22.03;span.t_end=20;integration.steps=4000', slow), &
        hard_case_t('sleeping_at', '1e-3 rad from the upright, at the threshold spin: perturbations grow as a power of time', &
            'initial.theta=1e-3;initial.omega3=21.8119168043289;span.t_end=20;integration.steps=4000', slow), &
        hard_case_t('sleeping_below', '1e-6 rad from the upright, too slow to sleep: falls after a long rest, and rises again', &
            'initial.theta=1e-6;initial.omega3=15;span.t_end=16;integration.steps=4000', slow), &
        hard_case_t('separatrix', 'approaches the upright asymptotically: errors grow by a factor of a million', &
            'initial.theta=0.5;initial.phi_rate=2.2825667;initial.theta_rate=-1.0861182;initial.omega3=15;' // &
            'span.t_end=12;integration.steps=4000', slow), &
        hard_case_t('near_steady', 'steady precession with a nutation rate of 1e-6 rad/s: a small nutation of a large motion', &
            'initial.theta=1.0471975511965976;initial.phi_rate=0.88373947226147785;initial.theta_rate=1e-6;' // &
            'initial.omega3=40;span.t_end=20;integration.steps=8000', slow), &
        hard_case_t('very_fast_spin', 'the wheel of Example 2 at 8859 rad/s: 50 nutations of 2e-3 rad', &
            'initial.theta=0.19634954084936207;initial.omega3=8858.9;span.nutations=50;integration.steps=8000', wheel), &
        hard_case_t('plane_pendulum', 'no spin: a plane pendulum, through the hanging position', &
            'initial.theta=2;span.t_end=20;integration.steps=4000', slow), &
        hard_case_t('spherical_pendulum', 'no spin: a spherical pendulum that passes the hanging position at 1e-3 rad', &
            'initial.theta=2;initial.phi_rate=5e-3;initial.omega3=0;span.t_end=20;integration.steps=4000', slow), &
        hard_case_t('oblate', 'an oblate body (I3 > I1): its spin relative to the free precession is retrograde', &
            'initial.theta=0.5;initial.omega3=3;span.nutations=8;integration.steps=4000', ball), &
        hard_case_t('thin_rod', 'a thin rod that spins at 50000 rad/s, with little effect on its motion', &
            'initial.theta=0.5;initial.omega3=50000;span.t_end=10;integration.steps=20000', rod), &
        hard_case_t('flat_disc', 'a free disc about its centre, at the limit of the triangle inequality', &
            'initial.theta=0.7;initial.phi_rate=2;initial.omega3=30;span.t_end=20;integration.steps=8000', disc), &
        hard_case_t('million_nutations', 'Example 1 of the paper for 2.4 million seconds', &
            'initial.theta=0.19634954084936207;initial.psi_rate=1;span.nutations=1e6;integration.steps=200000000;' // &
            'integration.max_steps=2000000000', slow, is_long=.true.), &
        hard_case_t('thousand_nutations', 'Example 1 of the paper for forty minutes: errors accumulate', &
            'initial.theta=0.19634954084936207;initial.psi_rate=1;span.nutations=1000;integration.steps=200000', slow, &
            is_long=.true.), &
        hard_case_t('intermediate_axis', 'a free body that rotates about its intermediate axis, and turns over repeatedly', &
            'initial.quaternion=1,0,0,0;initial.omega=1e-3,1,1e-3;span.t_end=100;integration.steps=8000', free), &
        hard_case_t('unstable_rotation', 'the same, started 1e-8 rad/s off that axis: errors grow by a factor of 1e8', &
            'initial.quaternion=1,0,0,0;initial.omega=1e-8,1,1e-8;span.t_end=80;integration.steps=8000', free), &
        hard_case_t('free_needle', 'a free body with two moments that differ by 7e-4, and one 26 times smaller', &
            'initial.quaternion=1,0,0,0;initial.omega=30,100,1;span.t_end=10;integration.steps=16000', needle), &
        hard_case_t('nearly_symmetric', 'Example 1 of the paper with moments that differ by 1e-7: it has no closed form', &
            'initial.theta=0.19634954084936207;initial.psi_rate=1;span.t_end=10;integration.steps=8000', almost), &
        hard_case_t('kovalevskaya', 'the Kovalevskaya top (integrable): its centre of mass is not on the symmetry axis', &
            'initial.quaternion=0.77046945974922898,0.57785209481169215,0.24077170617153840,-0.12038585308576920;' // &
            'initial.omega=0.5,0.25,1;span.t_end=100;integration.steps=8000', kovalevskaya), &
        hard_case_t('goryachev_chaplygin', 'the Goryachev-Chaplygin top: integrable only without vertical momentum', &
            'initial.quaternion=1,0,0,0;initial.omega=1,0.5,0;span.t_end=100;integration.steps=8000', goryachev), &
        hard_case_t('chaotic_body', 'a body without symmetry: neighbouring motions diverge', &
            'initial.quaternion=0.8,0.6,0,0;initial.omega=0.5,0.5,1;span.t_end=100;integration.steps=20000', skew), &
        hard_case_t('heavy_top_benchmark', 'Bruels, Cardona and Arnold 2012: a fast top with its axis along body y', &
            'initial.quaternion=1,0,0,0;initial.omega=0,150,-4.61538;span.t_end=2;integration.steps=4000', benchmark), &
        hard_case_t('simo_wong', 'Simo and Wong 1991: a fast top that is nearly upright', &
            'initial.theta=0.05;initial.omega3=50;span.t_end=10;integration.steps=8000', shell), &
        hard_case_t('damped_body', 'a body without symmetry, with damping: energy and momentum decay', &
            'initial.theta=0.19634954084936207;initial.omega3=10;span.t_end=20;integration.steps=8000', damped), &
        hard_case_t('friction_to_rest', 'dry friction and drag bring a top to rest: no derivative exists at that instant', &
            'initial.theta=2;initial.omega3=8;effects.friction_torque=0.4;effects.drag_force=0.05;span.t_end=20;' // &
            'integration.steps=8000', plain), &
        hard_case_t('fast_vibration', 'a body without spin that a fast vibration of its pivot holds upright (Kapitza)', &
            'initial.theta=0.1;effects.vibration_amplitude=0,0,0.15;effects.vibration_rate=60;span.t_end=4;' // &
            'integration.steps=4000', plain), &
        hard_case_t('motor_resonance', 'a motor spins a hanging body up: its slow swing passes the rate of a vibrating pivot', &
            'initial.theta=3.04;effects.torque_body=0,0,0.1;effects.vibration_amplitude=0.02,0,0;' // &
            'effects.vibration_rate=1.5;span.t_end=40;integration.steps=8000', plain)]

    !> Name of the case of the input.
    character(*), parameter :: own_case = 'input'
    !> Default tolerance, and number of steps for the case of the input.
    real(dp), parameter :: default_tolerance = 1.0e-12_dp
    integer, parameter :: default_steps = 8000
    !> Methods on motions that are difficult to integrate.
    type, extends(comparison_t) :: stability_study_t
        !> Indices in the catalogue; 0 is the case of the input.
        integer, allocatable :: places(:)
        !> The relative tolerance of adaptive methods.
        real(dp) :: tolerance = default_tolerance
    contains
        procedure :: check
        procedure :: choose
        procedure :: scene_of
        procedure :: settings
        procedure :: compare
        procedure :: judge
        procedure :: summarize
    end type stability_study_t

    !> All columns, in the order of the table.
    type(column), parameter :: stability_columns(*) = [ &
        column('case', '', 'case of the catalogue', 'trial', traits=categorical), &
        column('method', '', 'method', 'trial', traits=categorical), &
        column('formulation', '', 'formulation of the equations of motion', 'trial', traits=categorical), &
        column('verdict', '', 'verdict on the computed motion', 'verdict', traits=categorical), &
        column('orientation_error', 'rad', 'largest rotation angle from the reference attitude', 'errors'), &
        column('tip_error', '', 'largest distance of the axis tip from that of the reference', 'errors'), &
        column('energy_error', '', 'largest energy error over (kinetic at start + m g |r|)', 'errors'), &
        column('lz_error', '', 'largest error of the vertical momentum, over its scale', 'errors'), &
        column('l3_error', '', 'largest error of the momentum about body z, over the same scale', 'errors'), &
        column('norm_error', '', 'largest norm error abs(q) - 1 of the quaternion', 'errors'), &
        column('inherent_error', 'rad', 'error of the attitude due to rounding of the data', 'errors'), &
        column('steps', '', 'steps', 'cost'), &
        column('rejected', '', 'rejected steps', 'cost'), &
        column('evaluations', '', 'RHS evaluations', 'cost'), &
        column('time_s', 's', 'computing time', 'cost'), &
        column('status', '', 'status of the run', 'verdict', traits=categorical), &
        column('t', 's', 'time reached', 'verdict'), &
        column('upright_growth', '1/s', 'largest growth rate of the symmetric top sleeping upright with this spin', 'growth'), &
        column('lyapunov_exponent', '1/s', 'mean growth rate of perturbations over the span', 'growth'), &
        column('reference', '', 'reference of the comparison', 'reference', traits=categorical), &
        column('reference_error', 'rad', 'difference between two computations of the reference', 'reference'), &
        column('reason', '', 'reason of the verdict', 'verdict', traits=categorical)]

    !> Combinations that are run in addition to each method with the formulation that suits the body.
    character(*), parameter :: more_choices(*) = [character(28) :: 'rk4/lagrange', 'rk4/euler', &
        'ode45/lagrange', 'ode45/euler', 'dop853/lagrange', 'dop853/euler', 'taylor/rigid_body', &
        'splitting_8/rigid_body']

    !> Fewest and most intervals between the times at which a motion is compared, as far as the steps allow it.
    integer, parameter :: fewest_intervals = 40, most_intervals = 1000

    !> The verdicts, from best to worst, one for methods that are not for such a body, and one for cases
    !> whose motion is not known.
    integer, parameter :: verdict_accurate = 1, verdict_drifts = 2, verdict_wrong = 3, &
        verdict_failed = 4, verdict_unsuitable = 5, verdict_no_reference = 6
    character(*), parameter :: verdict_names(*) = [character(12) :: &
        'accurate', 'drifts', 'wrong', 'failed', 'unsuitable', 'no_reference']

    !> Orientation errors, rad: accurate up to the first one, which increases with the inherent error; wrong
    !> beyond the second.
    real(dp), parameter :: accurate_below = 1.0e-6_dp, floors = 100, wrong_above = 0.1_dp

contains

    !> The settings of a case of the catalogue, those of its body included.
    pure function settings_of(case) result(settings)
        type(hard_case_t), intent(in) :: case !! entry of the catalogue
        character(:), allocatable :: settings
        settings = trim(bodies(case%body)) // ';' // trim(case%settings)
    end function settings_of

    !> Finds the cases and the methods; checks the case of the input if it is one of them.
    subroutine check(self, job, problems)
        class(stability_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(scene_t), allocatable :: scene
        integer :: k

        call self%choose(job%input%scene, problems)
        self%count = size(self%places)
        self%attempts_each = size(self%choices)
        allocate (self%verdicts(size(self%choices), size(verdict_names)), source=0_int64)
        self%phrase = 'the stability of ' // to_text(size(self%choices)) // ' methods on ' // to_text(size(self%places)) // ' cases'
        do k = 1, size(verdict_names)
            call append(self%remarks, 'verdict ' // trim(verdict_names(k)) // ': ' // verdict_meaning(k))
        end do
        if (problems%any() .or. all(self%places > 0)) return
        call job%make_first_case(scene, problems, planned=.false.)
    end subroutine check

    !> The named cases and methods, or all.
    subroutine choose(self, scene, problems)
        class(stability_study_t), intent(inout) :: self
        type(scene_t), intent(in) :: scene !! contents of the input
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        character(*), parameter :: compares = 'a stability study compares methods and formulations', &
            hint = 'name them in stability.methods'
        type(method_info_t), allocatable :: methods(:)
        integer :: i, k, slash

        if (scene%stop_at /= '') then
            call problems%add('span.stop_at', 'a stability study computes each motion to the end of its span', 'omit it')
        end if
        if (scene%method /= 'auto') call problems%add('integration.method', compares, hint)
        if (scene%formulation /= 'auto') call problems%add('integration.formulation', compares, hint)
        if (all(scene%stability_cases == '')) then
            self%places = pack([(i, i=1, size(hard_cases))], .not. hard_cases%is_long)
        else
            call find_cases('stability.cases', 'case', scene%stability_cases, [character(24) :: hard_cases%name, own_case], &
                            self%places, problems)
            where (self%places > size(hard_cases)) self%places = 0 ! the case of the input
        end if
        if (is_set(scene%relative_tolerance)) self%tolerance = scene%relative_tolerance
        if (allocated(self%choices)) deallocate (self%choices)
        allocate (self%choices(0))
        allocate (methods, source=infos_of_methods(scene))
        call add_methods('stability.methods', names_of_methods(scene, scene%stability_methods), methods, ['auto'], &
                         self%choices, problems)
        if (any(scene%stability_methods /= '')) return
        ! Every method with the formulation that suits the body, some also with others.
        do i = 1, size(methods)
            self%choices = [self%choices, method_choice_t(methods(i))]
            do k = 1, size(more_choices)
                slash = index(more_choices(k), '/')
                if (more_choices(k)(:slash - 1) /= methods(i)%name) cycle
                self%choices = [self%choices, method_choice_t(methods(i), more_choices(k)(slash + 1:))]
            end do
        end do
    end subroutine choose

    !> The scene of a case: of the catalogue, with the tolerances and tables of the input, or (0) the input itself.
    subroutine scene_of(self, input, place, scene, error)
        class(stability_study_t), intent(in) :: self
        type(scene_t), intent(in) :: input !! the scene of the input
        integer, intent(in) :: place !! index in the catalogue
        type(scene_t), intent(inout) :: scene !! becomes the scene of the case
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (place > 0) then
            call make_scene_of_settings(settings_of(hard_cases(place)), scene, error)
            scene%absolute_tolerance = input%absolute_tolerance
            if (allocated(input%tableaus)) scene%tableaus = input%tableaus
        else
            scene = input
            if (scene%steps == unset_integer) scene%steps = default_steps
        end if
    end subroutine scene_of

    !> The setting of a method: adaptive methods use the tolerances of the input, the others the number of steps of the case.
    function settings(self, choice, problem)
        class(stability_study_t), intent(in) :: self
        type(method_choice_t), intent(in) :: choice !! method and formulation
        type(problem_t), intent(in) :: problem !! the case
        type(setting_t), allocatable :: settings(:)
        if (.not. choice%method%adaptive) then
            settings = [setting_t(steps=problem%scene%steps)]
        else if (choice%method%needs == structure_quadruple) then
            settings = [setting_t()] ! its default tolerances are smaller
        else
            settings = [setting_t(tolerance=self%tolerance)]
        end if
    end function settings

    !> Runs all methods on a case.
    subroutine compare(self, job, number, cells, summary, error)
        class(stability_study_t), intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        integer(int64), intent(in) :: number !! of the case
        type(text_buffer_t), intent(inout) :: cells !! the rows are appended
        type(summary_t), intent(inout) :: summary !! lines are added
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(problem_t), allocatable :: problem
        type(problems_t) :: problems
        type(motion_t) :: sleeping
        complex(dp) :: eigenvalues(6)
        real(dp) :: upright_growth, lyapunov_exponent
        integer :: i, intervals, status

        allocate (problem)
        problem%name = own_case
        associate (place => self%places(number))
            if (place > 0) problem%name = trim(hard_cases(place)%name)
            call self%scene_of(job%input%scene, place, problem%scene, error)
        end associate
        if (allocated(error)) return
        call make_case(problem%scene, problem%case, problems)
        if (problems%any()) then
            error = internal_error('stability: case ' // problem%name // ': ' // problems%first())
            return
        end if
        ! Steps of fixed size lie between the times of the comparison: all of them, if they are not too many.
        do intervals = min(problem%scene%steps, most_intervals), fewest_intervals, -1
            if (mod(problem%scene%steps, intervals) == 0) exit
        end do
        if (intervals < fewest_intervals) intervals = problem%scene%steps
        call find_reference(problem%case, 1 + intervals, reference_auto, int(problem%scene%max_steps, int64), &
                            problem%reference, problem%status)
        ! Growth rates of perturbations, 1/s; NaN if they do not exist.
        upright_growth = no_number
        associate (case => problem%case)
            if (case%body%is_lagrange()) then
                sleeping = motion_from_quaternion(0.0_dp, [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], &
                                                  [0.0_dp, 0.0_dp, case%start%omega(3)], case%start%angle)
                call find_equilibrium_eigenvalues(case%body, sleeping, eigenvalues, status)
                if (is_ok(status)) upright_growth = maxval(real(eigenvalues, dp))
            end if
            call find_lyapunov(case%body, case%start, case%t_end, lyapunov_exponent, status, &
                               max_steps=min(problem%scene%max_steps, huge(1) - 1))
            if (.not. is_ok(status)) lyapunov_exponent = no_number
        end associate
        call self%try_all(problem)
        do i = 1, size(self%attempts)
            associate (row => self%attempts(i))
                self%verdicts(row%number, row%verdict) = self%verdicts(row%number, row%verdict) + 1
                call add_row(problem, row, upright_growth, lyapunov_exponent, cells)
            end associate
        end do
        if (is_ok(problem%status)) then
            call self%count_end(self%attempts%verdict /= verdict_unsuitable)
        else
            self%failures = self%failures + 1
        end if
    end subroutine compare

    !> Runs one method on a case, and finds the verdict. There is no row for a combination that was run already, or that would be
    !> compared with itself.
    subroutine judge(self, problem, scene, plan, attempt)
        class(stability_study_t), intent(inout) :: self
        type(problem_t), intent(in) :: problem !! the case
        type(scene_t), intent(in) :: scene !! its scene with the method
        type(plan_t), intent(inout) :: plan !! the plan of that scene
        type(attempt_t), intent(inout) :: attempt !! completed by this procedure

        attempt%is_kept = .not. (attempt%is_repeated .or. attempt%is_reference)
        if (.not. attempt%is_kept) return
        ! A method that was not run has no errors, no computing time and no end.
        attempt%trial%errors = no_number
        attempt%trial%time = no_number
        attempt%trial%t = no_number
        if (attempt%reason /= '') then
            attempt%verdict = verdict_unsuitable
        else if (.not. is_ok(problem%status)) then
            attempt%verdict = verdict_no_reference
            attempt%trial%status = problem%status
            attempt%reason = 'no reference: ' // status_meaning(problem%status)
        else
            call run_trial(problem%case, plan, problem%reference, attempt%trial)
            attempt%verdict = judge_trial(attempt%trial, maxval(problem%reference%floor), problem%reference%uncertainty)
            attempt%reason = explain_trial(attempt%trial, attempt%verdict)
        end if
    end subroutine judge

    !> Adds a row, a cell per column.
    subroutine add_row(problem, row, upright_growth, lyapunov_exponent, cells)
        type(problem_t), intent(in) :: problem !! the case
        type(attempt_t), intent(in) :: row !! the row
        real(dp), intent(in) :: upright_growth, lyapunov_exponent !! growth rates of the case, 1/s
        type(text_buffer_t), intent(inout) :: cells !! the row is appended
        real(dp) :: inherent_error

        inherent_error = no_number
        if (is_ok(problem%status)) inherent_error = maxval(problem%reference%floor)
        call row%begin_cells(problem%name, cells)
        call cells%add_text(verdict_names(row%verdict))
        associate (errors => row%trial%errors, counts => row%trial%counts)
            call cells%add_reals([errors(:error_norm), inherent_error])
            call cells%add_integer(counts%steps)
            call cells%add_integer(counts%rejected)
            call cells%add_integer(counts%evaluations)
        end associate
        call cells%add_reals([row%trial%time])
        ! A combination that does not suit the body was not run.
        if (row%verdict == verdict_unsuitable) then
            call cells%add_text(verdict_names(verdict_unsuitable))
        else
            call cells%add_text(status_names(row%trial%status))
        end if
        call cells%add_reals([row%trial%t, upright_growth, lyapunov_exponent])
        call cells%add_text(problem%reference%source)
        call cells%add_reals([problem%reference%uncertainty])
        call cells%add_text(row%reason)
        call cells%end_row()
    end subroutine add_row

    !> The verdicts, and the results of each method in one line.
    subroutine summarize(self, summary)
        class(stability_study_t), intent(in) :: self
        type(summary_t), intent(inout) :: summary !! lines are added
        integer, parameter :: width = 36
        character(:), allocatable :: text
        integer :: i, k, length

        do k = 1, size(verdict_names)
            if (k == verdict_no_reference .and. all(self%verdicts(:, k) == 0)) cycle
            call summary%add(verdict_names(k), verdict_meaning(k), is_detail=.true.)
        end do
        do k = 1, size(self%verdicts, 1)
            associate (choice => self%choices(k))
                text = trim(choice%method%name)
                if (choice%formulation /= 'auto') text = text // '/' // trim(choice%formulation)
            end associate
            text = text // repeat(' ', max(1, width - len(text)))
            length = len(text)
            do i = 1, size(verdict_names)
                if (self%verdicts(k, i) == 0) cycle
                if (len(text) > length) text = text // ', '
                text = text // to_text(self%verdicts(k, i)) // ' ' // trim(verdict_names(i))
            end do
            call summary%add('', text)
        end do
    end subroutine summarize

    !> Meaning of a verdict.
    function verdict_meaning(verdict) result(meaning)
        integer, intent(in) :: verdict !! one of the verdict constants
        character(:), allocatable :: meaning
        select case (verdict)
        case (verdict_accurate)
            meaning = 'orientation error at most ' // to_text(accurate_below) // ' rad plus ' // to_text(nint(floors)) &
                      // ' times the inherent error'
        case (verdict_drifts)
            meaning = 'orientation error at most ' // to_text(wrong_above) // ' rad'
        case (verdict_wrong)
            meaning = 'orientation error above ' // to_text(wrong_above) // ' rad'
        case (verdict_failed)
            meaning = 'the method ended before the end of the span, with a status'
        case (verdict_no_reference)
            meaning = 'there is no motion to compare with, or it is not known to ' // to_text(wrong_above) // ' rad'
        case default
            meaning = 'the method or its equations do not apply to the body'
        end select
    end function verdict_meaning

    !> The verdict on a trial; `floor` is the inherent error of the attitude, rad, and `uncertainty` that of the reference.
    pure integer function judge_trial(trial, floor, uncertainty) result(verdict)
        type(trial_t), intent(in) :: trial !! result of the computation
        real(dp), intent(in) :: floor, uncertainty !! inherent error of the attitude, and error of the reference, rad
        if (.not. is_ok(trial%status)) then
            verdict = verdict_failed
        else if (accurate_below + floors * floor > wrong_above .or. uncertainty > wrong_above) then
            verdict = verdict_no_reference
        else if (trial%errors(error_orientation) <= accurate_below + floors * floor) then
            verdict = verdict_accurate
        else if (trial%errors(error_orientation) <= wrong_above) then
            verdict = verdict_drifts
        else
            verdict = verdict_wrong
        end if
    end function judge_trial

    !> The reason for a verdict; empty for an accurate trial.
    function explain_trial(trial, verdict) result(reason)
        type(trial_t), intent(in) :: trial !! result of the computation
        integer, intent(in) :: verdict !! one of the verdict constants
        character(:), allocatable :: reason
        !> If the relative error of an invariant is below this fraction of the orientation error, the
        !> invariant does not show that error.
        real(dp), parameter :: hidden = 1.0e-3_dp
        character(:), allocatable :: invariants

        reason = ''
        select case (verdict)
        case (verdict_failed)
            reason = 'at t = ' // rounded(trial%t) // ' s: ' // trim(status_meanings(trial%status))
        case (verdict_no_reference)
            reason = 'the motion is not known to ' // to_text(wrong_above) // ' rad'
        case (verdict_drifts, verdict_wrong)
            associate (errors => trial%errors)
                reason = 'orientation error ' // scientific(errors(error_orientation)) // ' rad'
                invariants = 'energy error ' // scientific(errors(error_energy)) // ', momentum error ' &
                             // scientific(maxval(errors([error_lz, error_l3])))
                if (maxval(errors([error_energy, error_lz, error_l3])) < hidden * errors(error_orientation)) then
                    reason = reason // ', although ' // invariants
                else
                    reason = reason // '; ' // invariants
                end if
            end associate
        end select
    end function explain_trial

    !> A number with two digits.
    function scientific(value) result(text)
        real(dp), intent(in) :: value
        character(:), allocatable :: text
        character(16) :: buffer
        write (buffer, '(ss, es9.1e3)') value
        text = trim(adjustl(buffer))
    end function scientific

end module spintop_stability_study
