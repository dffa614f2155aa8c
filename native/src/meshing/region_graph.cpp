// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/region_graph.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/index.hpp"
#include "base/vectors.hpp"
#include "meshing/constrained_delaunay.hpp"
#include "meshing/edge_cutting.hpp"
#include "meshing/plan_predicates.hpp"
#include "meshing/winding.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/meshing/rings.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::meshing {

namespace {

/// Takes a triangulation over: the region's area, and the edges between inside and outside.
void take_region(RegionGraph& graph, ConstrainedTriangulation&& mesh, std::vector<bool>&& inside) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!inside[t]) continue;
        const auto& corners = mesh.triangles[t];
        graph.area += 0.5 * twice_area(graph.points[corners[0]], graph.points[corners[1]],
                                       graph.points[corners[2]]);
        for (int i = 0; i < 3; ++i) {
            const std::int32_t across = mesh.neighbors[t][i];
            if (across >= 0 && inside[across]) continue;
            graph.border.push_back({corners[i], corners[(i + 1) % 3]});
            graph.border_at.emplace_back(static_cast<std::int32_t>(t), i);
        }
    }
    graph.triangulation = std::move(mesh);
    graph.inside = std::move(inside);
}

void require_finite(const PlanPoint& p, std::int64_t line, std::size_t corner) {
    if (std::isfinite(p[0]) && std::isfinite(p[1])) return;
    const std::string what =
        line < 0 ? "the constraint points" : "constraint " + std::to_string(line);
    throw InputError("constraint_not_finite",
                     "point " + std::to_string(corner) + " of " + what + " is not a finite number",
                     -1, {line, static_cast<std::int64_t>(corner)});
}

spatial::Box::Position in_space(const PlanPoint& p) {
    return {p[0], p[1], 0};
}

/// For each segment the places at which it is to be cut, in order from its start: where it and
/// another cross (rounded, the same for both), and where another ends on it. Pairs of the first
/// `settled` segments are known to cross nowhere. Decisions are exact.
std::vector<std::vector<PlanPoint>> crossings(std::span<const PlanPoint> points,
                                              std::span<const VertexSegment> segments,
                                              std::size_t settled, const Check& check) {
    std::vector<spatial::Box> boxes(segments.size());
    for (std::size_t s = 0; s < segments.size(); ++s) {
        for (const std::int32_t end : segments[s])
            boxes[s].include(in_space(points[end]));
    }
    std::vector<std::vector<PlanPoint>> cuts(segments.size());
    const auto meet = [&](std::int32_t s, std::int32_t t) {
        const PlanPoint &a = points[segments[s][0]], &b = points[segments[s][1]],
                        &c = points[segments[t][0]], &d = points[segments[t][1]];
        const int ac = orient2d(a, b, c), ad = orient2d(a, b, d), ca = orient2d(c, d, a),
                  cb = orient2d(c, d, b);
        if (ac * ad < 0 && ca * cb < 0) {
            // From the same two names in the same order, so that both get the same place.
            PlanPoint p = crossing_place(a, b, c, d);
            for (const spatial::Box& box : {boxes[s], boxes[t]}) {
                for (int k = 0; k < 2; ++k)
                    p[k] = std::clamp(p[k], box.low[k], box.high[k]);
            }
            cuts[s].push_back(p);
            cuts[t].push_back(p);
            return;
        }
        if (ac == 0 && boxes[s].contains(in_space(c))) cuts[s].push_back(c);
        if (ad == 0 && boxes[s].contains(in_space(d))) cuts[s].push_back(d);
        if (ca == 0 && boxes[t].contains(in_space(a))) cuts[t].push_back(a);
        if (cb == 0 && boxes[t].contains(in_space(b))) cuts[t].push_back(b);
    };

    const spatial::BoxTree tree(boxes);
    for (std::size_t t = settled; t < segments.size(); ++t) {
        if (t % 64 == 0) check(0);
        tree.find(boxes[t], [&](std::int32_t s) {
            const auto number = static_cast<std::int32_t>(t);
            if (s < number) meet(s, number);
        });
    }
    for (std::size_t s = 0; s < segments.size(); ++s) {
        const PlanPoint &a = points[segments[s][0]], &b = points[segments[s][1]];
        const auto along = [&](const PlanPoint& p) { return dot(minus(p, a), minus(b, a)); };
        std::ranges::sort(cuts[s], {}, [&](const PlanPoint& p) { return std::pair(along(p), p); });
        cuts[s].erase(std::unique(cuts[s].begin(), cuts[s].end()), cuts[s].end());
    }
    return cuts;
}

/// Rings and constraints as one graph.
class ConstrainedGraph {
public:
    ConstrainedGraph(RingGraph&& rings, const Constraints& constraints, const Check& check)
        : constraints_(constraints), check_(check), ring_edges_(std::move(rings.segments)) {
        graph_.points = std::move(rings.points);
    }

    RegionGraph run() {
        add_constraints();
        cut_at_crossings();
        take_triangulation();
        require_points_inside();
        return std::move(graph_);
    }

private:
    std::int32_t add_point(const PlanPoint& p) {
        graph_.points.push_back(p);
        return static_cast<std::int32_t>(graph_.points.size()) - 1;
    }

    void add_constraints() {
        for (std::size_t l = 0; l < constraints_.lines.size(); ++l) {
            const auto& line = constraints_.lines[l];
            for (std::size_t i = 0; i < line.size(); ++i) {
                require_finite(line[i], static_cast<std::int64_t>(l), i);
                const std::int32_t end = add_point(line[i]);
                if (i > 0 && line[i] != line[i - 1]) inner_edges_.push_back({end - 1, end});
            }
        }
        first_point_ = static_cast<std::int32_t>(graph_.points.size());
        for (std::size_t i = 0; i < constraints_.points.size(); ++i) {
            require_finite(constraints_.points[i], -1, i);
            add_point(constraints_.points[i]);
        }
    }

    /// Cuts everything where constraints meet something. Crossings are rounded, which bends what
    /// they cut, and that may cross something else: then all is cut once more. Rings are cut only
    /// where there is room for it. What of constraints still crosses something after some rounds
    /// cannot be told from its crossings in doubles, and is left out.
    void cut_at_crossings() {
        constexpr int kMostRounds = 8;
        EdgeCutting rings = triangulated_rings();
        for (int round = 1; round <= kMostRounds; ++round) {
            cut_once(rings);
            cdt_.clear();
            vertices_ = insert_points(cdt_, graph_.points, check_, Repeated::kJoin);
            insert_segments(cdt_, vertices_, ring_edges_, check_);
            std::vector<std::size_t> refused;
            insert_segments(cdt_, vertices_, inner_edges_, check_, &refused);
            if (refused.empty()) return;
            if (round < kMostRounds) continue;
            for (auto edge = refused.rbegin(); edge != refused.rend(); ++edge)
                inner_edges_.erase(inner_edges_.begin() + static_cast<std::ptrdiff_t>(*edge));
        }
    }

    /// The rings among all points, cut where points are on them.
    EdgeCutting triangulated_rings() {
        Cdt cdt;
        const auto vertices = insert_points(cdt, graph_.points, check_, Repeated::kJoin);
        insert_segments(cdt, vertices, ring_edges_, check_);
        std::vector<CoveredEdge> covered = covered_edges(cdt, vertices, ring_edges_);
        std::ranges::stable_sort(covered, {}, &CoveredEdge::segment);
        const std::vector<VertexSegment> whole = std::move(ring_edges_);
        ring_edges_.clear();
        for (const auto& [from, to, segment] : covered) {
            const bool is_reversed = whole[segment][0] == to || whole[segment][1] == from;
            ring_edges_.push_back(is_reversed ? VertexSegment{to, from} : VertexSegment{from, to});
        }
        const ConstrainedTriangulation mesh = numbered_triangles(cdt);
        return {mesh, std::vector<bool>(mesh.triangles.size()), graph_.points};
    }

    void cut_once(EdgeCutting& rings) {
        std::vector<VertexSegment> segments = ring_edges_;
        segments.insert(segments.end(), inner_edges_.begin(), inner_edges_.end());
        const std::size_t ring_count = ring_edges_.size();
        std::vector<std::vector<PlanPoint>> cuts =
            crossings(graph_.points, segments, ring_count, check_);
        const auto moved = cut_rings(rings, std::span(cuts).first(ring_count));
        inner_edges_.clear();
        for (std::size_t s = ring_count; s < segments.size(); ++s) {
            std::int32_t last = segments[s][0];
            const auto step = [&](std::int32_t next) {
                if (graph_.points[next] != graph_.points[last])
                    inner_edges_.push_back({last, next});
                last = next;
            };
            for (const PlanPoint& p : cuts[s]) {
                const auto at = std::lower_bound(moved.begin(), moved.end(), Moved{p, p});
                step(add_point(at != moved.end() && (*at)[0] == p ? (*at)[1] : p));
            }
            step(segments[s][1]);
        }
    }

    /// A point wanted on a ring and the one that there is room for.
    using Moved = std::array<PlanPoint, 2>;

    /// Cuts the rings' edges as far as there is room; returns the points that moved, sorted.
    std::vector<Moved> cut_rings(EdgeCutting& rings, std::span<const std::vector<PlanPoint>> cuts) {
        std::vector<CutEdge> edges;
        for (std::size_t s = 0; s < cuts.size(); ++s) {
            const VertexSegment edge = ring_edges_[s];
            const auto first = static_cast<std::int32_t>(graph_.points.size());
            for (const PlanPoint& p : cuts[s])
                if (p != graph_.points[edge[0]] && p != graph_.points[edge[1]]) add_point(p);
            edges.push_back({edge, first, static_cast<std::int32_t>(graph_.points.size())});
        }
        rings.add_points(graph_.points);
        rings.cut(edges, check_);
        std::vector<Moved> moved;
        ring_edges_.clear();
        for (const auto& [edge, first, last] : edges) {
            std::int32_t begin = edge[0];
            for (std::int32_t i = first; i < last; ++i) {
                if (!rings.has(i)) continue;
                const PlanPoint& p = rings.mesh().points[i];
                if (p != graph_.points[i]) moved.push_back({graph_.points[i], p});
                graph_.points[i] = p;
                ring_edges_.push_back({begin, i});
                begin = i;
            }
            ring_edges_.push_back({begin, edge[1]});
        }
        std::sort(moved.begin(), moved.end());
        return moved;
    }

    /// The edges of the triangulation that segments run along, by the lesser end first; sorted.
    std::vector<VertexSegment> edges_along(std::span<const VertexSegment> segments) const {
        std::vector<VertexSegment> edges;
        for (const CoveredEdge& edge : covered_edges(cdt_, vertices_, segments))
            edges.push_back({edge.from, edge.to});
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        return edges;
    }

    void take_triangulation() {
        ConstrainedTriangulation mesh = numbered_triangles(cdt_);
        const auto is_along = [&](const std::vector<VertexSegment>& edges, std::size_t t, int i) {
            const auto& corners = mesh.triangles[t];
            return mesh.constrained[t][i] &&
                   std::ranges::binary_search(edges, unordered(corners[i], corners[(i + 1) % 3]));
        };
        const std::vector<VertexSegment> ring_edges = edges_along(ring_edges_),
                                         inner_edges = edges_along(inner_edges_);
        std::vector<bool> inside =
            inside_rings(mesh, [&](std::int32_t t, int i) { return is_along(ring_edges, t, i); });
        std::vector<bool> is_ended(graph_.points.size(), false);
        is_within_.assign(graph_.points.size(), false);
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            if (!inside[t]) continue;
            for (int i = 0; i < 3; ++i) {
                const std::int32_t a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
                is_within_[a] = true;
                const std::int32_t other = mesh.neighbors[t][i];
                if (a > b || other < 0 || !inside[other] || !is_along(inner_edges, t, i)) continue;
                graph_.inner.push_back({a, b});
                graph_.inner_at.emplace_back(static_cast<std::int32_t>(t), i);
                is_ended[a] = is_ended[b] = true;
            }
        }
        take_region(graph_, std::move(mesh), std::move(inside));
        for (const auto& [from, to] : graph_.border)
            is_ended[from] = is_ended[to] = true;
        for (std::size_t i = 0; i < graph_.points.size(); ++i)
            if (is_within_[i] && !is_ended[i])
                graph_.loners.push_back(static_cast<std::int32_t>(i));
    }

    void require_points_inside() const {
        for (std::size_t i = 0; i < constraints_.points.size(); ++i) {
            const std::size_t number = static_cast<std::size_t>(first_point_) + i;
            if (is_within_[vertices_[number]->number]) continue;
            const PlanPoint& p = constraints_.points[i];
            const auto item = static_cast<std::int64_t>(i);
            throw InputError("constraint_outside",
                             "constraint point " + std::to_string(i) + " at " + text_of(p) +
                                 " lies outside the region; leave it out",
                             -1, {item}, std::array{p[0], p[1], 0.0});
        }
    }

    const Constraints& constraints_;
    const Check& check_;
    RegionGraph graph_;
    std::vector<VertexSegment> ring_edges_, inner_edges_;  ///< cut wherever they are known to meet
    std::int32_t first_point_ = 0;                         ///< of the constraints' points
    std::vector<bool> is_within_;                          ///< of each point: the region
    Cdt cdt_;
    std::vector<Cdt::Vertex_handle> vertices_;
};

}  // namespace

RegionGraph region_graph(std::span<const Ring> rings, const Constraints& constraints,
                         Progress* progress) {
    const Check check = stopped_by(progress);
    RingTriangulation region = triangulate_region(rings, progress);
    if (!constraints.lines.empty() || !constraints.points.empty())
        return ConstrainedGraph(std::move(region.graph), constraints, check).run();
    RegionGraph graph;
    graph.points = std::move(region.graph.points);
    take_region(graph, std::move(region.triangulation), std::move(region.inside));
    return graph;
}

}  // namespace realmodel::meshing
