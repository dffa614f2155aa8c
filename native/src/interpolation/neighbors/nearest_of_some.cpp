// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/neighbors/nearest_of_some.hpp"

#include <algorithm>
#include <cmath>

#include "base/algorithms.hpp"
#include "interpolation/node_loop.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kBetweenChecks = 1 << 16;

/// The `count` nearest of `among`, with numbers in it.
std::vector<spatial::Neighbor> nearest_among(std::span<const Position> among,
                                             const DistinctPoints& positions,
                                             std::span<const std::int32_t> asked, std::size_t count,
                                             int threads) {
    const spatial::NearestPoints tree(among);
    std::vector<spatial::Neighbor> out(asked.size() * count);
    const NodeLoop loop{asked.size(), 64, {threads, nullptr}};
    loop.over_nodes([] { return std::vector<spatial::Neighbor>(); },
                    [&](std::vector<spatial::Neighbor>& found, std::size_t k) {
                        tree.find(positions.at(static_cast<std::size_t>(asked[k])), count, found);
                        std::copy(found.begin(), found.end(), out.begin() + k * count);
                    });
    return out;
}

/// The nearest so far of each that is asked, no farther than a distance.
class NearestOfAsked {
public:
    /// @param bounds  squared distances that `count` points do not exceed
    NearestOfAsked(const std::vector<Position>& asked, std::size_t count,
                   std::vector<double> bounds)
        : asked_(asked),
          count_(count),
          bounds_(std::move(bounds)),
          filled_(asked.size()),
          found_(asked.size() * count),
          tree_(boxes()) {}

    void meet(const Position& position, std::int32_t number) {
        const spatial::Box box{{position[0], position[1], 0}, {position[0], position[1], 0}};
        tree_.find(box, [&](std::int32_t k) { add(k, position, number); });
    }
    std::vector<spatial::Neighbor> taken() { return std::move(found_); }

private:
    std::vector<spatial::Box> boxes() const {
        std::vector<spatial::Box> out;
        for (std::size_t k = 0; k < asked_.size(); ++k) {
            const auto& [x, y] = asked_[k];
            const double reach = std::sqrt(bounds_[k]) * (1 + 1e-9) + 1e-150;
            const double slack = 1e-15 * std::max(std::abs(x), std::abs(y));
            out.push_back({{x - reach - slack, y - reach - slack, 0},
                           {x + reach + slack, y + reach + slack, 0}});
        }
        return out;
    }
    void add(std::size_t k, const Position& position, std::int32_t number) {
        const double dx = asked_[k][0] - position[0], dy = asked_[k][1] - position[1];
        const spatial::Neighbor added{dx * dx + dy * dy, number};
        if (added.squared_distance > bounds_[k]) return;
        spatial::Neighbor* const row = found_.data() + k * count_;
        std::size_t& filled = filled_[k];
        if (filled == count_) {
            if (!(added < row[filled - 1])) return;
            --filled;
        }
        std::size_t i = filled++;
        for (; i > 0 && added < row[i - 1]; --i)
            row[i] = row[i - 1];
        row[i] = added;
        if (filled == count_) bounds_[k] = row[filled - 1].squared_distance;
    }

    const std::vector<Position>& asked_;
    std::size_t count_;
    std::vector<double> bounds_;
    std::vector<std::size_t> filled_;
    std::vector<spatial::Neighbor> found_;
    spatial::BoxTree tree_;
};

}  // namespace

std::vector<spatial::Neighbor> nearest_of_some(const DistinctPoints& positions,
                                               std::span<const std::int32_t> asked,
                                               std::size_t count, const Execution& execution,
                                               std::size_t most) {
    count = std::min(count, positions.size);
    most = std::max(most, count);
    const std::vector<std::int32_t> part = even_part(positions.size, most);
    const auto at = [&](std::int32_t i) { return positions.at(static_cast<std::size_t>(i)); };
    const std::vector<Position> among = transformed(part, at);
    std::vector<spatial::Neighbor> found =
        nearest_among(among, positions, asked, count, execution.threads);
    if (part.size() == positions.size) return found;
    std::vector<double> bounds;
    for (std::size_t k = 0; k < asked.size(); ++k)
        bounds.push_back(found[(k + 1) * count - 1].squared_distance);
    const std::vector<Position> places = transformed(asked, at);
    NearestOfAsked nearest(places, count, std::move(bounds));
    for (std::size_t i = 0; i < positions.size; ++i) {
        if (i % kBetweenChecks == 0 && execution.progress != nullptr) execution.progress->check();
        nearest.meet(positions.at(i), static_cast<std::int32_t>(i));
    }
    return nearest.taken();
}

}  // namespace realmodel::interpolation
