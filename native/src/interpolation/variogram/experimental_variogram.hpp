// SPDX-License-Identifier: GPL-3.0-or-later
// The experimental semivariogram of points that are checked already. Private.
#pragma once

#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace realmodel::interpolation {

ExperimentalVariogram experimental_variogram(const DataPoints& data, const Anisotropy& anisotropy);

/// Places turned and stretched so that their plain distances are those under the anisotropy.
std::vector<Place> isotropic_places(const DataPoints& data, const Anisotropy& anisotropy);

/// Of the box around places.
double diagonal(std::span<const Place> places);

}  // namespace realmodel::interpolation
