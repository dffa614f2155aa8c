// SPDX-License-Identifier: GPL-3.0-or-later
// Five level sets of a recumbent fold below a ground: seconds from the values of a field to level
// sets, and to cells; faces, cells, and a digest of them.
//
//   fold_benchmark [NODES [THREADS [columns|blocks]]]
//
// The lattice has NODES x NODES x NODES nodes, the ground 32 x 32 x 2 triangles.
#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "../fuzz/digest.hpp"
#include "realmodel/fields/level_sets.hpp"
#include "realmodel/structures/build_compartments.hpp"

namespace {

using namespace realmodel;

constexpr double kSize = 10;
constexpr double kTop = 11;  // of all rock

struct Surface {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;
    TriangleView view() const { return {vertices, triangles}; }
};

/// A grid of quads over the region and 0.5 beyond it.
template <class Height>
Surface sheet(int quads, const Height& height) {
    Surface s;
    for (int i = 0; i <= quads; ++i) {
        for (int j = 0; j <= quads; ++j) {
            const double x = -0.5 + (kSize + 1) * i / quads, y = -0.5 + (kSize + 1) * j / quads;
            s.vertices.insert(s.vertices.end(), {x, y, height(x, y)});
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

double seconds_since(std::chrono::steady_clock::time_point began) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

}  // namespace

int main(int count, char** arguments) {
    const int nodes = count > 1 ? std::atoi(arguments[1]) : 36;
    const Execution execution{count > 2 ? std::atoi(arguments[2]) : 1, nullptr};
    const bool columns = count > 3 && std::strcmp(arguments[3], "columns") == 0;

    const std::vector<double> levels{0.8, 1.6, 2.5, 3.4, 4.4};
    const double step = (kSize + 1.3) / (nodes - 1);
    fields::LatticeField field{
        {{-0.63, -0.71, -0.57}, {step, step, step}, {nodes, nodes, nodes}}, {}, {}, {}};
    std::vector<double> values;
    for (int k = 0; k < nodes; ++k) {
        for (int j = 0; j < nodes; ++j) {
            for (int i = 0; i < nodes; ++i) {
                const auto p = field.lattice.position(i, j, k);
                values.push_back(0.45 * p[0] + 2.2 * std::sin(0.9 * p[2] + 0.15 * p[1]) +
                                 0.1 * p[2]);
            }
        }
    }
    field.values = values;
    const auto began = std::chrono::steady_clock::now();
    const auto solids = fields::level_sets(field, levels, execution);
    const double until_solids = seconds_since(began);

    const Surface region{{0, 0, kSize, 0, kSize, kSize, 0, kSize}, {0, 1, 2, 0, 2, 3}};  // in plan
    const Surface base = sheet(1, [](double, double) { return 0.0; });
    const Surface top = sheet(1, [](double, double) { return kTop; });
    const Surface ground =
        sheet(32, [](double x, double y) { return 8 + 0.6 * std::sin(x) * std::cos(0.7 * y); });
    const std::size_t sets = levels.size();
    structures::CompartmentInput compartment;
    std::size_t triangles = 0;
    for (std::size_t s = 0; s < sets; ++s) {
        const auto& own = solids[s];
        triangles += own.triangles.size();
        compartment.solids.push_back({{{own.vertices[0].data(), 3 * own.vertices.size()},
                                       {own.triangles[0].data(), 3 * own.triangles.size()}},
                                      static_cast<std::int32_t>(s)});
    }
    for (std::size_t place = 0; place <= sets; ++place) {  // between level sets place - 1 and place
        structures::LevelCompartment own;
        structures::CompartmentStack rock;
        rock.stack.region = region.view();
        const auto add = [&](const Surface& surface, structures::CompartmentSurface in_whole) {
            rock.stack.surfaces.push_back(surface.view());
            rock.surfaces.push_back(in_whole);
            rock.stack.rules.push_back(strata::Rule::kErosional);
        };
        if (place == 0) {
            rock.stack.base_elevation = 0;
        } else {
            add(base, {kBase, -1});
        }
        for (std::size_t s = 0; s < sets; ++s) {
            own.sides.push_back(s >= place ? -1 : 1);
            add(s >= place ? top : base,
                {s >= place ? kCutFace : kBase, static_cast<std::int32_t>(s)});
        }
        add(ground, {static_cast<std::int32_t>(sets), static_cast<std::int32_t>(sets)});
        own.rocks.push_back(std::move(rock));
        compartment.between.push_back(std::move(own));
    }
    structures::StructuredInput input;
    input.compartments.push_back(std::move(compartment));
    input.surfaces = static_cast<std::int32_t>(sets) + 1;
    input.blocks = sets + 1;
    input.cells = columns ? CellKind::kColumns : CellKind::kBlocks;
    const auto joining = std::chrono::steady_clock::now();
    const auto built = structures::build_compartments(input, execution).complex;
    const double until_cells = seconds_since(joining);
    std::printf("%d tetrahedra, %zu triangles: %.3f + %.3f s, %zu faces, %zu cells, %016" PRIx64
                "\n",
                6 * (nodes - 1) * (nodes - 1) * (nodes - 1), triangles, until_solids, until_cells,
                built.face_surface.size(), built.cell_block.size(), fuzz::digest(built));
    return 0;
}
