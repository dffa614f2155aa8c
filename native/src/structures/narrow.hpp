// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "cutting/polygons.hpp"

namespace realmodel::structures {

/// Whether polygons, of which some may be holes, are narrower than rounding may have made them.
class Narrow {
public:
    /// @param least_rounding  how coarse rounding is at least
    explicit Narrow(double least_rounding = 0) : rounding_(least_rounding) {}
    void add(std::span<const cutting::Position> corners, bool is_hole) {
        for (std::size_t i = 0; i < corners.size(); ++i)
            border_ += length(minus(corners[(i + 1) % corners.size()], corners[i]));
        const double size = length(polygon_normal(corners));
        area_ += is_hole ? -size : size;
        rounding_ = std::max(rounding_, cutting::rounding_of(corners));
    }
    explicit operator bool() const { return area_ <= kTimes * rounding_ * border_; }

private:
    static constexpr double kTimes = 64;  ///< rounding
    double border_ = 0, area_ = 0, rounding_;
};

}  // namespace realmodel::structures
