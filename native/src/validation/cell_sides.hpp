// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::validation {

/// A face seen from one of its cells: `face * 2 + side`. From the second cell its loop runs the
/// other way.
using Side = std::uint32_t;
inline std::size_t face_of(Side side) {
    return side >> 1;
}
inline bool is_reversed(Side side) {
    return (side & 1) != 0;
}

/// The sides of every cell, ascending.
struct SidesByCell : Buckets<Side> {
    SidesByCell(const ComplexView& model, const Execution& execution);
};

/// The box around a cell.
class CellExtent {
public:
    CellExtent(const ComplexView& model, std::span<const Side> sides);

    /// Whether the cell has no extent along an axis.
    bool is_flat() const;
    /// How far rounding its coordinates may have changed its volume.
    double volume_rounding() const;
    std::array<double, 3> middle() const;

private:
    std::array<double, 3> low_, high_;
};

/// An edge of a cell and how often its faces run along it: from `low` to `high`, and back.
struct EdgeCount {
    std::int32_t low = -1, high = -1;
    std::int64_t ahead = 0, back = 0;
};

/// Cells with more faces than this are looked at one by one, on all threads.
inline constexpr std::size_t kFacesOfLargeCell = 4096;

/// Of the edges of a cell that its faces do not use once each way (of blocks: as often either way),
/// the one with the lowest vertices; or none.
/// @param uses  room for the edges of a small cell, which one thread uses for cell after cell
/// @param execution  for a large cell
std::optional<EdgeCount> open_edge(const ComplexView& model, std::span<const Side> sides,
                                   std::vector<std::uint64_t>& uses, const Execution& execution);

}  // namespace realmodel::validation
