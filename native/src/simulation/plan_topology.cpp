// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/plan_topology.hpp"

#include <cassert>

#include "base/vectors.hpp"
#include "exact/orient2d.hpp"
#include "simulation/plan_adaption.hpp"

namespace realmodel::simulation {

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
    posts_ = Posts(mesh_, edges);
    spread_rocks(lines);
    assert(is_valid());
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
