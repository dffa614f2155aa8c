// SPDX-License-Identifier: GPL-3.0-or-later
// What tests ask of variograms.
#pragma once

#include <array>

#include "realmodel/interpolation/variogram.hpp"

namespace realmodel::interpolation {

inline constexpr std::array kAllVariogramModels{
    VariogramModel::kSpherical, VariogramModel::kExponential, VariogramModel::kGaussian,
    VariogramModel::kCubic,     VariogramModel::kMatern32,    VariogramModel::kMatern52,
    VariogramModel::kWave};

/// Semivariance along the azimuth of each structure.
inline double gamma_of(const Variogram& variogram, double distance) {
    if (distance == 0) return 0;
    double sum = variogram.nugget;
    for (const NestedStructure& nested : variogram.structures())
        sum += nested.sill * structure(nested.model, distance / nested.range);
    return sum;
}

}  // namespace realmodel::interpolation
