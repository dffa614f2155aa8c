// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/ties/tie_kernel.hpp"

#include <algorithm>

#include "interpolation/node_loop.hpp"
#include "realmodel/interpolation/ties.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kOfBlock = 64;     // nodes, about: of larger blocks centers reach only some
constexpr std::size_t kMostBlocks = 16;  // that a thread does in a row

}  // namespace

NodeBlocks::NodeBlocks(std::span<const Position> nodes, std::span<const double> sided,
                       std::size_t faults)
    : nodes_(nodes), sided_(sided), faults_(faults) {
    const spatial::PlanTiles tiles(spatial::box_around(nodes), nodes.size() / kOfBlock + 1);
    blocks_ = bucketize<std::uint32_t>(tiles.size(), [&](const auto& put) {
        for (std::size_t i = 0; i < nodes.size(); ++i)
            put(tiles.tile_at(nodes[i]), static_cast<std::uint32_t>(i));
    });
}

NodeBlock NodeBlocks::operator[](std::size_t number) const {
    const std::span<const std::uint32_t> numbers = blocks_[number];
    const auto count = static_cast<Eigen::Index>(numbers.size());
    NodeBlock block{numbers, Eigen::ArrayXd(count), Eigen::ArrayXd(count),
                    Eigen::ArrayXXd(count, static_cast<Eigen::Index>(faults_)), spatial::kNoBox};
    for (Eigen::Index k = 0; k < count; ++k) {
        const std::uint32_t i = numbers[static_cast<std::size_t>(k)];
        const auto& [x, y] = nodes_[i];
        block.x[k] = x;
        block.y[k] = y;
        block.box = block.box.united({x, y, x, y});
        for (std::size_t fault = 0; fault < faults_; ++fault)
            block.sided(k, static_cast<Eigen::Index>(fault)) = sided_[i * faults_ + fault];
    }
    return block;
}

KernelSum::KernelSum(std::span<const Position> positions, std::span<const double> sided,
                     std::size_t faults, std::span<const double> coefficients, double radius)
    : numbers_(that_count(coefficients)),
      positions_(positions),
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

std::vector<std::size_t> KernelSum::near(const NodeBlock& block) const {
    std::vector<std::size_t> found;
    bins_.within(block.box.widened(radius_), [&](std::size_t number, const Position& p) {
        const double dx = std::max({block.box.low_x - p[0], p[0] - block.box.high_x, 0.0}),
                     dy = std::max({block.box.low_y - p[1], p[1] - block.box.high_y, 0.0});
        if (dx * dx + dy * dy < radius_ * radius_)
            found.push_back(static_cast<std::size_t>(numbers_[number]));
    });
    std::sort(found.begin(), found.end());
    return found;
}

Eigen::ArrayXd KernelSum::at(const NodeBlock& block) const {
    Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(block.x.size());
    Eigen::ArrayXd share(sum.size()), value(sum.size());
    for (const std::size_t i : near(block)) {
        const auto& [x, y] = positions_[i];
        share = ((block.x - x).square() + (block.y - y).square()).sqrt() / radius_;
        value = (1 - share).max(0).square().square() * (4 * share + 1);
        for (std::size_t fault = 0; fault < faults_; ++fault)
            value *=
                1 + block.sided.col(static_cast<Eigen::Index>(fault)) * sided_[i * faults_ + fault];
        sum += coefficients_[i] * value;
    }
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
    const NodeBlocks blocks(nodes, sided, faults);
    const NodeLoop loop{blocks.size(), kMostBlocks, execution};
    loop.over_nodes([] { return 0; },
                    [&](int, std::size_t number) {
                        const NodeBlock block = blocks[number];
                        Eigen::ArrayXd correction = Eigen::ArrayXd::Zero(block.x.size());
                        for (const KernelSum& sum : sums)
                            correction += sum.at(block);
                        for (std::size_t k = 0; k < block.numbers.size(); ++k)
                            z[block.numbers[k]] += correction[static_cast<Eigen::Index>(k)];
                    });
    return z;
}

}  // namespace realmodel::interpolation
