// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "realmodel/spatial/queries.hpp"
#include "spatial/hilbert_order.hpp"
#include "spatial/space_triangles.hpp"

namespace realmodel::spatial {

namespace {

/// The greatest z at which (0, 0, z) is `away` from an edge; -infinite where it is farther in plan.
double over_edge(const Vec3& a, const Vec3& b, double away) {
    const Vec2 along{b[0] - a[0], b[1] - a[1]};
    const double size = length(along), rise = b[2] - a[2];
    const auto over = [&](double share) {
        const Vec3 foot = moved(a, share, minus(b, a));
        const double left = away * away - (foot[0] * foot[0] + foot[1] * foot[1]);
        return left >= 0 ? foot[2] + std::sqrt(left) : -HUGE_VAL;
    };
    if (!(size > 0)) return std::max(over(0), over(1));
    const double off = cross(along, Vec2{-a[0], -a[1]}) / size;  // of the line, in plan
    if (std::abs(off) > away) return -HUGE_VAL;
    // The tube around the edge is highest over (0, 0) where its tilted circle has its foot.
    const double nearest = -(a[0] * along[0] + a[1] * along[1]) / size;
    const double half = std::sqrt((away - off) * (away + off));
    const double foot = nearest + rise * half / std::sqrt(size * size + rise * rise);
    return over(std::clamp(foot / size, 0.0, 1.0));
}

/// Whether a position in plan is in a triangle, up to rounding.
bool contains(const SpaceTriangle& triangle, const Vec2& at) {
    bool left = true, right = true;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 &a = triangle[i], &b = triangle[(i + 1) % 3];
        const double side = cross(Vec2{b[0] - a[0], b[1] - a[1]}, Vec2{at[0] - a[0], at[1] - a[1]});
        left &= side >= 0;
        right &= side <= 0;
    }
    return left || right;
}

/// The greatest z at which (0, 0, z) is `away` from a triangle.
double over_triangle(const SpaceTriangle& triangle, double away) {
    constexpr double kIsOn = 1e-9;  // of the distance; the plane of a needle is not known better
    Vec3 normal = cross(minus(triangle[1], triangle[0]), minus(triangle[2], triangle[0]));
    if (normal[2] < 0) normal = times(-1, normal);
    if (normal[2] > 0) {
        const double size = length(normal);
        const Vec3& a = *std::ranges::min_element(
            triangle, {}, [](const Vec3& p) { return p[0] * p[0] + p[1] * p[1]; });
        const double under = a[2] + (normal[0] * a[0] + normal[1] * a[1]) / normal[2];
        const double z = under + away * size / normal[2];
        if (contains(triangle, {-away * normal[0] / size, -away * normal[1] / size}) &&
            std::abs(triangle_distance({0, 0, z}, triangle) - away) <= kIsOn * away)
            return z;
    }
    double highest = -HUGE_VAL;
    for (std::size_t i = 0; i < 3; ++i)
        highest = std::max(highest, over_edge(triangle[i], triangle[(i + 1) % 3], away));
    return highest;
}

}  // namespace

std::vector<double> heights_at_distance(std::span<const SpaceTriangle> triangles,
                                        std::span<const Vec2> positions,
                                        std::span<const double> own, std::span<const double> away,
                                        const Execution& execution) {
    constexpr std::size_t kPositionsOfChunk = 256;
    if (own.size() != positions.size() || away.size() != positions.size())
        throw InputError("bad_index", "a height and a distance of each position are needed");
    const BoxTree tree(boxes_of(triangles), execution);
    std::vector<double> found(positions.size(), HUGE_VAL);
    // `support`: a triangle that may ask for most, as it did at a position nearby; then the one
    // that does.
    const auto at = [&](std::size_t i, std::int32_t& support) {
        if (!std::isfinite(own[i]) || !(away[i] > 0)) return own[i];
        const Vec3 under{positions[i][0], positions[i][1], own[i]};
        const auto asked = [&](std::int32_t t) {
            SpaceTriangle moved_there = triangles[index(t)];
            for (Vec3& corner : moved_there)
                corner = minus(corner, under);
            return over_triangle(moved_there, away[i]);
        };
        double above = away[i];
        if (support >= 0) above = std::max(above, asked(support));
        // Above a sheet its distance does not shrink upward. So of a height that is too low the
        // nearest triangle is one that asks for more; the last of them asks for the most.
        for (;;) {
            double least = away[i], higher = above;
            const Vec3 p{under[0], under[1], under[2] + above};
            tree.approach(
                p, [&] { return least * least * kRoundedDistance * kRoundedDistance; },
                [&](std::int32_t t) {
                    const double distance = triangle_distance(p, triangles[index(t)]);
                    if (!(distance < least)) return;
                    const double by_this = asked(t);
                    if (!(by_this > above)) return;
                    least = distance;
                    if (!(by_this > higher)) return;
                    higher = by_this;
                    support = t;
                });
            if (!(higher > above)) return own[i] + above;
            above = higher;
        }
    };
    const std::vector<std::uint32_t> order = along_hilbert_curve(positions);
    parallel_ranges(positions.size(), kPositionsOfChunk, execution,
                    [&](std::size_t begin, std::size_t end) {
                        std::int32_t support = -1;
                        for (std::size_t k = begin; k < end; ++k)
                            found[order[k]] = at(order[k], support);
                    });
    return found;
}

}  // namespace realmodel::spatial
