// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/edge_fan.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>

#include "exact/space_points.hpp"

namespace realmodel::arrangement {

void find_fan(const exact::SpacePoints& points, exact::SpacePointId a, exact::SpacePointId b,
              std::span<const HalfPlane> items, EdgeFan& fan) {
    assert(!items.empty());
    // in the view in which the first is not seen from its edge
    const auto turns_as_first = [&](std::size_t i) {
        const auto turn = [&](std::size_t axis, std::size_t item) {
            return exact::orient2d(points, axis, a, b, items[item].towards);
        };
        std::size_t axis = 0;
        while (axis < 2 && turn(axis, 0) == 0)
            ++axis;
        return turn(axis, i) == turn(axis, 0);
    };
    // what is known to lie in one plane needs no arithmetic
    const auto share_plane = [&](std::size_t i, std::size_t j) {
        return items[i].plane >= 0 && items[i].plane == items[j].plane;
    };
    const auto orientation = [&](std::size_t i, std::size_t j) {
        return share_plane(i, j)
                   ? 0
                   : exact::orient3d(points, a, b, items[i].towards, items[j].towards);
    };
    // in the direction of the first (0), in the half from there (1), against it (2), in the other
    constexpr std::size_t kOnStack = 8;
    std::array<int, kOnStack> few{};
    std::vector<int> many(items.size() > kOnStack ? items.size() : 0);
    int* const quarter = items.size() > kOnStack ? many.data() : few.data();
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (const int side = orientation(0, i)) {
            quarter[i] = side < 0 ? 1 : 3;
            continue;
        }
        const bool same =
            share_plane(0, i) ? items[i].direction == items[0].direction : turns_as_first(i);
        quarter[i] = same ? 0 : 2;
    }
    const auto compare = [&](std::size_t i, std::size_t j) {
        if (quarter[i] != quarter[j]) return quarter[i] - quarter[j];
        return quarter[i] % 2 == 0 ? 0 : orientation(i, j);
    };
    fan.order.resize(items.size());
    std::iota(fan.order.begin(), fan.order.end(), std::size_t{0});
    if (items.size() > kOnStack) {
        std::stable_sort(fan.order.begin(), fan.order.end(),
                         [&](std::size_t i, std::size_t j) { return compare(i, j) < 0; });
    } else {  // by insertion, which takes no memory
        for (std::size_t i = 1; i < items.size(); ++i) {
            for (std::size_t k = i; k > 0 && compare(fan.order[k], fan.order[k - 1]) < 0; --k)
                std::swap(fan.order[k], fan.order[k - 1]);
        }
    }
    fan.half_plane_begins.assign(1, 0);
    for (std::size_t i = 1; i <= fan.order.size(); ++i) {
        if (i == fan.order.size() || compare(fan.order[i - 1], fan.order[i]) != 0)
            fan.half_plane_begins.push_back(i);
    }
    assert(quarter[fan.order.front()] == 0 && fan.half_plane_begins.back() == items.size());
}

}  // namespace realmodel::arrangement
