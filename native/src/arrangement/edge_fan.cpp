// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/edge_fan.hpp"

#include <cassert>
#include <numeric>

#include "exact/space_predicates.hpp"

namespace realmodel::arrangement {

EdgeFan fan_around(const exact::SpacePoints& points, exact::SpacePointId a, exact::SpacePointId b,
                   std::span<const HalfPlane> items) {
    assert(!items.empty());
    // the view in which the first is not seen from its edge
    std::size_t axis = 0;
    const auto turn = [&](std::size_t i) {
        return exact::orient2d(points, axis, a, b, items[i].towards);
    };
    while (axis < 2 && turn(0) == 0)
        ++axis;
    const int first_turn = turn(0);
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
    std::vector<int> quarter;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (const int side = orientation(0, i)) {
            quarter.push_back(side < 0 ? 1 : 3);
            continue;
        }
        const bool same =
            share_plane(0, i) ? items[i].direction == items[0].direction : turn(i) == first_turn;
        quarter.push_back(same ? 0 : 2);
    }
    const auto compare = [&](std::size_t i, std::size_t j) {
        if (quarter[i] != quarter[j]) return quarter[i] - quarter[j];
        return quarter[i] % 2 == 0 ? 0 : orientation(i, j);
    };
    EdgeFan fan;
    fan.order.resize(items.size());
    std::iota(fan.order.begin(), fan.order.end(), std::size_t{0});
    std::stable_sort(fan.order.begin(), fan.order.end(),
                     [&](std::size_t i, std::size_t j) { return compare(i, j) < 0; });
    for (std::size_t i = 1; i <= fan.order.size(); ++i) {
        if (i == fan.order.size() || compare(fan.order[i - 1], fan.order[i]) != 0)
            fan.blade_begins.push_back(i);
    }
    return fan;
}

}  // namespace realmodel::arrangement
