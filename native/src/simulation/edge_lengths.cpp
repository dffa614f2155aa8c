// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/edge_lengths.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "base/parallel.hpp"
#include "meshing/requested_sizes.hpp"
#include "realmodel/base/errors.hpp"
#include "simulation/column_heights.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::simulation {

namespace {

constexpr double kMostLeaves = 1e7;  ///< of the field, and pieces that its lines are divided into
constexpr double kAlike = 3;  ///< edge lengths: in a square as wide edges are about alike in length

[[noreturn]] void refuse_lengths() {
    throw InputError("too_large",
                     "the local lengths are so short that the mesh would be too large; "
                     "use longer ones");
}

}  // namespace

meshing::SizeField edge_lengths(const ComplexView& model, const BoundaryFaces& faces,
                                double edge_length, double tolerance,
                                std::span<const meshing::LocalLength> sizes) {
    if (sizes.empty()) return meshing::SizeField(edge_length);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        if (sizes[i].length < tolerance) {
            throw InputError("size",
                             "size " + std::to_string(i) +
                                 ": its length must not be below the minimum thickness",
                             -1, {static_cast<std::int64_t>(i)});
        }
    }
    meshing::RegionGraph graph;
    for (const auto& [a, b] : faces.sharp_edges) {
        const auto first = static_cast<std::int32_t>(graph.points.size());
        graph.points.push_back(plan_of(model, a));
        graph.points.push_back(plan_of(model, b));
        graph.border.push_back({first, first + 1});
    }
    meshing::MeshRequest request;
    request.sizes.assign(sizes.begin(), sizes.end());
    std::vector<meshing::SizeSource> sources =
        meshing::requested_sources(graph, request, edge_length, 1);
    spatial::PlanBox box = spatial::kNoBox;
    for (const BoundaryTriangle& t : faces.triangles) {
        const auto [a, b, c] = t.corners;
        box = box.united(spatial::box_around(
            std::array{plan_of(model, a), plan_of(model, b), plan_of(model, c)}));
    }
    const meshing::PlanPoint low{box.low_x, box.low_y}, high{box.high_x, box.high_y};
    if (meshing::pieces_along(sources, low, high) > kMostLeaves) refuse_lengths();
    return {edge_length, meshing::kGradation, std::move(sources), low, high, kMostLeaves};
}

double cubes_in(meshing::SizeField& lengths, const std::array<double, 3>& low,
                const std::array<double, 3>& high, double most, Progress* progress) {
    const double height = high[2] - low[2];
    if (lengths.is_uniform()) {
        const double edge = lengths.largest();
        return (high[0] - low[0]) * (high[1] - low[1]) * height / (edge * edge * edge);
    }
    struct Square {
        double x, y, width;
    };
    double cubes = 0;
    std::vector<Square> open{{low[0], low[1], std::max(high[0] - low[0], high[1] - low[1])}};
    for (std::size_t count = 0; !open.empty(); ++count) {
        poll(progress, count);
        const auto [x, y, width] = open.back();
        open.pop_back();
        if (x >= high[0] || y >= high[1]) continue;
        const double half = width / 2, edge = lengths.at({x + half, y + half});
        if (width > kAlike * edge) {
            for (const double right : {0.0, half})
                for (const double upper : {0.0, half})
                    open.push_back({x + right, y + upper, half});
            continue;
        }
        const double area = (std::min(x + width, high[0]) - x) * (std::min(y + width, high[1]) - y);
        cubes += area / (edge * edge) * std::max(1.0, height / edge);
        if (cubes > most) refuse_lengths();
    }
    return cubes;
}

}  // namespace realmodel::simulation
