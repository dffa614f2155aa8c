// SPDX-License-Identifier: GPL-3.0-or-later
// What proving a model costs beside building it: seconds, and nanoseconds a face on each thread.
//
//   validation_benchmark [SURFACES [QUADS [THREADS [blocks]]]]
//
// Each surface has QUADS x QUADS x 2 triangles on jittered nodes of its own.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "realmodel/strata/stack.hpp"
#include "realmodel/validation/topology.hpp"

namespace {

struct Surface {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;
};

Surface make_surface(int quads, int number, std::mt19937_64& random) {
    std::uniform_real_distribution<double> phase(0, 6), jitter(-0.2, 0.2);
    const double p = phase(random), q = phase(random), r = phase(random);
    Surface s;
    for (int i = 0; i <= quads; ++i) {
        for (int j = 0; j <= quads; ++j) {
            const auto place = [&](int n) {
                return (n + (n > 0 && n < quads ? jitter(random) : 0.0)) / quads;
            };
            const double x = place(i), y = place(j);
            s.vertices.insert(s.vertices.end(),
                              {x, y,
                               0.05 * number + 0.1 * std::sin(3 * x + p) * std::cos(4 * y + q) +
                                   0.03 * std::sin(9 * x + r + 5 * y)});
        }
    }
    for (int i = 0; i < quads; ++i) {
        for (int j = 0; j < quads; ++j) {
            const std::int32_t a = i * (quads + 1) + j, b = a + quads + 1, c = b + 1, d = a + 1;
            s.triangles.insert(s.triangles.end(), {a, b, c, a, c, d});
        }
    }
    return s;
}

}  // namespace

int main(int count, char** arguments) {
    using namespace realmodel;
    const auto number = [&](int i, int otherwise) {
        return count > i ? std::atoi(arguments[i]) : otherwise;
    };
    const int surfaces = number(1, 10), quads = number(2, 60), threads = number(3, 0);
    const bool blocks = count > 4 && std::string(arguments[4]) == "blocks";
    std::mt19937_64 random(1);
    std::vector<Surface> owned;
    strata::StackInput input;
    for (int k = 0; k < surfaces; ++k)
        owned.push_back(make_surface(quads, k, random));
    for (const Surface& s : owned)
        input.surfaces.push_back({s.vertices, s.triangles});

    using Clock = std::chrono::steady_clock;
    const auto seconds = [](Clock::time_point since) {
        return std::chrono::duration<double>(Clock::now() - since).count();
    };
    const auto begin = Clock::now();
    const CellComplex model = strata::build_stack(input, {threads, nullptr},
                                                  blocks ? CellKind::kBlocks : CellKind::kColumns);
    const double built = seconds(begin);

    const auto start = Clock::now();
    const auto results = validation::check_topology(model, {threads, nullptr});
    const double checked = seconds(start);
    const auto faces = static_cast<double>(model.face_cells.size());
    std::printf("%.0f faces: built in %.2f s, proven in %.3f s (%.1f %%), %.0f ns a face\n", faces,
                built, checked, 100 * checked / built, 1e9 * checked / faces);
    bool passed = true;
    for (const auto& test : results) {
        std::printf("  %-14s %10lld %-9s %6.1f ns a face%s\n", test.name.c_str(),
                    static_cast<long long>(test.findings.examined), test.unit.c_str(),
                    1e9 * test.seconds / faces, test.findings.passed() ? "" : "  FAILED");
        passed = passed && test.findings.passed();
    }
    return passed ? 0 : 1;
}
