// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "interpolation/variogram/many_points.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace realmodel::interpolation {

/// How semivariance grows with distance, from 0 to 1: as a model does, or with a structure that is
/// rougher - a rougher model, or one of a shorter range.
struct VariogramCurve {
    VariogramModel model = VariogramModel::kSpherical;
    double range = 1;
    VariogramModel rougher = VariogramModel::kExponential;
    double rough_range = 1;  ///< of the range
    double rough_share = 0;  ///< of the rougher structure; 0: there is none

    double operator()(double distance) const {
        const double t = distance / range;
        const double f = structure(model, t);
        return rough_share > 0 ? f + rough_share * (structure(rougher, t / rough_range) - f) : f;
    }
};

/// nugget + partial_sill curve(h), and how far from the experimental values: the sum of squares
/// weighted by pairs / lag^2 (Chiles and Delfiner 2012, section 2.6.2, as gstat does).
struct CurveFit {
    VariogramCurve curve;
    double nugget = 0, partial_sill = 0;
    double misfit = std::numeric_limits<double>::infinity();

    double sill() const { return nugget + partial_sill; }
};

/// Of one model, nugget (free, or 0), range and sill.
CurveFit fit_curve(const ExperimentalVariogram& e, VariogramModel model, bool with_nugget);

/// Curve and nugget given, the sill alone.
CurveFit fit_sill(const ExperimentalVariogram& e, const VariogramCurve& curve, double nugget);

Variogram variogram_of(const CurveFit& fit, const Anisotropy& anisotropy);
/// Multiplies all that is in units of height squared.
void multiply_sills(Variogram& variogram, double factor);

/// As for points that are not checked yet (variogram_fit.hpp).
ExperimentalVariogram experimental_variogram(const ManyPoints& points, const Anisotropy& anisotropy,
                                             Progress* progress = nullptr);

}  // namespace realmodel::interpolation
