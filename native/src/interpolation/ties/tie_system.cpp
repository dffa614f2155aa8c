// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/ties/tie_system.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "base/keep_single.hpp"
#include "spatial/point_bins.hpp"

namespace realmodel::interpolation {

namespace {

constexpr double kRidge = 1e-9;  // of the diagonal: no pivot is 0

}  // namespace

TieSystem::TieSystem(const TieRows& rows, std::span<const std::int32_t> members, double radius,
                     double ridge) {
    std::vector<Position> corners;  // three for each member
    for (const std::int32_t member : members)
        for (const std::int32_t corner : rows.rows[member].corners)
            corners.push_back(rows.positions[corner]);
    const spatial::PointBins bins(corners);
    const auto count = static_cast<std::int32_t>(members.size());
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<std::int32_t> near;
    for (std::int32_t b = 0; b < count; ++b) {
        near.clear();
        const TieRow& row = rows.rows[members[b]];
        for (const std::int32_t corner : row.corners) {
            const auto& [x, y] = rows.positions[corner];
            bins.within({x - radius, y - radius, x + radius, y + radius},
                        [&](std::size_t number, const Position&) {
                            const auto a = static_cast<std::int32_t>(number / 3);
                            if (a >= b) near.push_back(a);
                        });
        }
        sort_unique(near);
        for (const std::int32_t a : near) {
            const double value = rows.product(rows.rows[members[a]], row, radius);
            if (value != 0) entries.emplace_back(a, b, a == b ? value * (1 + ridge) : value);
        }
    }
    matrix_.resize(count, count);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    factor_.compute(matrix_);
}

std::vector<std::int32_t> TieSystem::dependent(double share) const {
    const Eigen::VectorXd left = pivots();
    std::vector<std::int32_t> found;
    for (Eigen::Index i = 0; i < left.size(); ++i)
        if (!(left[i] > share * matrix_.coeff(i, i))) found.push_back(static_cast<std::int32_t>(i));
    return found;
}

std::vector<std::int32_t> TieSystem::below(double least) const {
    const Eigen::VectorXd left = pivots();
    std::vector<std::int32_t> found;
    for (Eigen::Index i = 0; i < left.size(); ++i)
        if (!(left[i] > least)) found.push_back(static_cast<std::int32_t>(i));
    return found;
}

Eigen::VectorXd TieSystem::pivots() const {
    const auto& place = factor_.permutationP().indices();
    Eigen::VectorXd found(matrix_.cols());
    for (Eigen::Index i = 0; i < found.size(); ++i)
        found[i] = factor_.vectorD()[place[i]];
    return found;
}

double TieSystem::likeness(std::int32_t a, std::int32_t b) const {
    const double product = matrix_.coeff(std::max(a, b), std::min(a, b));
    return std::abs(product) / std::sqrt(matrix_.coeff(a, a) * matrix_.coeff(b, b));
}

std::vector<std::int32_t> TieSystem::related(std::int32_t at) const {
    std::vector<std::int32_t> found;
    for (std::int32_t column = 0; column < at; ++column)
        if (matrix_.coeff(at, column) != 0) found.push_back(column);
    for (Matrix::InnerIterator entry(matrix_, at); entry; ++entry)
        if (entry.row() != at) found.push_back(static_cast<std::int32_t>(entry.row()));
    return found;
}

std::vector<std::int32_t> crowded_members(const TieRows& rows,
                                          std::span<const std::int32_t> members, double least) {
    std::vector<bool> is_met(rows.positions.size(), false);
    const auto is_at_node = [](const TieRow& row) {
        return *std::max_element(row.weights.begin(), row.weights.end()) == 1;
    };
    for (const std::int32_t member : members) {
        const TieRow& row = rows.rows[member];
        for (std::size_t k = 0; k < 3 && is_at_node(row); ++k)
            if (row.weights[k] == 1) is_met[row.corners[k]] = true;
    }
    TieRows rest = rows;
    std::vector<std::int32_t> left, places, crowded;
    for (std::size_t i = 0; i < members.size(); ++i) {
        TieRow& row = rest.rows[members[i]];
        if (is_at_node(row)) continue;
        double square = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            if (is_met[row.corners[k]]) row.weights[k] = 0;
            square += row.weights[k] * row.weights[k];
        }
        if (square > least) {
            left.push_back(members[i]);
            places.push_back(static_cast<std::int32_t>(i));
        } else {
            crowded.push_back(static_cast<std::int32_t>(i));
        }
    }
    if (!left.empty()) {
        for (const std::int32_t at : TieSystem(rest, left, DBL_MIN, kRidge).below(least))
            crowded.push_back(places[at]);
    }
    std::sort(crowded.begin(), crowded.end());
    return crowded;
}

}  // namespace realmodel::interpolation
