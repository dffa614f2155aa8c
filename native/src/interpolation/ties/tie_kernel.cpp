// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/ties/tie_kernel.hpp"

#include <algorithm>

#include "interpolation/node_loop.hpp"
#include "realmodel/interpolation/ties.hpp"

namespace realmodel::interpolation {

KernelSum::KernelSum(std::span<const Position> positions, std::span<const double> sided,
                     std::size_t faults, std::span<const double> coefficients, double radius)
    : numbers_(that_count(coefficients)),
      sided_(sided),
      coefficients_(coefficients),
      faults_(faults),
      radius_(radius),
      bins_(own(positions)) {}

std::vector<std::int32_t> KernelSum::that_count(std::span<const double> coefficients) {
    std::vector<std::int32_t> numbers;
    for (std::size_t i = 0; i < coefficients.size(); ++i)
        if (coefficients[i] != 0) numbers.push_back(static_cast<std::int32_t>(i));
    return numbers;
}

std::vector<Position> KernelSum::own(std::span<const Position> positions) const {
    std::vector<Position> found;
    found.reserve(numbers_.size());
    for (const std::int32_t i : numbers_)
        found.push_back(positions[i]);
    return found;
}

double KernelSum::at(const SheetNode& node) const {
    const auto& [x, y] = node.position;
    double sum = 0;
    bins_.within({x - radius_, y - radius_, x + radius_, y + radius_},
                 [&](std::size_t number, const Position& p) {
                     const auto i = static_cast<std::size_t>(numbers_[number]);
                     const SheetNode center{p, sided_.subspan(i * faults_, faults_)};
                     sum += coefficients_[i] * tie_kernel(node, center, radius_);
                 });
    return sum;
}

std::vector<double> tied_heights(std::span<const double> heights, std::span<const Position> nodes,
                                 std::span<const double> sided, const TieTerms& terms,
                                 const Execution& execution) {
    std::vector<double> z(heights.begin(), heights.end());
    const std::size_t count = terms.positions.size();
    if (count == 0) return z;
    const std::size_t faults = terms.sided.size() / count;
    std::vector<KernelSum> sums;
    for (std::size_t level = 0; level < terms.radii.size(); ++level) {
        const auto own = std::span(terms.coefficients).subspan(level * count, count);
        if (std::all_of(own.begin(), own.end(), [](double c) { return c == 0; })) continue;
        sums.emplace_back(terms.positions, terms.sided, faults, own, terms.radii[level]);
    }
    const NodeLoop loop{nodes.size(), 1024, execution};
    loop.over_nodes([] { return 0; },
                    [&](int, std::size_t i) {
                        const SheetNode node{nodes[i], sided.subspan(i * faults, faults)};
                        double correction = 0;
                        for (const KernelSum& sum : sums)
                            correction += sum.at(node);
                        z[i] += correction;
                    });
    return z;
}

}  // namespace realmodel::interpolation
