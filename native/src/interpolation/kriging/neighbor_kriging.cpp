// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/neighbor_kriging.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "interpolation/node_loop.hpp"

namespace realmodel::interpolation {

Estimate universal_kriging(double base, double uu, double ut, const DriftBasis& basis,
                           const DriftFrame::Terms& terms, const DriftBasis::Coefficients& qu,
                           const DriftBasis::Coefficients& qt) {
    const DriftBasis::Coefficients open = basis.solve(terms) - qu;
    const double variance = 1 - uu + open.squaredNorm();
    return {base + ut + open.dot(qt), variance > 0 ? variance : 0};
}

void NeighborKriging::assemble(const PlanPosition& node, std::int32_t sheet,
                               std::span<const spatial::Neighbor> neighbors,
                               const DriftFrame& frame) {
    const Eigen::Index terms = drift_terms(drift_);
    rows_ = count_ + 2 + static_cast<std::size_t>(terms);
    matrix_.resize(count_ * rows_);
    plain_.resize(static_cast<Eigen::Index>(count_), terms);
    const double base = data_.points().values[neighbors[0].point];
    for (std::size_t k = 0; k < count_; ++k) {
        const std::int32_t datum = neighbors[k].point;
        double* const to = column(k);
        to[k] = 1;
        for (std::size_t i = k + 1; i < count_; ++i)
            to[i] = data_.between(neighbors[i].point, datum, covariance_);
        to[count_] = data_.with_height(node, datum, covariance_, sheet);
        to[count_ + 1] = data_.value(datum, base);
        const auto row = static_cast<Eigen::Index>(k);
        plain_.row(row) = data_.terms(datum, frame);
        for (Eigen::Index term = 0; term < terms; ++term)
            to[count_ + 2 + term] = plain_(row, term);
    }
}

/// Whether it was not cancelled.
bool NeighborKriging::eliminate(Progress* progress) {
    for (std::size_t k = 0; k < count_; ++k) {
        if (k % 64 == 63 && cancelled(progress)) return false;
        double* const pivot = column(k);
        if (pivot[k] < kRedundantVariance) {  // the nearer points determine this one
            std::fill(pivot + count_, pivot + rows_, 0.0);
            plain_.row(static_cast<Eigen::Index>(k)).setZero();
            continue;
        }
        const double scale = 1 / std::sqrt(pivot[k]);
        for (std::size_t i = k + 1; i < rows_; ++i)
            pivot[i] *= scale;
        for (std::size_t j = k + 1; j < count_; ++j) {
            double* const other = column(j);
            const double factor = pivot[j];
#pragma omp simd
            for (std::size_t i = j; i < rows_; ++i)
                other[i] -= factor * pivot[i];
        }
    }
    return true;
}

Estimate NeighborKriging::at(const PlanPosition& node, std::span<const spatial::Neighbor> neighbors,
                             std::int32_t sheet, Progress* progress) {
    assert(!neighbors.empty());
    count_ = neighbors.size();
    positions_.clear();
    for (const spatial::Neighbor& neighbor : neighbors)
        positions_.push_back(data_.position(neighbor.point));
    const DriftFrame frame(positions_, drift_);
    assemble(node, sheet, neighbors, frame);
    if (!eliminate(progress)) return {};
    const double base = data_.points().values[neighbors[0].point];
    if (drift_ == Drift::kConstant && !data_.has_sheets()) {
        double uu = 0, us = 0, ut = 0, ss = 0, st = 0;
        for (std::size_t k = 0; k < count_; ++k) {
            const double* const of = column(k) + count_;
            const double u = of[0], t = of[1], s = of[2];
            uu += u * u;
            us += u * s;
            ut += u * t;
            ss += s * s;
            st += s * t;
        }
        const Estimate estimate = ordinary_kriging(uu, us, ut, ss, st);
        return {base + estimate.value, estimate.variance};
    }
    const auto rows = static_cast<Eigen::Index>(rows_), count = static_cast<Eigen::Index>(count_);
    const Eigen::Map<const Eigen::MatrixXd> matrix(matrix_.data(), rows, count);
    u_ = matrix.row(count).transpose();
    t_ = matrix.row(count + 1).transpose();
    whitened_ = matrix.bottomRows(rows - count - 2).transpose();
    basis_.make(plain_, whitened_);
    const auto estimate = [&](double from) {
        return universal_kriging(from, u_.squaredNorm(), u_.dot(t_), basis_,
                                 data_.terms(node, sheet, frame), basis_.project(u_),
                                 basis_.project(t_));
    };
    return data_.has_sheets() ? in_heights(base, data_.unit(sheet), estimate(0)) : estimate(base);
}

}  // namespace realmodel::interpolation
