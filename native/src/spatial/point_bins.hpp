// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/counting_sort.hpp"

namespace realmodel::spatial {

/// Points in plan, in square bins about as many as there are points: finds the few within a box.
class PointBins {
public:
    using Position = std::array<double, 2>;

    explicit PointBins(const std::vector<Position>& points) {
        if (points.empty()) return;
        low_ = high_ = points.front();
        for (const Position& p : points) {
            for (std::size_t axis = 0; axis < 2; ++axis) {
                low_[axis] = std::min(low_[axis], p[axis]);
                high_[axis] = std::max(high_[axis], p[axis]);
            }
        }
        side_ = std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(points.size())));
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const double scale = static_cast<double>(side_) / (high_[axis] - low_[axis]);
            scale_[axis] = std::isfinite(scale) ? scale : 0;  // all in one bin
        }
        bins_ = bucketize<Item>(side_ * side_, [&](const auto& put) {
            for (std::size_t i = 0; i < points.size(); ++i)
                put(bin(points[i][0], 0) * side_ + bin(points[i][1], 1), Item{points[i], i});
        });
    }

    /// Calls visit(number, position) for every point within the box, borders included.
    template <class Visit>
    void within(const Position& low, const Position& high, const Visit& visit) const {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            if (high[axis] < low_[axis] || low[axis] > high_[axis]) return;
        }
        const std::size_t last_column = bin(high[0], 0), last_row = bin(high[1], 1);
        for (std::size_t column = bin(low[0], 0); column <= last_column; ++column) {
            for (std::size_t row = bin(low[1], 1); row <= last_row; ++row) {
                for (const auto& [p, number] : bins_[column * side_ + row]) {
                    if (p[0] >= low[0] && p[0] <= high[0] && p[1] >= low[1] && p[1] <= high[1])
                        visit(number, p);
                }
            }
        }
    }

private:
    struct Item {
        Position position;
        std::size_t number;
    };

    std::size_t bin(double value, std::size_t axis) const {
        const double at = (value - low_[axis]) * scale_[axis];
        return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(side_) - 0.5));
    }

    Position low_{HUGE_VAL, HUGE_VAL}, high_{-HUGE_VAL, -HUGE_VAL};
    std::array<double, 2> scale_{};
    std::size_t side_ = 1;
    Buckets<Item> bins_;
};

}  // namespace realmodel::spatial
