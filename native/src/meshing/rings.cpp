// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/rings.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "meshing/constrained_delaunay.hpp"
#include "meshing/plan_predicates.hpp"
#include "meshing/point_insertion.hpp"
#include "meshing/ring_graph.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::meshing {

namespace {

/// A corner of a ring and its number in the input.
struct Corner {
    PlanPoint place;
    std::int64_t number;
};

std::vector<Corner> distinct_corners(const Ring& ring, std::int64_t ring_number) {
    std::vector<Corner> corners;
    corners.reserve(ring.size());
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const auto number = static_cast<std::int64_t>(i);
        if (!std::isfinite(ring[i][0]) || !std::isfinite(ring[i][1])) {
            throw InputError("not_finite",
                             "corner " + std::to_string(i) + " of outline " +
                                 std::to_string(ring_number) + " is not a finite number",
                             -1, {ring_number, number});
        }
        if (corners.empty() || corners.back().place != ring[i])
            corners.push_back({ring[i], number});
    }
    while (corners.size() > 1 && corners.back().place == corners.front().place)
        corners.pop_back();
    return corners;
}

/// Refuses what has no area whichever way it is looked at.
void require_area(const std::vector<Corner>& corners, std::int64_t ring_number) {
    const auto refuse = [&](const std::string& what) {
        std::optional<std::array<double, 3>> place;
        if (!corners.empty()) place = {corners[0].place[0], corners[0].place[1], 0.0};
        throw InputError("outline_degenerate",
                         "outline " + std::to_string(ring_number) + " " + what +
                             (corners.empty() ? "" : " near " + text_of(corners[0].place)) +
                             "; it needs three corners that are not in one line",
                         -1, {ring_number}, place);
    };
    if (corners.size() < 3) {
        refuse("has " + std::to_string(corners.size()) + " distinct corner" +
               (corners.size() == 1 ? "" : "s"));
    }
    const bool in_line = std::all_of(corners.begin() + 2, corners.end(), [&](const Corner& c) {
        return orient2d(corners[0].place, corners[1].place, c.place) == 0;
    });
    if (in_line) refuse("has all its corners in one line");
}

/// Makes corners at one place one point, numbered in order of appearance.
std::vector<std::int32_t> number_places(const std::vector<PlanPoint>& corners,
                                        std::vector<PlanPoint>& points) {
    const std::vector<std::int32_t> first = first_equal(corners);
    std::vector<std::int32_t> number(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (first[i] == static_cast<std::int32_t>(i)) {
            number[i] = static_cast<std::int32_t>(points.size());
            points.push_back(corners[i]);
        } else {
            number[i] = number[first[i]];
        }
    }
    return number;
}

void refuse_overlaps(const RingGraph& graph, const std::vector<CoveredEdge>& edges) {
    const CoveredEdge* worst = nullptr;
    for (std::size_t i = 1; i < edges.size(); ++i) {
        if (edges[i].from != edges[i - 1].from || edges[i].to != edges[i - 1].to) continue;
        if (worst == nullptr || edges[i].segment < worst->segment) worst = &edges[i];
    }
    if (worst != nullptr) refuse_overlap(graph, *(worst - 1), *worst);
}

/// Refuses two edges of the graph, given by their segments.
[[noreturn]] void refuse_edges(const RingGraph& graph, std::int64_t first, std::int64_t second,
                               const std::string& kind, const std::string& verb,
                               const PlanPoint& place) {
    const auto [first_ring, first_corner] = graph.origin[first];
    const auto [second_ring, second_corner] = graph.origin[second];
    const auto edge = [](std::int64_t ring, std::int64_t corner) {
        return "the edge after corner " + std::to_string(corner) + " of outline " +
               std::to_string(ring);
    };
    throw InputError(kind,
                     edge(first_ring, first_corner) + " " + verb + " " +
                         edge(second_ring, second_corner) + " at " + text_of(place),
                     -1, {first_ring, first_corner, second_ring, second_corner},
                     std::array{place[0], place[1], 0.0});
}

/// Rings as points and segments.
RingGraph ring_graph(std::span<const Ring> rings) {
    if (rings.empty()) throw InputError("no_outline", "the region has no outline");
    RingGraph graph;
    std::vector<PlanPoint> corners;
    std::vector<std::array<std::size_t, 2>> corner_range;
    for (std::size_t r = 0; r < rings.size(); ++r) {
        const auto ring_number = static_cast<std::int64_t>(r);
        const std::vector<Corner> ring = distinct_corners(rings[r], ring_number);
        require_area(ring, ring_number);
        corner_range.push_back({corners.size(), corners.size() + ring.size()});
        for (const Corner& corner : ring) {
            corners.push_back(corner.place);
            graph.origin.push_back({ring_number, corner.number});
        }
    }
    const std::vector<std::int32_t> number = number_places(corners, graph.points);
    graph.segments.reserve(corners.size());
    for (const auto [begin, end] : corner_range) {
        for (std::size_t i = begin; i < end; ++i) {
            graph.segments.push_back({number[i], number[i + 1 < end ? i + 1 : begin]});
        }
    }
    return graph;
}

}  // namespace

std::vector<std::int32_t> first_equal(std::span<const PlanPoint> places) {
    std::vector<std::int32_t> order(places.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, {}, [&](std::int32_t i) { return std::pair(places[i], i); });
    std::vector<std::int32_t> first(places.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && places[order[i]] == places[order[i - 1]];
        first[order[i]] = same ? first[order[i - 1]] : order[i];
    }
    return first;
}

void refuse_overlap(const RingGraph& graph, const CoveredEdge& first, const CoveredEdge& second) {
    refuse_edges(graph, first.segment, second.segment, "outline_overlaps", "runs along",
                 middle(graph.points[first.from], graph.points[first.to]));
}

ConstrainedRings constrained_rings(std::span<const Ring> rings, Progress* progress) {
    ConstrainedRings out{ring_graph(rings), {}, {}};
    const RingGraph& graph = out.graph;
    const Check check = stopped_by(progress);
    Cdt cdt;
    const std::vector<Cdt::Vertex_handle> vertices = insert_points(cdt, graph.points, check);
    try {
        insert_segments(cdt, vertices, graph.segments, check);
    } catch (const InputError& error) {
        if (error.kind != "crossing") throw;
        refuse_edges(graph, error.items[0], error.items[1], "outline_crosses", "crosses",
                     {(*error.place)[0], (*error.place)[1]});
    }
    out.edges = covered_edges(cdt, vertices, graph.segments);
    out.triangulation = numbered_triangles(cdt);
    return out;
}

RingTriangulation triangulate_region(std::span<const Ring> rings, Progress* progress) {
    ConstrainedRings all = constrained_rings(rings, progress);
    refuse_overlaps(all.graph, all.edges);
    RingTriangulation out{std::move(all.graph), std::move(all.triangulation), {}};
    const auto& constrained = out.triangulation.constrained;
    out.inside =
        inside_rings(out.triangulation, [&](std::int32_t t, int i) { return constrained[t][i]; });
    return out;
}

PlanarMesh triangulate_rings(std::span<const Ring> rings) {
    RingTriangulation region = triangulate_region(rings);
    PlanarMesh mesh;
    mesh.vertices = std::move(region.graph.points);
    for (std::size_t t = 0; t < region.inside.size(); ++t) {
        if (region.inside[t]) mesh.triangles.push_back(region.triangulation.triangles[t]);
    }
    return mesh;
}

}  // namespace realmodel::meshing
