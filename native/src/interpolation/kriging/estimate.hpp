// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/host_device.hpp"

namespace realmodel::interpolation {

/// What kriging gives for a node.
/// @tparam Number  double, or a vector of doubles: of several nodes
template <class Number>
struct EstimateOf {
    Number value;
    Number variance;  ///< in units of the sill
};
using Estimate = EstimateOf<double>;

/// What was estimated less a base and in units, in heights.
inline Estimate in_heights(double base, double unit, const Estimate& estimate) {
    return {base + unit * estimate.value, unit * unit * estimate.variance};
}

/// A point is left out of a system where the others determine its value with a variance below this
/// share of the sill: the system stays well-conditioned. Without a nugget the Gaussian model soon
/// comes here; the others only where points nearly coincide.
inline constexpr double kRedundantVariance = 1e-10;

/// The estimate, less `base`, from what elimination leaves: with C = L L^T the covariance matrix of
/// the data, u = L^-1 c (c: covariances with the node), s = L^-1 1, t = L^-1 (values - base), given
/// as scalar products (Chiles and Delfiner 2012, section 3.4.1, the Lagrange multiplier
/// eliminated).
template <class Number>
REALMODEL_HOST_DEVICE inline EstimateOf<Number> ordinary_kriging(Number uu, Number us, Number ut,
                                                                 Number ss, Number st) {
    const Number excess = us - 1;
    const Number variance = 1 - uu + excess * excess / ss;
    return {ut - excess / ss * st, variance > 0.0 ? variance : Number{}};
}

}  // namespace realmodel::interpolation
