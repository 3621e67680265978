// A heavy top by the explicit midpoint rule with three step sizes, compared with the reference.
#include <cstdio>
#include <iostream>

#include "check.hpp"

using State = std::array<double, 7>; // quaternion (scalar first, body to space) and omega (body axes)

struct Body {
    reference::Vector inertia, centre; // the principal moments of inertia: this body's axes are principal ones
    double weight;
};

static State rates(const Body &body, const State &s) {
    const double w = s[0], x = s[1], y = s[2], z = s[3], a = s[4] / 2, b = s[5] / 2, c = s[6] / 2;
    const reference::Vector omega = {s[4], s[5], s[6]}, &i = body.inertia, momentum = {i[0] * s[4], i[1] * s[5], i[2] * s[6]};
    const reference::Vector up = {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z};
    const reference::Vector gyro = reference::cross(momentum, omega), pull = reference::cross(up, body.centre);
    State rate = {-x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a};
    for (int k = 0; k < 3; ++k) rate[4 + k] = (gyro[k] + body.weight * pull[k]) / i[k];
    return rate;
}

static State moved(const State &s, double h, const State &rate) {
    State to = s;
    for (int k = 0; k < 7; ++k) to[k] += h * rate[k];
    return to;
}

int main(int, char **arguments) {
    const std::string path = std::string(arguments[1]) + "/loop", json = reference::text_of(path + ".json");
    const auto times = reference::columns_of(reference::text_of(path + ".csv"))["t"];
    const auto q = reference::numbers_of(json, "quaternion"), omega = reference::numbers_of(json, "omega");
    const auto inertia = reference::numbers_of(json, "inertia"), centre = reference::numbers_of(json, "centre_of_mass");
    const Body body = {{inertia[0], inertia[4], inertia[8]},
                       {centre[0], centre[1], centre[2]},
                       reference::numbers_of(json, "mass")[0] * reference::numbers_of(json, "gravity")[0]};
    std::vector<double> sizes, errors;
    for (int steps = 50; steps <= 200; steps *= 2) {
        std::vector<reference::Quaternion> quaternions;
        std::vector<reference::Vector> omegas;
        State state = {q[0], q[1], q[2], q[3], omega[0], omega[1], omega[2]};
        const double h = (times[1] - times[0]) / steps;
        for (std::size_t row = 0; row < times.size(); ++row) {
            quaternions.push_back({state[0], state[1], state[2], state[3]});
            omegas.push_back({state[4], state[5], state[6]});
            for (int i = 0; i < steps; ++i) state = moved(state, h, rates(body, moved(state, h / 2, rates(body, state))));
        }
        const auto report = reference::check(times, quaternions, omegas, path + ".json");
        sizes.push_back(h), errors.push_back(report.attitude_error);
        if (steps == 200) std::cout << report;
    }
    std::printf("order of convergence %.2f\n", reference::order(sizes, errors));
}
