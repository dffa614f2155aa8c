// SPDX-License-Identifier: GPL-3.0-or-later
// The kernel of corrections, and sums of it.
// Heights in triangles, as sums of heights of nodes.
// The system of the corrections that rows ask for.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vectors.hpp"
#include "interpolation/data_points.hpp"
#include "realmodel/interpolation/ties.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::interpolation {

/// The range of finite heights.
struct DataRange {
    double low = HUGE_VAL, high = -HUGE_VAL;

    void add(double z) {
        if (!std::isfinite(z)) return;
        low = std::min(low, z);
        high = std::max(high, z);
    }
    double size() const { return high - low; }
};

/// A node of a sheet. sided: the sheet's side of each fault times the fault's weight at the node.
struct SheetNode {
    PlanPosition position;
    std::span<const double> sided;
};

/// Wendland's function of smoothness 2, which is 0 from `radius` on, between two nodes of sheets:
/// as large again for each fault on whose one side both are, 0 across a fault of full weight.
inline double tie_kernel(const SheetNode& a, const SheetNode& b, double radius) {
    const double share = length(minus(a.position, b.position)) / radius;
    if (!(share < 1)) return 0;
    const double left = 1 - share, squared = left * left;
    double value = squared * squared * (4 * share + 1);
    for (std::size_t fault = 0; fault < a.sided.size(); ++fault)
        value *= 1 + a.sided[fault] * b.sided[fault];
    return value;
}

/// The sum of kernels of one radius around centers with coefficients that are not 0.
class KernelSum {
public:
    /// @param sided  of each center, `faults` numbers
    KernelSum(std::span<const PlanPosition> positions, std::span<const double> sided,
              std::size_t faults, std::span<const double> coefficients, double radius);

    double at(const SheetNode& node) const;

private:
    std::span<const double> sided_, coefficients_;
    std::size_t faults_;
    double radius_;
    std::vector<std::size_t> numbers_;  // of the centers in the bins
    spatial::PointBins bins_;
};

/// A height that is asked for in a triangle. corners: numbers of centers.
struct TieRow {
    std::array<std::int32_t, 3> corners{};
    std::array<double, 3> weights{};
    double lower = 0, upper = 0;
    double shortest_edge = 0;
    bool is_known = false;  ///< there is a triangle with heights

    bool is_contact() const { return lower == upper; }
    /// Linear in the triangle, as heights_on_surface has it.
    double value(std::span<const double> z) const {
        const double base = z[corners[0]];
        double sum = base;
        for (std::size_t k = 1; k < 3; ++k)
            sum += weights[k] * (z[corners[k]] - base);
        return sum;
    }
};

/// The rows of data, and their corners, the centers of kernels.
struct TieRows {
    std::vector<TieRow> rows;
    std::vector<PlanPosition> positions;  ///< of centers
    std::vector<double> sided, heights;
    std::size_t faults = 0;
    double area = 0;  ///< of the mesh

    TieRows(const TiedSheets& sheets, const TieData& data);

    SheetNode center(std::int32_t number) const {
        const auto i = static_cast<std::size_t>(number);
        return {positions[i], std::span(sided).subspan(i * faults, faults)};
    }
    /// The scalar product of two rows.
    double product(const TieRow& a, const TieRow& b, double radius) const;
};

/// The products of rows, factored.
class TieSystem {
public:
    /// @param members  numbers of rows
    /// @param ridge    is added to the diagonal, as a share of it
    TieSystem(const TieRows& rows, std::span<const std::int32_t> members, double radius,
              double ridge);

    /// The places in `members` of rows of which others leave no more than a share and a number,
    /// ascending.
    std::vector<std::int32_t> dependent(double share, double least = 0) const;
    /// The product of the rows at two places in `members`, as a share of theirs with themselves.
    double likeness(std::int32_t a, std::int32_t b) const;
    /// The places in `members` of rows that have a product with one.
    std::vector<std::int32_t> related(std::int32_t at) const;
    Eigen::VectorXd solve(const Eigen::VectorXd& right) const { return factor_.solve(right); }

private:
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
