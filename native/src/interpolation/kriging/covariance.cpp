// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/covariance.hpp"

#include <algorithm>
#include <numbers>

#include "interpolation/kriging/estimate.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::interpolation {

namespace {

std::vector<CovariancePart> parts_of(const Variogram& variogram) {
    std::vector<CovariancePart> parts;
    const auto add = [&](VariogramModel model, double range, double sill,
                         const Anisotropy& anisotropy) {
        // Distances across the azimuth count `ratio` times.
        const double azimuth = anisotropy.azimuth * std::numbers::pi / 180;
        const double ratio = std::max(anisotropy.ratio, 1 / anisotropy.ratio);
        const double x = elementary::sin(azimuth), y = elementary::cos(azimuth);
        const bool is_wave = model == VariogramModel::kWave;
        const double across = is_wave ? 1 : ratio;
        parts.push_back({model, x / range, y / range, across * y / range, -across * x / range,
                         sill / variogram.sill, is_wave ? ratio : 0});
    };
    add(variogram.model, variogram.range, variogram.first_sill(), variogram.anisotropy);
    for (const NestedStructure& nested : variogram.further)
        add(nested.model, nested.range, nested.sill, nested.anisotropy);
    return parts;
}

}  // namespace

Covariance::Covariance(const Variogram& variogram, const Sheets& sheets)
    : parts_(parts_of(variogram)), variances_(sheets.variances.begin(), sheets.variances.end()) {
    if (variances_.empty()) return;
    thickness_ = parts_of(sheets.thickness);
    for (const double variance : variances_)
        units_.push_back(std::sqrt(1 + variance));
}

std::array<double, 2> Covariance::scales_over(double baseline, std::int32_t sheet) const {
    const auto scale = [&](const Position& to) {
        const Position from{};
        const double variance =
            2 * ((*this)(from, sheet, from, sheet) - (*this)(to, sheet, from, sheet));
        return variance > kRedundantVariance ? 1 / std::sqrt(variance) : 0;
    };
    return {scale({baseline, 0}), scale({0, baseline})};
}

}  // namespace realmodel::interpolation
