// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/plan_topology.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/counting_sort.hpp"
#include "base/disjoint_sets.hpp"
#include "base/vectors.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::simulation {

namespace {

constexpr double kOnLine = 1e-6;  ///< of a segment's length: nodes on it are no farther from it

}  // namespace

LineEdges::LineEdges(const PlanLines& lines, const meshing::FlatMesh& mesh)
    : lines_(&lines), is_on_line_(mesh.points.size()) {
    std::map<PlanPoint, std::int32_t> node_at;
    for (const PlanPoint& p : lines.points)
        node_at.emplace(p, -1);
    for (std::size_t n = mesh.points.size(); n-- > 0;) {
        const auto anchor = node_at.find(mesh.points[n]);
        if (anchor != node_at.end()) anchor->second = static_cast<std::int32_t>(n);
    }
    const auto neighbors = bucketize<std::int32_t>(mesh.points.size(), [&](const auto& put) {
        mesh.for_each_edge([&](meshing::HalfEdge edge) {
            put(index(mesh.from(edge)), mesh.to(edge));
            put(index(mesh.from(edge)), mesh.apex(edge));
        });
    });
    for (std::size_t s = 0; s < lines.segments.size(); ++s) {
        const PlanPoint &from = lines.points[index(lines.segments[s].from)],
                        &to = lines.points[index(lines.segments[s].to)];
        const std::int32_t begin = node_at.at(from), end = node_at.at(to);
        if (begin < 0 || end < 0) {
            throw InputError("bad_index", "the planar mesh lacks an end of a line", -1,
                             {static_cast<std::int64_t>(s)},
                             std::array<double, 3>{from[0], from[1], 0});
        }
        const PlanPoint way = minus(to, from);
        const double length = distance(from, to);
        std::int32_t here = begin;
        for (std::size_t steps = 0; here != end && steps < mesh.points.size(); ++steps) {
            // the edge that leads on along the line
            std::int32_t next = -1;
            double nearest = kOnLine * length;
            for (const std::int32_t other : neighbors[index(here)]) {
                const PlanPoint& q = mesh.points[index(other)];
                if (dot(minus(q, mesh.points[index(here)]), way) <= 0) continue;
                const double off = std::abs(cross(minus(q, from), way)) / length;
                if (off >= nearest) continue;
                nearest = off;
                next = other;
            }
            if (next < 0) break;  // a part that the mesher left out
            segments_[unordered(here, next)] = static_cast<std::int32_t>(s);
            is_on_line_[index(here)] = is_on_line_[index(next)] = true;
            here = next;
        }
    }
}

void LineEdges::divide(std::int32_t a, std::int32_t b, std::int32_t middle) {
    assert(a != middle && b != middle && segment(a, middle) < 0 && segment(middle, b) < 0);
    const std::int32_t line = segment(a, b);
    if (line < 0) return;
    is_on_line_.resize(std::max(is_on_line_.size(), index(middle) + 1));
    segments_.erase(unordered(a, b));
    segments_[unordered(a, middle)] = segments_[unordered(middle, b)] = line;
    is_on_line_[index(middle)] = true;
}

Pillars::Pillars(const meshing::FlatMesh& mesh, const LineEdges& edges)
    : of_corner(3 * mesh.corners.size(), -1), is_divided(mesh.points.size(), 0) {
    DisjointSets sets(of_corner.size());
    const auto corner = [](HalfEdge edge) { return 3 * edge.triangle() + edge.index(); };
    mesh.for_each_edge([&](HalfEdge edge) {
        const HalfEdge twin = mesh.twin(edge);
        if (twin.is_none()) return;
        const std::int32_t a = mesh.from(edge), b = mesh.to(edge);
        if (edges.is_step(a, b)) {
            is_divided[index(a)] = is_divided[index(b)] = 1;
        } else {
            sets.join(corner(edge), corner(twin.next()));
            sets.join(corner(edge.next()), corner(twin));
        }
    });
    std::vector<std::uint8_t> has_pillar(mesh.points.size(), 0);
    mesh.for_each_edge([&](HalfEdge edge) {
        const std::int32_t c = corner(edge), first = sets.find(c);
        if (first != c) {
            of_corner[index(c)] = of_corner[index(first)];
            return;
        }
        const std::int32_t n = mesh.from(edge);
        of_corner[index(c)] = static_cast<std::int32_t>(node.size());
        node.push_back(n);
        if (has_pillar[index(n)] != 0) is_divided[index(n)] = 1;
        has_pillar[index(n)] = 1;
    });
}

PlanTopology::PlanTopology(const PlanLines& lines, meshing::PlanarMesh mesh)
    : mesh_(std::move(mesh)) {
    LineEdges edges(lines, mesh_);
    adapt_plan(mesh_, edges);
    segment_.resize(triangles());
    is_step_.resize(triangles());
    for (std::size_t t = 0; t < triangles(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t a = corners(t)[i], b = corners(t)[(i + 1) % 3];
            segment_[t][i] = edges.segment(a, b);
            is_step_[t][i] = edges.is_step(a, b);
        }
    }
    pillars_ = Pillars(mesh_, edges);
    spread_rocks(lines);
    assert(is_valid());
}

Buckets<std::int32_t> PlanTopology::triangles_at_nodes() const {
    return bucketize<std::int32_t>(nodes(), [&](const auto& put) {
        for (std::size_t t = 0; t < triangles(); ++t) {
            for (const std::int32_t n : corners(t))
                put(index(n), static_cast<std::int32_t>(t));
        }
    });
}

/// What columns rely on: triangles are counter-clockwise, and of the edges between divided nodes
/// all are steps, so that a triangle has one at most.
[[maybe_unused]] bool PlanTopology::is_valid() const {
    for (std::size_t t = 0; t < triangles(); ++t) {
        const auto [a, b, c] = corners(t);
        if (exact::orient2d(point(a), point(b), point(c)) <= 0) return false;
        int steps = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            steps += is_inner_step(t, i);
            if (is_divided(corners(t)[i]) && is_divided(corners(t)[(i + 1) % 3]) &&
                !is_inner_step(t, i))
                return false;
        }
        if (steps > 1) return false;
    }
    return true;
}

/// Segments say which rock mass lies on their sides; it reaches as far as the next segments.
void PlanTopology::spread_rocks(const PlanLines& lines) {
    rock_.assign(triangles(), -1);
    std::vector<std::int32_t> waiting;
    for (std::size_t t = 0; t < triangles(); ++t) {
        for (std::size_t i = 0; i < 3 && rock_[t] < 0; ++i) {
            if (segment_[t][i] < 0) continue;
            const PlanSegment& s = lines.segments[index(segment_[t][i])];
            const PlanPoint line = minus(lines.points[index(s.to)], lines.points[index(s.from)]),
                            edge = minus(point(corners(t)[(i + 1) % 3]), point(corners(t)[i]));
            rock_[t] = dot(line, edge) > 0 ? s.left_rock : s.right_rock;
        }
        if (rock_[t] >= 0) waiting.push_back(static_cast<std::int32_t>(t));
    }
    while (!waiting.empty()) {
        const auto t = index(waiting.back());
        waiting.pop_back();
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t n = neighbor(t, i);
            if (n < 0 || segment_[t][i] >= 0 || rock_[index(n)] >= 0) continue;
            rock_[index(n)] = rock_[t];
            waiting.push_back(n);
        }
    }
}

}  // namespace realmodel::simulation
