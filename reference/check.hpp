// Compare the trajectory of an engine with a reference motion of spintop, in C++11, without other libraries.
//
//     auto report = reference::check(times, quaternions, omega, "reference/motions/slow_top.json");
//     std::cout << report;
//
// Conventions of the set: quaternions have the scalar first and turn body axes into space axes, angular velocities are in
// body axes, space z is up. Those of the engine are found: those that fit best. Public domain (CC0-1.0).
#ifndef SPINTOP_REFERENCE_CHECK
#define SPINTOP_REFERENCE_CHECK

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace reference {

using Quaternion = std::array<double, 4>;
using Vector = std::array<double, 3>;

// What was found. The conventions of the trajectory; the largest rotation from the reference, rad, and difference of the
// angular velocity, rad/s; the largest change of energy (over the kinetic energy at the start plus m g |r|) and of momentum
// (over the largest) against the reference; the error of the reference plus that by rounding of the data, rad. The errors
// at the common times are in the lists.
struct Report {
    std::string scalar, direction, frame, sign;
    double attitude_error = 0, omega_error = 0, energy_change = 0, momentum_change = 0, attitude_floor = 0;
    std::vector<double> times, attitude_errors, omega_errors;
};

inline std::ostream &operator<<(std::ostream &out, const Report &r) {
    return out << "scalar " << r.scalar << "\ndirection " << r.direction << "\nframe " << r.frame << "\nsign " << r.sign
               << "\nattitude_error " << r.attitude_error << "\nattitude_floor " << r.attitude_floor << "\nomega_error "
               << r.omega_error << "\nenergy_change " << r.energy_change << "\nmomentum_change " << r.momentum_change << '\n';
}

inline std::string text_of(const std::string &path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(path + " cannot be read");
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

// The numbers behind a key of a JSON, as many as there are up to the next word.
inline std::vector<double> numbers_of(const std::string &json, const std::string &key) {
    std::vector<double> found;
    std::size_t at = json.find('"' + key + "\":");
    if (at == std::string::npos) throw std::runtime_error("there is no " + key);
    for (const char *here = json.c_str() + at + key.size() + 3; *here && *here != '"';) {
        char *end;
        const double number = std::strtod(here, &end);
        if (end != here) found.push_back(number);
        here = end == here ? here + 1 : end;
    }
    return found;
}

// The columns of a table by name.
inline std::map<std::string, std::vector<double>> columns_of(const std::string &table) {
    std::map<std::string, std::vector<double>> columns;
    std::vector<std::string> names;
    std::stringstream lines(table);
    for (std::string line, cell; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::stringstream cells(line);
        const bool is_head = names.empty();
        for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
            if (is_head) names.push_back(cell);
            else columns[names.at(i)].push_back(std::strtod(cell.c_str(), nullptr));
        }
    }
    return columns;
}

inline Vector cross(const Vector &a, const Vector &b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline double dot(const Vector &a, const Vector &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline double distance(const Vector &a, const Vector &b) {
    return std::hypot(std::hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

// A vector turned by a quaternion from body to space axes, or back.
inline Vector turned(const Quaternion &q, const Vector &v, bool back = false) {
    const double s = back ? -1 : 1;
    const Vector u = {s * q[1], s * q[2], s * q[3]}, c = cross(u, v), d = cross(u, {2 * c[0], 2 * c[1], 2 * c[2]});
    return {v[0] + 2 * q[0] * c[0] + d[0], v[1] + 2 * q[0] * c[1] + d[1], v[2] + 2 * q[0] * c[2] + d[2]};
}

// The angle of the rotation from one attitude to another; the signs of the quaternions do not matter.
inline double angle(const Quaternion &p, const Quaternion &q) {
    const Vector a = {p[1], p[2], p[3]}, b = {q[1], q[2], q[3]}, c = cross(a, b);
    const Vector v = {p[0] * b[0] - q[0] * a[0] - c[0], p[0] * b[1] - q[0] * a[1] - c[1], p[0] * b[2] - q[0] * a[2] - c[2]};
    return 2 * std::atan2(distance(v, {0, 0, 0}), std::abs(p[0] * q[0] + dot(a, b)));
}

inline double median(std::vector<double> x) {
    std::nth_element(x.begin(), x.begin() + x.size() / 2, x.end());
    return x[x.size() / 2];
}

// Compare a trajectory with the motion of a JSON, beside which lies its table. Times that the reference does not have are
// left out. `omega` may be empty. Errors are exceptions of the standard library.
inline Report check(const std::vector<double> &times, const std::vector<Quaternion> &quaternions,
                    const std::vector<Vector> &omega, const std::string &json_path) {
    const std::string json = text_of(json_path);
    auto columns = columns_of(text_of(json_path.substr(0, json_path.size() - 5) + ".csv"));
    const std::vector<double> &t = columns["t"];
    if (quaternions.size() != times.size() || (!omega.empty() && omega.size() != times.size()))
        throw std::invalid_argument("there must be a quaternion, and an omega if any, for each time");
    Report best, r;
    std::vector<std::size_t> rows, mine;
    for (std::size_t i = 0, row = 0; i < times.size(); ++i) {
        while (row < t.size() && t[row] < times[i] - 1e-9 * (t[1] - t[0])) ++row;
        if (row == t.size() || std::abs(t[row] - times[i]) > 1e-9 * (t[1] - t[0])) continue;
        rows.push_back(row), mine.push_back(i);
        r.times.push_back(times[i]);
        r.attitude_floor = std::max(r.attitude_floor, numbers_of(json, "value")[0] + columns["inherent_error"][row]);
    }
    if (rows.size() < 2) throw std::invalid_argument("fewer than two of the times are those of the motion");
    const std::vector<double> inertia = numbers_of(json, "inertia"), centre = numbers_of(json, "centre_of_mass");
    const double weight = numbers_of(json, "mass")[0] * numbers_of(json, "gravity")[0];
    const Vector arm = {centre[0], centre[1], centre[2]};
    auto quaternion = [&](std::size_t row) {
        return Quaternion{columns["q0"][row], columns["q1"][row], columns["q2"][row], columns["q3"][row]};
    };
    auto momentum = [&](const Vector &w) {
        Vector p = {0, 0, 0};
        for (int k = 0; k < 9; ++k) p[k / 3] += inertia[k] * w[k % 3];
        return p;
    };
    auto energy = [&](const Quaternion &q, const Vector &w) { return dot(w, momentum(w)) / 2 + weight * turned(q, arm)[2]; };

    std::vector<Quaternion> attitude(rows.size()), kept;
    for (int way = 0; way < 4; ++way) {
        r.attitude_errors.clear();
        for (std::size_t k = 0; k < rows.size(); ++k) {
            Quaternion q = quaternions[mine[k]];
            if (way % 2) std::rotate(q.begin(), q.begin() + 3, q.end());
            const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), s = way / 2 ? -1 : 1;
            attitude[k] = {q[0] / length, s * q[1] / length, s * q[2] / length, s * q[3] / length};
            r.attitude_errors.push_back(angle(attitude[k], quaternion(rows[k])));
        }
        r.scalar = way % 2 ? "last" : "first";
        r.direction = way / 2 ? "space to body" : "body to space";
        r.attitude_error = *std::max_element(r.attitude_errors.begin(), r.attitude_errors.end());
        if (kept.empty() || median(r.attitude_errors) < median(best.attitude_errors)) best = r, kept = attitude;
    }
    if (omega.empty()) return best;
    r = best;
    for (int way = 0; way < 4; ++way) {
        r.omega_errors.clear();
        r.omega_error = r.energy_change = r.momentum_change = 0;
        double scale = 0, largest = 0;
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const double s = way % 2 ? -1 : 1;
            const Vector given = omega[mine[k]], same = {s * given[0], s * given[1], s * given[2]};
            const Vector w = way / 2 ? turned(kept[k], same, true) : same;
            const Vector truth = {columns["omega1"][rows[k]], columns["omega2"][rows[k]], columns["omega3"][rows[k]]};
            const Quaternion q = quaternion(rows[k]);
            const Vector p = turned(q, momentum(truth));
            if (k == 0) scale = dot(truth, momentum(truth)) / 2 + weight * distance(arm, {0, 0, 0});
            largest = std::max(largest, distance(p, {0, 0, 0}));
            r.omega_errors.push_back(distance(w, truth));
            r.omega_error = std::max(r.omega_error, r.omega_errors.back());
            r.energy_change = std::max(r.energy_change, std::abs(energy(kept[k], w) - energy(q, truth)));
            r.momentum_change = std::max(r.momentum_change, distance(turned(kept[k], momentum(w)), p));
        }
        r.energy_change /= scale > 0 ? scale : 1;
        r.momentum_change /= largest > 0 ? largest : 1;
        r.sign = way % 2 ? "minus" : "plus";
        r.frame = way / 2 ? "space" : "body";
        if (best.omega_errors.empty() || median(r.omega_errors) < median(best.omega_errors)) best = r;
    }
    return best;
}

// The order of convergence: the slope of log(error) over log(step), of three steps or more.
inline double order(const std::vector<double> &steps, const std::vector<double> &errors) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const double a = std::log(steps[i]), b = std::log(errors.at(i));
        n += 1, x += a, y += b, xx += a * a, xy += a * b;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

} // namespace reference
#endif
