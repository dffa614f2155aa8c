// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include "spatial/box_tree.hpp"

namespace realmodel::spatial {

/// Whether a part of a triangle is in a box, but for rounding: what its six planes leave of the
/// triangle (I. Sutherland, G. Hodgman, "Reentrant polygon clipping", 1974).
inline bool passes(const Box& box, const std::array<std::array<double, 3>, 3>& triangle) {
    using Corner = std::array<double, 3>;
    constexpr std::size_t kMost = 9;  // each plane adds one corner at most
    std::array<Corner, kMost> left{triangle[0], triangle[1], triangle[2]}, kept;
    std::size_t count = 3;
    for (std::size_t plane = 0; plane < 6 && count > 0; ++plane) {
        const std::size_t k = plane / 2;
        const auto inward = [&](const Corner& p) {
            return plane % 2 == 0 ? p[k] - box.low[k] : box.high[k] - p[k];
        };
        std::size_t next = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const Corner &a = left[i], &b = left[i + 1 < count ? i + 1 : 0];
            const double at_a = inward(a), at_b = inward(b);
            if (at_a >= 0) kept[next++] = a;
            if ((at_a < 0) == (at_b < 0)) continue;
            const double share = at_a / (at_a - at_b);
            for (std::size_t axis = 0; axis < 3; ++axis)
                kept[next][axis] = a[axis] + share * (b[axis] - a[axis]);
            ++next;
        }
        left = kept;
        count = next;
    }
    return count > 0;
}

}  // namespace realmodel::spatial
