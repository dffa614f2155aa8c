// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/linear_data.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {

void check_dips(const Dips& dips) {
    const std::size_t count = dips.positions.size();
    if (dips.slopes.size() != count) {
        throw InputError("option", "there are " + std::to_string(count) +
                                       " positions of dips and " +
                                       std::to_string(dips.slopes.size()) + " slopes");
    }
    if (count == 0) return;
    require_countable(2 * count, "slopes");
    if (!(dips.baseline > 0) || !std::isfinite(dips.baseline))
        throw InputError("option", "the baseline of dips is not a positive, finite length");
    if (dips.neighbors < 0)
        throw InputError("option", "the number of dips at a node is negative; 0 means all");
    for (std::size_t i = 0; i < count; ++i) {
        require_usable(dips.positions[i], "dip", i);
        require_usable(dips.slopes[i], "dip", i);
    }
}

void check_sheets(const Sheets& sheets, std::size_t points, std::size_t dips) {
    if (sheets.variances.empty()) return;
    check_variogram(sheets.thickness);
    const auto count = static_cast<std::int32_t>(sheets.variances.size());
    const auto is_sheet = [&](std::int32_t sheet) { return sheet >= 0 && sheet < count; };
    if (sheets.of_points.size() != points || sheets.of_dips.size() != dips)
        throw InputError("option", "each point and each dip must be on one of the sheets");
    if (!is_sheet(sheets.asked) ||
        !std::all_of(sheets.of_points.begin(), sheets.of_points.end(), is_sheet) ||
        !std::all_of(sheets.of_dips.begin(), sheets.of_dips.end(), is_sheet))
        throw InputError("option", "there is no such sheet");
    double before = 0;
    for (const double variance : sheets.variances) {
        if (!(variance >= before) || !usable(variance))
            throw InputError("option", "variances of sheets must be finite, and ascend from 0");
        before = variance;
    }
}

LinearData::LinearData(const DataPoints& points, const Dips& dips,
                       std::span<const std::array<double, 2>> scales, std::vector<double> units,
                       std::span<const std::int32_t> of_dips)
    : points_(points), units_(std::move(units)) {
    check_dips(dips);
    require_countable(points.local.size() + 2 * dips.positions.size(), "points and slopes");
    const double half = dips.baseline / 2;
    for (std::size_t i = 0; i < dips.positions.size(); ++i) {
        const PlanPosition at = points.to_local(dips.positions[i]);
        dips_.push_back(at);
        const std::int32_t sheet = has_sheets() ? of_dips[i] : 0;
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const double scale = scales[sheet][axis];
            // kernels of sheets have heights in the units of these, and so has the scale
            const double rise = dips.baseline * dips.slopes[i][axis] / unit(sheet);
            Difference d{at, at, scale, scale * rise, sheet};
            d.to[axis] += half;
            d.from[axis] -= half;
            differences_.push_back(d);
        }
    }
    if (dips_.empty()) return;
    const auto wanted = static_cast<std::size_t>(dips.neighbors);
    dips_at_node_ = wanted == 0 ? dips_.size() : std::min(wanted, dips_.size());
    dip_tree_.emplace(dips_);
}

}  // namespace realmodel::interpolation
