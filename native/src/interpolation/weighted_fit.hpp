// SPDX-License-Identifier: GPL-3.0-or-later
// Weighted least squares of a variogram's curve to experimental values. Private.
#pragma once

#include <limits>

#include "realmodel/interpolation/variogram_fit.hpp"

namespace realmodel::interpolation {

/// nugget + partial_sill f(h / range), and how far from the experimental values: the sum of squares
/// weighted by pairs / lag^2 (Chiles and Delfiner 2012, section 2.6.2, as gstat does).
struct CurveFit {
    VariogramModel model = VariogramModel::spherical;
    double range = 1, nugget = 0, partial_sill = 0;
    double misfit = std::numeric_limits<double>::infinity();

    double sill() const { return nugget + partial_sill; }
};

/// Of one model, nugget (free, or 0), range and sill.
CurveFit fit_curve(const ExperimentalVariogram& e, VariogramModel model, bool with_nugget);

/// Range and nugget given, the sill alone.
CurveFit fit_sill(const ExperimentalVariogram& e, VariogramModel model, double range,
                  double nugget);

}  // namespace realmodel::interpolation
