// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/nearest_side.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "arrangement/edge_fan.hpp"
#include "arrangement/space_cells.hpp"
#include "base/algorithms.hpp"
#include "exact/orientation.hpp"
#include "exact/space_points.hpp"
#include "exact/triangle_distances.hpp"

namespace realmodel::cutting {

using spatial::Box;

namespace {

/// 1 where a triangle turns counter-clockwise seen from p, or p is in its plane; -1 else.
std::int8_t side_of(const std::array<Position, 3>& t, const Position& p) {
    std::optional<int> side = exact::orient3d_filter(t[0], t[1], t[2], p);
    if (!side) {
        exact::SpacePoints points;
        const std::array of{points.add(t[0]), points.add(t[1]), points.add(t[2]), points.add(p)};
        side = exact::orient3d(points, of[0], of[1], of[2], of[3]);
    }
    return *side < 0 ? kBelow : kAbove;
}

/// Whether the plane of a triangle may pass through a box.
bool plane_meets(const std::array<Position, 3>& triangle, const Box& box) {
    constexpr double kRounding = 0x1p-40;
    const Position& a = triangle[0];
    const Position normal = polygon_normal(triangle);
    double distance = 0, reach = 0, size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double off = (box.low[k] + box.high[k]) / 2 - a[k];
        distance += normal[k] * off;
        reach += std::abs(normal[k]) * (box.high[k] - box.low[k]) / 2;
        size += std::abs(normal[k] * off);
    }
    return std::abs(distance) <= reach + kRounding * size;
}

std::vector<Box> boxes_of(const Cutter& cutter) {
    return transformed(cutter.triangles, [&](const auto& t) {
        return spatial::bounding_box(t, [&](NodeId v) { return cutter.vertices[index(v)]; });
    });
}

}  // namespace

NearestSide::NearestSide(const Cutter& cutter, const Execution& execution)
    : cutter_(cutter), tree_(boxes_of(cutter), execution), border_(cutter.triangles.size(), 0) {
    if (cutter.is_closed) return;
    const auto edges = arrangement::edges_of(
        border_.size(),
        cutter.vertices.size(), [&](std::size_t t) -> const auto& { return cutter.triangles[t]; },
        execution);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges[e].size() != 1) continue;
        const auto t = index(edges[e][0].item);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& triangle = cutter.triangles[t];
            if (unordered(triangle[i], triangle[(i + 1) % 3]) == edges.ends(e))
                border_[t] |= static_cast<std::uint8_t>(1U << i);
        }
    }
}

/// The border edges of a triangle that may come as near to a point: bit i for that after corner i.
unsigned NearestSide::border_within(std::int32_t triangle, const Position& p,
                                    double distance) const {
    unsigned edges = border_[index(triangle)];
    const auto at = corners(triangle);
    for (std::size_t i = 0; i < 3; ++i) {
        const Position &from = at[i], &to = at[(i + 1) % 3];
        if ((edges >> i & 1U) != 0 && exact::distance_bounds(p, {from, to, to}).low > distance)
            edges &= ~(1U << i);
    }
    return edges;
}

std::int8_t NearestSide::operator()(const Position& p, bool* at_border) const {
    struct NearTriangle {
        double least_distance;
        std::int32_t number;
    };
    // mostly only one may be nearest, which needs no memory
    std::optional<NearTriangle> first;
    std::vector<NearTriangle> others;
    double least = HUGE_VAL;
    tree_.approach(
        p, [&least] { return least * least * (1 + 0x1p-40); },
        [&](std::int32_t t) {
            const auto [low, high] = exact::distance_bounds(p, corners(t));
            if (low > least) return;
            least = std::min(least, high);
            if (!first || (others.empty() && first->least_distance > least))
                first = {low, t};
            else
                others.push_back({low, t});
        });
    if (!first) return kAbove;
    const auto border_near = [&](std::int32_t t) {
        return at_border == nullptr ? 0U : border_within(t, p, least);
    };
    if (others.empty() && border_near(first->number) == 0)
        return side_of(corners(first->number), p);
    others.push_back(*first);
    std::ranges::sort(others, {}, &NearTriangle::number);
    std::vector<exact::MarkedTriangle> triangles;
    std::vector<std::int8_t> sides;
    for (const NearTriangle& one : others) {
        if (one.least_distance > least) continue;
        triangles.push_back({corners(one.number), border_near(one.number)});
        sides.push_back(side_of(triangles.back().corners, p));
    }
    const auto are_equal = [&sides] {
        return std::ranges::adjacent_find(sides, std::not_equal_to<>()) == sides.end();
    };
    const bool may_be_at_border =
        std::ranges::any_of(triangles, [](const auto& t) { return t.edges != 0; });
    if (!may_be_at_border && are_equal()) return sides[0];
    const auto nearest = exact::nearest_triangles(p, triangles);
    if (nearest.are_on_edge) *at_border = true;
    const auto only_nearest = [&nearest](auto& list) {
        list = transformed(nearest.numbers, [&list](std::size_t i) { return list[i]; });
    };
    only_nearest(sides);
    if (are_equal()) return sides[0];
    only_nearest(triangles);
    return sides[exact::farthest_plane(p, triangles)];
}

std::optional<std::int8_t> NearestSide::of_ball(const Position& center, double radius,
                                                bool& at_border) const {
    constexpr double kRounding = 0x1p-40;  // of lengths and of products of these
    double least = HUGE_VAL;
    tree_.approach(
        center, [&least] { return least * least * (1 + kRounding); },
        [&](std::int32_t t) {
            least = std::min(least, exact::distance_bounds(center, corners(t)).high);
        });
    if (!(radius < least)) return std::nullopt;
    // what is nearest to a position in the ball is no farther from its center than this
    const double reach = (least + 2 * radius) * (1 + kRounding);
    std::optional<std::int8_t> side;
    bool is_certain = true;
    tree_.approach(
        center, [&] { return is_certain ? reach * reach * (1 + kRounding) : -1.0; },
        [&](std::int32_t t) {
            const auto [a, b, c] = corners(t);
            if (exact::distance_bounds(center, {a, b, c}).low > reach) return;
            const Position ab = minus(b, a), ac = minus(c, a);
            const Position normal = cross(ab, ac), off = minus(center, a);
            const double distance = dot(normal, off);
            const double least_distance = radius * length(normal) + kRounding * length(ab) *
                                                                        length(ac) *
                                                                        (length(off) + radius);
            const std::int8_t triangle_side = distance < 0 ? kBelow : kAbove;
            is_certain &= std::abs(distance) > least_distance &&
                          side.value_or(triangle_side) == triangle_side;
            side = triangle_side;
            at_border = at_border || border_within(t, center, reach) != 0;
        });
    return is_certain ? side : std::nullopt;
}

bool NearestSide::is_near(const Box& box, double margin) const {
    Box around = box, wide = box;
    around.widen(margin);
    wide.widen(2 * margin);
    return tree_.any(wide, [&](std::int32_t t) { return plane_meets(corners(t), around); });
}

std::int8_t NearestSide::within(const Position& p) const {
    exact::SpacePoints points;
    return within(points, points.add(p), 2, false);
}

std::int8_t NearestSide::within(exact::SpacePoints& points, exact::SpacePointId p, std::size_t axis,
                                bool from_below) const {
    bool inside = false;
    tree_.find(arrangement::ray_box(points, p, axis), [&](std::int32_t t) {
        const auto corner = corners(t);
        const std::array of{points.add(corner[0]), points.add(corner[1]), points.add(corner[2])};
        if (exact::ray_crosses(points, axis, p, of, from_below) != 0) inside = !inside;
    });
    return inside ? kBelow : kAbove;
}

}  // namespace realmodel::cutting
