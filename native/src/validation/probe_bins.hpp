// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "validation/probes.hpp"

namespace realmodel::validation {

/// Finds the few places that lie within a box: the many faces and triangles of a model are looked
/// at once each, and most of them meet none.
class ProbeBins {
public:
    explicit ProbeBins(const std::vector<PlanPosition>& places) : places_(places) {
        if (places.empty()) return;
        low_ = high_ = places.front();
        for (const PlanPosition& p : places) {
            for (std::size_t axis = 0; axis < 2; ++axis) {
                low_[axis] = std::min(low_[axis], p[axis]);
                high_[axis] = std::max(high_[axis], p[axis]);
            }
        }
        side_ = std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(places.size())));
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const double extent = high_[axis] - low_[axis];
            const double scale = static_cast<double>(side_) / extent;
            scale_[axis] = std::isfinite(scale) ? scale : 0;  // all in one bin
        }
        start_.assign(side_ * side_ + 1, 0);
        for (const PlanPosition& p : places)
            ++start_[bin(p) + 1];
        for (std::size_t i = 1; i < start_.size(); ++i)
            start_[i] += start_[i - 1];
        order_.resize(places.size());
        std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
        for (std::size_t i = 0; i < places.size(); ++i)
            order_[next[bin(places[i])]++] = i;
    }

    /// Calls visit(i) for every place within the box, borders included.
    template <class Visit>
    void within(const PlanPosition& low, const PlanPosition& high, const Visit& visit) const {
        if (places_.empty() || high[0] < low_[0] || high[1] < low_[1] || low[0] > high_[0] ||
            low[1] > high_[1])
            return;
        const std::size_t last_column = index(high[0], 0), last_row = index(high[1], 1);
        for (std::size_t column = index(low[0], 0); column <= last_column; ++column) {
            for (std::size_t row = index(low[1], 1); row <= last_row; ++row) {
                const std::size_t b = column * side_ + row;
                for (std::size_t k = start_[b]; k < start_[b + 1]; ++k) {
                    const PlanPosition& p = places_[order_[k]];
                    if (p[0] >= low[0] && p[0] <= high[0] && p[1] >= low[1] && p[1] <= high[1])
                        visit(order_[k]);
                }
            }
        }
    }

private:
    std::size_t index(double value, std::size_t axis) const {
        const double at = (value - low_[axis]) * scale_[axis];
        return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(side_) - 0.5));
    }
    std::size_t bin(const PlanPosition& p) const { return index(p[0], 0) * side_ + index(p[1], 1); }

    const std::vector<PlanPosition>& places_;
    PlanPosition low_{}, high_{};
    std::array<double, 2> scale_{};
    std::size_t side_ = 1;
    std::vector<std::size_t> start_, order_;
};

}  // namespace realmodel::validation
