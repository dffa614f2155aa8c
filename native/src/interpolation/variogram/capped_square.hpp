// SPDX-License-Identifier: GPL-3.0-or-later
// What the errors at points left out say of a variogram. Private.
#pragma once

#include <span>
#include <vector>

#include "interpolation/variogram/leave_one_out.hpp"

namespace realmodel::interpolation {

/// The value below which a share of them lies. They are not empty.
double quantile(std::vector<double> values, double share);

/// Mean squares of errors, of which a few may be of another kind (faults, mistakes in the data):
/// those beyond twenty deviations count as twenty.
class Judge {
public:
    /// @param errors  of a variogram that is not bad: what is outlying is judged by them
    explicit Judge(std::span<const double> errors);

    double operator()(std::span<const double> errors) const;

    /// Whether errors are surely smaller than others at the same points: their squares by more than
    /// chance makes of points that are told equally well.
    bool surely_less(std::span<const double> errors, std::span<const double> others) const;

private:
    double most_;  // square
};

/// The sill with which 95 % of the errors lie within two deviations.
double honest_sill(const LeftOutErrors& told);

}  // namespace realmodel::interpolation
