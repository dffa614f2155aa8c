// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#ifndef EIGEN_DONT_PARALLELIZE
#define EIGEN_DONT_PARALLELIZE
#endif
#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "realmodel/interpolation/drift.hpp"

namespace realmodel::interpolation {

inline constexpr Eigen::Index kMostDriftTerms = 6;

/// 1, 3 or 6.
Eigen::Index drift_terms(Drift drift);

/// Coordinates in which a polynomial drift is well-conditioned: from the mean of some positions,
/// along the axis of their greatest spread and across it, in units of that spread. Terms across
/// come after those along, so that positions in one line keep the terms along it.
class DriftFrame {
public:
    using Terms = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMostDriftTerms>;

    DriftFrame(std::span<const PlanPosition> positions, Drift drift);
    Terms terms(const PlanPosition& position) const;
    /// A row for each position.
    Eigen::MatrixXd terms(std::span<const PlanPosition> positions) const;

private:
    Drift drift_;
    PlanPosition center_{};
    double along_x_ = 1, along_y_ = 0, scale_ = 1;
};

/// An orthonormal basis of the whitened drift L^-1 F, where C = L L^T is the covariance of the data
/// and F has the drift's terms at them; without the terms that the data do not distinguish from
/// those before them.
class DriftBasis {
public:
    using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostDriftTerms, 1>;

    /// @param plain     F; on it is decided which terms are kept. Rows that elimination left out
    /// are 0
    /// @param whitened  L^-1 F, the same rows 0
    void make(const Eigen::Ref<const Eigen::MatrixXd>& plain,
              const Eigen::Ref<const Eigen::MatrixXd>& whitened);

    Eigen::Index size() const { return size_; }

    /// Q^T v.
    Coefficients project(const Eigen::Ref<const Eigen::VectorXd>& v) const {
        return basis_.leftCols(size_).transpose() * v;
    }

    double orthonormal(Eigen::Index row, Eigen::Index term) const { return basis_(row, term); }

    /// Q a.
    Eigen::VectorXd expand(const Coefficients& a) const { return basis_.leftCols(size_) * a; }

    /// R^-T f, for the terms f at a position.
    Coefficients solve(const DriftFrame::Terms& terms) const;

private:
    Eigen::MatrixXd basis_;  // Q, its first size_ columns
    std::array<Eigen::Index, kMostDriftTerms> term_{};
    Eigen::Matrix<double, kMostDriftTerms, kMostDriftTerms> upper_;  // R, of the kept terms
    Eigen::Index size_ = 0;
    Eigen::MatrixXd plain_basis_;
};

}  // namespace realmodel::interpolation
