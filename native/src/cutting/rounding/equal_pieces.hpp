// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "cutting/rounding/rounded_parts.hpp"

namespace realmodel::cutting {

/// Which way round a loop goes from its least node to the lesser of the two beside that: 1 or -1.
int winding_of(std::span<const NodeId> loop);

/// The nodes of a loop from its least one on, toward the lesser of the two beside that: the same
/// for loops that pass the same edges.
void put_first(std::span<const NodeId> loop, std::vector<NodeId>& nodes);

/// Pieces near the cutter that pass the same edges: groups of two or more.
std::vector<std::vector<std::size_t>> equal_pieces(const RoundedParts& parts);

}  // namespace realmodel::cutting
