// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "interpolation/variogram/capped_square.hpp"
#include "interpolation/variogram/leave_one_out.hpp"
#include "interpolation/variogram/weighted_fit.hpp"

namespace realmodel::interpolation {

/// A fit's range under an anisotropy: the area within it stays the same.
CurveFit stretched(CurveFit fit, const Anisotropy& anisotropy);

/// Ratio and azimuth of the least mean square with this fit, stretched; of ratio 1 where none is
/// better than none. Ratios up to four are tried: beyond, the nearest points in plan would no more
/// be those that matter most.
Anisotropy find_anisotropy(const LeaveOneOut& points, const CurveFit& fit,
                           const CappedSquare& square_of);

/// Whether positions spread in two directions, so that an anisotropy shows.
bool spread_in_plan(const ManyPoints& points);

}  // namespace realmodel::interpolation
