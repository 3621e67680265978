!> The catalogue of published benchmark tops: the settings of each as in an input, the source, and the figures that were
!> published. A quantity without a figure in the source has none here. The last benchmarks are special solutions, which
!> are known in closed form or by an invariant.
module spintop_benchmark_cases
    use spintop_kinds, only: degree, dp, no_number
    implicit none
    private
    public :: benchmark_t, benchmarks, figure_t, figures

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

end module spintop_benchmark_cases
