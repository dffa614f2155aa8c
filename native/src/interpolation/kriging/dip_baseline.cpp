// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>

#include "realmodel/interpolation/dips.hpp"

namespace realmodel::interpolation {

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
    const auto add = [&](VariogramModel model, double range, double sill, double ratio) {
        const double across = range / std::max(ratio, 1 / ratio);
        shortest = std::min(shortest, across);
        longest = std::max(longest, model == VariogramModel::kWave ? across : range);
        rough = rough || (is_rough(model) && sill > 0);
    };
    add(variogram.model, variogram.range, variogram.first_sill(), variogram.anisotropy.ratio);
    for (const NestedStructure& part : variogram.further)
        add(part.model, part.range, part.sill, part.anisotropy.ratio);
    const double baseline = std::min(spacing, shortest);
    return rough ? baseline : std::max(kOfSmooth * baseline, kOfRange * longest);
}

}  // namespace realmodel::interpolation
