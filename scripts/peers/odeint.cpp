// Integrates the equations with a controlled stepper of Boost.odeint, and prints the end and the cost.
//
// usage: odeint FORMULATION METHOD TOLERANCE T_END CONSTANTS... STATE...
#include <array>
#include <cstdlib>
#include <cstring>
#include <string>

#include "answer_line.h"
#include "equations.h"
#include "least_time.h"
#include "odeint_methods.h"

namespace odeint = boost::numeric::odeint;

namespace {

using rates_t = void (*)(const double *, const double *, double *);

template <int states, int constants, rates_t rates, template <class> class method> struct problem {
    using state_t = std::array<double, states>;
    double tolerance, t_end, c[constants];
    state_t start, y;
    std::size_t steps = 0;

    template <class system_t> void integrate(system_t system)
    {
        y = start;
        steps = odeint::integrate_adaptive(method<state_t>::make(tolerance), system, y, 0.0, t_end,
                                           first_step * t_end);
    }

    static void run(void *self)
    {
        auto *const p = static_cast<problem *>(self);
        p->integrate([p](const state_t &x, state_t &dx, double) { rates(p->c, x.data(), dx.data()); });
    }

    long count()
    {
        long calls = 0;
        integrate([this, &calls](const state_t &x, state_t &dx, double) {
            ++calls;
            rates(c, x.data(), dx.data());
        });
        return calls;
    }

    int solve(char **argument)
    {
        tolerance = std::atof(*argument++);
        t_end = std::atof(*argument++);
        for (auto &value : c)
            value = std::atof(*argument++);
        for (auto &value : start)
            value = std::atof(*argument++);
        const long evaluations = count();
        const double time_s = least_time(run, this);
        return print_answer(y.data(), states, static_cast<long>(steps), -1, evaluations, time_s);
    }
};

template <int states, int constants, rates_t rates>
int choose(const std::string &method, char **argument)
{
    if (method == "odeint_dopri5")
        return problem<states, constants, rates, dopri5>{}.solve(argument);
    if (method == "odeint_fehlberg78")
        return problem<states, constants, rates, fehlberg78>{}.solve(argument);
    if (method == "odeint_bulirsch_stoer")
        return problem<states, constants, rates, bulirsch_stoer>{}.solve(argument);
    return 2;
}

} // namespace

int main(int, char **argument)
{
    const char *const formulation = argument[1];
#define CHOOSE(name, states, constants)                                                              \
    if (std::strcmp(formulation, #name) == 0)                                                        \
        return choose<states, constants, name>(argument[2], argument + 3);
    FORMULATIONS(CHOOSE)
    return 2;
}
