// SPDX-License-Identifier: GPL-3.0-or-later
// Universal kriging from a few points. Private.
#pragma once

#include <span>
#include <vector>

#include "interpolation/kriging/covariance.hpp"
#include "interpolation/drift_basis.hpp"
#include "realmodel/spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// The estimate from what elimination leaves: with C = L L^T the covariance matrix of the data,
/// u = L^-1 c, t = L^-1 (values - base), and a basis Q R = L^-1 F of the drift (Chiles and Delfiner
/// 2012, section 3.4; generalised least squares by QR as in Bjorck 1996, section 4.3).
inline Estimate universal_kriging(double base, double uu, double ut, const DriftBasis& basis,
                                  const DriftFrame::Terms& terms,
                                  const DriftBasis::Coefficients& qu,
                                  const DriftBasis::Coefficients& qt) {
    const DriftBasis::Coefficients open = basis.solve(terms) - qu;
    const double variance = 1 - uu + open.squaredNorm();
    return {base + ut + open.dot(qt), variance > 0 ? variance : 0};
}

/// Solves one small system for each place, with a drift. Keeps its memory between places; one for
/// each thread.
class DriftKriging {
public:
    DriftKriging(const DataPoints& data, const Covariance& covariance, Drift drift)
        : data_(data), covariance_(covariance), drift_(drift) {}

    /// As LocalKriging::at.
    template <class Stop>
    Estimate at(const Place& place, std::span<const spatial::Neighbour> neighbours, Stop&& stop);

private:
    const DataPoints& data_;
    Covariance covariance_;
    Drift drift_;
    std::vector<Place> places_;
    Eigen::MatrixXd
        matrix_;  // columns: the lower triangle of C, below it c^T, (values - base)^T, F^T
    Eigen::MatrixXd plain_, whitened_;
    Eigen::VectorXd u_, t_;
    DriftBasis basis_;
};

template <class Stop>
Estimate DriftKriging::at(const Place& place, std::span<const spatial::Neighbour> neighbours,
                          Stop&& stop) {
    const auto n = static_cast<Eigen::Index>(neighbours.size());
    places_.clear();
    for (const spatial::Neighbour& neighbour : neighbours)
        places_.push_back(data_.local[static_cast<std::size_t>(neighbour.point)]);
    const DriftFrame frame(places_, drift_);
    const Eigen::Index terms = drift_terms(drift_), rows = n + 2 + terms;
    matrix_.resize(rows, n);
    plain_.resize(n, terms);
    const auto value = [&](Eigen::Index k) {
        return data_
            .values[static_cast<std::size_t>(neighbours[static_cast<std::size_t>(k)].point)];
    };
    const double base = value(0);
    for (Eigen::Index k = 0; k < n; ++k) {
        const Place& there = places_[static_cast<std::size_t>(k)];
        double* column = matrix_.col(k).data();
        column[k] = 1;
        for (Eigen::Index i = k + 1; i < n; ++i)
            column[i] = covariance_(places_[static_cast<std::size_t>(i)], there);
        column[n] = covariance_(place, there);
        column[n + 1] = value(k) - base;
        plain_.row(k) = frame.terms(there);
        for (Eigen::Index term = 0; term < terms; ++term)
            column[n + 2 + term] = plain_(k, term);
    }
    for (Eigen::Index k = 0; k < n; ++k) {
        if (k % 64 == 63 && stop()) return {};
        double* column = matrix_.col(k).data();
        if (column[k] < redundant_variance) {
            matrix_.col(k).tail(terms + 2).setZero();
            plain_.row(k).setZero();
            continue;
        }
        const double scale = 1 / std::sqrt(column[k]);
        for (Eigen::Index i = k + 1; i < rows; ++i)
            column[i] *= scale;
        for (Eigen::Index j = k + 1; j < n; ++j) {
            double* other = matrix_.col(j).data();
            const double factor = column[j];
#pragma omp simd
            for (Eigen::Index i = j; i < rows; ++i)
                other[i] -= factor * column[i];
        }
    }
    u_ = matrix_.row(n).transpose();
    t_ = matrix_.row(n + 1).transpose();
    whitened_ = matrix_.bottomRows(terms).transpose();
    basis_.make(plain_, whitened_);
    return universal_kriging(base, u_.squaredNorm(), u_.dot(t_), basis_, frame.terms(place),
                             basis_.project(u_), basis_.project(t_));
}

}  // namespace realmodel::interpolation
