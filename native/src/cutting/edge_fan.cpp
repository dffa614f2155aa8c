// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/edge_fan.hpp"

#include <algorithm>
#include <numeric>

namespace realmodel::cutting {

namespace {

/// The corner of a face that is farthest from the line of one of its edges, as an exact point.
NodeId far_corner(SurfaceOverlay& overlay, std::size_t face, const std::array<NodeId, 2>& edge) {
    const Position a = overlay.position(edge[0]), b = overlay.position(edge[1]);
    NodeId found = edge[0];
    double farthest = -1;
    for (const NodeId v : overlay.model().face(face)) {
        const std::array corners{a, b, overlay.position(v)};
        const Position normal = polygon_normal(corners);
        const double away = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
        if (away > farthest) {
            farthest = away;
            found = v;
        }
    }
    return overlay.exact(found);
}

}  // namespace

EdgeFan fan_of(SurfaceOverlay& overlay, std::span<const EdgeUse> uses) {
    ExactPoints& points = overlay.points();
    const NodeId a = overlay.exact(uses[0].edge[0]), b = overlay.exact(uses[0].edge[1]);
    std::vector<NodeId> towards;
    for (const EdgeUse& use : uses) {
        if (index(use.item) >= overlay.size()) {
            towards.push_back(far_corner(overlay, index(use.item) - overlay.size(), use.edge));
        } else {
            towards.push_back(use.direction > 0 ? overlay.left_corner(index(use.item), a, b)
                                                : overlay.left_corner(index(use.item), b, a));
        }
    }
    // in the direction of the first, in the half turn from there, against it, in the other half
    std::size_t axis = 0;
    while (axis < 2 && points.turn(axis, a, b, towards[0]) == 0)
        ++axis;
    const int first_turn = points.turn(axis, a, b, towards[0]);
    // what is known to lie in one plane needs no arithmetic
    const auto are_level = [&](std::size_t i, std::size_t j) {
        return index(uses[i].item) < overlay.size() && index(uses[j].item) < overlay.size() &&
               overlay.are_of_one_triangle(index(uses[i].item), index(uses[j].item));
    };
    const auto orientation = [&](std::size_t i, std::size_t j) {
        return are_level(i, j) ? 0 : points.orientation(a, b, towards[i], towards[j]);
    };
    std::vector<int> quarter;
    for (std::size_t i = 0; i < uses.size(); ++i) {
        const NodeId p = towards[i];
        const int o = orientation(0, i);
        if (o != 0) {
            quarter.push_back(o < 0 ? 1 : 3);
        } else if (are_level(0, i)) {
            quarter.push_back(uses[i].direction == uses[0].direction ? 0 : 2);
        } else {
            quarter.push_back(points.turn(axis, a, b, p) == first_turn ? 0 : 2);
        }
    }
    const auto compare = [&](std::size_t i, std::size_t j) {
        if (quarter[i] != quarter[j]) return quarter[i] - quarter[j];
        return quarter[i] % 2 == 0 ? 0 : orientation(i, j);
    };
    EdgeFan fan;
    fan.order.resize(uses.size());
    std::iota(fan.order.begin(), fan.order.end(), std::size_t{0});
    std::stable_sort(fan.order.begin(), fan.order.end(),
                     [&](std::size_t i, std::size_t j) { return compare(i, j) < 0; });
    for (std::size_t i = 1; i <= fan.order.size(); ++i) {
        if (i == fan.order.size() || compare(fan.order[i - 1], fan.order[i]) != 0)
            fan.blade_begins.push_back(i);
    }
    return fan;
}

}  // namespace realmodel::cutting
