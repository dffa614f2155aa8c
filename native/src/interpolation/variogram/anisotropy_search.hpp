// SPDX-License-Identifier: GPL-3.0-or-later
// The anisotropy with which points that are left out are told best. Private.
#pragma once

#include "interpolation/variogram/capped_square.hpp"
#include "interpolation/variogram/leave_one_out.hpp"
#include "interpolation/variogram/weighted_fit.hpp"

namespace realmodel::interpolation {

/// A fit's range under an anisotropy: the area within it stays the same.
CurveFit stretched(CurveFit fit, const Anisotropy& anisotropy);

/// Ratio and azimuth of the least mean square with this fit, stretched; of ratio 1 where none is
/// better than none. Ratios up to four are tried: beyond, the nearest points in plan would no more
/// be those that tell most.
Anisotropy find_anisotropy(const LeftOutPoints& points, const CurveFit& fit, const Judge& judge);

/// Whether places spread in two directions, so that an anisotropy can be told from a range.
bool spread_in_plan(const DataPoints& data);

}  // namespace realmodel::interpolation
