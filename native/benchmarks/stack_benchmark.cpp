// SPDX-License-Identifier: GPL-3.0-or-later
// Cells of a stack of crossing surfaces: seconds, cells and faces a second.
//
//   stack_benchmark [SURFACES [QUADS [THREADS [WORD]...]]]
//
// Each surface has QUADS x QUADS x 2 triangles on jittered nodes of its own. Words:
//   shared  all surfaces have the same plan mesh
//   blocks  each connected part of a block is one cell
//   rules   the surfaces have all four rules in turn, not only the erosional one
//   two     two rock masses of such surfaces lie side by side
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "realmodel/strata/stack.hpp"

namespace {

struct Surface {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;
};

Surface make_surface(int quads, int number, int rock, bool shared, std::mt19937_64& random) {
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const double p = uniform(0, 6), q = uniform(0, 6), r = uniform(0, 6);
    Surface s;
    for (int i = 0; i <= quads; ++i) {
        for (int j = 0; j <= quads; ++j) {
            const auto place = [&](int n) {
                const bool inside = !shared && n > 0 && n < quads;
                return (n + (inside ? uniform(-0.2, 0.2) : 0.0)) / quads;
            };
            const double x = rock + place(i), y = place(j);
            const double z = 0.05 * number + 0.1 * std::sin(3 * x + p) * std::cos(4 * y + q) +
                             0.03 * std::sin(9 * x + r + 5 * y);
            s.vertices.insert(s.vertices.end(), {x, y, z});
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
    const auto number = [&](int i, int otherwise) {
        return count > i ? std::atoi(arguments[i]) : otherwise;
    };
    const int surfaces = number(1, 10), quads = number(2, 60), threads = number(3, 0);
    const auto has = [&](const char* word) {
        return std::any_of(arguments + std::min(count, 4), arguments + count,
                           [&](const char* given) { return std::string(given) == word; });
    };
    const bool shared = has("shared"), blocks = has("blocks");
    std::mt19937_64 random(1);
    const int rocks = has("two") ? 2 : 1;
    std::vector<Surface> made;
    for (int rock = 0; rock < rocks; ++rock) {
        for (int k = 0; k < surfaces; ++k)
            made.push_back(make_surface(quads, k, rock, shared, random));
    }
    using realmodel::strata::Rule;
    constexpr std::array kRules{Rule::kErosional, Rule::kConformable, Rule::kBase,
                                Rule::kDiscontinuous};
    std::vector<realmodel::strata::StackInput> input(static_cast<std::size_t>(rocks));
    for (std::size_t i = 0; i < made.size(); ++i) {
        auto& rock = input[i / static_cast<std::size_t>(surfaces)];
        rock.rules.push_back(has("rules") ? kRules[rock.surfaces.size() % kRules.size()]
                                          : Rule::kErosional);
        rock.surfaces.push_back({made[i].vertices, made[i].triangles});
    }
    const auto began = std::chrono::steady_clock::now();
    const auto complex = realmodel::strata::build_rock_masses(
        input, {threads, nullptr},
        blocks ? realmodel::strata::CellKind::kBlocks : realmodel::strata::CellKind::kColumns);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    std::printf(
        "%zu surfaces x %d triangles: %.3f s, %zu cells (%.0f/s), %zu faces (%.0f/s), %.4f %% of "
        "%llu signs exact\n",
        made.size(), 2 * quads * quads, seconds, complex.cell_block.size(),
        static_cast<double>(complex.cell_block.size()) / seconds, complex.face_cells.size(),
        static_cast<double>(complex.face_cells.size()) / seconds,
        100.0 * static_cast<double>(complex.exact_decisions) /
            static_cast<double>(std::max<std::uint64_t>(complex.decisions, 1)),
        static_cast<unsigned long long>(complex.decisions));
    return 0;
}
