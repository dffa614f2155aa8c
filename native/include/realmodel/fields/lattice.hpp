// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

namespace realmodel::fields {

/// Nodes (i, j, k) at origin + spacing * (i, j, k); node (i, j, k) has the number i + nx (j + ny
/// k). Each cell is divided into six tetrahedra that share its diagonal from its lowest corner to
/// its highest (Freudenthal 1942; Kuhn 1960).
struct Lattice {
    std::array<double, 3> origin;
    std::array<double, 3> spacing;
    std::array<int, 3> counts;  ///< nodes along each axis, two at least

    std::size_t nodes() const {
        return static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1]) *
               static_cast<std::size_t>(counts[2]);
    }
    std::array<double, 3> position(int i, int j, int k) const {
        return {origin[0] + spacing[0] * i, origin[1] + spacing[1] * j, origin[2] + spacing[2] * k};
    }
    bool contains(const std::array<double, 3>& point) const {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double share = (point[axis] - origin[axis]) / spacing[axis];
            if (!(share >= 0 && share <= counts[axis] - 1)) return false;
        }
        return true;
    }
};

}  // namespace realmodel::fields
