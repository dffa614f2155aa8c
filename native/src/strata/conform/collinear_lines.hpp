// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "strata/conform/plan_vertices.hpp"

namespace realmodel::strata {

/// The supporting lines: lines in use that run through the same points are one. They have the order
/// of their lowest lines.
struct CollinearLines {
    Array<std::int32_t> of_line;   ///< -1 for lines that no face edge is on
    Array<LineId> representative;  ///< the lowest of its lines
};
CollinearLines join_lines(const exact::PlanArrangement& geometry, const FaceList& faces,
                          const Execution& execution);

}  // namespace realmodel::strata
