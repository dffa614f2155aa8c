// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/border_detail.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include "meshing/band.hpp"
#include "meshing/border_pieces.hpp"
#include "meshing/point_insertion.hpp"
#include "meshing/refinement.hpp"

namespace realmodel::meshing {

namespace {

// Where detail is everywhere (combs, coasts), sizes follow it only so far: what is finer is left to
// the refinement of angles, which needs no field that is as fine as the detail.
constexpr std::size_t kManySources = 50'000;
constexpr double kFinestOfMany = 64;

// Beside outlines that are all detail most triangles are where lengths grow: the slower they do,
// the better they are, and the more (15 % more than with a kGrowth of a quarter).
constexpr double kGrowth = 0.2;

/// How long edges should be at a fixed edge. Refinement halves lengths; where the region is a strip
/// between the edge and the border opposite, its width tells how far.
double length_at(const FlatMesh& mesh, HalfEdge edge, const std::vector<bool>& is_fixed) {
    const PlanPoint &a = mesh.origin_point(edge), &b = mesh.target_point(edge);
    const double length = std::sqrt(squared_distance(a, b));
    const bool is_strip =
        is_fixed[mesh.apex(edge)] && !mesh.is_fixed(edge.next()) && !mesh.is_fixed(edge.prev());
    if (!is_strip) return length;
    const double width = twice_area(a, b, mesh.apex_point(edge)) / length;
    return std::clamp(2 / std::numbers::sqrt3 * width, 0.25 * length, 1.5 * length);
}

/// No source finer than `finest`, and of those one in each square of that edge.
void thin_out(std::vector<SizeSource>& sources, double finest) {
    std::vector<SizeSource> kept;
    std::ranges::stable_sort(sources, std::greater<>(), &SizeSource::least);
    std::vector<std::pair<std::array<double, 2>, std::size_t>> squares;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        if (sources[i].least >= finest) {
            kept.push_back(sources[i]);
            continue;
        }
        const PlanPoint m = middle(sources[i].a, sources[i].b);
        squares.push_back({{std::floor(m[0] / finest), std::floor(m[1] / finest)}, i});
    }
    std::sort(squares.begin(), squares.end());
    for (std::size_t i = 0; i < squares.size(); ++i) {
        if (i > 0 && squares[i].first == squares[i - 1].first) continue;
        SizeSource source = sources[squares[i].second];
        source.start = source.least = finest;
        kept.push_back(source);
    }
    sources = std::move(kept);
}

}  // namespace

std::vector<SizeSource> border_detail(const RegionGraph& graph, SizeField& size, double least_angle,
                                      double shortest_edge, std::size_t most_vertices,
                                      const Check& check) {
    constexpr double kShortShare = 0.7;  // cut_border's own pieces are hardly shorter than that
    FlatMesh mesh = mesh_without_lattice(graph, cut_border(graph, size, shortest_edge, check),
                                         shortest_edge, check);
    refine(mesh,
           {least_angle, std::numeric_limits<double>::infinity(), shortest_edge, most_vertices},
           size, 0, {}, check);
    std::vector<bool> is_loner(mesh.points.size(), false);
    for (const std::int32_t v : graph.loners)
        is_loner[v] = true;
    std::vector<SizeSource> sources;
    std::vector<bool> is_fixed(mesh.points.size(), false);
    mesh.for_each_edge([&](HalfEdge edge) {
        if (mesh.is_fixed(edge)) is_fixed[mesh.from(edge)] = is_fixed[mesh.to(edge)] = true;
    });
    mesh.for_each_edge([&](HalfEdge edge) {
        const bool is_first = mesh.is_border(edge) || mesh.twin(edge).triangle() > edge.triangle();
        if (!is_first) return;
        const PlanPoint &a = mesh.origin_point(edge), &b = mesh.target_point(edge);
        const double length = std::sqrt(squared_distance(a, b));
        if (length >= kShortShare * size.at(middle(a, b))) return;
        // Refinement passes over triangles with the shortest edges: leave it room above them.
        const double least = std::max(length, 4 * shortest_edge);
        if (mesh.is_fixed(edge)) {
            const double here = std::max(length_at(mesh, edge, is_fixed), 4 * shortest_edge);
            sources.push_back({a, b, here, here, kGrowth});
        }
        for (const std::int32_t v : {mesh.from(edge), mesh.to(edge)}) {
            const PlanPoint& p = mesh.points[v];
            if (is_loner[v]) sources.push_back({p, p, least, least, kGrowth});
        }
    });
    if (sources.size() > kManySources) thin_out(sources, size.largest() / kFinestOfMany);
    return sources;
}

}  // namespace realmodel::meshing
