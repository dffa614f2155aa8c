// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "realmodel/interpolation/variogram.hpp"

namespace realmodel {
class Progress;
}

namespace realmodel::interpolation {

struct KrigingOptions {
    int neighbours =
        16;           ///< nearest in plan that make a node's system; 0: all points, factored once
    int threads = 0;  ///< 0: as many as there are
};

struct Kriged {
    std::vector<double> z;         ///< of each node
    std::vector<double> variance;  ///< of its error, squared units of z, not negative
};

/// Ordinary kriging (Matheron 1963; Chiles and Delfiner 2012, section 3.4).
///
/// A node on a point gets that point's value, with variance 0. Points that the nearer ones already
/// tell (variance below 1e-10 of the sill) are left out of a system, so none is singular.
/// @param points  x, y, z; repeated points count once
/// @param nodes   x, y
/// @return        the same bytes for any number of threads
/// Throws InputError of kind "no_points", "not_finite", "contradicting_points" (items: both points;
/// place), "variogram", "anisotropy", "option", "too_large" (says how much memory the systems would
/// take); Cancelled within 0.2 s of Progress::cancel.
Kriged krige(std::span<const std::array<double, 3>> points,
             std::span<const std::array<double, 2>> nodes, const Variogram& variogram,
             const KrigingOptions& options, Progress* progress = nullptr);

}  // namespace realmodel::interpolation
