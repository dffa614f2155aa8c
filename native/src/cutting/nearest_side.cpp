// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/nearest_side.hpp"

#include <algorithm>
#include <cmath>

#include "arrangement/edge_fan.hpp"
#include "arrangement/space_cells.hpp"
#include "base/algorithms.hpp"
#include "exact/orientation.hpp"
#include "exact/space_points.hpp"

namespace realmodel::cutting {

using spatial::Box;

namespace {

constexpr double kAlike = 1e-9;  // squared distances that differ by less count as equal

/// The point of a triangle that is nearest to p (C. Ericson, "Real-time collision detection", 2005,
/// section 5.1.5).
Position nearest_in_triangle(const Position& p, const Position& a, const Position& b,
                             const Position& c) {
    const Position ab = minus(b, a), ac = minus(c, a), ap = minus(p, a);
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const Position bp = minus(p, b);
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return moved(a, d1 / (d1 - d3), ab);
    const Position cp = minus(p, c);
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return moved(a, d2 / (d2 - d6), ac);
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        return moved(b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), minus(c, b));
    const double share = 1 / (va + vb + vc);
    return moved(moved(a, vb * share, ab), vc * share, ac);
}

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

std::vector<Box> boxes_of(const CutterSurface& surface) {
    return transformed(surface.triangles, [&](const auto& t) {
        return spatial::bounding_box(t, [&](NodeId v) { return surface.vertices[index(v)]; });
    });
}

}  // namespace

NearestSide::NearestSide(const CutterSurface& surface, const Execution& execution)
    : surface_(surface), tree_(boxes_of(surface), execution), border_(surface.triangles.size(), 0) {
    if (surface.is_closed) return;
    const auto edges = arrangement::edges_of(
        border_.size(),
        surface.vertices.size(), [&](std::size_t t) -> const auto& { return surface.triangles[t]; },
        execution);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges[e].size() != 1) continue;
        const auto t = index(edges[e][0].item);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& own = surface.triangles[t];
            if (unordered(own[i], own[(i + 1) % 3]) == edges.ends(e))
                border_[t] |= static_cast<std::uint8_t>(1U << i);
        }
    }
}

/// Whether a point of a triangle is on one of its border edges, but for rounding.
bool NearestSide::is_on_border(std::int32_t triangle, const Position& q) const {
    constexpr double kOnEdge = 1e-12;  // of its squared length: squared distance
    const auto own = corners(triangle);
    for (std::size_t i = 0; i < 3; ++i) {
        if ((border_[index(triangle)] & (1U << i)) == 0) continue;
        const Position line = minus(own[(i + 1) % 3], own[i]), off = minus(q, own[i]);
        const double square = dot(line, line), share = dot(off, line) / square;
        if (dot(off, off) - share * share * square <= kOnEdge * square) return true;
    }
    return false;
}

std::int8_t NearestSide::operator()(const Position& p, bool* at_border) const {
    struct NearTriangle {
        double distance;
        std::int32_t triangle;
        Position at;
    };
    // mostly one is nearest, which needs no memory and is compared with none
    std::optional<NearTriangle> first;
    std::vector<NearTriangle> others;
    double least = HUGE_VAL;
    tree_.approach(
        p, [&least] { return least * (1 + kAlike); },
        [&](std::int32_t t) {
            const auto own = corners(t);
            const Position at = nearest_in_triangle(p, own[0], own[1], own[2]);
            const Position away = minus(p, at);
            const double distance = dot(away, away);
            if (distance > least * (1 + kAlike)) return;
            least = std::min(least, distance);
            if (!first || (others.empty() && first->distance > least * (1 + kAlike)))
                first = {distance, t, at};
            else
                others.push_back({distance, t, at});
        });
    if (!first) return kAbove;
    std::int32_t best = -1;
    double best_square = 0;
    const auto compare = [&](const NearTriangle& one) {
        if (one.distance > least * (1 + kAlike)) return;
        if (at_border != nullptr && is_on_border(one.triangle, one.at)) *at_border = true;
        double square = 0;
        if (!others.empty()) {
            const Position normal = polygon_normal(corners(one.triangle));
            square = std::abs(dot(normal, minus(p, one.at))) /
                     std::sqrt(std::max(dot(normal, normal), 1e-300));
        }
        if (best < 0 || square > best_square || (square == best_square && one.triangle < best)) {
            best = one.triangle;
            best_square = square;
        }
    };
    compare(*first);
    std::ranges::for_each(others, compare);
    return side_of(corners(best), p);
}

std::optional<std::int8_t> NearestSide::of_ball(const Position& center, double radius) const {
    constexpr double kRounding = 0x1p-40;  // of lengths and of products of these
    constexpr double kOnEdge = 0x1p-19;    // of its length: farther than is_on_border has it
    double least = HUGE_VAL;
    const auto square_to = [&](const std::array<Position, 3>& own) {
        const Position away = minus(center, nearest_in_triangle(center, own[0], own[1], own[2]));
        return dot(away, away);
    };
    tree_.approach(
        center, [&least] { return least; },
        [&](std::int32_t t) { least = std::min(least, square_to(corners(t))); });
    if (!(radius * radius < least)) return std::nullopt;
    // what is nearest to a position in the ball is no farther from its center than this
    const double reach = (std::sqrt(least) + 2 * radius) * (1 + kAlike);
    std::optional<std::int8_t> side;
    bool is_certain = true;
    tree_.approach(
        center, [&] { return is_certain ? reach * reach : -1.0; },
        [&](std::int32_t t) {
            const auto own = corners(t);
            if (square_to(own) > reach * reach) return;
            const Position ab = minus(own[1], own[0]), ac = minus(own[2], own[0]);
            const Position normal = cross(ab, ac), off = minus(center, own[0]);
            const double distance = dot(normal, off);
            const double least_distance = radius * length(normal) + kRounding * length(ab) *
                                                                        length(ac) *
                                                                        (length(off) + radius);
            const std::int8_t own_side = distance < 0 ? kBelow : kAbove;
            is_certain &=
                std::abs(distance) > least_distance && side.value_or(own_side) == own_side;
            side = own_side;
            for (std::size_t i = 0; i < 3; ++i) {
                if ((border_[index(t)] & (1U << i)) == 0) continue;
                const Position line = minus(own[(i + 1) % 3], own[i]);
                const double size = length(line);
                is_certain &= length(cross(line, minus(center, own[i]))) >
                              (reach + kOnEdge * size) * size * (1 + kRounding);
            }
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
        const auto own = corners(t);
        const std::array of{points.add(own[0]), points.add(own[1]), points.add(own[2])};
        if (exact::ray_crosses(points, axis, p, of, from_below) != 0) inside = !inside;
    });
    return inside ? kBelow : kAbove;
}

}  // namespace realmodel::cutting
