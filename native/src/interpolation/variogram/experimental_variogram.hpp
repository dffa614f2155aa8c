// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace realmodel::interpolation {

/// As for points that are not checked yet (variogram_fit.hpp).
ExperimentalVariogram experimental_variogram(const DataPoints& data, const Anisotropy& anisotropy);

/// Positions rotated and stretched so that their plain distances are those under the anisotropy.
std::vector<Position> isotropic_positions(const DataPoints& data, const Anisotropy& anisotropy);

/// Of the box around positions.
double diagonal(std::span<const Position> positions);

}  // namespace realmodel::interpolation
