// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "interpolation/kriging/covariance.hpp"
#include "interpolation/kriging/estimate.hpp"
#include "interpolation/linear_data.hpp"
#include "realmodel/base/progress.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// The estimate from what elimination leaves: with C = L L^T the covariance matrix of the data,
/// u = L^-1 c (c: covariances with the node), t = L^-1 (values - base), and a basis Q R = L^-1 F of
/// the drift (Chiles and Delfiner 2012, section 3.4; generalized least squares by QR as in
/// Bjorck 1996, section 4.3).
Estimate universal_kriging(double base, double uu, double ut, const DriftBasis& basis,
                           const DriftFrame::Terms& terms, const DriftBasis::Coefficients& qu,
                           const DriftBasis::Coefficients& qt);

/// Kriging from a few data, one small system at a time, with any drift. Keeps its memory between
/// nodes; one for each thread.
class NeighborKriging {
public:
    NeighborKriging(const LinearData& data, const Covariance& covariance, Drift drift)
        : data_(data), covariance_(covariance), drift_(drift) {}

    /// @param node       in local coordinates
    /// @param neighbors  numbers of data; the nearest point first, and none at the node
    ///                   itself on its sheet
    /// @return           means nothing once the caller has cancelled
    /// @param sheet      that the node is on
    Estimate at(const PlanPosition& node, std::span<const spatial::Neighbor> neighbors,
                std::int32_t sheet = 0, Progress* progress = nullptr);

private:
    double* column(std::size_t k) { return matrix_.data() + k * rows_; }
    void assemble(const PlanPosition& node, std::int32_t sheet,
                  std::span<const spatial::Neighbor> neighbors, const DriftFrame& frame);
    bool eliminate(Progress* progress);

    const LinearData& data_;
    Covariance covariance_;
    Drift drift_;
    std::vector<PlanPosition> positions_;
    // Columns of the lower triangle of C, and below it the rows c^T, (values - base)^T and F^T, of
    // which elimination makes u^T, t^T and (L^-1 F)^T.
    std::vector<double> matrix_;
    std::size_t count_ = 0, rows_ = 0;
    Eigen::MatrixXd plain_, whitened_;
    Eigen::VectorXd u_, t_;
    DriftBasis basis_;
};

}  // namespace realmodel::interpolation
