// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "interpolation/variogram/many_points.hpp"
#include "realmodel/base/execution.hpp"

namespace realmodel::interpolation {

/// How far others should be from a point that is left out, so that it is predicted from as far as
/// the places between the points are, where points are clustered: contacts along the lines of a
/// map, picks along sections. Twice the spacing that so many points would have evenly in their
/// convex hull; 0 where they are not clustered. They are where the mean distance to the nearest
/// other is below half of that expected of random ones (Clark and Evans 1954, "Distance to nearest
/// neighbor as a measure of spatial relationships in populations", Ecology 35). Errors at the
/// distances of predictions: Mila et al. 2022, "Nearest neighbour distance matching leave-one-out
/// cross-validation", Methods in Ecology and Evolution 13.
/// @throws Cancelled
double buffer_of_clusters(const ManyPoints& points, const Execution& execution);

}  // namespace realmodel::interpolation
