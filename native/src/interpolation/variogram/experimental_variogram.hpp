// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "interpolation/variogram/many_points.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace realmodel::interpolation {

/// As for points that are not checked yet (variogram_fit.hpp).
ExperimentalVariogram experimental_variogram(const ManyPoints& points, const Anisotropy& anisotropy,
                                             Progress* progress = nullptr);

}  // namespace realmodel::interpolation
