// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "fields/functional.hpp"
#include "fields/spline.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/fields/field.hpp"

namespace realmodel::fields {

inline constexpr AxisRatios kIsotropic{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {1, 1, 1}};

/// Scales space by the ratios along the axes.
Map3 map_of(const AxisRatios& anisotropy);

/// What kind of random function data are most likely to be of.
struct Likely {
    AxisRatios anisotropy = kIsotropic;
    Errors errors;
    int order = 3;               ///< of the derivatives that are least: see Kernel
    double lift = 1;             ///< of further coordinates
    std::vector<Vec3> throws{};  ///< by how much places move for each unit of each of these
    bool is_even = false;        ///< beds keep their thickness: see EvenSteepness

    Smoothness smoothness() const { return {map_of(anisotropy), errors, order, lift, throws}; }
};

/// The anisotropy, the errors of measurement and the scale of further coordinates under which what
/// is known is most likely, with the third order. The anisotropy is along the fold axis, to which
/// the normals are most nearly perpendicular, or where they show none along the best of some
/// directions; then along a direction across it. Where faults give further coordinates, it is also
/// sought by how much places on one side of each have been moved along it.
/// @param faults  their normals
/// @param error  of values, as of Spline::log_likelihood
Likely most_likely(std::span<const Functional> known, std::span<const Vec3> normals,
                   std::span<const Vec3> faults, double error, const Execution& execution);

/// The same, with an anisotropy along any directions. It takes about three times as long.
Likely most_likely_anywhere(std::span<const Functional> known, const Likely& likely, double error,
                            const Execution& execution);

/// The same with the fifth order, whose ratios are one over ranges: `likely` where that is
/// likelier.
Likely most_likely_smooth(std::span<const Functional> known, const Likely& likely, double error,
                          const Execution& execution);

}  // namespace realmodel::fields
