// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "arrangement/triangulate.hpp"
#include "base/index.hpp"

namespace realmodel::cutting {

using arrangement::CornerTurns;
using arrangement::divide_convex;
using arrangement::Loop;
using arrangement::LoopCorner;
using arrangement::NodeId;
using arrangement::PlanePosition;
using arrangement::Polygons;
using arrangement::Position;
using arrangement::rounding_of;
using arrangement::triangulate;
using arrangement::triangulate_beside;
using arrangement::View;

/// Sides of a cutter: above it or outside of it, on it, below it or inside.
inline constexpr std::int8_t kAbove = 1, kOn = 0, kBelow = -1;

/// An edge as one number, which sorts as its ends do, the lesser first, but faster.
inline std::uint64_t edge_number(NodeId a, NodeId b) {
    const auto [low, high] = unordered(a, b);
    return std::uint64_t{index(low)} << 32 | index(high);
}
inline std::array<NodeId, 2> ends_of_edge(std::uint64_t number) {
    return {static_cast<NodeId>(number >> 32), static_cast<NodeId>(number & UINT32_MAX)};
}

}  // namespace realmodel::cutting
