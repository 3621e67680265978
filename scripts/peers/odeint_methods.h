/* The controlled steppers of Boost.odeint that are compared, with equal relative and absolute tolerance. */
#ifndef SPINTOP_ODEINT_METHODS_H
#define SPINTOP_ODEINT_METHODS_H

#include <boost/numeric/odeint.hpp>

constexpr double first_step = 1e-3; // of the span; the control takes it from there

template <class state_t> struct dopri5 {
    static auto make(double e)
    {
        using namespace boost::numeric::odeint;
        return make_controlled<runge_kutta_dopri5<state_t>>(e, e);
    }
};
template <class state_t> struct fehlberg78 {
    static auto make(double e)
    {
        using namespace boost::numeric::odeint;
        return make_controlled<runge_kutta_fehlberg78<state_t>>(e, e);
    }
};
template <class state_t> struct bulirsch_stoer {
    static auto make(double e)
    {
        return boost::numeric::odeint::bulirsch_stoer<state_t>(e, e);
    }
};

#endif
