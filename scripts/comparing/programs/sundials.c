/* Integrates the equations with CVODE of SUNDIALS, and writes the end and the cost.
 *
 * usage: sundials FORMULATION METHOD TOLERANCE T_END 1 1 < NUMBERS
 *
 * Adams formulas iterate by fixed points, BDF by Newton's method with a dense matrix of differences. A
 * run sets the integrator up anew as far as that is needed: its memory is kept. */
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "answer.h"
#include "equations.h"

enum { most_constants = 16, most_states = 16 };
static const long most_steps = 5000000;
static const double least_step = 1e-13; /* of the span: a solution that blows up is given up */

typedef void (*rates_t)(const double *, const double *, double *);

struct problem {
    rates_t rates;
    double c[most_constants], start[most_states], t_end;
    int states;
    N_Vector y;
    void *cvode;
};

/* What SUNDIALS returns is zero, or positive with no harm. */
static void check(int flag, const char *what)
{
    if (flag >= 0)
        return;
    fprintf(stderr, "%s returns %d\n", what, flag);
    exit(1);
}

static int derivative(double t, N_Vector y, N_Vector dy, void *data)
{
    const struct problem *const p = data;
    (void)t;
    p->rates(p->c, N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
    return 0;
}

static void run(void *data)
{
    struct problem *const p = data;
    double t = 0;
    memcpy(N_VGetArrayPointer(p->y), p->start, (size_t)p->states * sizeof(double));
    check(CVodeReInit(p->cvode, 0, p->y), "CVodeReInit");
    check(CVodeSetStopTime(p->cvode, p->t_end), "CVodeSetStopTime");
    check(CVode(p->cvode, p->t_end, p->y, &t, CV_NORMAL), "CVode");
}

static void prepare(struct problem *p, int formula, double tolerance, SUNContext context)
{
    p->cvode = CVodeCreate(formula, context);
    check(CVodeInit(p->cvode, derivative, 0, p->y), "CVodeInit");
    check(CVodeSStolerances(p->cvode, tolerance, tolerance), "CVodeSStolerances");
    check(CVodeSetUserData(p->cvode, p), "CVodeSetUserData");
    check(CVodeSetMaxNumSteps(p->cvode, most_steps), "CVodeSetMaxNumSteps");
    check(CVodeSetMinStep(p->cvode, least_step * p->t_end), "CVodeSetMinStep");
#if SUNDIALS_VERSION_MAJOR < 7
    check(CVodeSetErrFile(p->cvode, NULL), "CVodeSetErrFile");
#endif
    if (formula == CV_ADAMS) {
        SUNNonlinearSolver solver = SUNNonlinSol_FixedPoint(p->y, 0, context);
        check(CVodeSetNonlinearSolver(p->cvode, solver), "CVodeSetNonlinearSolver");
    } else {
        SUNMatrix matrix = SUNDenseMatrix(p->states, p->states, context);
        SUNLinearSolver solver = SUNLinSol_Dense(p->y, matrix, context);
        check(CVodeSetLinearSolver(p->cvode, solver, matrix), "CVodeSetLinearSolver");
    }
}

/* Writes what the last run found and took. */
static void report(const struct problem *p, double time_s)
{
    long steps, evaluations, extra = 0, rejected = 0;
    check(CVodeGetNumSteps(p->cvode, &steps), "CVodeGetNumSteps");
    check(CVodeGetNumRhsEvals(p->cvode, &evaluations), "CVodeGetNumRhsEvals");
    check(CVodeGetNumErrTestFails(p->cvode, &rejected), "CVodeGetNumErrTestFails");
    if (CVodeGetNumLinRhsEvals(p->cvode, &extra) < 0)
        extra = 0; /* there is no linear solver */
    write_state(N_VGetArrayPointer(p->y), p->states, 1);
    write_costs(time_s, (double)steps, (double)rejected, (double)(evaluations + extra));
}

int main(int count, char **argument)
{
    struct problem p = {0};
    SUNContext context;
    size_t constants = 0, states;
#define CHOOSE(form, its_states, its_constants)                                                      \
    if (count == 7 && strcmp(argument[1], #form) == 0) {                                             \
        p.rates = form;                                                                              \
        p.states = its_states;                                                                       \
        constants = its_constants;                                                                   \
    }
    FORMULATIONS(CHOOSE)
    states = (size_t)p.states;
    if (!p.rates || fread(p.c, sizeof(double), constants, stdin) != constants ||
        fread(p.start, sizeof(double), states, stdin) != states)
        return 2;
    p.t_end = atof(argument[4]);
    /* From generation 7 on it is the context that is kept from printing errors, here as there: what went wrong is in the returns. */
#if SUNDIALS_VERSION_MAJOR < 7
    check(SUNContext_Create(NULL, &context), "SUNContext_Create");
#else
    check(-abs(SUNContext_Create(SUN_COMM_NULL, &context)), "SUNContext_Create");
    check(-abs(SUNContext_ClearErrHandlers(context)), "SUNContext_ClearErrHandlers");
#endif
    p.y = N_VNew_Serial(p.states, context);
    prepare(&p, strcmp(argument[2], "cvode_adams") ? CV_BDF : CV_ADAMS, atof(argument[3]), context);
    report(&p, least_time(run, &p, CLOCK_MONOTONIC));
    return 0;
}
