// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "realmodel/interpolation/variogram.hpp"

namespace realmodel::interpolation {

/// Slopes that a surface has at positions in plan. Along each axis a slope is the difference of the
/// heights at the ends of a baseline about its position: a linear functional for any variogram,
/// where a derivative has a variance for those only that are twice differentiable at 0 (Chiles and
/// Delfiner 2012, "Geostatistics", section 2.3.3; slopes over short distances as data: Renard and
/// Ruffo 1993, "Depth, dip and gradient").
struct Dips {
    std::span<const std::array<double, 2>> positions;  ///< x, y
    std::span<const std::array<double, 2>> slopes;     ///< dz/dx, dz/dy
    double baseline = 0;                               ///< above 0 where there are dips
    int neighbors = 0;  ///< so many of the nearest count at a node; 0: all
};

/// The baseline with which slopes say most of heights under a variogram. A model that is not
/// differentiable at 0 has slopes of infinite variance, and a slope at a point would say nothing of
/// the heights around it: there the slope is that over the mean spacing of the data. Otherwise the
/// baseline is so short that the slope is that at its position.
/// @param spacing  of points and dips together
double dip_baseline(const Variogram& variogram, double spacing);

}  // namespace realmodel::interpolation
