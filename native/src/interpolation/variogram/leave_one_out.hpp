// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/kriging/covariance.hpp"
#include "interpolation/variogram/many_points.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/interpolation/drift.hpp"

namespace realmodel::interpolation {

/// Predicted less true values, and the variances of these errors in units of the sill.
struct PredictionErrors {
    std::vector<double> errors, variances;
};

/// Points that are left out one by one and predicted by kriging from their nearest others: a fixed,
/// even subset of the data. One search for any number of variograms.
class LeaveOneOut {
public:
    /// @param neighbors  1 .. 64; fewer where there are not so many others
    /// @param most       points that are left out, where there are so many
    /// @param buffer     others nearer than this are left out with each of them; 0: none
    LeaveOneOut(const ManyPoints& points, std::size_t neighbors, std::size_t most, double buffer,
                const Execution& execution);

    std::size_t size() const { return left_out_.size(); }
    std::size_t neighbors() const { return neighbors_; }

    /// By ordinary kriging, or with a drift, which is slower. The same bytes for any number of
    /// threads.
    /// @throws Cancelled
    PredictionErrors errors(const Covariance& covariance, Drift drift = Drift::kConstant) const;

    /// By ordinary kriging with each of several covariances, whose structures are the same in other
    /// shares: these are computed once. The same bytes as one by one.
    std::vector<PredictionErrors> errors(std::span<const Covariance> alike) const;

private:
    std::vector<spatial::Neighbor> beyond(std::span<const spatial::Neighbor> near,
                                          std::size_t asked, double buffer) const;

    DataPoints data_;  // those left out, and their others
    std::size_t neighbors_;
    Execution execution_;
    std::vector<std::int32_t> left_out_;  // numbers of points, in the order of a curve
    std::vector<std::int32_t> others_;    // neighbors_ of each, nearest first
};

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
double honest_sill(const PredictionErrors& predictions);

}  // namespace realmodel::interpolation
