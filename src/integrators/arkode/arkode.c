// Runge-Kutta methods of SUNDIALS ARKODE, 6 and 7, for arkode.f90, which has the equations and what follows a step. Explicit
// tables also use ARKStep: ERKStep of SUNDIALS 6.4 loses orders for tables whose last stage is at the end of the step without
// being the first stage of the next step. Each run has its own SUNContext, so that runs in several threads share nothing.

#include <arkode/arkode_arkstep.h>
#include <float.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <sunnonlinsol/sunnonlinsol_newton.h>

// From 7.1 on the functions of ARKStep have successors, which 6 does not have.
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

enum { most_states = 8, most_stages = 16, length_of_name = 40 };

// The names of the tables without their ARKODE_, in increasing order. Coefficients and orders come from the library.
// ARKODE_KNOTH_WOLKE_3_3 is omitted, because it has no embedded method for step control.
static const char tables_explicit[] =
    "HEUN_EULER_2_1_2 BOGACKI_SHAMPINE_4_2_3 ARK324L2SA_ERK_4_2_3 ZONNEVELD_5_3_4 ARK436L2SA_ERK_6_3_4 SAYFY_ABURUB_6_3_4 "
    "ARK437L2SA_ERK_7_3_4 CASH_KARP_6_4_5 FEHLBERG_6_4_5 DORMAND_PRINCE_7_4_5 ARK548L2SA_ERK_8_4_5 ARK548L2SAb_ERK_8_4_5 "
    "VERNER_8_5_6 FEHLBERG_13_7_8 ";
static const char tables_implicit[] =
    "SDIRK_2_1_2 BILLINGTON_3_3_2 TRBDF2_3_3_2 KVAERNO_4_2_3 ARK324L2SA_DIRK_4_2_3 ESDIRK324L2SA_4_2_3 ESDIRK325L2SA_5_2_3 "
    "ESDIRK32I5L2SA_5_2_3 CASH_5_2_4 CASH_5_3_4 SDIRK_5_3_4 KVAERNO_5_3_4 ARK436L2SA_DIRK_6_3_4 ARK437L2SA_DIRK_7_3_4 "
    "ESDIRK436L2SA_6_3_4 ESDIRK43I6L2SA_6_3_4 QESDIRK436L2SA_6_3_4 ESDIRK437L2SA_7_3_4 KVAERNO_7_4_5 ARK548L2SA_DIRK_8_4_5 "
    "ARK548L2SAb_DIRK_8_4_5 ESDIRK547L2SA_7_4_5 ESDIRK547L2SA2_7_4_5 ";
static const char *const usual_tables[] = {"ARKODE_FEHLBERG_13_7_8", "ARKODE_ESDIRK547L2SA2_7_4_5"};

// A table: arkode_table_t of arkode.f90. Row i of a is that of stage i; embedded_order is 0 if there is no embedded method.
struct arkode_table {
    int implicit, stages, order, embedded_order;
    double a[most_stages][most_stages], b[most_stages], embedded[most_stages], c[most_stages];
};

// Functions of arkode.f90. They return 0, 1 for another attempt with a shorter step, or -1. `run` is what its step has given.
int spintop_arkode_rhs(void *run, double t, const double *y, double *slope);
int spintop_arkode_finish(void *run, double t, double *y);

// A run. ARKODE computes in the units of the state, powers of two, so that its linear equations do not depend on those of mass,
// length and time. An error may be `absolute`, and `relative` times the variable, in the units of arkode.f90. Stages with a
// fixed step size are judged by the state at the beginning of the step, of variables that are not cyclic, the scales of the
// variables, and what the iteration of a stage has done so far: its last correction and the smallest one, in units of the
// variables, the number of corrections since that, and the ratio of the last correction to the one before.
struct spintop_arkode {
    void *run, *integrator;
    SUNContext context;
    N_Vector y;
    SUNMatrix matrix;
    SUNLinearSolver linear;
    SUNNonlinearSolver nonlinear;
    double unit[most_states], per_unit[most_states], absolute[most_states], relative[most_states];
    double scale[most_states], start[most_states], previous, smallest, rate, growth;
    int64_t rejected, jacobians;
    int n, cyclic[most_states], idle, is_fixed, flag;
};

// A state of arkode.f90 from a vector of ARKODE, and a vector from that.
static void from_vector(const struct spintop_arkode *ark, N_Vector from, double state[most_states]) {
    const double *const y = NV_DATA_S(from);
    for (int i = 0; i < ark->n; ++i) state[i] = y[i] * ark->unit[i];
    for (int i = ark->n; i < most_states; ++i) state[i] = 0;
}

static void to_vector(const struct spintop_arkode *ark, const double *state, N_Vector to) {
    double *const y = NV_DATA_S(to);
    for (int i = 0; i < ark->n; ++i) y[i] = state[i] * ark->per_unit[i];
}

static int rhs(double t, N_Vector y, N_Vector slope, void *of) {
    double state[most_states], rate[most_states];
    from_vector(of, y, state);
    const int verdict = spintop_arkode_rhs(((struct spintop_arkode *)of)->run, t, state, rate);
    if (verdict == 0) to_vector(of, rate, slope);
    return verdict;
}

static int find_weights(N_Vector y, N_Vector weights, void *of) {
    const struct spintop_arkode *const ark = of;
    double state[most_states];
    from_vector(ark, y, state);
    for (int i = 0; i < ark->n; ++i) {
        const double allowed = ark->absolute[i] + ark->relative[i] * fabs(state[i]);
        if (!(allowed > 0)) return -1;
        NV_DATA_S(weights)[i] = ark->unit[i] / allowed;
    }
    return 0;
}

static int finish(double t, N_Vector y, void *of) {
    double state[most_states];
    from_vector(of, y, state);
    const int verdict = spintop_arkode_finish(((struct spintop_arkode *)of)->run, t, state);
    to_vector(of, state, y);
    return verdict;
}

// Judges a correction of a stage whose increment over the state is `change`, down to rounding errors: ARKODE's own test needs a
// tolerance, which is not known in advance with a fixed step size. A correction of an angle causes one of its rate, hence the
// larger of two successive ratios.
static int judge(SUNNonlinearSolver solver, N_Vector change, N_Vector correction, double tolerance, N_Vector weights,
                 void *of) {
    static const double negligible = DBL_EPSILON / 128, acceptable = 1e-12;
    struct spintop_arkode *const ark = of;
    double size = 0;
    int iteration = 0;
    (void)tolerance, (void)weights;
    for (int i = 0; i < ark->n; ++i) {
        const double start = ark->cyclic[i] ? 0 : fabs(ark->start[i]);
        const double unit = fmax(fmax(ark->scale[i], fabs(N_VGetArrayPointer(change)[i])), start);
        size = fmax(size, fabs(N_VGetArrayPointer(correction)[i]) / unit);
    }
    SUNNonlinSolGetCurIter(solver, &iteration);
    if (iteration == 0) ark->previous = ark->smallest = HUGE_VAL, ark->idle = 0, ark->rate = 0;
    const double rate = iteration == 0 ? 1 : size / ark->previous, next = fmin(fmax(rate, ark->rate), 1) * size;
    const double most = fmax(ark->growth * ark->previous, acceptable);
    ark->idle = size < ark->smallest ? 0 : ark->idle + 1;
    ark->smallest = fmin(ark->smallest, size), ark->previous = size, ark->rate = rate;
    if (next <= negligible || (ark->idle > 1 && size <= acceptable)) return 0;
    return size <= most ? SUN_NLS_CONTINUE : SUN_NLS_CONV_RECVR;
}

// Name `i` of the explicit or implicit tables, from 1 on, as the library has it; 0 if there are fewer.
int spintop_arkode_name(int implicit, int i, char name[length_of_name]) {
    const char *known = implicit ? tables_implicit : tables_explicit;
    while (--i > 0 && *known) known = strchr(known, ' ') + 1;
    snprintf(name, length_of_name, "ARKODE_%.*s", (int)strcspn(known, " "), known);
    return *known != 0;
}

// The explicit or implicit table of a name in any case, or the usual one if that is empty; if there is none it stays as it is.
void spintop_arkode_find(const char *name, int implicit, struct arkode_table *table) {
    char known[length_of_name];
    int i = 1, is_known = 1;
    if (*name) {
        while ((is_known = spintop_arkode_name(implicit, i, known)) && strcasecmp(name, known)) ++i;
    } else {
        strcpy(known, usual_tables[implicit != 0]);
    }
    ARKodeButcherTable its = 0;
    if (is_known) its = implicit ? ARKodeButcherTable_LoadDIRKByName(known) : ARKodeButcherTable_LoadERKByName(known);
    if (!its) return;
    memset(table, 0, sizeof *table);
    table->implicit = implicit, table->stages = its->stages, table->order = its->q, table->embedded_order = its->p;
    for (int i = 0; i < its->stages; ++i) {
        table->b[i] = its->b[i], table->embedded[i] = its->d[i], table->c[i] = its->c[i];
        for (int j = 0; j < its->stages; ++j) table->a[i][j] = its->A[i][j];
    }
    ARKodeButcherTable_Free(its);
}

static ARKodeButcherTable table_of(const struct arkode_table *from) {
    double rows[most_stages * most_stages];
    struct arkode_table table = *from;
    for (int i = 0; i < table.stages; ++i) memcpy(rows + i * table.stages, table.a[i], table.stages * sizeof *rows);
    return ARKodeButcherTable_Create(table.stages, table.order, table.embedded_order, table.c, rows, table.b,
                                     table.embedded_order > 0 ? table.embedded : 0);
}

// The orders that the coefficients have; conditions beyond order 6 are not checked.
void spintop_arkode_orders(const struct arkode_table *table, int *order, int *embedded_order) {
    ARKodeButcherTable copy = table_of(table);
    ARKodeButcherTable_CheckOrder(copy, order, embedded_order, 0);
    ARKodeButcherTable_Free(copy);
}

// Keeps the first failure of a call, which the first step reports.
static void keep(struct spintop_arkode *ark, int flag) {
    if (ark->flag >= 0) ark->flag = flag;
}

#if SUNDIALS_VERSION_MAJOR < 7
static void ignore(int code, const char *module, const char *function, char *message, void *of) {
    (void)code, (void)module, (void)function, (void)message, (void)of;
}

// Makes a context, and the integrator, which does not print.
static void make_integrator(struct spintop_arkode *ark, int implicit, double t, const double *y) {
    keep(ark, SUNContext_Create(0, &ark->context));
#else
static void make_integrator(struct spintop_arkode *ark, int implicit, double t, const double *y) {
    // Of one process, also under MPI: a communicator would make all ranks create and free their contexts together.
    keep(ark, SUNContext_Create(SUN_COMM_NULL, &ark->context));
    if (ark->flag >= 0) keep(ark, SUNContext_ClearErrHandlers(ark->context));
    if (ark->flag >= 0) keep(ark, SUNContext_SetLogger(ark->context, 0));
#endif
    if (ark->flag < 0) return;
    ark->y = N_VNew_Serial(ark->n, ark->context);
    to_vector(ark, y, ark->y);
    ark->integrator = ARKStepCreate(implicit ? 0 : rhs, implicit ? rhs : 0, t, ark->y, ark->context);
    if (!ark->integrator) keep(ark, ARK_MEM_FAIL);
#if SUNDIALS_VERSION_MAJOR < 7
    if (ark->integrator) keep(ark, ARKStepSetErrHandlerFn(ark->integrator, ignore, 0));
#endif
}

// The solver for the equations of the stages.
static void set_implicit(struct spintop_arkode *ark, int is_adaptive, int by_insertion) {
    // A correction of an angle causes a larger one of its rate before both decrease.
    static const double growth_allowed = 100, share_of_tolerance = 1e-2;
    void *const of = ark->integrator;
    ark->growth = by_insertion ? growth_allowed : 2;
    if (by_insertion) {
        ark->nonlinear = SUNNonlinSol_FixedPoint(ark->y, 0, ark->context);
        keep(ark, ARKStepSetNonlinearSolver(of, ark->nonlinear));
        keep(ark, ARKStepSetMaxNonlinIters(of, 200));
        keep(ark, ARKStepSetNonlinRDiv(of, growth_allowed));
    } else {
        ark->nonlinear = SUNNonlinSol_Newton(ark->y, ark->context);
        keep(ark, ARKStepSetNonlinearSolver(of, ark->nonlinear));
        ark->matrix = SUNDenseMatrix(ark->n, ark->n, ark->context);
        ark->linear = SUNLinSol_Dense(ark->y, ark->matrix, ark->context);
        keep(ark, ARKStepSetLinearSolver(of, ark->linear, ark->matrix));
        // By default a Jacobian is used for 50 steps and a factorisation for 20, and the estimate of the resulting error fails
        // at tight tolerances.
        keep(ark, ARKStepSetLSetupFrequency(of, 1));
        keep(ark, ARKStepSetJacEvalFrequency(of, 1));
        keep(ark, ARKStepSetMaxNonlinIters(of, 30));
    }
    keep(ark, ARKStepSetNonlinConvCoef(of, share_of_tolerance));
    if (!is_adaptive) keep(ark, SUNNonlinSolSetConvTestFn(ark->nonlinear, judge, ark));
    keep(ark, ARKStepSetDeduceImplicitRhs(of, 1));
}

// Begins a run at the time t in a state of n variables with their units, scales and admissible errors; null without memory.
struct spintop_arkode *spintop_arkode_create(int n, double t, const double *y, const double *unit, const double *scale,
                                             const double *absolute, const double *relative, const int *cyclic,
                                             const struct arkode_table *of, int is_adaptive, int by_insertion) {
    // So many failures of a step reduce it from the length of the span to the rounding error of the time.
    enum { most_failures = 60 };
    struct spintop_arkode *const ark = n > most_states ? 0 : calloc(1, sizeof *ark);
    double unused[3] = {0};
    if (!ark) return 0;
    ark->n = n;
    for (int i = 0; i < n; ++i) {
        ark->unit[i] = unit[i], ark->per_unit[i] = 1 / unit[i], ark->scale[i] = scale[i] / unit[i], ark->cyclic[i] = cyclic[i];
        ark->absolute[i] = absolute[i], ark->relative[i] = relative[i];
    }
    make_integrator(ark, of->implicit, t, y);
    if (ark->flag < 0) return ark;
    ARKodeButcherTable table = table_of(of);
    keep(ark,
         ARKStepSetTables(ark->integrator, of->order, of->embedded_order, of->implicit ? table : 0, of->implicit ? 0 : table));
    ARKodeButcherTable_Free(table);
    keep(ark, ARKStepSetUserData(ark->integrator, ark));
    keep(ark, ARKStepWFtolerances(ark->integrator, find_weights));
    // The I controller: for this smooth motion it needs one sixth fewer evaluations than the default of ARKODE.
    keep(ark, ARKStepSetAdaptivityMethod(ark->integrator, ARK_ADAPT_I, 1, 0, unused));
    keep(ark, ARKStepSetMaxNumSteps(ark->integrator, -1));
    keep(ark, ARKStepSetMaxErrTestFails(ark->integrator, most_failures));
    keep(ark, ARKStepSetMaxConvFails(ark->integrator, most_failures));
    keep(ark, ARKStepSetPostprocessStepFn(ark->integrator, finish));
    // Higher interpolants evaluate the right-hand side at every stop time, and they have no advantage here: that of degree 5
    // has the error of one of degree 4 (seen in 6.4 and 7.5).
    keep(ark, ARKStepSetInterpolantDegree(ark->integrator, 3));
    if (of->implicit) set_implicit(ark, is_adaptive, by_insertion);
    return ark;
}

// One step of the size h towards t_end or, if h is 0, of a size that ARKODE chooses, not beyond t_end. Returns 0, 1 if the step
// became too small, 2 if a stage did not converge, 3 otherwise. The costs of the step are added.
int spintop_arkode_step(struct spintop_arkode *ark, void *run, double h, double t_end, double t_stop, int64_t *rejected,
                        int64_t *jacobians) {
    long attempts = 0, steps = 0, evaluated = 0;
    double t;
    if (h > 0 || ark->is_fixed) keep(ark, ARKStepSetFixedStep(ark->integrator, h)), ark->is_fixed = h > 0;
    if (!(h > 0)) keep(ark, ARKStepSetStopTime(ark->integrator, t_stop));
    int flag = ark->flag;
    if (flag < 0) return 3;
    ark->run = run;
    memcpy(ark->start, N_VGetArrayPointer(ark->y), ark->n * sizeof *ark->start);
    flag = ARKStepEvolve(ark->integrator, t_end, ark->y, &t, ARK_ONE_STEP);
    ARKStepGetNumStepAttempts(ark->integrator, &attempts), ARKStepGetNumSteps(ark->integrator, &steps);
    if (ark->linear) ARKStepGetNumJacEvals(ark->integrator, &evaluated);
    *rejected += attempts - steps - ark->rejected, *jacobians += evaluated - ark->jacobians;
    ark->rejected = attempts - steps, ark->jacobians = evaluated;
    switch (flag) {
    case ARK_ERR_FAILURE:
    case ARK_TOO_MUCH_WORK:
    case ARK_TOO_MUCH_ACC:
        return 1;
    case ARK_CONV_FAILURE:
    case ARK_LSETUP_FAIL:
    case ARK_LSOLVE_FAIL:
        return 2;
    default:
        return flag < 0 ? 3 : 0;
    }
}

// Goes on from a state, with a first step of the size h if that is not 0.
void spintop_arkode_restart(struct spintop_arkode *ark, double t, const double *y, double h) {
    if (!ark->integrator) return;
    to_vector(ark, y, ark->y);
    keep(ark, ARKStepReset(ark->integrator, t, ark->y));
    if (h > 0) keep(ark, ARKStepSetInitStep(ark->integrator, h));
}

// Step size of the last trial; 0 if there was none.
double spintop_arkode_last_trial(struct spintop_arkode *ark) {
    double h = 0;
    return ark->integrator && ARKStepGetCurrentStep(ark->integrator, &h) >= 0 ? h : 0;
}

void spintop_arkode_destroy(struct spintop_arkode *ark) {
    if (!ark) return;
    if (ark->integrator) ARKStepFree(&ark->integrator);
    if (ark->nonlinear) SUNNonlinSolFree(ark->nonlinear);
    if (ark->linear) SUNLinSolFree(ark->linear);
    if (ark->matrix) SUNMatDestroy(ark->matrix);
    if (ark->y) N_VDestroy(ark->y);
    if (ark->context) SUNContext_Free(&ark->context);
    free(ark);
}
