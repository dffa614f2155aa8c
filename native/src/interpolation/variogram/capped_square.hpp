// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "interpolation/variogram/leave_one_out.hpp"

namespace realmodel::interpolation {

/// The value below which a share of them lies. They are not empty.
double quantile(std::vector<double> values, double share);

/// The mean square of errors, a few of which may be of another kind (faults, mistakes in the data):
/// those beyond twenty deviations count as twenty.
class CappedSquare {
public:
    /// @param errors  of a variogram that is not bad: they decide what is an outlier
    explicit CappedSquare(std::span<const double> errors);

    double operator()(std::span<const double> errors) const;

    /// Whether errors are surely smaller than others at the same points: by more than chance makes
    /// between equally good predictions.
    bool surely_less(std::span<const double> errors, std::span<const double> others) const;

private:
    double most_;  // square
};

/// The sill with which 95 % of the errors lie within two deviations.
double honest_sill(const PredictionErrors& found);

}  // namespace realmodel::interpolation
