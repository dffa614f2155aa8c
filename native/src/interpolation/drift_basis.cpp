// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/drift_basis.hpp"

#include <algorithm>
#include <cmath>

#include "realmodel/base/elementary.hpp"

namespace realmodel::interpolation {

namespace {

// The least part of a term, its values of the order of 1, that is orthogonal to the terms before
// it: with less the data do not distinguish it from them. Points off a line by a millionth of its
// length are on it.
constexpr double kLeastComponent = 1e-6;
// Points closer together show no trend: far from them its terms, and the variances that are their
// squares, would overflow.
constexpr double kLeastSpread = 1e-60;

/// Takes the part along the first `count` columns of an orthonormal basis out of v, twice for full
/// accuracy (Giraud and others 2005); along(k, part) gets what was taken out.
template <class Along>
void make_orthogonal(const Eigen::MatrixXd& basis, Eigen::Index count, Eigen::VectorXd& v,
                     Along&& along) {
    for (int pass = 0; pass < 2; ++pass) {
        for (Eigen::Index k = 0; k < count; ++k) {
            const double component = basis.col(k).dot(v);
            v -= component * basis.col(k);
            along(k, component);
        }
    }
}

}  // namespace

Eigen::Index drift_terms(Drift drift) {
    return drift == Drift::kConstant ? 1 : drift == Drift::kLinear ? 3 : 6;
}

DriftFrame::DriftFrame(std::span<const PlanPosition> positions, Drift drift) : drift_(drift) {
    if (drift == Drift::kConstant || positions.empty()) return;
    for (const PlanPosition& p : positions) {
        center_[0] += p[0];
        center_[1] += p[1];
    }
    center_[0] /= static_cast<double>(positions.size());
    center_[1] /= static_cast<double>(positions.size());
    double xx = 0, xy = 0, yy = 0, largest = 0;
    for (const PlanPosition& p : positions) {
        const double x = p[0] - center_[0], y = p[1] - center_[1];
        xx += x * x;
        xy += x * y;
        yy += y * y;
        largest = std::max({largest, std::abs(x), std::abs(y)});
    }
    if (largest > kLeastSpread) scale_ = largest;
    // The axis of greatest spread of the covariance matrix [xx xy; xy yy].
    const double angle = 0.5 * elementary::atan2(2 * xy, xx - yy);
    along_x_ = elementary::cos(angle);
    along_y_ = elementary::sin(angle);
}

DriftFrame::Terms DriftFrame::terms(const PlanPosition& position) const {
    const double x = (position[0] - center_[0]) / scale_, y = (position[1] - center_[1]) / scale_;
    const double along = along_x_ * x + along_y_ * y, across = along_x_ * y - along_y_ * x;
    Terms terms(drift_terms(drift_));
    terms(0) = 1;
    if (drift_ == Drift::kConstant) return terms;
    // Terms along come first: of few points in one line the quadratic along it is kept.
    terms(1) = along;
    terms(2) = across;
    if (drift_ == Drift::kQuadratic) {
        terms(3) = along * along;
        terms(4) = along * across;
        terms(5) = across * across;
    }
    return terms;
}

Eigen::MatrixXd DriftFrame::terms(std::span<const PlanPosition> positions) const {
    Eigen::MatrixXd rows(std::ssize(positions), drift_terms(drift_));
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
        rows.row(i) = terms(positions[i]);
    return rows;
}

void DriftBasis::make(const Eigen::Ref<const Eigen::MatrixXd>& plain,
                      const Eigen::Ref<const Eigen::MatrixXd>& whitened) {
    const Eigen::Index rows = plain.rows(), terms = plain.cols();
    basis_.resize(rows, terms);
    plain_basis_.resize(rows, terms);
    size_ = 0;
    const double least = kLeastComponent * std::sqrt(static_cast<double>(rows));
    Eigen::VectorXd v;
    for (Eigen::Index term = 0; term < terms; ++term) {
        v = plain.col(term);
        make_orthogonal(plain_basis_, size_, v, [](Eigen::Index, double) {});
        const double left = v.norm();
        if (!(left > least)) continue;
        plain_basis_.col(size_) = v / left;

        v = whitened.col(term);
        upper_.col(size_).setZero();
        make_orthogonal(basis_, size_, v,
                        [&](Eigen::Index k, double component) { upper_(k, size_) += component; });
        const double length = v.norm();
        if (!(length > 1e-12 * whitened.col(term).norm())) continue;
        basis_.col(size_) = v / length;
        upper_(size_, size_) = length;
        term_[size_] = term;
        ++size_;
    }
}

DriftBasis::Coefficients DriftBasis::solve(const DriftFrame::Terms& terms) const {
    Coefficients out(size_);
    for (Eigen::Index k = 0; k < size_; ++k) {
        double sum = terms(term_[k]);
        for (Eigen::Index j = 0; j < k; ++j)
            sum -= upper_(j, k) * out(j);
        out(k) = sum / upper_(k, k);
    }
    return out;
}

}  // namespace realmodel::interpolation
