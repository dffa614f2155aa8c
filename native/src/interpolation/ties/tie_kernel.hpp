// SPDX-License-Identifier: GPL-3.0-or-later
// The kernel of corrections, and sums of it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/vectors.hpp"
#include "interpolation/data_points.hpp"
#include "spatial/point_bins.hpp"

namespace realmodel::interpolation {

/// A node of a sheet. sided: the sheet's side of each fault times the fault's weight at the node.
struct SheetNode {
    Position position;
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

/// Nodes that lie close together.
struct NodeBlock {
    std::span<const std::uint32_t> numbers;
    Eigen::ArrayXd x, y;
    Eigen::ArrayXXd sided;  ///< a column for each fault
    spatial::PlanBox box;
};

/// Nodes of a sheet, as SheetNode, in blocks.
class NodeBlocks {
public:
    /// @param sided  of each node, `faults` numbers
    NodeBlocks(std::span<const Position> nodes, std::span<const double> sided, std::size_t faults);

    std::size_t size() const { return blocks_.size(); }
    NodeBlock operator[](std::size_t number) const;

private:
    std::span<const Position> nodes_;
    std::span<const double> sided_;
    std::size_t faults_;
    Buckets<std::uint32_t> blocks_;
};

/// The sum of kernels of one radius around centers with coefficients that are not 0.
class KernelSum {
public:
    /// @param sided  of each center, `faults` numbers
    KernelSum(std::span<const Position> positions, std::span<const double> sided,
              std::size_t faults, std::span<const double> coefficients, double radius);

    /// At the nodes of a block: terms are added in the order of the centers, so each node has the
    /// same bytes in any block.
    Eigen::ArrayXd at(const NodeBlock& block) const;

private:
    static std::vector<std::int32_t> that_count(std::span<const double> coefficients);
    std::vector<Position> own(std::span<const Position> positions) const;
    /// The centers that may reach a block, ascending.
    std::vector<std::size_t> near(const NodeBlock& block) const;

    std::vector<std::int32_t> numbers_;
    std::span<const Position> positions_;
    std::span<const double> sided_, coefficients_;
    std::size_t faults_;
    double radius_;
    spatial::PointBins bins_;
};

}  // namespace realmodel::interpolation
