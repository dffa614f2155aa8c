// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::simulation {

using meshing::PlanPoint;

/// Where in plan blocks end or step: the edges of the tops and bottoms of blocks that no other face
/// of the same top or bottom continues.
struct Traces {
    /// The top of the model ends or steps here; what else does stands beside it.
    static constexpr std::int32_t kOfTop = -2;
    struct TraceSegment {
        std::array<std::int32_t, 2> ends;  ///< points
        std::int32_t block;  ///< that ends here without thickness, -1: a step or wall; or kOfTop
        auto operator<=>(const TraceSegment&) const = default;
    };
    std::vector<PlanPoint> points;       ///< distinct, sorted
    std::vector<TraceSegment> segments;  ///< sorted, each once
};

Traces traces_of(const ComplexView& model, Progress* progress);

/// Points on the traces, apart by `spacing` there (along steps and walls by 0.7 of it at least), so
/// that every position on the traces has one as near. Corners of steps and walls come first, then
/// points spread evenly along these, so close that no other line can draw them aside; then the ends
/// of other lines, and points between them.
std::vector<PlanPoint> line_anchors(const Traces& traces,
                                    const std::function<double(const PlanPoint&)>& spacing,
                                    Progress* progress);

/// Edges between points, and which of them each point has.
struct EdgeGraph {
    std::vector<std::array<std::int32_t, 2>> edges;
    Buckets<std::int32_t> at;

    EdgeGraph(std::size_t points, std::vector<std::array<std::int32_t, 2>> of);
    std::int32_t other(std::int32_t edge, std::int32_t point) const {
        const auto& [from, to] = edges[index(edge)];
        return from == point ? to : from;
    }
    /// The points of all runs of edges from end to end, then of those that are closed.
    std::vector<std::vector<std::int32_t>> chains(std::span<const std::uint8_t> is_end) const;
};

}  // namespace realmodel::simulation
