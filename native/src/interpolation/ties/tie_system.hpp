// SPDX-License-Identifier: GPL-3.0-or-later
// The system of the corrections that rows ask for.
#pragma once

#include <Eigen/SparseCholesky>
#include <cstdint>
#include <span>
#include <vector>

#include "interpolation/ties/tie_rows.hpp"

namespace realmodel::interpolation {

/// The products of rows, factored.
class TieSystem {
public:
    /// @param members  numbers of rows
    /// @param ridge    is added to the diagonal, as a share of it
    TieSystem(const TieRows& rows, std::span<const std::int32_t> members, double radius,
              double ridge);

    /// The places in `members` of rows of which others leave less than a share, ascending.
    std::vector<std::int32_t> dependent(double share) const;
    /// The same, of which others leave no more than a number.
    std::vector<std::int32_t> below(double least) const;
    /// The product of the rows at two places in `members`, as a share of theirs with themselves.
    double likeness(std::int32_t a, std::int32_t b) const;
    /// The places in `members` of rows that have a product with one.
    std::vector<std::int32_t> related(std::int32_t at) const;
    Eigen::VectorXd solve(const Eigen::VectorXd& right) const { return factor_.solve(right); }

private:
    /// What those that are eliminated before leave of each row.
    Eigen::VectorXd pivots() const;

    using Matrix = Eigen::SparseMatrix<double>;  // lower triangle

    Matrix matrix_;
    Eigen::SimplicialLDLT<Matrix> factor_;
};

/// The places in `members` of rows that the nodes of the mesh cannot honor beside the others: of
/// their squares, between a third and 1, others leave less than `least`. Rows at a node itself come
/// first.
std::vector<std::int32_t> crowded_members(const TieRows& rows,
                                          std::span<const std::int32_t> members, double least);

}  // namespace realmodel::interpolation
