// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/region_graph.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "meshing/constrained_delaunay.hpp"
#include "meshing/plan_predicates.hpp"
#include "meshing/ring_graph.hpp"
#include "meshing/segment_crossings.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::meshing {

namespace {

/// Adds the region's triangles to its area, and the sides between inside and outside to its border.
void take_region(RegionGraph& graph, const ConstrainedTriangulation& mesh,
                 const std::vector<bool>& inside) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!inside[t]) continue;
        const auto& corners = mesh.triangles[t];
        const PlanPoint &a = graph.points[corners[0]], &b = graph.points[corners[1]],
                        &c = graph.points[corners[2]];
        graph.triangles.push_back({a, b, c});
        graph.area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        for (int i = 0; i < 3; ++i) {
            const std::int32_t across = mesh.neighbors[t][i];
            if (across >= 0 && inside[across]) continue;
            graph.border.push_back({corners[i], corners[(i + 1) % 3]});
        }
    }
}

/// Numbers the points of constraints after those of the rings; equal points are one.
class Places {
public:
    explicit Places(std::vector<PlanPoint>& points) : points_(points) {
        for (std::size_t i = 0; i < points.size(); ++i)
            known_.emplace_back(points[i], static_cast<std::int32_t>(i));
        std::sort(known_.begin(), known_.end());
    }

    /// Numbers of many places at once.
    std::vector<std::int32_t> number(std::span<const PlanPoint> places) {
        const std::vector<std::int32_t> first = first_equal(places);
        std::vector<std::int32_t> numbers(places.size());
        const std::size_t before = known_.size();
        for (std::size_t i = 0; i < places.size(); ++i) {
            if (first[i] != static_cast<std::int32_t>(i)) {
                numbers[i] = numbers[first[i]];
                continue;
            }
            const auto end = known_.begin() + static_cast<std::ptrdiff_t>(before);
            const auto at = std::lower_bound(known_.begin(), end, std::pair(places[i], 0));
            if (at != end && at->first == places[i]) {
                numbers[i] = at->second;
                continue;
            }
            numbers[i] = static_cast<std::int32_t>(points_.size());
            points_.push_back(places[i]);
            known_.emplace_back(places[i], numbers[i]);
        }
        std::sort(known_.begin(), known_.end());
        return numbers;
    }

private:
    std::vector<PlanPoint>& points_;
    std::vector<std::pair<PlanPoint, std::int32_t>> known_;
};

void require_finite(const PlanPoint& p, std::size_t line, std::size_t corner, const char* what) {
    if (std::isfinite(p[0]) && std::isfinite(p[1])) return;
    throw InputError("constraint_not_finite",
                     "point " + std::to_string(corner) + " of " + what +
                         (line == static_cast<std::size_t>(-1) ? "" : " " + std::to_string(line)) +
                         " is not a finite number",
                     -1, {static_cast<std::int64_t>(line), static_cast<std::int64_t>(corner)});
}

void sort_out_repeats(std::vector<Segment>& segments) {
    for (Segment& s : segments)
        if (s[0] > s[1]) std::swap(s[0], s[1]);
    std::sort(segments.begin(), segments.end());
    segments.erase(std::unique(segments.begin(), segments.end()), segments.end());
}

}  // namespace

RegionGraph region_graph(std::span<const Ring> rings, const Constraints& constraints,
                         const Progress* progress) {
    const Check check = [progress](double) {
        if (progress != nullptr) progress->check();
    };
    RingTriangulation region = triangulate_region(rings, progress);
    RegionGraph graph;
    graph.points = std::move(region.graph.points);
    if (constraints.lines.empty() && constraints.points.empty()) {
        take_region(graph, region.triangulation, region.inside);
        return graph;
    }

    // All segments, the rings' first, cut where they meet.
    Places places(graph.points);
    std::vector<Segment> segments = region.graph.segments;
    const std::size_t ring_segments = segments.size();
    for (std::size_t l = 0; l < constraints.lines.size(); ++l) {
        const auto& line = constraints.lines[l];
        for (std::size_t i = 0; i < line.size(); ++i)
            require_finite(line[i], l, i, "constraint");
    }
    std::vector<PlanPoint> given;
    for (const auto& line : constraints.lines)
        given.insert(given.end(), line.begin(), line.end());
    const std::size_t line_points = given.size();
    for (std::size_t i = 0; i < constraints.points.size(); ++i) {
        require_finite(constraints.points[i], static_cast<std::size_t>(-1), i,
                       "the constraint points");
        given.push_back(constraints.points[i]);
    }
    const std::vector<std::int32_t> number = places.number(given);
    std::size_t at = 0;
    for (const auto& line : constraints.lines) {
        for (std::size_t i = 0; i < line.size(); ++i, ++at) {
            if (i > 0 && number[at - 1] != number[at]) {
                segments.push_back({number[at - 1], number[at]});
            }
        }
    }
    const std::vector<std::vector<PlanPoint>> cuts =
        crossings(graph.points, segments, ring_segments, check);
    std::vector<PlanPoint> cut_places;
    for (const auto& list : cuts)
        cut_places.insert(cut_places.end(), list.begin(), list.end());
    const std::vector<std::int32_t> cut_number = places.number(cut_places);

    std::vector<Segment> ring_edges, inner_edges;
    at = 0;
    for (std::size_t s = 0; s < segments.size(); ++s) {
        std::vector<Segment>& out = s < ring_segments ? ring_edges : inner_edges;
        std::int32_t last = segments[s][0];
        const auto step = [&](std::int32_t next) {
            if (next != last) out.push_back({last, next});
            last = next;
        };
        for (std::size_t i = 0; i < cuts[s].size(); ++i)
            step(cut_number[at++]);
        step(segments[s][1]);
    }

    Cdt cdt;
    const std::vector<Cdt::Vertex_handle> vertices = insert_points(cdt, graph.points, check);
    std::vector<Segment> all = ring_edges;
    all.insert(all.end(), inner_edges.begin(), inner_edges.end());
    try {
        insert_segments(cdt, vertices, all, check);
    } catch (const InputError& error) {
        if (error.kind != "crossing" || !error.place) throw;
        throw InputError(
            "too_close",
            "a constraint comes so close to another line at " +
                text_of({(*error.place)[0], (*error.place)[1]}) +
                " that they cannot be told apart; move it, or let them meet in a point",
            -1, {}, error.place);
    }
    // A point may lie on a segment without being its end: name the edges that there are.
    const auto chain = [&](const std::vector<Segment>& wanted) {
        std::vector<Segment> edges;
        for (const CoveredEdge& edge : covered_edges(cdt, vertices, wanted))
            edges.push_back({edge.from, edge.to});
        sort_out_repeats(edges);
        return edges;
    };
    ring_edges = chain(ring_edges);
    inner_edges = chain(inner_edges);
    const ConstrainedTriangulation mesh = numbered_triangles(cdt);
    const std::vector<bool> inside = inside_rings(mesh, [&](std::int32_t t, int i) {
        const auto [low, high] = std::minmax(mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3]);
        return mesh.constrained[t][i] &&
               std::binary_search(ring_edges.begin(), ring_edges.end(), Segment{low, high});
    });
    take_region(graph, mesh, inside);

    std::vector<bool> within(graph.points.size(), false), ended(graph.points.size(), false);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!inside[t]) continue;
        for (int i = 0; i < 3; ++i) {
            const std::int32_t a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
            within[a] = true;
            const std::int32_t other = mesh.neighbors[t][i];
            if (a > b || !mesh.constrained[t][i] || other < 0 || !inside[other]) continue;
            if (!std::binary_search(inner_edges.begin(), inner_edges.end(), Segment{a, b}))
                continue;
            graph.inner.push_back({a, b});
            ended[a] = ended[b] = true;
        }
    }
    for (std::size_t i = line_points; i < given.size(); ++i) {
        if (within[number[i]]) continue;
        const PlanPoint& p = given[i];
        throw InputError("constraint_outside",
                         "constraint point " + std::to_string(i - line_points) + " at " +
                             text_of(p) + " lies outside the region; leave it out",
                         -1, {static_cast<std::int64_t>(i - line_points)},
                         std::array{p[0], p[1], 0.0});
    }
    for (const Segment& edge : graph.border)
        ended[edge[0]] = ended[edge[1]] = true;
    for (std::size_t i = 0; i < graph.points.size(); ++i)
        if (within[i] && !ended[i]) graph.loners.push_back(static_cast<std::int32_t>(i));
    return graph;
}

}  // namespace realmodel::meshing
