// SPDX-License-Identifier: GPL-3.0-or-later
// Speed of the interpolation methods: kriging_benchmark [POINTS [NODES [THREADS]]]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <vector>

#include "realmodel/interpolation/distances.hpp"
#include "realmodel/interpolation/kriging.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace {

using namespace realmodel::interpolation;

void time_it(const char* name, std::size_t count, const char* unit,
             const std::function<void()>& run) {
    const auto start = std::chrono::steady_clock::now();
    run();
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%-40s %8.3f s %12.0f %s/s\n", name, seconds, static_cast<double>(count) / seconds,
                unit);
}

}  // namespace

int main(int argc, char** argv) {
    const int point_count = argc > 1 ? std::atoi(argv[1]) : 20'000;
    const int node_count = argc > 2 ? std::atoi(argv[2]) : 1'000'000;
    const int threads = argc > 3 ? std::atoi(argv[3]) : 0;
    std::mt19937 random(1);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    std::vector<std::array<double, 3>> points;
    for (int i = 0; i < point_count; ++i) {
        const double x = uniform(), y = uniform();
        points.push_back({4e5 + 5000 * x, 5e6 + 5000 * y, 100 * std::sin(6 * x) * std::cos(5 * y)});
    }
    std::vector<std::array<double, 2>> places, slopes;
    for (int i = 0; i < point_count / 10; ++i) {
        const double x = uniform(), y = uniform();
        places.push_back({4e5 + 5000 * x, 5e6 + 5000 * y});
        slopes.push_back(
            {0.12 * std::cos(6 * x) * std::cos(5 * y), -0.1 * std::sin(6 * x) * std::sin(5 * y)});
    }
    std::vector<std::array<double, 2>> nodes;
    const int side = static_cast<int>(std::sqrt(static_cast<double>(node_count)));
    for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
            nodes.push_back({4e5 + 5000.0 * (i + 0.5) / side, 5e6 + 5000.0 * (j + 0.5) / side});
        }
    }
    std::printf("%d points, %zu nodes, threads %d (0: all)\n", point_count, nodes.size(), threads);
    time_it("variogram fit", points.size(), "points", [&] { (void)fit_variogram(points, {}); });
    for (const VariogramModel model : {VariogramModel::kSpherical, VariogramModel::kMatern32}) {
        for (const int neighbours : {16, 32}) {
            char name[80];
            std::snprintf(name, sizeof name, "kriging, %s, %d neighbours",
                          std::string(name_of(model)).c_str(), neighbours);
            const Variogram variogram{model, 1500, 2500, 0, {}};
            time_it(name, nodes.size(), "nodes",
                    [&] { (void)krige(points, nodes, variogram, {{neighbours}}, {threads}); });
            // A dip for ten points: as many count at a node as lie among its points on average.
            std::snprintf(name, sizeof name, "  and %d dips", (neighbours + 9) / 10);
            const Dips dips{places, slopes, 5, (neighbours + 9) / 10};
            time_it(name, nodes.size(), "nodes", [&] {
                (void)krige(points, nodes, variogram, {{neighbours}, Drift::kConstant, dips},
                            {threads});
            });
        }
    }
    time_it("inverse distance, 16 neighbours", nodes.size(), "nodes",
            [&] { (void)inverse_distance(points, nodes, {}, {threads}); });
    const std::vector<std::array<double, 3>> few(points.begin(),
                                                 points.begin() + std::min(point_count, 1000));
    const std::vector<std::array<double, 2>> part(
        nodes.begin(), nodes.begin() + std::min<std::ptrdiff_t>(20'000, std::ssize(nodes)));
    time_it("kriging, spherical, all of 1000 points", part.size(), "nodes", [&] {
        (void)krige(few, part, {VariogramModel::kSpherical, 1500, 2500, 0, {}}, {{0}}, {threads});
    });
}
