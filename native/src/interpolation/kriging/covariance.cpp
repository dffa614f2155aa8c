// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/covariance.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include "interpolation/kriging/estimate.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/interpolation/dips.hpp"

namespace realmodel::interpolation {

namespace {

std::vector<CovarianceStructure> structures_of(const Variogram& variogram) {
    std::vector<CovarianceStructure> structures;
    for (const auto& [model, range, sill, anisotropy] : variogram.structures()) {
        // Distances across the azimuth count `ratio` times.
        const double azimuth = anisotropy.azimuth * std::numbers::pi / 180;
        const double ratio = std::max(anisotropy.ratio, 1 / anisotropy.ratio);
        const double x = elementary::sin(azimuth), y = elementary::cos(azimuth);
        const bool is_wave = model == VariogramModel::kWave;
        const double across = is_wave ? 1 : ratio;
        structures.push_back({model, x / range, y / range, across * y / range, -across * x / range,
                              sill / variogram.sill, is_wave ? ratio : 0});
    }
    return structures;
}

}  // namespace

Covariance::Covariance(const Variogram& variogram, const Sheets& sheets)
    : structures_(structures_of(variogram)),
      variances_(sheets.variances.begin(), sheets.variances.end()) {
    if (variances_.empty()) return;
    thickness_ = structures_of(sheets.thickness);
    for (const double variance : variances_)
        units_.push_back(std::sqrt(1 + variance));
}

std::array<double, 2> Covariance::scales_over(double baseline, std::int32_t sheet) const {
    const auto scale = [&](const PlanPosition& to) {
        const PlanPosition from{};
        const double variance =
            2 * ((*this)(from, sheet, from, sheet) - (*this)(to, sheet, from, sheet));
        return variance > kRedundantVariance ? 1 / std::sqrt(variance) : 0;
    };
    return {scale({baseline, 0}), scale({0, baseline})};
}

namespace {

constexpr double kOfSmooth = 1.0 / 64;   // of the spacing
constexpr double kOfRange = 1.0 / 1024;  // less leaves too few digits of differences

bool is_rough(VariogramModel model) {
    return model == VariogramModel::kSpherical || model == VariogramModel::kExponential;
}

}  // namespace

double dip_baseline(const Variogram& variogram, double spacing) {
    double shortest = std::numeric_limits<double>::infinity(), longest = 0;
    bool rough = false;
    for (const auto& [model, range, sill, anisotropy] : variogram.structures()) {
        const double across = range / std::max(anisotropy.ratio, 1 / anisotropy.ratio);
        shortest = std::min(shortest, across);
        longest = std::max(longest, model == VariogramModel::kWave ? across : range);
        rough = rough || (is_rough(model) && sill > 0);
    }
    const double baseline = std::min(spacing, shortest);
    return rough ? baseline : std::max(kOfSmooth * baseline, kOfRange * longest);
}

}  // namespace realmodel::interpolation
