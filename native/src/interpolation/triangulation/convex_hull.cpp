// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/convex_hull.hpp"

#include <algorithm>
#include <numeric>

#include "base/algorithms.hpp"
#include "exact/orientation.hpp"
#include "interpolation/data_points.hpp"
#include "interpolation/node_loop.hpp"

namespace realmodel::interpolation {

ConvexHull::ConvexHull(std::vector<PlanPosition> positions) {
    sort_unique(positions);
    const auto add = [](std::vector<PlanPosition>& chain, const PlanPosition& position,
                        int outward) {
        while (chain.size() > 1 &&
               exact::orient2d(chain[chain.size() - 2], chain.back(), position) != -outward) {
            chain.pop_back();
        }
        chain.push_back(position);
    };
    for (const PlanPosition& position : positions) {
        add(lower_, position, -1);
        add(upper_, position, 1);
    }
}

bool ConvexHull::contains(const PlanPosition& position) const {
    if (lower_.empty() || position[0] < lower_.front()[0] || position[0] > lower_.back()[0])
        return false;
    const auto left_of = [](const PlanPosition& a, double x) { return a[0] < x; };
    const auto right_of = [](double x, const PlanPosition& a) { return x < a[0]; };
    const auto low = std::lower_bound(lower_.begin(), lower_.end(), position[0], left_of);
    if ((*low)[0] == position[0] ? position[1] < (*low)[1]
                                 : exact::orient2d(*(low - 1), *low, position) < 0) {
        return false;
    }
    const auto beyond = std::upper_bound(upper_.begin(), upper_.end(), position[0], right_of);
    const PlanPosition& before = *(beyond - 1);
    return before[0] == position[0] ? position[1] <= before[1]
                                    : exact::orient2d(before, *beyond, position) <= 0;
}

std::vector<std::int32_t> hull_border(std::span<const PlanPosition> positions) {
    std::vector<std::int32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0);
    const auto at = [&](std::int32_t i) { return positions[static_cast<std::size_t>(i)]; };
    std::ranges::sort(order, {}, at);
    if (order.size() < 3) return order;
    const auto turn = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
        return exact::orient2d(at(a), at(b), at(c));
    };
    const auto is_in_line = [&](std::int32_t i) {
        return turn(order.front(), order.back(), i) == 0;
    };
    if (std::all_of(order.begin(), order.end(), is_in_line)) return order;
    std::vector<std::int32_t> border;
    const auto add_chain = [&](auto first, auto last) {
        const std::size_t begin = border.size();
        for (; first != last; ++first) {
            while (border.size() > begin + 1 &&
                   turn(border[border.size() - 2], border.back(), *first) < 0)
                border.pop_back();
            border.push_back(*first);
        }
        border.pop_back();  // where the other chain begins
    };
    add_chain(order.begin(), order.end());
    add_chain(order.rbegin(), order.rend());
    return border;
}

std::vector<std::uint8_t> outside_hull(std::span<const std::array<double, 3>> points,
                                       std::span<const std::array<double, 2>> nodes,
                                       const Execution& execution) {
    require_finite_nodes(nodes);
    auto positions = transformed(points, [](const auto& p) { return PlanPosition{p[0], p[1]}; });
    require_finite_nodes(positions);
    const ConvexHull hull(std::move(positions));
    std::vector<std::uint8_t> outside(nodes.size());
    const NodeLoop loop{nodes.size(), 4096, execution};
    loop.over_nodes([] { return 0; },
                    [&](int, std::size_t i) { outside[i] = hull.contains(nodes[i]) ? 0 : 1; });
    return outside;
}

}  // namespace realmodel::interpolation
