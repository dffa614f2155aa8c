// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/region_check.hpp"

#include <algorithm>
#include <string>

#include "meshing/plan_predicates.hpp"
#include "meshing/ring_graph.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::meshing {

namespace {

constexpr std::int32_t kNone = -1;

/// Finds the rings that run along an edge of the triangulation.
class RingsOfEdges {
public:
    RingsOfEdges(const RingGraph& graph, std::span<const RegionRing> rings,
                 std::vector<CoveredEdge> edges)
        : graph_(graph), edges_(std::move(edges)) {
        for (std::size_t i = 1; i < edges_.size(); ++i) {
            const CoveredEdge &a = edges_[i - 1], &b = edges_[i];
            if (a.from != b.from || a.to != b.to) continue;
            shared_ = true;
            if (rings[ring_of(a)].polygon != rings[ring_of(b)].polygon) continue;
            if (same_ == kNone || b.segment < edges_[same_].segment)
                same_ = static_cast<std::int32_t>(i);
        }
    }

    /// Whether polygons share borders.
    bool shared() const { return shared_; }

    /// Refuses rings of one polygon that share a stretch, the first such one.
    void require_apart() const {
        if (same_ != kNone) refuse_overlap(graph_, edges_[same_ - 1], edges_[same_]);
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
    std::vector<CoveredEdge> edges_;
    bool shared_ = false;
    std::int32_t same_ = kNone;
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
        bool found = false;
        std::size_t steps = 0;
        for (std::int32_t around = nesting.parents[r]; around != kNone && steps <= rings.size();
             around = nesting.parents[around], ++steps) {
            found = found || (rings[around].polygon == rings[r].polygon && !rings[around].hole);
        }
        if (found) continue;
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
    std::vector<Ring> given;
    given.reserve(rings.size());
    for (const RegionRing& ring : rings)
        given.push_back(ring.corners);
    const ConstrainedRings all = constrained_rings(given, progress);
    const ConstrainedTriangulation& mesh = all.triangulation;
    const RingsOfEdges edges(all.graph, rings, all.edges);
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
    if (!edges.shared()) return given;
    return border_rings(all.graph, mesh, inside);
}

}  // namespace realmodel::meshing
