// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace realmodel::simulation {

/// Of each corner of a triangle: a height of its node.
using Front = std::array<std::int32_t, 3>;

/// The elements over all triangles of a planar mesh: each lies between two fronts, one after the
/// other.
struct ColumnFronts {
    std::vector<std::size_t> offset{0};  ///< of the first front of each triangle, and the end
    std::vector<Front> fronts;           ///< upward; none where nothing stands
    std::vector<std::int32_t> blocks;    ///< of what lies above each; -1 above the last

    /// How many elements stand on a triangle. Element e has the number offset[t] + e, and so has
    /// the front below it.
    std::size_t elements(std::size_t t) const {
        const std::size_t own = offset[t + 1] - offset[t];
        return own == 0 ? 0 : own - 1;
    }
};

}  // namespace realmodel::simulation
