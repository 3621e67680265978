!> Explicit Runge-Kutta methods by their Butcher tables: with a fixed step size; the adaptive Dormand-Prince pair 5(4) with MATLAB's
!> step control, ode45; and DOP853, adaptive or with a fixed step size.
module spintop_runge_kutta
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kinds, only: dp, xp, is_finite
    use spintop_fixed_step, only: fixed_step_t, advance_on_grid, begin_on_grid, longest_step
    use spintop_formulation, only: max_aside, max_states
    use spintop_status, only: is_ok, status_non_finite, status_ok, status_step_too_small
    use spintop_stepper, only: run_state_t, smallest_step, stepper_t
    implicit none
    private
    public :: butcher_t, max_stages, explicit_table, classical_table, dormand_prince_table, runge_kutta_t, ode45_t, &
        stage_sum
    public :: dop853_t, dop853_table_t, dop853_table, main_stages, new_slope, all_stages

    !> Maximum number of stages of a table.
    integer, parameter :: max_stages = 7

    !> Coefficients of an explicit Runge-Kutta method
    !> k_i = f(t + c_i h, y + h sum_j a_ij k_j), y+ = y + h sum_i b_i k_i.
    type :: butcher_t
        integer :: stages = 0
        integer :: order = 0
        !> a(j, i) multiplies k_j in stage i: columns are stages.
        real(dp) :: a(max_stages, max_stages) = 0
        real(dp) :: b(max_stages) = 0
        !> Where the stages lie in the step.
        real(dp) :: c(max_stages) = 0
        !> b minus the weights of the embedded method; zero if there is none.
        real(dp) :: error(max_stages) = 0
        !> Dense output: the weight of k_i at the fraction s of a step is sum_p dense(p, i) s^p.
        real(dp) :: dense(4, max_stages) = 0
    end type butcher_t

    !> An explicit Runge-Kutta method given by its Butcher table.
    type, extends(fixed_step_t) :: runge_kutta_t
        !> Its coefficients.
        type(butcher_t) :: table
    contains
        procedure :: step => step_by_table
    end type runge_kutta_t

    !> An embedded Runge-Kutta pair whose last stage is the first one of the next step.
    type, extends(stepper_t) :: ode45_t
        type(butcher_t) :: table
        real(dp) :: k(max_states, max_stages) = 0
    contains
        procedure :: begin => begin_ode45
        procedure :: advance => advance_ode45
        procedure :: state_within => state_within_ode45
    end type ode45_t

    !> Largest step relative to the span.
    real(dp), parameter :: largest_share = 0.1_dp

    !> Number of stages of a step; index of the slope at its end, which is the first stage of the next step;
    !> and number of all stages, with the three of dense output.
    integer, parameter :: main_stages = 12, new_slope = 13, all_stages = 16

    !> The method of Dormand and Prince of order 8 with embedded methods of orders 5 and 3 and dense output of order 7: DOP853 of
    !> Hairer, Norsett and Wanner (Solving Ordinary Differential Equations I, 2nd edition, 1993, sections II.4 to II.6), with the
    !> decimals of their program; Prince and Dormand, J. Comp. Appl. Math. 7 (1981).
    type :: dop853_table_t
        !> a(j, i) multiplies k_j in stage i: columns are stages.
        real(dp) :: a(all_stages, all_stages) = 0
        !> Stage i depends on stage 1 and on those from since(i) to i - 1.
        integer :: since(all_stages) = 1
        real(dp) :: b(all_stages) = 0
        !> Weights of stage i in the sums of a step, column i: b, its rounding error, and b minus the weights of the embedded
        !> methods of orders 5 and 3.
        real(dp) :: sums(4, all_stages) = 0
        !> Where the stages lie in the step.
        real(dp) :: c(all_stages) = 0
        !> Rounding errors of b, which would accumulate over long times.
        real(dp) :: b_rest(all_stages) = 0
        !> Dense output: weights of the last four terms. The first four are those of the cubic Hermite
        !> polynomial.
        real(dp) :: dense(all_stages, 4) = 0
    end type dop853_table_t

    !> Fraction of the step that the error estimate allows, and bounds of its change from step to step.
    real(dp), parameter :: safety = 0.9_dp, largest_growth = 6, largest_cut = 1.0_dp / 3
    !> Power of the error estimate in the step size.
    real(dp), parameter :: error_power = 8
    !> By which powers of the error of a step, and of that before it, the next one changes: the control that DOP853 offers
    !> with BETA = 0.04 (section IV.2 of volume II). Without the second one, a step in five of a body that spins fast is
    !> rejected.
    real(dp), parameter :: by_last_error = 0.04_dp, by_error = 1 / error_power - 0.2_dp * by_last_error
    !> Logarithm to base 2 of the least error before a step that counts, 1e-4; also that before the first step.
    real(dp), parameter :: least_error = -13.287712379549449_dp

    !> DOP853 with its step control, or with a fixed step size. The state is summed with compensation, so that small steps at tight
    !> tolerances lose no digits.
    type, extends(fixed_step_t) :: dop853_t
        type(dop853_table_t) :: table
        real(dp) :: k(max_states, all_stages) = 0
        !> What stages that are found at once leave for those after them.
        real(dp) :: aside(max_aside, all_stages) = 0
        !> Terms of the dense output, once it was needed in the last step.
        real(dp) :: term(max_states, 8) = 0
        logical :: has_terms = .false.
        !> Logarithm to base 2 of the error of the last step, in units of the tolerance.
        real(dp) :: last_error = least_error
    contains
        procedure :: begin => begin_dop853
        procedure :: advance => advance_dop853
        procedure :: step => step_dop853
        procedure :: state_within => state_within_dop853
    end type dop853_t

    interface
        !> The change of the state over a step, the state after it, the logarithm of its error, and by which factor the next
        !> step is larger.
        real(c_double) function c_sum(since, stages, weights, k, y, rest, h, absolute, relative, states, most, share, &
                                      change, y_new, growth) bind(C, name='spintop_sum_stages')
            import :: c_double, c_int
            integer(c_int), value :: since, stages, states
            real(c_double), value :: h, most, share
            real(c_double), intent(in) :: weights(*), k(*), y(*), rest(*), absolute(*), relative(*)
            real(c_double), intent(out) :: change(*), y_new(*), growth
        end function c_sum
    end interface

contains

    !> The table of a method whose rows below the first are given one after another: a stage lies where the sum of its row puts
    !> it.
    pure type(butcher_t) function explicit_table(order, rows, b) result(table)
        integer, intent(in) :: order !! order of the method
        real(dp), intent(in) :: rows(:), b(:) !! a21, a31, a32, ..., and the weights of the stages
        integer :: i, before
        table%stages = size(b)
        table%order = order
        table%b(:size(b)) = b
        before = 0
        do i = 2, size(b)
            table%a(:i - 1, i) = rows(before + 1:before + i - 1)
            table%c(i) = sum(table%a(:i - 1, i))
            before = before + i - 1
        end do
    end function explicit_table

    !> The classical Runge-Kutta method (Kutta 1901).
    pure type(butcher_t) function classical_table() result(table)
        table = explicit_table(4, [0.5_dp, 0.0_dp, 0.5_dp, 0.0_dp, 0.0_dp, 1.0_dp], [1, 2, 2, 1] / 6.0_dp)
    end function classical_table

    !> The Dormand-Prince pair 5(4) (J. Comp. Appl. Math. 6, 1980) with the interpolant of order 4 of Shampine
    !> (Math. Comp. 46, 1986), as in MATLAB's ode45. The last stage is the first one of the next step.
    pure type(butcher_t) function dormand_prince_table() result(table)
        table%stages = 7
        table%order = 5
        table%a(1:1, 2) = [1.0_dp / 5]
        table%a(1:2, 3) = [3.0_dp / 40, 9.0_dp / 40]
        table%a(1:3, 4) = [44.0_dp / 45, -56.0_dp / 15, 32.0_dp / 9]
        table%a(1:4, 5) = [19372.0_dp / 6561, -25360.0_dp / 2187, 64448.0_dp / 6561, -212.0_dp / 729]
        table%a(1:5, 6) = [9017.0_dp / 3168, -355.0_dp / 33, 46732.0_dp / 5247, 49.0_dp / 176, &
                           -5103.0_dp / 18656]
        table%a(1:6, 7) = [35.0_dp / 384, 0.0_dp, 500.0_dp / 1113, 125.0_dp / 192, &
                           -2187.0_dp / 6784, 11.0_dp / 84]
        table%b = table%a(:, 7)
        table%c = [0.0_dp, 1.0_dp / 5, 3.0_dp / 10, 4.0_dp / 5, 8.0_dp / 9, 1.0_dp, 1.0_dp]
        table%error = [71.0_dp / 57600, 0.0_dp, -71.0_dp / 16695, 71.0_dp / 1920, &
                       -17253.0_dp / 339200, 22.0_dp / 525, -1.0_dp / 40]
        table%dense(:, 1) = [1.0_dp, -183.0_dp / 64, 37.0_dp / 12, -145.0_dp / 128]
        table%dense(:, 3) = [0.0_dp, 1500.0_dp / 371, -1000.0_dp / 159, 1000.0_dp / 371]
        table%dense(:, 4) = [0.0_dp, -125.0_dp / 32, 125.0_dp / 12, -375.0_dp / 64]
        table%dense(:, 5) = [0.0_dp, 9477.0_dp / 3392, -729.0_dp / 106, 25515.0_dp / 6784]
        table%dense(:, 6) = [0.0_dp, -11.0_dp / 7, 11.0_dp / 3, -55.0_dp / 28]
        table%dense(:, 7) = [0.0_dp, 3.0_dp / 2, -4.0_dp, 5.0_dp / 2]
    end function dormand_prince_table

    !> One step of the method.
    subroutine step_by_table(self, h, change, status)
        class(runge_kutta_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: k(max_states, max_stages), y(max_states)
        change = 0
        call find_stages(self%run_state_t, self%table, h, k, y, status)
        if (is_ok(status)) change = h * stage_sum(k, self%table%b, self%table%stages)
    end subroutine step_by_table

    !> The stages of a step of size h, of which the first is the known slope, and the state of the last one.
    subroutine find_stages(run, table, h, k, y, status)
        class(run_state_t), intent(inout) :: run
        type(butcher_t), intent(in) :: table
        real(dp), intent(in) :: h
        real(dp), intent(inout) :: k(max_states, max_stages)
        real(dp), intent(out) :: y(max_states)
        integer, intent(out) :: status
        integer :: i
        status = status_ok
        y = run%y
        k(:, 1) = run%slope
        do i = 2, table%stages
            y = run%y + h * stage_sum(k, table%a(:, i), i - 1)
            call run%evaluate(run%t + table%c(i) * h, y, k(:, i), status)
            if (.not. is_ok(status)) return
        end do
    end subroutine find_stages

    !> Sum of the first n stages with the weights given.
    pure function stage_sum(k, weight, n) result(total)
        integer, intent(in) :: n !! number of stages
        real(dp), intent(in) :: k(max_states, n), weight(n) !! slopes at the stages, and their weights
        real(dp) :: total(max_states)
        integer :: i, j
        total = 0
        do i = 1, n
            ! Without this order of loops gfortran vectorizes over the stages, which is three times slower.
            !$omp simd
            do j = 1, max_states
                total(j) = total(j) + weight(i) * k(j, i)
            end do
        end do
    end function stage_sum

    !> First slope and MATLAB's first step size.
    subroutine begin_ode45(self, status)
        class(ode45_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: steepest

        call self%set_weight(self%controls%relative_tolerance, self%controls%absolute_tolerance)
        call self%evaluate(self%t, self%y, self%slope, status)
        if (.not. is_ok(status)) return
        self%h = largest_share * (self%t_end - self%t_begin)
        steepest = maxval(abs(self%slope) / max(abs(self%y), self%weight%threshold)) &
                   / (0.8_dp * self%controls%relative_tolerance**(1.0_dp / self%table%order))
        if (self%h * steepest > 1) self%h = 1 / steepest
    end subroutine begin_ode45

    !> One accepted step; rejected steps are counted.
    subroutine advance_ode45(self, status)
        class(ode45_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: h, h_smallest, h_left, t_new, y_new(max_states), error, growth, power
        logical :: first_trial, changed

        power = 1.0_dp / self%table%order
        h_smallest = smallest_step(0.0_dp, self%t)
        h_left = longest_step(self%formulation, self%y)
        self%h = min(max(self%h, h_smallest), largest_share * (self%t_end - self%t_begin))
        first_trial = .true.
        do
            h = min(self%h, h_left)
            t_new = self%t + h
            ! A step that nearly reaches the end is stretched to the end.
            if (1.1_dp * h >= self%t_end - self%t .and. h < h_left) t_new = self%t_end
            t_new = min(t_new, self%t_end)
            h = t_new - self%t
            call find_stages(self%run_state_t, self%table, h, self%k, y_new, status)
            error = huge(1.0_dp)
            if (is_ok(status)) then
                ! In units in which the relative tolerance is the limit.
                error = h * maxval(abs(stage_sum(self%k, self%table%error, self%table%stages)) &
                                   / max(abs(self%y), abs(y_new), self%weight%threshold))
                if (.not. is_finite(error)) status = status_non_finite
            end if
            if (is_ok(status) .and. error <= self%controls%relative_tolerance) exit
            self%counts%rejected = self%counts%rejected + 1
            if (h <= h_smallest) then
                if (is_ok(status)) status = status_step_too_small
                return
            end if
            growth = 0.5_dp
            if (is_ok(status) .and. first_trial) then
                growth = max(0.1_dp, 0.8_dp * (self%controls%relative_tolerance / error)**power)
            end if
            self%h = max(h * growth, h_smallest)
            first_trial = .false.
        end do
        call self%accept_step(t_new, y_new, changed)
        self%slope = self%k(:, self%table%stages)
        if (changed) call self%evaluate(self%t, self%y, self%slope, status)
        if (first_trial) then
            growth = 1.25_dp * (error / self%controls%relative_tolerance)**power
            self%h = h / max(growth, 0.2_dp)
        end if
    end subroutine advance_ode45

    !> Dense output of order 4 within the last step.
    function state_within_ode45(self, t) result(y)
        class(ode45_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states), s, weight(max_stages)
        s = (t - self%t_last) / (self%t - self%t_last)
        weight = matmul(s**[1, 2, 3, 4], self%table%dense)
        y = self%y_last + (self%t - self%t_last) &
            * stage_sum(self%k, weight, self%table%stages)
    end function state_within_ode45

    !> The coefficients of DOP853.
    pure type(dop853_table_t) function dop853_table() result(table)
        real(xp) :: b(all_stages)
        real(dp), dimension(all_stages) :: error5, error3
        integer :: i

        table%a(1, 2) = 0.0526001519587677318785587544488_dp
        table%a(1:2, 3) = [0.0197250569845378994544595329183_dp, &
            0.0591751709536136983633785987549_dp]
        table%a(1, 4) = 0.0295875854768068491816892993775_dp
        table%a(3, 4) = 0.0887627564304205475450678981324_dp
        table%a(1, 5) = 0.241365134159266685502369798665_dp
        table%a(3:4, 5) = [-0.884549479328286085344864962717_dp, &
            0.924834003261792003115737966543_dp]
        table%a(1, 6) = 0.037037037037037037037037037037_dp
        table%a(4:5, 6) = [0.170828608729473871279604482173_dp, &
            0.125467687566822425016691814123_dp]
        table%a(1, 7) = 0.037109375_dp
        table%a(4:6, 7) = [0.170252211019544039314978060272_dp, &
            0.0602165389804559606850219397283_dp, -0.017578125_dp]
        table%a(1, 8) = 0.0370920001185047927108779319836_dp
        table%a(4:7, 8) = [0.170383925712239993810214054705_dp, &
            0.107262030446373284651809199168_dp, -0.0153194377486244017527936158236_dp, &
            8.27378916381402288758473766002e-3_dp]
        table%a(1, 9) = 0.624110958716075717114429577812_dp
        table%a(4:8, 9) = [-3.36089262944694129406857109825_dp, &
            -0.868219346841726006818189891453_dp, 27.5920996994467083049415600797_dp, &
            20.1540675504778934086186788979_dp, -43.4898841810699588477366255144_dp]
        table%a(1, 10) = 0.477662536438264365890433908527_dp
        table%a(4:9, 10) = [-2.48811461997166764192642586468_dp, &
            -0.590290826836842996371446475743_dp, 21.2300514481811942347288949897_dp, &
            15.2792336328824235832596922938_dp, -33.2882109689848629194453265587_dp, &
            -0.0203312017085086261358222928593_dp]
        table%a(1, 11) = -0.93714243008598732571704021658_dp
        table%a(4:10, 11) = [5.18637242884406370830023853209_dp, &
            1.09143734899672957818500254654_dp, -8.14978701074692612513997267357_dp, &
            -18.5200656599969598641566180701_dp, 22.7394870993505042818970056734_dp, &
            2.49360555267965238987089396762_dp, -3.0467644718982195003823669022_dp]
        table%a(1, 12) = 2.27331014751653820792359768449_dp
        table%a(4:11, 12) = [-10.5344954667372501984066689879_dp, &
            -2.00087205822486249909675718444_dp, -17.9589318631187989172765950534_dp, &
            27.9488845294199600508499808837_dp, -2.85899827713502369474065508674_dp, &
            -8.87285693353062954433549289258_dp, 12.3605671757943030647266201528_dp, &
            0.643392746015763530355970484046_dp]
        ! The new state, whose slope is stage 13.
        b = 0
        b(1) = 0.0542937341165687622380535766363_xp
        b(6:12) = [4.45031289275240888144113950566_xp, &
            1.89151789931450038304281599044_xp, -5.8012039600105847814672114227_xp, &
            0.31116436695781989440891606237_xp, -0.152160949662516078556178806805_xp, &
            0.201365400804030348374776537501_xp, 0.0447106157277725905176885569043_xp]
        table%b = real(b, dp)
        table%b_rest = real(b - table%b, dp)
        table%a(:, new_slope) = table%b
        table%c = [0.0_dp, 0.0526001519587677318785587544488_dp, 0.0789002279381515978178381316732_dp, &
            0.118350341907227396726757197510_dp, 0.281649658092772603273242802490_dp, 1.0_dp / 3, 1.0_dp / 4, &
            4.0_dp / 13, 127.0_dp / 195, 3.0_dp / 5, 6.0_dp / 7, 1.0_dp, 1.0_dp, 1.0_dp / 10, 1.0_dp / 5, 7.0_dp / 9]
        error3 = table%b
        error3([1, 9, 12]) = error3([1, 9, 12]) - [0.244094488188976377952755905512_dp, &
            0.733846688281611857341361741547_dp, 0.0220588235294117647058823529412_dp]
        error5 = 0
        error5(1) = 0.01312004499419488073250102996_dp
        error5(6:12) = [-1.225156446376204440720569753_dp, &
            -0.4957589496572501915214079952_dp, 1.664377182454986536961530415_dp, &
            -0.350328848749973681688648729_dp, 0.3341791187130174790297318841_dp, &
            0.08192320648511571246570742613_dp, -0.02235530786388629525884427845_dp]
        call set_dense_output(table)
        do i = 3, all_stages
            table%since(i) = min(1 + findloc(abs(table%a(2:, i)) > 0, .true., dim=1), i - 1)
        end do
        table%sums = transpose(reshape([table%b, table%b_rest, error5, error3], [all_stages, 4]))
    end function dop853_table

    !> The stages that are used for dense output only, and its weights.
    pure subroutine set_dense_output(table)
        type(dop853_table_t), intent(inout) :: table
        table%a(1, 14) = 0.0561675022830479523392909219681_dp
        table%a(7:13, 14) = [0.253500210216624811088794765333_dp, &
            -0.246239037470802489917441475441_dp, -0.124191423263816360469010140626_dp, &
            0.15329179827876569731206322685_dp, 8.20105229563468988491666602057e-3_dp, &
            7.56789766054569976138603589584e-3_dp, -8.298e-3_dp]
        table%a(1, 15) = 0.0318346481635021405060768473261_dp
        table%a(6:8, 15) = [0.0283009096723667755288322961402_dp, &
            0.0535419883074385676223797384372_dp, -0.0549237485713909884646569340306_dp]
        table%a(11:14, 15) = [-1.08347328697249322858509316994e-4_dp, &
            3.82571090835658412954920192323e-4_dp, -3.40465008687404560802977114492e-4_dp, &
            0.141312443674632500278074618366_dp]
        table%a(1, 16) = -0.428896301583791923408573538692_dp
        table%a(6:9, 16) = [-4.69762141536116384314449447206_dp, &
            7.68342119606259904184240953878_dp, 4.06898981839711007970213554331_dp, &
            0.356727187455281109270669543021_dp]
        table%a(13:15, 16) = [-1.39902416515901462129418009734e-3_dp, &
            2.9475147891527723389556272149_dp, -9.15095847217987001081870187138_dp]
        table%dense(1, 1) = -8.4289382761090128651353491142_dp
        table%dense(6:16, 1) = [0.5667149535193777696253178359_dp, &
            -3.0689499459498916912797304727_dp, 2.384667656512069828772814968_dp, &
            2.1170345824450282767155149946_dp, -0.8713915837779729920678990749_dp, &
            2.240437430260788275854177165_dp, 0.6315787787694688181557024929_dp, &
            -0.0889903364513333108206981174_dp, 18.148505520854727256656404962_dp, &
            -9.1946323924783554000451984436_dp, -4.4360363875948939664310572_dp]
        table%dense(1, 2) = 10.427508642579134603413151009_dp
        table%dense(6:16, 2) = [242.28349177525818288430175319_dp, &
            165.20045171727028198505394887_dp, -374.54675472269020279518312152_dp, &
            -22.113666853125306036270938578_dp, 7.7334326684722638389603898808_dp, &
            -30.674084731089398182061213626_dp, -9.3321305264302278729567221706_dp, &
            15.697238121770843886131091075_dp, -31.139403219565177677282850411_dp, &
            -9.3529243588444783865713862664_dp, 35.81684148639408375246589854_dp]
        table%dense(1, 3) = 19.985053242002433820987653617_dp
        table%dense(6:16, 3) = [-387.03730874935176555105901742_dp, &
            -189.17813819516756882830838328_dp, 527.80815920542364900561016686_dp, &
            -11.573902539959630126141871134_dp, 6.8812326946963000169666922661_dp, &
            -1.000605096691083840318386098_dp, 0.7777137798053443209286926574_dp, &
            -2.7782057523535084065932004339_dp, -60.196695231264120758267380846_dp, &
            84.320405506677161018159903784_dp, 11.99229113618278932803513003_dp]
        table%dense(1, 4) = -25.693933462703749003312586129_dp
        table%dense(6:16, 4) = [-154.18974869023643374053993627_dp, &
            -231.52937917604549567536039109_dp, 357.6391179106141237828534991_dp, &
            93.405324183624310003907691704_dp, -37.458323136451633156875139351_dp, &
            104.09964950896230045147246184_dp, 29.840293426660503123344363579_dp, &
            -43.533456590011143754432175058_dp, 96.3245539591882829483949506_dp, &
            -39.177261675615439165231486172_dp, -149.72683625798562581422125276_dp]
    end subroutine set_dense_output

    !> First slope and, unless the step size is fixed, first step size.
    subroutine begin_dop853(self, status)
        class(dop853_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        self%has_terms = .false.
        self%last_error = least_error
        call self%set_weight(self%controls%relative_tolerance, self%controls%absolute_tolerance)
        call begin_on_grid(self, status)
        if (self%controls%steps == 0 .and. is_ok(status)) self%h = first_step(self)
    end subroutine begin_dop853

    !> A step for which Euler's method has an error of about 1% of the state; then, from the curvature found
    !> with it, one for the order of this method. Times are relative to the time in which the state would
    !> change by its scale, so that the unit of time does not matter, nor that a variable is zero at the start.
    real(dp) function first_step(run) result(h)
        class(run_state_t), intent(inout) :: run
        real(dp), parameter :: share = 0.01_dp
        real(dp) :: span, allowed(max_states), slope(max_states), size, steepness, unit, bend
        integer :: status

        span = run%t_end - run%t
        h = span
        allowed = run%weight%absolute + run%weight%relative * run%formulation%scale
        size = norm2(run%formulation%scale / allowed)
        steepness = norm2(run%slope / allowed)
        if (.not. steepness > 0) return
        unit = size / steepness
        h = min(share * unit, span)
        call run%evaluate(run%t + h, run%y + h * run%slope, slope, status)
        if (.not. is_ok(status)) return
        bend = max(norm2((slope - run%slope) / allowed) / h * unit**2, size)
        h = min(span, 100 * h, unit * (share / bend)**(1 / error_power))
    end function first_step

    !> One step: of the grid, or of a size that the error estimate accepts; rejected steps are counted.
    subroutine advance_dop853(self, status)
        class(dop853_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: h, h_smallest, h_left, t_new, error, growth
        real(dp), dimension(max_states) :: change, y_new, slope
        logical :: was_rejected, changed, at_once

        self%has_terms = .false.
        if (self%controls%steps > 0) then
            call advance_on_grid(self, status)
            return
        end if
        at_once = self%formulation%has_stages
        h_left = longest_step(self%formulation, self%y)
        h_smallest = smallest_step(self%h, self%t)
        self%h = max(self%h, h_smallest)
        was_rejected = .false.
        do
            h = min(self%h, h_left)
            t_new = self%t + h
            ! A step that nearly reaches the end is stretched to the end.
            if (1.01_dp * h >= self%t_end - self%t .and. h < h_left) t_new = self%t_end
            t_new = min(t_new, self%t_end)
            h = t_new - self%t
            self%k(:, 1) = self%slope
            call find_stages_dop853(self, self%t, self%y, h, 2, merge(new_slope, main_stages, at_once), status)
            error = 0
            if (is_ok(status)) then
                associate (w => self%weight)
                    error = c_sum(self%table%since(new_slope), main_stages, self%table%sums, self%k, self%y, self%rest, h, &
                                  w%absolute, w%relative, w%states, by_last_error * self%last_error, by_error, &
                                  change, y_new, growth)
                end associate
                if (.not. error <= huge(error)) status = status_non_finite
            end if
            ! The slope at the new state must exist: it begins the next step.
            if (is_ok(status) .and. error <= 0) then
                slope = self%k(:, new_slope)
                if (.not. at_once) call self%evaluate(t_new, y_new, slope, status)
            end if
            if (is_ok(status) .and. error <= 0) exit
            self%counts%rejected = self%counts%rejected + 1
            h_smallest = smallest_step(h, self%t)
            if (h <= h_smallest) then
                if (is_ok(status)) status = status_step_too_small
                return
            end if
            growth = 0.5_dp
            if (is_ok(status)) growth = max(largest_cut, safety * 2**(-by_error * error))
            self%h = max(h * growth, h_smallest)
            was_rejected = .true.
        end do
        call self%accept_change(t_new, change, changed)
        self%slope = slope
        if (changed) call self%evaluate(self%t, self%y, self%slope, status)
        growth = min(largest_growth, max(largest_cut, safety * growth))
        if (was_rejected) growth = min(growth, 1.0_dp)
        self%h = h * growth
        self%last_error = max(error, least_error)
    end subroutine advance_dop853

    !> The stages of a step of size h, and the change of the state over it.
    subroutine step_dop853(self, h, change, status)
        class(dop853_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        change = 0
        status = status_ok
        self%k(:, 1) = self%slope
        call find_stages_dop853(self, self%t, self%y, h, 2, main_stages, status)
        if (.not. is_ok(status)) return
        change = h * (stage_sum(self%k, self%table%b, main_stages) &
                      + stage_sum(self%k, self%table%b_rest, main_stages))
    end subroutine step_dop853

    !> Stages of a step of size h from a time and a state: at once where the formulation offers this.
    subroutine find_stages_dop853(self, t, y, h, from, to, status)
        class(dop853_t), intent(inout) :: self
        real(dp), intent(in) :: t, y(max_states), h
        integer, intent(in) :: from, to
        integer, intent(out) :: status
        real(dp) :: stage(max_states)
        integer :: i

        status = status_ok
        if (self%formulation%has_stages) then
            call self%formulation%find_stages(from, to, t, y, h, all_stages, self%table%a, self%table%since, self%table%c, &
                                         self%k, self%aside)
            self%counts%evaluations = self%counts%evaluations + (to - from + 1)
            ! What is no number in a stage is none in those after it.
            if (.not. all_finite(self%k(:, to))) status = status_non_finite
            return
        end if
        do i = from, to
            stage = y + h * stage_sum(self%k, self%table%a(:, i), i - 1)
            call self%evaluate(t + self%table%c(i) * h, stage, self%k(:, i), status)
            if (.not. is_ok(status)) return
        end do
    end subroutine find_stages_dop853

    !> Whether all components are finite: no difference of one from itself is NaN.
    pure logical function all_finite(x)
        real(dp), intent(in) :: x(max_states)
        real(dp) :: zero(max_states)
        zero = x - x
        all_finite = ((zero(1) + zero(5)) + (zero(2) + zero(6))) + ((zero(3) + zero(7)) + (zero(4) + zero(8))) >= 0
    end function all_finite

    !> Dense output of order 7 within the last step.
    function state_within_dop853(self, t) result(y)
        class(dop853_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states), s
        integer :: i

        if (.not. self%has_terms) call find_terms(self)
        s = (t - self%t_last) / (self%t - self%t_last)
        y = 0
        do i = 8, 1, -1
            y = self%term(:, i) + y * merge(s, 1 - s, mod(i, 2) == 1)
        end do
    end function state_within_dop853

    !> The terms of the dense output of the last step, with three more stages. If one of these does not exist,
    !> the cubic Hermite polynomial is used.
    subroutine find_terms(self)
        class(dop853_t), intent(inout) :: self
        real(dp) :: h
        integer :: i, from, status

        h = self%t - self%t_last
        self%has_terms = .true.
        self%k(:, new_slope) = self%slope
        self%term(:, 1) = self%y_last
        self%term(:, 2) = self%y - self%y_last
        self%term(:, 3) = h * self%k(:, 1) - self%term(:, 2)
        self%term(:, 4) = self%term(:, 2) - h * self%slope - self%term(:, 3)
        self%term(:, 5:8) = 0
        ! Stages that are found at once depend on what that of the slope leaves aside, which was not found on a grid.
        from = new_slope + 1
        if (self%controls%steps > 0 .and. self%formulation%has_stages) from = new_slope
        call find_stages_dop853(self, self%t_last, self%y_last, h, from, all_stages, status)
        if (.not. is_ok(status)) return
        do i = 1, 4
            self%term(:, 4 + i) = h * stage_sum(self%k, self%table%dense(:, i), all_stages)
        end do
    end subroutine find_terms

end module spintop_runge_kutta
