// Many tops in C++17: a sweep over arrays of parameters, the fastest way for symmetric tops, and one top in eight
// threads at once.
#include <spintop.h>

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

struct Deleter {
    void operator()(spintop_error *error) const { spintop_error_delete(error); }
    void operator()(spintop_result *result) const { spintop_result_delete(result); }
    void operator()(spintop_top *top) const { spintop_top_delete(top); }
};

template <class T> using Owned = std::unique_ptr<T, Deleter>;

// Calls a function of the library with a place for its error, and throws that.
template <class Call> auto checked(Call call) {
    spintop_error *error = nullptr;
    auto result = call(&error);
    Owned<spintop_error> owned(error);
    if (owned) throw std::runtime_error(owned->message);
    return result;
}

const std::string top = "&top mass = 1 inertia = 0.875, 0.875, 0.25 length = 0.8660254037844387 /\n";

// theta_max of tops with some inclinations and rates, by a sweep of the general kind.
std::vector<double> by_sweep(const std::vector<double> &theta, const std::vector<double> &omega3) {
    const char *names[] = {"initial.theta", "initial.omega3"};
    const double *values[] = {theta.data(), omega3.data()};
    const std::string input =
        top + "&study kind = 'sweep' / &initial theta = 0 / &span t_end = 1 / &output columns = 'theta_max', 'theta_end' /";
    Owned<spintop_result> result(checked([&](spintop_error **error) {
        return spintop_sweep(input.c_str(), 2, names, values, theta.size(), 0, error);
    }));
    const spintop_table &table = result->tables[0];
    std::printf("sweep: code %d, columns", result->code);
    std::vector<double> found;
    for (long long c = 0; c < table.column_count; ++c) {
        const spintop_column &column = table.columns[c];
        std::printf(" %s", column.name);
        if (std::string(column.name) == "theta_max") found.assign(column.values, column.values + table.row_count);
    }
    std::printf("\n");
    return found;
}

// The same by arrays.
std::vector<double> by_arrays(const std::vector<double> &theta, const std::vector<double> &omega3) {
    const double inertia1 = 0.875, inertia3 = 0.25, mgl = 9.81 * 0.8660254037844387;
    const char *given_names[] = {"inertia1", "inertia3", "mgl", "theta", "omega3"};
    const double *given[] = {&inertia1, &inertia3, &mgl, theta.data(), omega3.data()};
    const long long strides[] = {0, 0, 0, 1, 1};
    const char *wanted_names[] = {"theta_max"};
    std::vector<double> found(theta.size());
    double *wanted[] = {found.data()};
    checked([&](spintop_error **error) {
        return spintop_tops((long long)theta.size(), 5, given_names, given, strides, 1, wanted_names, wanted, nullptr, 0,
                            error);
    });
    return found;
}

// The inclination of one top, by several threads at once; returns the number of those that differ from the first.
int in_threads() {
    const std::string input =
        top + "&initial theta_deg = 11.25 psi_rate = 1 / &span t_end = 1 / &output columns = 'theta' /";
    Owned<spintop_top> shared(
        checked([&](spintop_error **error) { return spintop_top_new(input.c_str(), nullptr, error); }));
    std::vector<double> t(1000);
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = 0.01 * (double)i;
    std::vector<std::vector<double>> theta(8, std::vector<double>(t.size()));
    std::vector<std::thread> threads;
    for (auto &own : theta) {
        threads.emplace_back([&] { spintop_top_at(shared.get(), t.size(), t.data(), own.data(), nullptr); });
    }
    for (auto &thread : threads) thread.join();
    int different = 0;
    for (auto &own : theta) different += own != theta.front();
    return different;
}

int main() {
    std::vector<double> theta(1000), omega3(1000);
    for (std::size_t i = 0; i < theta.size(); ++i) {
        theta[i] = 0.1 + 0.001 * (double)i;
        omega3[i] = 1.0 + 0.01 * (double)i;
    }
    const auto a = by_sweep(theta, omega3), b = by_arrays(theta, omega3);
    std::printf("%zu tops, theta_max of the first %.15g, %s\n", a.size(), a.front(), a == b ? "equal" : "different");
    std::printf("%d of 8 threads differ\n", in_threads());
    try {
        by_sweep({-1.0}, {1.0});
    } catch (const std::runtime_error &error) {
        std::printf("%s\n", error.what());
    }
    return a == b && a.size() == 1000 ? 0 : 1;
}
