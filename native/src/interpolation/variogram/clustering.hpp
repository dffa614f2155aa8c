// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "interpolation/variogram/many_points.hpp"
#include "realmodel/base/execution.hpp"

namespace realmodel::interpolation {

/// buffer_of_clusters of variogram_fit.hpp.
double buffer_of_clusters(const ManyPoints& points, const Execution& execution);

}  // namespace realmodel::interpolation
