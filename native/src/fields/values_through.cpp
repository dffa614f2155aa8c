// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/fields/values_through.hpp"

#ifndef EIGEN_DONT_PARALLELIZE
#define EIGEN_DONT_PARALLELIZE
#endif
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstddef>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::fields {

namespace {

/// Of the share of a contact in its tetrahedron: where contacts share corners, none moves far.
constexpr double kLoose = 1e-2;
constexpr double kReached = 1e-12;  ///< of what contacts miss their levels by at first: nothing

/// The weights of contacts, a row for each, by those values alone that are corners.
using WeightMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// @param used  the places of the values that are corners, rising
WeightMatrix weights_of(const LevelsAtContacts& at, std::span<const std::int64_t> used) {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t contact = 0; contact < at.corners.size(); ++contact) {
        for (std::size_t i = 0; i < 4; ++i) {
            const auto place = std::ranges::lower_bound(used, at.corners[contact][i]);
            entries.emplace_back(static_cast<int>(contact), static_cast<int>(place - used.begin()),
                                 at.weights[contact][i]);
        }
    }
    WeightMatrix weights(std::ssize(at.corners), std::ssize(used));
    weights.setFromTriplets(entries.begin(), entries.end());
    return weights;
}

}  // namespace

ValuesThrough values_through(std::span<const double> initial, const LevelsAtContacts& at,
                             int rounds, const Execution& execution) {
    std::vector<std::int64_t> used;
    for (const auto& corners : at.corners)
        used.insert(used.end(), corners.begin(), corners.end());
    sort_unique(used);
    if (!used.empty() && (used.front() < 0 || used.back() >= std::ssize(initial)))
        throw InputError("option", "a corner is no value");
    const WeightMatrix weights = weights_of(at, used);
    Eigen::VectorXd values(std::ssize(used));
    for (std::size_t n = 0; n < used.size(); ++n)
        values[static_cast<Eigen::Index>(n)] = initial[index(used[n])];
    const Eigen::Map<const Eigen::VectorXd> levels(at.levels.data(), std::ssize(at.levels));
    Eigen::VectorXd missed = levels - weights * values;
    const double reached = kReached * missed.norm();
    Eigen::SparseMatrix<double> square(weights.cols(), weights.cols());
    square.setIdentity();
    square = kLoose * square + weights.transpose() * weights;
    if (execution.progress != nullptr) execution.progress->check();
    // contacts lie on surfaces: that is a graph of two dimensions, and the factor is small
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> moves(square);
    for (int round = 0; round < rounds && missed.norm() > reached; ++round) {
        if (execution.progress != nullptr) execution.progress->check();
        values += moves.solve(weights.transpose() * missed);
        missed = levels - weights * values;
    }
    ValuesThrough fitted{{initial.begin(), initial.end()}, {missed.begin(), missed.end()}};
    for (std::size_t n = 0; n < used.size(); ++n)
        fitted.values[index(used[n])] = values[static_cast<Eigen::Index>(n)];
    return fitted;
}

}  // namespace realmodel::fields
