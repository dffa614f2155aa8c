// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/unique_neighborhood.hpp"

#include "interpolation/node_loop.hpp"

namespace realmodel::interpolation {

namespace {

constexpr int kMostOthers = 200;  // from which a point is estimated that the factor cannot estimate

std::vector<Position> positions_of(const LinearData& data) {
    std::vector<Position> positions;
    for (std::size_t i = 0; i < data.size(); ++i)
        positions.push_back(data.position(static_cast<std::int32_t>(i)));
    return positions;
}

std::int32_t number(Eigen::Index datum) {
    return static_cast<std::int32_t>(datum);
}

}  // namespace

UniqueNeighborhood::UniqueNeighborhood(const KrigingTask& task, double factor_share)
    : task_(task),
      count_(static_cast<Eigen::Index>(task.data.size())),
      base_(task.data.points().values[0]),
      frame_(positions_of(task.data), task.options.drift),
      factor_(
          count_,
          [&](Eigen::Index i, Eigen::Index j) {
              return i == j ? 1.0 : task.data.between(number(i), number(j), task.covariance);
          },
          kRedundantVariance, task.execution, factor_share) {
    const Eigen::Index terms = drift_terms(task.options.drift);
    Eigen::MatrixXd plain(count_, terms), given(count_, terms + 1);
    for (Eigen::Index p = 0; p < count_; ++p) {
        plain.row(p) = task.data.terms(number(p), frame_);
        given.row(p).head(terms) = plain.row(p);
        given(p, terms) = task.data.value(number(p), base_);
        if (factor_.left_out(p)) plain.row(p).setZero();
    }
    factor_.solve(given, task.execution.progress);
    basis_.make(plain, given.leftCols(terms));
    t_ = given.col(terms);
    qt_ = basis_.project(t_);
}

void UniqueNeighborhood::krige(std::size_t begin, std::size_t end, Scratch& scratch) const {
    Eigen::MatrixXd& u = scratch.u;
    // Always of one width, and columns at one alignment: sums are added in the same order then,
    // whichever nodes are estimated together.
    u.setZero(count_, kNodesAtOnce);
    for (std::size_t i = begin; i < end; ++i) {
        const Position node = task_.node(i);
        const auto column = static_cast<Eigen::Index>(i - begin);
        for (Eigen::Index p = 0; p < count_; ++p)
            u(p, column) =
                task_.data.with_height(node, number(p), task_.covariance, task_.sheet(i));
        if (cancelled(task_.execution.progress)) return;
    }
    factor_.solve(u, task_.execution.progress);
    for (std::size_t i = begin; i < end && !cancelled(task_.execution.progress); ++i) {
        const Position node = task_.node(i);
        const std::int32_t sheet = task_.sheet(i);
        task_.tree.find(node, task_.data.sheet_count(), scratch.near);
        const std::int32_t there = task_.point_there(scratch.near, sheet);
        if (there != NeighborSearch::kNobody) {
            task_.set(i, {task_.data.points().values[there], 0});
            continue;
        }
        Eigen::VectorXd& column = scratch.column;
        column = u.col(static_cast<Eigen::Index>(i - begin));
        const auto estimate = [&](double from) {
            return universal_kriging(from, column.squaredNorm(), column.dot(t_), basis_,
                                     task_.data.terms(node, sheet, frame_), basis_.project(column),
                                     qt_);
        };
        task_.set(i, task_.data.has_sheets()
                         ? in_heights(base_, task_.data.unit(sheet), estimate(0))
                         : estimate(base_));
    }
}

/// With B = C^-1 - C^-1 F (F^T C^-1 F)^-1 F^T C^-1 the error is (B z)_i / B_ii and its variance
/// 1 / B_ii (Dubrule 1983); column i of L^-1 gives both.
void UniqueNeighborhood::leave_out(std::size_t begin, std::size_t end, Scratch& scratch) const {
    Eigen::MatrixXd& u = scratch.u;
    u.setZero(count_, static_cast<Eigen::Index>(end - begin));
    for (std::size_t i = begin; i < end; ++i)
        u(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i - begin)) = 1;
    factor_.solve(u, task_.execution.progress);
    for (std::size_t i = begin; i < end && !cancelled(task_.execution.progress); ++i) {
        const auto column = u.col(static_cast<Eigen::Index>(i - begin));
        const DriftBasis::Coefficients qu = basis_.project(column);
        const double whole = column.squaredNorm(), b = whole - qu.squaredNorm();
        const double value = task_.data.points().values[i];
        const double unit = task_.data.unit(task_.sheet(i));
        if (b > 1e-9 * whole) {
            task_.set(i, {value - unit * (column.dot(t_) - qu.dot(qt_)) / b, unit * unit / b});
            continue;
        }
        // The point alone determines a term of the drift, or others determine the point.
        DataSearch search(task_.data, task_.tree, {kMostOthers, 0, 0});
        search.find(task_.node(i), scratch.near, task_.left_out(i));
        task_.set(i, scratch.near.empty()
                         ? unknown(value)
                         : scratch.others.at(task_.node(i), scratch.near, task_.sheet(i),
                                             task_.execution.progress));
    }
}

}  // namespace realmodel::interpolation
