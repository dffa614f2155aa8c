// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/line_edges.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/counting_sort.hpp"
#include "base/vectors.hpp"
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
        const auto found = node_at.find(mesh.points[n]);
        if (found != node_at.end()) found->second = static_cast<std::int32_t>(n);
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
    const std::int32_t own = segment(a, b);
    if (own < 0) return;
    is_on_line_.resize(std::max(is_on_line_.size(), index(middle) + 1));
    segments_.erase(unordered(a, b));
    segments_[unordered(a, middle)] = segments_[unordered(middle, b)] = own;
    is_on_line_[index(middle)] = true;
}

}  // namespace realmodel::simulation
