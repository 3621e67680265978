!> The catalogue of motions on which methods may fail: a description, the difficulty, and the settings as in
!> an input.
!>
!> Every case can be run separately, because its settings are parameters of an input file. integration.steps
!> is the number of steps for methods without step control.
module spintop_hard_cases
    implicit none
    private
    public :: hard_case_t, hard_cases, settings_of

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

contains

    !> The settings of a case of the catalogue, those of its body included.
    pure function settings_of(case) result(settings)
        type(hard_case_t), intent(in) :: case !! entry of the catalogue
        character(:), allocatable :: settings
        settings = trim(bodies(case%body)) // ';' // trim(case%settings)
    end function settings_of

end module spintop_hard_cases
