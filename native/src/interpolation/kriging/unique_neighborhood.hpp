// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "interpolation/drift_basis.hpp"
#include "interpolation/kriging/kriging_task.hpp"
#include "interpolation/kriging/neighbor_kriging.hpp"
#include "interpolation/kriging/tiled_cholesky.hpp"

namespace realmodel::interpolation {

/// Kriging of every node from all data, whose covariances are factored once.
class UniqueNeighborhood {
public:
    /// @param task          must outlive this
    /// @param factor_share  the progress goes up to this
    /// @throws Cancelled
    UniqueNeighborhood(const KrigingTask& task, double factor_share);

    /// What one thread works with.
    struct Scratch {
        Eigen::MatrixXd u;
        Eigen::VectorXd column;
        std::vector<spatial::Neighbor> near;
        NeighborKriging others;
    };
    Scratch scratch() const {
        return {{}, {}, {}, NeighborKriging(task_.data, task_.covariance, task_.options.drift)};
    }

    /// Right sides solved together: matrix products are fast.
    static constexpr Eigen::Index kNodesAtOnce = 64;

    /// Estimates the nodes begin .. end - 1 of the task at once, at most kNodesAtOnce.
    void krige(std::size_t begin, std::size_t end, Scratch& scratch) const;

    /// Estimates the points begin .. end - 1, each from the others.
    void leave_out(std::size_t begin, std::size_t end, Scratch& scratch) const;

private:
    const KrigingTask& task_;
    Eigen::Index count_;
    double base_;
    DriftFrame frame_;
    TiledCholesky factor_;
    DriftBasis basis_;
    Eigen::VectorXd t_;
    DriftBasis::Coefficients qt_;
};

}  // namespace realmodel::interpolation
