// Integrates the equations with a controlled stepper of Boost.odeint, at equal relative and absolute tolerance,
// and writes the ends and the cost. Many bodies are integrated sixteen at a time as one system, whose states
// and constants lie side by side so that the compiler can use vectors.
//
// usage: odeint FORMULATION METHOD TOLERANCE T_END BODIES EVERY < NUMBERS
#include <array>
#include <boost/numeric/odeint.hpp>
#include <string>
#include <vector>

#include "answer.h"
#include "equations.h"

namespace {

using namespace boost::numeric::odeint;
using rates_t = void (*)(const double *, const double *, double *);
constexpr double first_step = 1e-3; // of the span; the control takes it from there

template <class state_t> struct dopri5 {
    static auto make(double e) { return make_controlled<runge_kutta_dopri5<state_t>>(e, e); }
};
template <class state_t> struct fehlberg78 {
    static auto make(double e) { return make_controlled<runge_kutta_fehlberg78<state_t>>(e, e); }
};
template <class state_t> struct extrapolation {
    static auto make(double e) { return bulirsch_stoer<state_t>(e, e); }
};

template <int states, int constants, rates_t rates, template <class> class method, int lanes> struct bodies_t {
    using state_t = std::array<double, states * lanes>;
    struct block_t {
        std::array<double, constants * lanes> c;
        state_t start, y;
    };
    std::vector<block_t> blocks;
    double tolerance, t_end;
    long steps = 0, evaluations = 0;

    void derive(const block_t &block, const state_t &x, state_t &dx)
    {
        const double *const c = block.c.data(), *const y = x.data();
        double *const dy = dx.data();
        ++evaluations;
#pragma omp simd
        for (int l = 0; l < lanes; ++l) {
            double cl[constants], yl[states], dyl[states];
            for (int i = 0; i < constants; ++i)
                cl[i] = c[i * lanes + l];
            for (int i = 0; i < states; ++i)
                yl[i] = y[i * lanes + l];
            rates(cl, yl, dyl);
            for (int i = 0; i < states; ++i)
                dy[i * lanes + l] = dyl[i];
        }
    }

    static void run(void *self)
    {
        auto *const p = static_cast<bodies_t *>(self);
        p->steps = p->evaluations = 0;
        for (auto &block : p->blocks) {
            block.y = block.start;
            p->steps += static_cast<long>(integrate_adaptive(
                method<state_t>::make(p->tolerance),
                [p, &block](const state_t &x, state_t &dx, double) { p->derive(block, x, dx); }, block.y, 0.0,
                p->t_end, first_step * p->t_end));
        }
    }

    // The last block is filled up with its last body.
    bool read(int bodies)
    {
        double body[constants + states];
        blocks.resize((bodies + lanes - 1) / lanes);
        for (int k = 0; k < static_cast<int>(blocks.size()) * lanes; ++k) {
            if (k < bodies && std::fread(body, sizeof(double), constants + states, stdin) != constants + states)
                return false;
            auto &block = blocks[k / lanes];
            for (int i = 0; i < constants; ++i)
                block.c[i * lanes + k % lanes] = body[i];
            for (int i = 0; i < states; ++i)
                block.start[i * lanes + k % lanes] = body[constants + i];
        }
        return true;
    }

    int solve(char **argument)
    {
        tolerance = std::atof(argument[3]);
        t_end = std::atof(argument[4]);
        const int bodies = std::atoi(argument[5]), every = std::atoi(argument[6]);
        if (!read(bodies))
            return 2;
        const double time_s = least_time(run, this, lanes > 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC);
        for (int k = 0; k < bodies; k += every)
            write_state(&blocks[k / lanes].y[k % lanes], states, lanes);
        write_costs(time_s, static_cast<double>(steps), NAN, static_cast<double>(evaluations));
        return 0;
    }
};

template <int states, int constants, rates_t rates> int choose(char **argument)
{
    const std::string method = argument[2];
    if (method == "odeint_dopri5")
        return bodies_t<states, constants, rates, dopri5, 1>{}.solve(argument);
    if (method == "odeint_fehlberg78")
        return bodies_t<states, constants, rates, fehlberg78, 1>{}.solve(argument);
    if (method == "odeint_bulirsch_stoer")
        return bodies_t<states, constants, rates, extrapolation, 1>{}.solve(argument);
    if (method == "odeint_fehlberg78_16")
        return bodies_t<states, constants, rates, fehlberg78, 16>{}.solve(argument);
    return 2;
}

} // namespace

int main(int, char **argument)
{
    const std::string formulation = argument[1];
#define CHOOSE(name, states, constants)                                                              \
    if (formulation == #name)                                                                        \
        return choose<states, constants, name>(argument);
    FORMULATIONS(CHOOSE)
    return 2;
}
