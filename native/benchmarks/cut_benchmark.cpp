// SPDX-License-Identifier: GPL-3.0-or-later
// A model of crossing surfaces cut by another: seconds, parts, and a digest of both halves.
//
//   cut_benchmark [QUADS [CUTTER [THREADS [surface|fault|lattice|block|flat|plane]]]]
//
// The model has ten surfaces of QUADS x QUADS x 2 triangles each on plan meshes of their own, in
// columns. It is cut by a wavy surface of CUTTER x CUTTER x 2 triangles that rises across it, by an
// upright one ("fault"), by one on an integer lattice through a model that stands on it as well
// ("lattice"), by a block of a model like it ("block"), by one flat quadrangle ("flat"), or by the
// plane of that ("plane").
#include <array>
#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "../fuzz/digest.hpp"
#include "realmodel/cutting/cut.hpp"
#include "realmodel/strata/stack.hpp"

namespace {

struct Surface {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;
};

using Place = std::function<std::array<double, 3>(double, double)>;

/// Nodes at place(u, v), u and v from 0 to 1.
Surface make_surface(int quads, const Place& place) {
    Surface s;
    for (int i = 0; i <= quads; ++i) {
        for (int j = 0; j <= quads; ++j) {
            const auto p = place(static_cast<double>(i) / quads, static_cast<double>(j) / quads);
            s.vertices.insert(s.vertices.end(), p.begin(), p.end());
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

realmodel::CellComplex make_model(int quads, bool lattice, double shift, int threads) {
    std::vector<Surface> made;
    for (int k = 0; k < 10; ++k) {
        const int own = quads + (lattice ? 0 : k % 5 - 2);
        made.push_back(make_surface(own, [&](double u, double v) -> std::array<double, 3> {
            if (lattice) {
                const int i = static_cast<int>(std::lround(u * own)),
                          j = static_cast<int>(std::lround(v * own));
                return {1.0 * i, 1.0 * j, 2.0 * k + (i * 7 + j * 11 + i * j * k) % 4};
            }
            return {u + shift, v + shift,
                    0.3 * k + shift + 0.5 * std::sin(3 * u + k) * std::cos(4 * v - k)};
        }));
    }
    realmodel::strata::StackInput input;
    for (const Surface& s : made)
        input.surfaces.push_back({s.vertices, s.triangles});
    return realmodel::strata::build_stack(input, {threads, nullptr});
}

}  // namespace

int main(int count, char** arguments) {
    const auto number = [&](int i, int otherwise) {
        return count > i ? std::atoi(arguments[i]) : otherwise;
    };
    const int quads = number(1, 30), quads_of_cutter = number(2, 40), threads = number(3, 0);
    const std::string kind = count > 4 ? arguments[4] : "surface";
    const bool lattice = kind == "lattice", is_flat = kind == "flat" || kind == "plane";
    const auto model = make_model(quads, lattice, 0, threads);
    const Surface cutter = make_surface(
        is_flat ? 1 : quads_of_cutter, [&](double u, double v) -> std::array<double, 3> {
            const double size = lattice ? quads : 1.0;
            if (kind == "fault")
                return {0.5 + 0.05 * std::sin(5 * u + 3 * v), 1.2 * u - 0.1, 8 * v - 3};
            if (lattice)
                return {std::round(u * size), std::round(v * size),
                        std::round(8 + 3 * std::sin(u * 5) * v)};
            if (is_flat) return {8 * u - 4, 8 * v - 4, 1.1 + 2.4 * u - 1.6 * v};
            const double x = -0.1 + 1.2 * u, y = -0.1 + 1.2 * v;
            return {x, y, 1.2 + 0.3 * std::sin(5 * x) * y};
        });
    const auto other =
        kind == "block" ? make_model(quads, false, 0.03, threads) : realmodel::CellComplex{};
    const auto began = std::chrono::steady_clock::now();
    const auto cut = [&] {
        if (kind == "block")
            return realmodel::cutting::cut_by_block(model, other, 4, {threads, nullptr});
        if (kind == "plane")
            return realmodel::cutting::cut_by_plane(model, {{-4, -4, 1.1}, {-0.3, 0.2, 1}},
                                                    {threads, nullptr});
        return realmodel::cutting::cut_by_surface(model, {cutter.vertices, cutter.triangles},
                                                  {threads, nullptr});
    }();
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const std::array halves{realmodel::fuzz::digest(cut.below), realmodel::fuzz::digest(cut.above)};
    const std::uint64_t digest = realmodel::fuzz::Digest()
                                     .add(halves)
                                     .add(cut.section.vertices)
                                     .add(cut.section.polygon_vertices)
                                     .add(cut.section.cells)
                                     .value();
    std::printf(
        "%zu cells by %zu triangles: %.3f s, %zu + %zu parts, section of %zu, %016" PRIx64 "\n",
        model.cell_block.size(), cutter.triangles.size() / 3, seconds, cut.below.cell_block.size(),
        cut.above.cell_block.size(), cut.section.cells.size(), digest);
    return 0;
}
