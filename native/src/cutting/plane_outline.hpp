// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "cutting/positions.hpp"

namespace realmodel::cutting {

/// Planes along the edges of a triangle, at right angles to it.
class PlaneOutline {
public:
    /// @param margin  what its corners and others may be off by
    PlaneOutline(const std::array<Position, 3>& triangle, double margin)
        : corners_(triangle), margin_(4 * margin) {
        const Position normal = polygon_normal(triangle);
        for (std::size_t i = 0; i < 3; ++i)
            outward_[i] = cross(minus(triangle[(i + 1) % 3], triangle[i]), normal);
    }
    /// Whether other corners surely are beyond one of these planes.
    bool is_surely_beside(std::span<const Position> others) const {
        constexpr double kRounding = 0x1p-40;
        for (std::size_t i = 0; i < 3; ++i) {
            const Position& out = outward_[i];
            const double size = std::abs(out[0]) + std::abs(out[1]) + std::abs(out[2]);
            // rounding may have turned the plane itself, so that its own corners are beyond it
            double reach = -HUGE_VAL, least = HUGE_VAL, farthest = 0;
            for (const Position& corner : corners_) {
                const Position own = minus(corner, corners_[i]);
                reach = std::max(reach, dot(out, own));
                farthest = std::max(farthest, length(own));
            }
            for (const Position& other : others) {
                const Position beyond = minus(other, corners_[i]);
                least = std::min(least, dot(out, beyond));
                farthest = std::max(farthest, length(beyond));
            }
            if (least > reach + size * (margin_ + kRounding * farthest)) return true;
        }
        return false;
    }

private:
    std::array<Position, 3> corners_, outward_{};
    double margin_;
};

}  // namespace realmodel::cutting
