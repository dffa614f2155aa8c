// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/border_detail.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "meshing/band.hpp"
#include "meshing/border_pieces.hpp"
#include "meshing/point_insertion.hpp"
#include "meshing/refinement.hpp"

namespace realmodel::meshing {

namespace {

// Where detail is everywhere (combs, coasts), sizes follow it only so far: what is finer is left to
// the refinement of angles, which needs no field that is as fine as the detail.
constexpr std::size_t many_sources = 50'000;
constexpr double finest_of_many = 64;

/// No source finer than `finest`, and of those one in each square of that side.
void thin_out(std::vector<SizeSource>& sources, double finest) {
    std::vector<SizeSource> kept;
    std::stable_sort(sources.begin(), sources.end(),
                     [](const SizeSource& s, const SizeSource& t) { return s.least > t.least; });
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

std::vector<SizeSource> border_detail(const RegionGraph& graph, const SizeField& size,
                                      double least_angle, double shortest_edge,
                                      std::size_t most_vertices, const Check& check) {
    constexpr double short_share = 0.7;  // cut_border's own pieces are hardly shorter than that
    FlatMesh mesh = join_band(cut_border(graph, size, check), graph.loners, {}, check).mesh;
    refine(mesh,
           {least_angle, std::numeric_limits<double>::infinity(), shortest_edge, most_vertices},
           size, 0, {}, check);
    std::vector<bool> is_loner(mesh.points.size(), false);
    for (const std::int32_t v : graph.loners)
        is_loner[v] = true;
    std::vector<SizeSource> sources;
    const auto count = static_cast<std::int32_t>(mesh.corners.size());
    for (std::int32_t t = 0; t < count; ++t) {
        for (int i = 0; i < 3; ++i) {
            const Side side(t, i);
            const bool is_first = mesh.is_border(side) || mesh.behind(side).triangle() > t;
            if (!is_first) continue;
            const PlanPoint &a = mesh.point_from(side), &b = mesh.point_to(side);
            const double length = std::sqrt(squared_distance(a, b));
            if (length >= short_share * size.at(middle(a, b))) continue;
            // Refinement passes over triangles with the shortest edges: leave it room above them.
            const double least = std::max(length, 4 * shortest_edge);
            if (mesh.is_fixed(side)) sources.push_back({a, b, least, least});
            for (const std::int32_t v : {mesh.from(side), mesh.to(side)}) {
                const PlanPoint& p = mesh.points[v];
                if (is_loner[v]) sources.push_back({p, p, least, least});
            }
        }
    }
    if (sources.size() > many_sources) thin_out(sources, size.largest() / finest_of_many);
    return sources;
}

}  // namespace realmodel::meshing
