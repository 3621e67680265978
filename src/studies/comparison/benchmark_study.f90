!> Published benchmark tops: the true value of each quantity, the published figure with its error, and the fastest setting
!> of this program that is a hundred times better.
!>
!> The true value is that of a motion in quadruple precision. Where there is an exact solution the two are compared. The
!> catalogue has the settings of each benchmark as in an input, the source, and the figures that were published. A quantity
!> without a figure in the source has none here. The last benchmarks are special solutions, which are known in closed form or
!> by an invariant.
module spintop_benchmark_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t, make_case
    use spintop_kinds, only: degree, dp, no_number, is_finite
    use spintop_comparison, only: add_methods, find_cases, method_choice_t, setting_t, attempt_t, comparison_t, &
        make_scene_of_settings, problem_t
    use spintop_errors, only: error_t, internal_error
    use spintop_job, only: job_t
    use spintop_motion, only: motion_t
    use spintop_row_block, only: text_buffer_t
    use spintop_trajectory_columns, only: row_maker_t, trajectory_columns
    use spintop_own_butcher_tables, only: infos_of_methods, names_of_methods
    use spintop_planning, only: plan_t
    use spintop_problems, only: problems_t
    use spintop_trial, only: find_reference, reference_t, time_trial
    use spintop_scene_keys, only: scene_t, reference_exact, reference_quadruple
    use spintop_status, only: is_good_end, is_ok, status_meaning
    use spintop_study_column, only: categorical, column => study_column_t, place_of
    use spintop_summary, only: rounded, summary_t
    use spintop_text, only: counted, to_text
    implicit none
    private
    public :: benchmark_study_t, benchmark_columns, benchmark_t, benchmarks, figure_t, figures

    !> A benchmark of the literature.
    type :: benchmark_t
        character(24) :: name
        !> What it is.
        character(88) :: what
        !> Where it was published.
        character(192) :: source
        !> Parameters as in an input, separated by semicolons.
        character(288) :: settings
    end type benchmark_t

    !> A quantity of a benchmark at the end of its span.
    type :: figure_t
        !> Name of the benchmark, and of a column of trajectories.
        character(24) :: benchmark
        character(8) :: column
        !> The published figure; NaN if there is none. The sign of a quaternion is that of the published one.
        real(dp) :: published = no_number
        !> Who published it, with which method and step.
        character(112) :: method = ''
    end type figure_t

    !> The body and the start of Bruels, Cardona and Arnold.
    character(*), parameter :: heavy_top = 'top.mass=15;top.inertia=0.234375,0.46875,0.234375;' // &
        'top.inertia_about=centre_of_mass;top.centre_of_mass=0,1,0;initial.quaternion=1,0,0,0;initial.omega=0,150,-4.61538;'
    character(*), parameter :: of_heavy_top = 'O. Bruels, A. Cardona, M. Arnold, Lie group generalized-alpha time integration ' // &
        'of constrained flexible multibody systems, Mech. Mach. Theory 48, 2012'
    character(*), parameter :: fine_alpha = 'Kynema verification suite: Lie group generalized-alpha, step 2e-6 s', &
        coarse_alpha = 'Exudyn test heavyTop: generalized-alpha in Matlab, step 1e-4 s', &
        by_rk4 = 'Exudyn test heavyTop: RK4 in Matlab', &
        by_exudyn = 'Exudyn test heavyTop: generalized-alpha, index 2, step 1e-4 s', &
        by_cvode = 'Assimulo example cvode_gyro: CVODE, BDF of order 2, tolerances 1e-10', &
        by_nsdtst = 'NSDTST, ACM algorithm 648: reference value', &
        by_ottr = 'OTTR, OpenTurbine in Rust, test of the heavy top: Lie group generalized-alpha, step 0.002 s', &
        by_openturbine = 'OpenTurbine test PrecessionTest: Lie group generalized-alpha, step 0.01 s', &
        by_nasa_1 = 'NASA check-case 2, simulation 1', by_nasa_5 = 'NASA check-case 2, simulation 5', &
        by_mujoco = 'MuJoCo test engine_forward_test: Euler, step 0.01 s, energy 1.09 times that of the start', &
        by_implicitfast = 'MuJoCo test FreeBodyConservation: implicitfast, step 0.01 s, energy 0.93 times that of the start', &
        by_exudyn_lie = 'Exudyn Lie group test in Python: RK4, converged to 14 digits', &
        by_exudyn_parameters = 'Exudyn Lie group test: generalized-alpha, index 2, Euler parameters', &
        by_exudyn_vector = 'Exudyn Lie group test: RK4 in the rotation vector, 4000 steps', &
        by_exudyn_rk4 = 'Exudyn Lie group test: RK4 on the group, step 1e-4 s', &
        by_exudyn_dopri5 = 'Exudyn Lie group test: DOPRI5 on the group, tolerance 1e-14', &
        by_metis_eml = 'metis, reference solution EML', by_metis_emh = 'metis, reference solution EMH'
    !> y1' = y2 y3, y2' = -y1 y3, y3' = -0.51 y1 y2 from (0, 1, 1) is the motion of a body with moments 25, 42 and 18, of
    !> which the angular velocities are 9/5 y1, 3/4 y2 and 5/2 y3.
    real(dp), parameter :: detest(3) = [-0.9396570798729192_dp * 9 / 5, -0.3421177754000779_dp * 3 / 4, &
                                        0.7414126596199957_dp * 5 / 2]
    !> The angular velocity of simulation 5, rad/s; it is given in degrees. The moments of the brick stand below in slug ft^2,
    !> because their unit does not matter to a free body.
    real(dp), parameter :: brick(3) = [12.61842377_dp, -17.3974441_dp, 31.11960301_dp] * degree
    !> Its attitude, from the published roll, pitch and yaw. These are relative to north, east and down where the brick is, axes
    !> that turn about north with the Earth, 7.292115e-5 rad/s, and with the longitude, which is 1.0027827516629e-6 rad at 30 s;
    !> a free body has an attitude relative to the axes of the start. The signs are those of the true quaternion.
    real(dp), parameter :: brick_attitude_1(4) = [-0.8811471852979136_dp, 0.4701825277883141_dp, 0.011728252325837848_dp, &
                                                  0.048687539489454555_dp]
    real(dp), parameter :: brick_attitude_5(4) = [-0.881147354599921_dp, 0.4701822699715538_dp, 0.01172837307154365_dp, &
                                                  0.04868693614361647_dp]
    !> The kinetic energy of the box at the start, J.
    real(dp), parameter :: box_energy = 0.49_dp / 3

    !> The catalogue.
    type(benchmark_t), parameter :: benchmarks(*) = [ &
        benchmark_t('heavy_top', 'fast top with its axis along body y, to t = 2', of_heavy_top, heavy_top // 'span.t_end=2'), &
        benchmark_t('heavy_top_start', 'the same to t = 0.2', of_heavy_top, heavy_top // 'span.t_end=0.2'), &
        benchmark_t('heavy_top_middle', 'the same to t = 0.8', of_heavy_top, heavy_top // 'span.t_end=0.8'), &
        benchmark_t('heavy_top_first', 'the same to t = 0.01', of_heavy_top, heavy_top // 'span.t_end=0.01'), &
        benchmark_t('heavy_top_rate', 'the same to t = 2, its angular velocity', of_heavy_top, heavy_top // 'span.t_end=2'), &
        benchmark_t('simo_wong', 'fast top that is nearly upright', &
                    'J. C. Simo, K. K. Wong, Unconditionally stable algorithms for rigid body dynamics that exactly ' // &
                    'preserve energy and momentum, Int. J. Numer. Meth. Engng 31, 1991', &
                    'top.mass=1;top.gravity=20;top.inertia=5,5,1;top.length=1;initial.theta=0.05;initial.omega3=50;' // &
                    'span.t_end=10'), &
        benchmark_t('steady_cone', 'cone in steady precession at 60 degrees', &
                    'P. L. Kinon, P. Betsch, input of ggl_vi_error_analysis in the code metis, 2021', &
                    'top.shape=cone;top.radius=0.05;top.thickness=0.1;top.density=2700;initial.theta_deg=60;' // &
                    'initial.phi_rate=10;initial.psi_rate=135.6;span.t_end=1'), &
        benchmark_t('free_gyroscope', 'free body without symmetry', &
                    'E. Celledoni, N. Saefstroem, Efficient time-symmetric simulation of torqued rigid bodies using Jacobi ' // &
                    'elliptic functions, J. Phys. A 39, 2006', &
                    'top.mass=1;top.inertia=1000,5000,6000;top.length=0;initial.quaternion=1,0,0,0;' // &
                    'initial.omega=10,10,10;span.t_end=0.1'), &
        benchmark_t('euler_equations', 'Euler equations of a free body, y1'' = y2 y3, y2'' = -y1 y3, y3'' = -0.51 y1 y2', &
                    'Problem B5 of T. E. Hull, W. H. Enright, B. M. Fellen, A. E. Sedgwick, Comparing numerical methods ' // &
                    'for ordinary differential equations, SIAM J. Numer. Anal. 9, 1972', &
                    'top.mass=1;top.inertia=25,42,18;top.length=0;initial.quaternion=1,0,0,0;initial.omega=0,0.75,2.5;' // &
                    'span.t_end=20'), &
        benchmark_t('free_symmetric_body', 'free symmetric body in regular precession', &
                    'OpenTurbine, test PrecessionTest, National Renewable Energy Laboratory, 2026', &
                    'top.mass=1;top.inertia=1,1,0.5;top.length=0;initial.quaternion=1,0,0,0;' // &
                    'initial.omega=0.5,0.5,1;span.t_end=5'), &
        benchmark_t('tumbling_brick', 'free brick that turns with 10, 20 and 30 deg/s about its axes', &
                    'D. G. Murri, E. B. Jackson, R. O. Shelton, Check-cases for verification of 6-degree-of-freedom flight ' // &
                    'vehicle simulations, NASA/TM-2015-218675, 2015', &
                    'top.mass=1;top.inertia=0.001894220,0.006211019,0.007194665;top.length=0;initial.quaternion=1,0,0,0;' // &
                    'initial.omega=0.17453292519943295,0.3490658503988659,0.5235987755982988;span.t_end=30'), &
        benchmark_t('tumbling_box', 'free box of 0.2 x 0.4 x 0.6 m that tumbles for 5 s', &
                    'MuJoCo, test/engine/engine_forward_test.cc, Google DeepMind, 2026', &
                    'top.mass=1;top.inertia=0.043333333333333335,0.033333333333333333,0.016666666666666666;top.length=0;' // &
                    'initial.quaternion=1,0,0,0;initial.omega=1,2,3;span.t_end=5'), &
        benchmark_t('flipping_body', 'free body that turns nearly about its intermediate axis', &
                    'R. van Zon, J. Schofield, Numerical implementation of the exact dynamics of free rigid bodies, ' // &
                    'J. Comput. Phys. 225, 2007, with the start of JSBSim, check_cases/notebooks/rotation, 2026', &
                    'top.mass=1;top.inertia=10,20,26;top.length=0;initial.quaternion=1,0,0,0;initial.omega=1,15,1;' // &
                    'span.t_end=10'), &
        benchmark_t('flipping_box', 'free box of 0.1 x 0.4 x 0.9 m that turns nearly about its intermediate axis', &
                    'S. Peters, benchmark of boxes of the Open Source Robotics Foundation, complex scenario, 2015', &
                    'top.mass=10;top.inertia=0.8083333333333333,0.6833333333333333,0.1416666666666667;top.length=0;' // &
                    'initial.quaternion=1,0,0,0;initial.omega=0.1,5,0.1;span.t_end=10'), &
        benchmark_t('free_body', 'free body without symmetry, to t = 0.1', &
                    'P. L. Kinon, P. Betsch, input MUBO_kinon_betsch_2024 in the code metis, 2024', &
                    'top.mass=1;top.inertia=6,8,3;top.length=0;initial.quaternion=1,0,0,0;initial.omega=10,20,20;' // &
                    'span.t_end=0.1'), &
        benchmark_t('torqued_body', 'y1'' = -2 y2 y3, y2'' = 1.25 y1 y3, y3'' = -0.5 y1 y2 + 0.25 sin(t)^2', &
                    'C. Rackauckas, RigidBody_wpd of SciMLBenchmarks, 2026', &
                    'top.mass=1;top.inertia=1,2.5,3;top.length=0;initial.quaternion=1,0,0,0;initial.omega=1.25,0,2.25;' // &
                    'effects.torque_body=0,0,0.9375;effects.torque_body_amplitude=0,0,-0.9375;' // &
                    'effects.torque_body_rate=2;span.t_end=10'), &
        benchmark_t('staude', 'stable permanent rotation about an axis that is no principal one', &
                    'O. Staude, Ueber permanente Rotationsaxen bei der Bewegung eines schweren Koerpers um einen festen ' // &
                    'Punkt, J. reine angew. Math. 113, 1894', &
                    'top.mass=4;top.gravity=10;top.inertia=1,1.5,2.25;top.centre_of_mass=-0.108,-0.0675,0.036;' // &
                    'initial.theta=0.8762980611683406;initial.psi=0.6747409422235526;initial.omega=1.44,1.8,1.92;span.t_end=10'), &
        benchmark_t('grioli', 'regular precession of a body without symmetry about an inclined axis', &
                    'G. Grioli, Esistenza e determinazione delle precessioni regolari dinamicamente possibili per un solido ' // &
                    'pesante asimmetrico, Ann. Mat. Pura Appl. 26, 1947', &
                    'top.mass=1;top.gravity=10;top.inertia_tensor(1,:)=2,0,0.75;top.inertia_tensor(2,2:3)=2,0;' // &
                    'top.inertia_tensor(3,3)=1;top.length=0.5;initial.theta=1.5707963267948966;' // &
                    'initial.psi=-0.6435011087932844;initial.omega=0,2,2;span.t_end=10'), &
        benchmark_t('hess', 'motion whose momentum stays perpendicular to the axis of the centre of mass', &
                    'W. Hess, Ueber die Eulerschen Bewegungsgleichungen und ueber eine neue partikulaere Loesung des ' // &
                    'Problems, Math. Ann. 37, 1890', &
                    'top.mass=1;top.gravity=10;top.inertia=2.25,2,1;top.centre_of_mass=0.1,0,0.3;initial.theta=1;' // &
                    'initial.psi=0.5;initial.omega=-0.4,1,0.3;span.t_end=10'), &
        benchmark_t('bobylev_steklov', 'motion with omega1 constant and omega2 = 0', &
                    'D. Bobylev and V. Steklov 1896, in E. Leimanis, The general problem of the motion of coupled rigid ' // &
                    'bodies about a fixed point, Springer, 1965', &
                    'top.mass=1;top.gravity=4;top.inertia=2,1.5,1;top.centre_of_mass=0.25,0,0;' // &
                    'initial.theta=0.9272952180016123;initial.psi=0.8480620789814809;initial.omega=0.5,0,1.2;span.t_end=10')]

    !> The quantities, with the published figures.
    type(figure_t), parameter :: figures(*) = [ &
        figure_t('heavy_top', 'com_x', -0.150416985652933_dp, fine_alpha), &
        figure_t('heavy_top', 'com_y', -0.724164450779749_dp, fine_alpha), &
        figure_t('heavy_top', 'com_z', -0.673023460701136_dp, fine_alpha), &
        figure_t('heavy_top', 'q0', 0.122947275600560_dp, fine_alpha), &
        figure_t('heavy_top', 'q1', -0.491079359219981_dp, fine_alpha), &
        figure_t('heavy_top', 'q2', 0.350430794926147_dp, fine_alpha), &
        figure_t('heavy_top', 'q3', -0.787986857972906_dp, fine_alpha), &
        figure_t('heavy_top_start', 'q0', -0.70813_dp, coarse_alpha), &
        figure_t('heavy_top_start', 'q1', 0.43881_dp, coarse_alpha), &
        figure_t('heavy_top_start', 'q2', 0.54593_dp, coarse_alpha), &
        figure_t('heavy_top_start', 'q3', 0.089251_dp, coarse_alpha), &
        figure_t('heavy_top_start', 'q0', -0.70828_dp, by_rk4), &
        figure_t('heavy_top_start', 'q1', 0.43878_dp, by_rk4), &
        figure_t('heavy_top_start', 'q2', 0.54573_dp, by_rk4), &
        figure_t('heavy_top_start', 'q3', 0.0894_dp, by_rk4), &
        figure_t('heavy_top_start', 'q0', -0.70824157_dp, by_exudyn), &
        figure_t('heavy_top_start', 'q1', 0.43878143_dp, by_exudyn), &
        figure_t('heavy_top_start', 'q2', 0.54578152_dp, by_exudyn), &
        figure_t('heavy_top_start', 'q3', 0.08937154_dp, by_exudyn), &
        figure_t('heavy_top_middle', 'com_x', -0.4220299141898183_dp, by_ottr), &
        figure_t('heavy_top_middle', 'com_y', 1 - 0.09451353137427536_dp, by_ottr), &
        figure_t('heavy_top_middle', 'com_z', -0.04455341442645723_dp, by_ottr), &
        figure_t('heavy_top_middle', 'q0', -0.17794086498990777_dp, by_ottr), &
        figure_t('heavy_top_middle', 'q1', 0.21672292516262048_dp, by_ottr), &
        figure_t('heavy_top_middle', 'q2', -0.9597292673920982_dp, by_ottr), &
        figure_t('heavy_top_middle', 'q3', -0.016969254156485276_dp, by_ottr), &
        figure_t('heavy_top_first', 'omega_y', 149.8473939540758_dp, by_exudyn_lie), &
        figure_t('heavy_top_first', 'omega_y', 149.84738885863888_dp, by_exudyn_parameters), &
        figure_t('heavy_top_first', 'omega_y', 149.89507599262697_dp, by_exudyn_vector), &
        figure_t('heavy_top_first', 'omega_x'), figure_t('heavy_top_first', 'omega_z'), &
        figure_t('heavy_top_rate', 'omega_y', -106.16380619750855_dp, by_exudyn_rk4), &
        figure_t('heavy_top_rate', 'omega_y', -106.16380414306643_dp, by_exudyn_dopri5), &
        figure_t('simo_wong', 'energy', 1269.975_dp, 'Solfec validation: the start'), &
        figure_t('simo_wong', 'com_x'), figure_t('simo_wong', 'com_y'), figure_t('simo_wong', 'com_z'), &
        figure_t('steady_cone', 'com_x'), figure_t('steady_cone', 'com_y'), &
        figure_t('steady_cone', 'com_z'), &
        figure_t('free_gyroscope', 'omega1', 0.692800241862_dp, by_cvode), &
        figure_t('free_gyroscope', 'gamma2', 0.708468221_dp, by_cvode), &
        figure_t('euler_equations', 'omega1', detest(1), by_nsdtst), &
        figure_t('euler_equations', 'omega2', detest(2), by_nsdtst), &
        figure_t('euler_equations', 'omega3', detest(3), by_nsdtst), &
        figure_t('free_symmetric_body', 'q0', -0.6305304765029902_dp, by_openturbine), &
        figure_t('free_symmetric_body', 'q1', 0.6055602536398981_dp, by_openturbine), &
        figure_t('free_symmetric_body', 'q2', -0.30157705376951366_dp, by_openturbine), &
        figure_t('free_symmetric_body', 'q3', -0.3804988542061519_dp, by_openturbine), &
        figure_t('tumbling_brick', 'omega1', 0.22023246533868357_dp, by_nasa_1), &
        figure_t('tumbling_brick', 'omega2', -0.30364321612656375_dp, by_nasa_1), &
        figure_t('tumbling_brick', 'omega3', 0.5431392879422197_dp, by_nasa_1), &
        figure_t('tumbling_brick', 'omega1', brick(1), by_nasa_5), &
        figure_t('tumbling_brick', 'omega2', brick(2), by_nasa_5), &
        figure_t('tumbling_brick', 'omega3', brick(3), by_nasa_5), &
        figure_t('tumbling_brick', 'q0', brick_attitude_1(1), by_nasa_1), &
        figure_t('tumbling_brick', 'q1', brick_attitude_1(2), by_nasa_1), &
        figure_t('tumbling_brick', 'q2', brick_attitude_1(3), by_nasa_1), &
        figure_t('tumbling_brick', 'q3', brick_attitude_1(4), by_nasa_1), &
        figure_t('tumbling_brick', 'q0', brick_attitude_5(1), by_nasa_5), &
        figure_t('tumbling_brick', 'q1', brick_attitude_5(2), by_nasa_5), &
        figure_t('tumbling_brick', 'q2', brick_attitude_5(3), by_nasa_5), &
        figure_t('tumbling_brick', 'q3', brick_attitude_5(4), by_nasa_5), &
        figure_t('tumbling_box', 'kinetic', 1.09_dp * box_energy, by_mujoco), &
        figure_t('tumbling_box', 'kinetic', 0.93_dp * box_energy, by_implicitfast), &
        figure_t('flipping_body', 'omega1'), figure_t('flipping_body', 'omega2'), &
        figure_t('flipping_body', 'omega3'), figure_t('flipping_body', 'q0'), &
        figure_t('flipping_body', 'q1'), figure_t('flipping_body', 'q2'), figure_t('flipping_body', 'q3'), &
        figure_t('flipping_box', 'omega1'), figure_t('flipping_box', 'omega2'), &
        figure_t('flipping_box', 'omega3'), figure_t('flipping_box', 'q0'), figure_t('flipping_box', 'q1'), &
        figure_t('flipping_box', 'q2'), figure_t('flipping_box', 'q3'), &
        figure_t('free_body', 'axis_x', 0.5608118150306917_dp, by_metis_eml), &
        figure_t('free_body', 'axis_y', 0.08722427373011672_dp, by_metis_eml), &
        figure_t('free_body', 'axis_z', -0.8233359181975696_dp, by_metis_eml), &
        figure_t('free_body', 'gamma1', -0.010663491175453288_dp, by_metis_eml), &
        figure_t('free_body', 'gamma2', 0.5674541882493388_dp, by_metis_eml), &
        figure_t('free_body', 'axis_x', 0.5608118134437128_dp, by_metis_emh), &
        figure_t('free_body', 'axis_y', 0.08722426346159023_dp, by_metis_emh), &
        figure_t('free_body', 'axis_z', -0.823335920366382_dp, by_metis_emh), &
        figure_t('free_body', 'gamma1', -0.01066349978493103_dp, by_metis_emh), &
        figure_t('free_body', 'gamma2', 0.5674541849407575_dp, by_metis_emh), &
        figure_t('torqued_body', 'omega1'), figure_t('torqued_body', 'omega2'), &
        figure_t('torqued_body', 'omega3'), figure_t('staude', 'omega1'), figure_t('staude', 'gamma3'), &
        figure_t('grioli', 'omega1'), figure_t('grioli', 'gamma3'), figure_t('hess', 'omega1'), &
        figure_t('hess', 'gamma3'), figure_t('bobylev_steklov', 'omega3'), &
        figure_t('bobylev_steklov', 'gamma3')]

    !> Published benchmarks and their figures.
    type, extends(comparison_t) :: benchmark_study_t
        !> Indices in the catalogue.
        integer, allocatable :: places(:)
        !> The quantities of the current benchmark, their true values, and the errors that are allowed for.
        type(figure_t), allocatable :: wanted(:)
        real(dp), allocatable :: truth(:), goals(:)
    contains
        procedure :: check
        procedure :: settings
        procedure :: compare
        procedure :: judge
    end type benchmark_study_t

    !> The methods that are tried unless the input names others: the fastest of each family.
    character(*), parameter :: tried_methods(*) = [character(12) :: 'taylor', 'dop853', 'ode45', 'splitting_4', 'splitting_8', &
        'gauss_8', 'rk4']
    !> Tolerances of adaptive methods are powers of ten down to this one; the others take 25, 50, ... equal steps.
    integer, parameter :: least_power = -15, first_steps = 25, most_doublings = 11
    !> The goal is this part of the error of a published figure; without one, an error of 1e-10.
    real(dp), parameter :: better = 1.0e-2_dp, goal_without_figure = 1.0e-10_dp
    !> Timed computations of a setting.
    integer, parameter :: repeats = 3

    !> All columns, in the order of the table.
    type(column), parameter :: benchmark_columns(*) = [ &
        column('benchmark', '', 'benchmark of the catalogue', 'benchmark', traits=categorical), &
        column('quantity', '', 'column of trajectories at the end of the span', 'benchmark', traits=categorical), &
        column('t', 's', 'end of the span', 'benchmark'), &
        column('truth', '', 'true value, in the unit of that column', 'truth'), &
        column('truth_error', '', 'difference of two computations of it', 'truth'), &
        column('reference', '', 'how it was computed', 'truth', traits=categorical), &
        column('published', '', 'published figure (nan: none)', 'published'), &
        column('published_error', '', 'its difference from the true value', 'published'), &
        column('published_method', '', 'who published it, with which method', 'published', traits=categorical), &
        column('goal', '', 'a hundredth of that difference, over max(1, true value); 1e-10 without a figure', 'best'), &
        column('method', '', 'fastest method whose errors are within the goal', 'best', traits=categorical), &
        column('formulation', '', 'its formulation', 'best', traits=categorical), &
        column('setting', '', 'its setting', 'best', traits=categorical), &
        column('value', '', 'its value', 'best'), &
        column('error', '', 'its largest error of all quantities of the benchmark, over max(1, true value)', 'best'), &
        column('evaluations', '', 'its RHS evaluations', 'best'), &
        column('time_s', 's', 'its computing time', 'best'), &
        column('source', '', 'where the benchmark was published', 'benchmark', traits=categorical)]

contains

    !> Finds the benchmarks and the methods.
    subroutine check(self, job, problems)
        class(benchmark_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        character(len(job%input%scene%benchmark_methods)), allocatable :: methods(:)
        integer :: i

        associate (names => job%input%scene%benchmark_cases)
            call find_cases('benchmark.cases', 'benchmark', names, benchmarks%name, self%places, problems)
            if (all(names == '')) self%places = [(i, i=1, size(benchmarks))]
        end associate
        allocate (self%choices(0))
        associate (scene => job%input%scene)
            methods = names_of_methods(scene, scene%benchmark_methods)
            if (all(methods == '')) methods = tried_methods
            call add_methods('benchmark.methods', methods, infos_of_methods(scene), ['auto'], self%choices, problems)
        end associate
        self%count = size(self%places)
        call self%count_attempts()
        self%phrase = 'the figures of ' // to_text(self%count) // ' published benchmarks'
    end subroutine check

    !> The settings of a method, from coarse to fine.
    function settings(self, choice, problem)
        class(benchmark_study_t), intent(in) :: self
        type(method_choice_t), intent(in) :: choice !! method and formulation
        type(problem_t), intent(in) :: problem !! the benchmark
        type(setting_t), allocatable :: settings(:)
        integer :: k
        if (choice%method%adaptive) then
            settings = [(setting_t(tolerance=10.0_dp**(-k)), k=3, -least_power)]
        else
            settings = [(setting_t(steps=first_steps * 2**k), k=0, most_doublings)]
        end if
    end function settings

    !> The rows of a benchmark.
    subroutine compare(self, job, number, cells, summary, error)
        class(benchmark_study_t), intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        integer(int64), intent(in) :: number !! of the benchmark
        type(text_buffer_t), intent(inout) :: cells !! the rows are appended
        type(summary_t), intent(inout) :: summary !! lines are added
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(problem_t), allocatable :: problem
        type(benchmark_t) :: benchmark
        type(problems_t) :: problems
        type(reference_t) :: exact
        character(:), allocatable :: text
        integer(int64) :: max_steps
        real(dp), allocatable :: truth_error(:)
        logical, allocatable :: has_figure(:)
        integer :: k

        allocate (problem)
        benchmark = benchmarks(self%places(number))
        problem%name = trim(benchmark%name)
        call make_scene_of_settings(benchmark%settings, problem%scene, error)
        if (allocated(error)) return
        problem%scene%tableaus = job%input%scene%tableaus
        problem%scene%samples = 2
        self%wanted = pack(figures, figures%benchmark == benchmark%name)
        call make_case(problem%scene, problem%case, problems)
        if (problems%any()) then
            error = internal_error('benchmark ' // problem%name // ': ' // problems%first())
            return
        end if
        ! The true values, and their differences from those of the exact solution; without one, the difference of two computations
        ! in quadruple precision, rad.
        max_steps = problem%scene%max_steps
        call find_reference(problem%case, 2, reference_quadruple, max_steps, problem%reference, problem%status)
        if (is_ok(problem%status)) then
            self%truth = values_of(problem%case, problem%reference%motions(2), self%wanted)
            truth_error = spread(problem%reference%uncertainty, 1, size(self%wanted))
            if (problem%case%body%has_closed_form()) then
                call find_reference(problem%case, 2, reference_exact, max_steps, exact, problem%status)
                if (is_ok(problem%status)) truth_error = &
                    abs(values_of(problem%case, exact%motions(2), self%wanted) - self%truth)
            end if
        end if
        if (.not. is_ok(problem%status)) then
            self%failures = self%failures + 1
            call summary%add(problem%name, 'no reference: ' // status_meaning(problem%status))
            return
        end if
        self%goals = merge(better * abs(self%wanted%published - self%truth) / max(1.0_dp, abs(self%truth)), &
                           goal_without_figure, is_finite(self%wanted%published))
        call self%try_all(problem)
        do k = 1, size(self%wanted)
            call add_row(self, problem, benchmark%source, k, truth_error(k), cells)
        end do
        has_figure = is_finite(self%wanted%published)
        text = counted(size(self%wanted), 'quantity', 'quantities') // ' without a published figure'
        if (any(has_figure)) then
            k = maxloc(abs(self%wanted%published - self%truth), dim=1, mask=has_figure)
            text = counted(count(has_figure), 'published figure') // '; largest error ' &
                   // rounded(abs(self%wanted(k)%published - self%truth(k)), 2) // ' in ' // trim(self%wanted(k)%column) &
                   // ' (' // trim(self%wanted(k)%method) // ')'
        end if
        call summary%add(problem%name, text)
    end subroutine compare

    !> The values of some quantities of a motion, which is in the axes of the computation.
    function values_of(case, motion, wanted) result(values)
        type(case_t), intent(in) :: case
        type(motion_t), intent(in) :: motion
        type(figure_t), intent(in) :: wanted(:)
        real(dp) :: values(size(wanted))
        type(row_maker_t) :: rows
        type(motion_t) :: seen
        integer :: k

        call rows%set(trajectory_columns([(place_of(trajectory_columns, wanted(k)%column), k=1, size(wanted))]), case)
        seen = motion
        seen%given_angle = case%start%given_angle
        values = rows%row(seen, as_computed=.true.)
        where (wanted%column(1:1) == 'q') values = sign(values, wanted%published)
    end function values_of

    !> One setting of a method: its values and errors and, if it satisfies the largest goal, its time. There are no finer ones if
    !> it satisfies all goals.
    subroutine judge(self, problem, scene, plan, attempt)
        class(benchmark_study_t), intent(inout) :: self
        type(problem_t), intent(in) :: problem !! the benchmark
        type(scene_t), intent(in) :: scene !! its scene with the method and the setting
        type(plan_t), intent(inout) :: plan !! the plan of that scene
        type(attempt_t), intent(inout) :: attempt !! completed by this procedure
        type(motion_t) :: motion
        real(dp) :: first
        integer :: status

        if (attempt%reason /= '') return
        call time_trial(problem%case, plan, huge(first), 1, first, attempt%trial%counts, motion, status)
        if (.not. is_good_end(status)) return
        attempt%values = values_of(problem%case, motion, self%wanted)
        attempt%error = maxval(abs(attempt%values - self%truth) / max(1.0_dp, abs(self%truth)))
        attempt%time = first
        if (attempt%error <= maxval(self%goals)) then
            call time_trial(problem%case, plan, first, repeats, attempt%time, attempt%trial%counts)
        end if
        attempt%is_kept = is_finite(attempt%error)
        attempt%is_enough = attempt%error <= minval(self%goals)
    end subroutine judge

    !> Adds the row of quantity `k`, with the fastest attempt that satisfies its goal.
    subroutine add_row(self, problem, source, k, truth_error, cells)
        class(benchmark_study_t), intent(in) :: self
        type(problem_t), intent(in) :: problem
        character(*), intent(in) :: source
        integer, intent(in) :: k
        real(dp), intent(in) :: truth_error
        type(text_buffer_t), intent(inout) :: cells
        type(attempt_t) :: best
        integer :: place

        place = minloc(self%attempts%time, dim=1, mask=self%attempts%error <= self%goals(k))
        if (place == 0) then
            best%values = spread(no_number, 1, size(self%wanted))
        else
            best = self%attempts(place)
        end if
        associate (figure => self%wanted(k), truth => self%truth(k))
            call cells%add_text(problem%name)
            call cells%add_text(figure%column)
            call cells%add_reals([problem%case%t_end, truth, truth_error])
            call cells%add_text(trim(merge('quadruple and exact', 'quadruple          ', problem%case%body%has_closed_form())))
            call cells%add_reals([figure%published, abs(figure%published - truth)])
            call cells%add_text(figure%method)
            call cells%add_reals([self%goals(k)])
        end associate
        call cells%add_text(best%choice%method%name)
        call cells%add_text(best%formulation)
        if (place == 0) then
            call cells%add_text('')
        else
            call cells%add_text(best%setting%text())
        end if
        call cells%add_reals([best%values(k), best%error])
        call cells%add_integer(best%trial%counts%evaluations)
        call cells%add_reals([best%time])
        call cells%add_text(source)
        call cells%end_row()
    end subroutine add_row

end module spintop_benchmark_study
