// Integrates many bodies with Boost.odeint, sixteen at a time as one system, whose states and constants lie
// side by side so that the compiler can use vectors.
//
// usage: odeint_batch METHOD TOLERANCE T_END BODIES EVERY < NUMBERS
//
// The numbers are doubles: constants and state of each body. The line that is printed has the states at the
// end of every so many of the bodies, and the least time.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "equations.h"
/* Processor time, as that of a sweep and of heyoka: one run of all bodies takes long. */
#define LEAST_TIME_CLOCK CLOCK_THREAD_CPUTIME_ID
#include "least_time.h"
#include "odeint_methods.h"

namespace odeint = boost::numeric::odeint;

namespace {

constexpr int lanes = 16, states = 7, constants = 12;
using state_t = std::array<double, states * lanes>;

struct block_t {
    std::array<double, constants * lanes> c;
    state_t start, y;
};

void rates(const block_t &block, const state_t &x, state_t &dx)
{
    const double *const c = block.c.data(), *const y = x.data();
    double *const dy = dx.data();
#pragma omp simd
    for (int l = 0; l < lanes; ++l) {
        double cl[constants], yl[states], dyl[states];
        for (int i = 0; i < constants; ++i)
            cl[i] = c[i * lanes + l];
        for (int i = 0; i < states; ++i)
            yl[i] = y[i * lanes + l];
        rigid_body(cl, yl, dyl);
        for (int i = 0; i < states; ++i)
            dy[i * lanes + l] = dyl[i];
    }
}

template <template <class> class method> struct bodies_t {
    double tolerance, t_end;
    std::vector<block_t> blocks;

    static void run(void *self)
    {
        auto *const p = static_cast<bodies_t *>(self);
        for (auto &block : p->blocks) {
            block.y = block.start;
            odeint::integrate_adaptive(
                method<state_t>::make(p->tolerance),
                [&block](const state_t &x, state_t &dx, double) { rates(block, x, dx); }, block.y, 0.0,
                p->t_end, first_step * p->t_end);
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
        tolerance = std::atof(argument[0]);
        t_end = std::atof(argument[1]);
        const int bodies = std::atoi(argument[2]), every = std::atoi(argument[3]);
        if (!read(bodies))
            return 2;
        const double time_s = least_time(run, this);
        std::printf("{\"ends\": [");
        for (int k = 0; k < bodies; k += every)
            for (int i = 0; i < states; ++i)
                std::printf("%s%.17g%s", i ? ", " : k ? ", [" : "[", blocks[k / lanes].y[i * lanes + k % lanes],
                            i == states - 1 ? "]" : "");
        std::printf("], \"time_s\": %.9g}\n", time_s);
        return 0;
    }
};

} // namespace

int main(int, char **argument)
{
    const std::string method = argument[1];
    if (method == "odeint_fehlberg78_16")
        return bodies_t<fehlberg78>{}.solve(argument + 2);
    return 2;
}
