// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/rings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "meshing/plan_predicates.hpp"
#include "meshing/winding.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/meshing/region_check.hpp"

namespace realmodel::meshing {

namespace {

/// A corner of a ring and its number in the input.
struct RingCorner {
    PlanPoint place;
    std::int64_t number;
};

std::vector<RingCorner> distinct_corners(const Ring& ring, std::int64_t ring_number) {
    std::vector<RingCorner> corners;
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
void require_area(const std::vector<RingCorner>& corners, std::int64_t ring_number) {
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
    const bool in_line = std::all_of(corners.begin() + 2, corners.end(), [&](const RingCorner& c) {
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

std::array<std::int32_t, 2> ends_of(const CoveredEdge& edge) {
    return {edge.from, edge.to};
}

/// Calls visit(one, next) for segments that run along the same edge.
template <class Visit>
void for_overlaps(const std::vector<CoveredEdge>& edges, const Visit& visit) {
    for (const auto along : groups_of(edges, ends_of)) {
        for (std::size_t i = 1; i < along.size(); ++i)
            visit(along[i - 1], along[i]);
    }
}

/// Two segments along one edge; null: there are none.
using Overlap = std::array<const CoveredEdge*, 2>;

void keep_first(Overlap& overlap, const CoveredEdge& a, const CoveredEdge& b) {
    if (overlap[1] == nullptr || b.segment < overlap[1]->segment) overlap = {&a, &b};
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

/// Refuses two segments that run along one edge.
[[noreturn]] void refuse_overlap(const RingGraph& graph, const CoveredEdge& first,
                                 const CoveredEdge& second) {
    refuse_edges(graph, first.segment, second.segment, "outline_overlaps", "runs along",
                 middle(graph.points[first.from], graph.points[first.to]));
}

void refuse_overlaps(const RingGraph& graph, const std::vector<CoveredEdge>& edges) {
    Overlap first{};
    for_overlaps(edges,
                 [&](const CoveredEdge& a, const CoveredEdge& b) { keep_first(first, a, b); });
    if (first[1] != nullptr) refuse_overlap(graph, *first[0], *first[1]);
}

/// Rings as points and segments.
RingGraph ring_graph(std::span<const Ring> rings) {
    if (rings.empty()) throw InputError("no_outline", "the region has no outline");
    RingGraph graph;
    std::vector<PlanPoint> corners;
    std::vector<std::array<std::size_t, 2>> corner_range;
    for (std::size_t r = 0; r < rings.size(); ++r) {
        const auto ring_number = static_cast<std::int64_t>(r);
        const std::vector<RingCorner> ring = distinct_corners(rings[r], ring_number);
        require_area(ring, ring_number);
        corner_range.push_back({corners.size(), corners.size() + ring.size()});
        for (const RingCorner& corner : ring) {
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

/// Rings in a constrained Delaunay triangulation of their corners, of which it is not yet known
/// which are inside. They do not cross; some may share edges.
/// @throws InputError "no_outline", "not_finite", "outline_degenerate" and "outline_crosses" as
/// triangulate_region does; Cancelled.
RingTriangulation constrained_rings(std::span<const Ring> rings, Progress* progress) {
    RingTriangulation out{ring_graph(rings), {}, {}};
    const RingGraph& graph = out.graph;
    try {
        out.triangulation = constrained_delaunay(graph.points, graph.segments, progress);
    } catch (const InputError& error) {
        if (error.kind != "crossing") throw;
        refuse_edges(graph, error.items[0], error.items[1], "outline_crosses", "crosses",
                     {(*error.place)[0], (*error.place)[1]});
    }
    return out;
}

}  // namespace

std::vector<std::int32_t> winding_numbers(const ConstrainedTriangulation& mesh,
                                          std::span<const PlanPoint> points,
                                          std::span<const std::array<std::int32_t, 2>> segments,
                                          std::span<const std::int32_t> weights) {
    using Ends = std::array<std::int32_t, 2>;
    // of edges: how much more often the left than the right is wound around, seen from the first
    // end
    std::vector<std::pair<Ends, std::int32_t>> rises;
    for (const auto along : groups_of(mesh.covered, ends_of)) {
        std::int32_t rise = 0;
        for (const auto& [from, to, segment] : along) {
            const auto [start, end] = segments[segment];
            // points of a line are in the order of their coordinates, or against it
            const bool is_ahead = (points[start] < points[end]) == (points[from] < points[to]);
            rise += is_ahead ? weights[segment] : -weights[segment];
        }
        rises.emplace_back(ends_of(along[0]), rise);
    }
    return spread_inward<std::int32_t>(mesh, 0, [&](std::int32_t t, int i, std::int32_t before) {
        if (!mesh.constrained[t][i]) return before;
        const std::int32_t from = mesh.triangles[t][i], to = mesh.triangles[t][(i + 1) % 3];
        const auto edge = std::ranges::lower_bound(rises, unordered(from, to), {},
                                                   &std::pair<Ends, std::int32_t>::first);
        return from < to ? before - edge->second : before + edge->second;
    });
}

RingTriangulation triangulate_region(std::span<const Ring> rings, Progress* progress) {
    RingTriangulation out = constrained_rings(rings, progress);
    refuse_overlaps(out.graph, out.triangulation.covered);
    const auto& constrained = out.triangulation.constrained;
    out.inside =
        inside_rings(out.triangulation, [&](std::int32_t t, int i) { return constrained[t][i]; });
    return out;
}

PlanarMesh triangulate_rings(std::span<const Ring> rings, Progress* progress) {
    RingTriangulation region = triangulate_region(rings, progress);
    PlanarMesh mesh;
    mesh.vertices = std::move(region.graph.points);
    for (std::size_t t = 0; t < region.inside.size(); ++t) {
        if (region.inside[t]) mesh.triangles.push_back(region.triangulation.triangles[t]);
    }
    return mesh;
}

namespace {

constexpr std::int32_t kNone = -1;

/// Finds the rings that run along an edge of the triangulation.
class RingsOfEdges {
public:
    RingsOfEdges(const RingGraph& graph, std::span<const RegionRing> rings,
                 const std::vector<CoveredEdge>& edges)
        : graph_(graph), edges_(edges) {
        for_overlaps(edges_, [&](const CoveredEdge& a, const CoveredEdge& b) {
            shared_ = true;
            if (rings[ring_of(a)].polygon == rings[ring_of(b)].polygon) keep_first(same_, a, b);
        });
    }

    /// Whether polygons share borders.
    bool shared() const { return shared_; }

    /// Refuses rings of one polygon that share a stretch, the first such one.
    void require_apart() const {
        if (same_[1] != nullptr) refuse_overlap(graph_, *same_[0], *same_[1]);
    }

    /// The rings along the edge between two points.
    std::vector<std::int32_t> along(std::int32_t a, std::int32_t b) const {
        const CoveredEdge wanted{std::min(a, b), std::max(a, b), kNone};
        std::vector<std::int32_t> rings;
        for (auto at = std::lower_bound(edges_.begin(), edges_.end(), wanted);
             at != edges_.end() && at->from == wanted.from && at->to == wanted.to; ++at) {
            rings.push_back(ring_of(*at));
        }
        return rings;
    }

private:
    std::int32_t ring_of(const CoveredEdge& edge) const {
        return static_cast<std::int32_t>(graph_.origin[edge.segment][0]);
    }

    const RingGraph& graph_;
    const std::vector<CoveredEdge>& edges_;
    bool shared_ = false;
    Overlap same_{};  ///< of one polygon
};

/// How rings lie in each other, found by walking over the triangles from the outside: of each ring
/// the innermost other one around it, or kNone.
class Nesting {
public:
    Nesting(const ConstrainedTriangulation& mesh, const RingsOfEdges& rings, std::size_t ring_count)
        : parents(ring_count, kNone), rings_(rings), met_(ring_count, false) {
        spread_inward(mesh, kNone, [&](std::int32_t from, int i, std::int32_t around) {
            const auto& corners = mesh.triangles[from];
            return mesh.constrained[from][i] ? cross(corners[i], corners[(i + 1) % 3], around)
                                             : around;
        });
    }

    std::vector<std::int32_t> parents;

private:
    /// The innermost ring around a place, after an edge is crossed along which rings run.
    std::int32_t cross(std::int32_t a, std::int32_t b, std::int32_t innermost) {
        std::vector<std::int32_t> along = rings_.along(a, b);
        for (bool more = true; more;) {  // leave the innermost first, in whatever order they are
            more = false;
            for (std::int32_t& ring : along) {
                if (ring == kNone || ring != innermost) continue;
                innermost = parents[ring];
                ring = kNone;
                more = true;
            }
        }
        for (const std::int32_t ring : along) {
            if (ring == kNone) continue;
            if (!met_[ring]) parents[ring] = innermost;
            met_[ring] = true;
            innermost = ring;
        }
        return innermost;
    }

    const RingsOfEdges& rings_;
    std::vector<bool> met_;
};

/// Refuses the first hole that does not lie inside the outline of its polygon.
void require_holes_inside(std::span<const RegionRing> rings, const Nesting& nesting) {
    for (std::size_t r = 0; r < rings.size(); ++r) {
        if (!rings[r].hole) continue;
        bool inside = false;
        std::size_t steps = 0;
        for (std::int32_t around = nesting.parents[r]; around != kNone && steps <= rings.size();
             around = nesting.parents[around], ++steps) {
            inside = inside || (rings[around].polygon == rings[r].polygon && !rings[around].hole);
        }
        if (inside) continue;
        const PlanPoint& place = rings[r].corners.front();
        throw InputError("hole_outside",
                         "outline " + std::to_string(r) +
                             ", a hole, does not lie inside its outline, at " + text_of(place),
                         -1, {static_cast<std::int64_t>(r), 0},
                         std::array{place[0], place[1], 0.0});
    }
}

/// The border of what is inside as rings, each simple, with the inside on the left.
std::vector<Ring> border_rings(const RingGraph& graph, const ConstrainedTriangulation& mesh,
                               const std::vector<bool>& inside) {
    const auto is_border = [&](std::int32_t t, int i) {
        const std::int32_t across = mesh.neighbors[t][i];
        return across < 0 || !inside[across];
    };
    std::vector<std::array<bool, 3>> taken(mesh.triangles.size());
    std::vector<Ring> rings;
    for (std::size_t first = 0; first < mesh.triangles.size(); ++first) {
        if (!inside[first]) continue;
        for (int edge = 0; edge < 3; ++edge) {
            auto t = static_cast<std::int32_t>(first);
            int i = edge;
            if (taken[t][i] || !is_border(t, i)) continue;
            Ring& ring = rings.emplace_back();
            while (!taken[t][i]) {
                taken[t][i] = true;
                ring.push_back(graph.points[mesh.triangles[t][i]]);
                // Around the end of the edge, over triangles inside, to the next edge of the
                // border.
                const std::int32_t pivot = mesh.triangles[t][(i + 1) % 3];
                i = (i + 1) % 3;
                while (!is_border(t, i)) {
                    t = mesh.neighbors[t][i];
                    i = 0;
                    while (mesh.triangles[t][i] != pivot)
                        ++i;
                }
            }
        }
    }
    return rings;
}

}  // namespace

std::vector<Ring> checked_region(std::span<const RegionRing> rings, Progress* progress) {
    std::vector<Ring> loops;
    loops.reserve(rings.size());
    for (const RegionRing& ring : rings)
        loops.push_back(ring.corners);
    const RingTriangulation all = constrained_rings(loops, progress);
    const ConstrainedTriangulation& mesh = all.triangulation;
    const RingsOfEdges edges(all.graph, rings, mesh.covered);
    edges.require_apart();
    require_holes_inside(rings, Nesting(mesh, edges, rings.size()));
    const std::vector<bool> inside = inside_rings(mesh, [&](std::int32_t t, int i) {
        const auto& corners = mesh.triangles[t];
        return mesh.constrained[t][i] &&
               edges.along(corners[i], corners[(i + 1) % 3]).size() % 2 != 0;
    });
    if (std::none_of(inside.begin(), inside.end(), [](bool in) { return in; })) {
        throw InputError("no_area", "the polygons cover each other: nothing is left of the region");
    }
    if (!edges.shared()) return loops;
    return border_rings(all.graph, mesh, inside);
}

}  // namespace realmodel::meshing
