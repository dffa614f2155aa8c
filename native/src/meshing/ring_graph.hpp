// SPDX-License-Identifier: GPL-3.0-or-later
// Rings as a graph, and the refusal of two of its edges. Private.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "realmodel/meshing/rings.hpp"

namespace realmodel::meshing {

/// Rings as points and segments. Throws InputError "no_outline", "not_finite" and
/// "outline_degenerate" as triangulate_region does.
RingGraph ring_graph(std::span<const Ring> rings);

/// Refuses two edges of the graph, given by their segments.
[[noreturn]] void refuse_edges(const RingGraph& graph, std::int64_t first, std::int64_t second,
                               const std::string& kind, const std::string& verb,
                               const PlanPoint& place);

}  // namespace realmodel::meshing
