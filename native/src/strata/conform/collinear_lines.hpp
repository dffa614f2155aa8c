// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "strata/conform/conforming.hpp"

namespace realmodel::strata {

/// The lines in use, those that run through the same places taken together as one track. Tracks
/// have the order of their lowest lines.
struct CollinearLines {
    FlatArray<std::int32_t> of_line;   ///< -1 for lines that no face edge is on
    FlatArray<LineId> representative;  ///< the lowest line of each track
};
CollinearLines join_lines(const exact::PlanArrangement& geometry, const FaceList& faces,
                          int threads, const Progress* progress);

}  // namespace realmodel::strata
