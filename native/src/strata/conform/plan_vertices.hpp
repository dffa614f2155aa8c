// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "realmodel/base/array.hpp"
#include "realmodel/base/execution.hpp"
#include "strata/overlay/envelope.hpp"

namespace realmodel::strata {

/// Index of a plan vertex: one position in plan, however many points are named there.
using PlanVertexId = std::int32_t;

using PlanPosition = std::array<double, 2>;

/// A point that a line must pass, though no edge ends there: where heights of the columns on its
/// two sides cross.
struct ExtraPoint {
    LineId line;
    PointId point;
};

/// The points in use, those in the same position taken together, in order of rounded x, then y.
struct PlanVertices {
    Array<PlanVertexId> of_point;      ///< -1 for points that no face uses
    Array<PointId> representative;     ///< an input vertex where one is there
    Array<PlanPosition> position;      ///< rounded; empty until set_plan_positions
    Array<std::uint64_t> same_x_bits;  ///< of 64 plan vertices each: see has_same_x_next
    std::vector<PlanVertexId>
        coincident;  ///< those that round to the position of the plan vertex before them

    std::size_t size() const { return representative.size(); }
    /// Whether the next plan vertex rounds to the same x.
    bool has_same_x_next(PlanVertexId plan_vertex) const {
        const auto p = static_cast<std::size_t>(plan_vertex);
        return (same_x_bits[p / 64] >> (p % 64) & 1) != 0;
    }
};
PlanVertices find_plan_vertices(const exact::PlanArrangement& geometry, const FaceList& faces,
                                const std::vector<ExtraPoint>& extra, const Execution& execution);

/// Puts the positions in one array, for when the points will be forgotten.
void set_plan_positions(const exact::PlanArrangement& geometry, PlanVertices& plan_vertices,
                        const Execution& execution);

/// The supporting lines: lines in use that run through the same points are one. They have the order
/// of their lowest lines.
struct CollinearLines {
    Array<std::int32_t> of_line;   ///< -1 for lines that no face edge is on
    Array<LineId> representative;  ///< the lowest of its lines
};
/// @param left_out  if given: of each line, 1 where its edges are looked at elsewhere
CollinearLines join_lines(const exact::PlanArrangement& geometry, const FaceList& faces,
                          const Execution& execution,
                          const std::vector<std::uint8_t>* left_out = nullptr);

}  // namespace realmodel::strata
