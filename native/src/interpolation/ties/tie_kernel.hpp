// SPDX-License-Identifier: GPL-3.0-or-later
// The kernel of corrections, and sums of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

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

/// The sum of kernels of one radius around centers with coefficients that are not 0.
class KernelSum {
public:
    /// @param sided  of each center, `faults` numbers
    KernelSum(std::span<const Position> positions, std::span<const double> sided,
              std::size_t faults, std::span<const double> coefficients, double radius);

    /// At a node: terms are added in an order that depends on the centers alone.
    double at(const SheetNode& node) const;

private:
    static std::vector<std::int32_t> that_count(std::span<const double> coefficients);
    std::vector<Position> own(std::span<const Position> positions) const;

    std::vector<std::int32_t> numbers_;
    std::span<const double> sided_, coefficients_;
    std::size_t faults_;
    double radius_;
    spatial::PointBins bins_;
};

}  // namespace realmodel::interpolation
