// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/spatial/queries.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "exact/double_double_interval.hpp"
#include "exact/orientation.hpp"
#include "spatial/box_tree.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::spatial {

namespace {

using exact::DoubleDoubleInterval;
using Precise = std::array<DoubleDoubleInterval, 3>;

Precise precise_difference(const Vec3& a, const Vec3& b) {
    return {DoubleDoubleInterval::difference(a[0], b[0]),
            DoubleDoubleInterval::difference(a[1], b[1]),
            DoubleDoubleInterval::difference(a[2], b[2])};
}

/// How far a position is from a triangle. Over the triangle it is known to nearly all digits,
/// however narrow the triangle is; beside it to the rounding of coordinates.
double triangle_distance(const Vec3& p, const SpaceTriangle& triangle) {
    // The normal of a narrow triangle is the difference of long products.
    const Precise u = precise_difference(triangle[1], triangle[0]);
    const Precise v = precise_difference(triangle[2], triangle[0]);
    const Precise across{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                         u[0] * v[1] - u[1] * v[0]};
    const Vec3 normal{across[0].high, across[1].high, across[2].high};
    bool inside = true;
    double to_border = HUGE_VAL;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 edge = minus(triangle[(i + 1) % 3], triangle[i]), apart = minus(p, triangle[i]);
        inside &= dot(cross(edge, apart), normal) >= 0;
        const double square = dot(edge, edge);
        const double share = square > 0 ? std::clamp(dot(apart, edge) / square, 0.0, 1.0) : 0.0;
        const Vec3 off = minus(p, moved(triangle[i], share, edge));
        to_border = std::min(to_border, length(off));
    }
    const double size = length(normal);
    if (!inside || !(size > 0)) return to_border;
    const Precise apart = precise_difference(p, triangle[0]);
    const DoubleDoubleInterval volume =
        apart[0] * across[0] + apart[1] * across[1] + apart[2] * across[2];
    return std::abs(volume.high) / size;
}

/// Distances from boxes are rounded: what is so little farther may yet be as near.
constexpr double kRoundedDistance = 1 + 1e-9;

/// @throws InputError kind "too_large"
std::vector<Box> boxes_of(std::span<const SpaceTriangle> triangles) {
    checked_number(triangles.size(), "triangles");
    std::vector<Box> boxes(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const Vec3& corner : triangles[t])
            boxes[t].include(corner);
    }
    return boxes;
}

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
                                        std::span<const Vec2> positions, std::span<const double> z,
                                        std::span<const double> away, const Execution& execution) {
    constexpr std::size_t kPositionsOfChunk = 256;
    if (z.size() != positions.size() || away.size() != positions.size())
        throw InputError("bad_index", "a height and a distance of each position are needed");
    const BoxTree tree(boxes_of(triangles), execution);
    std::vector<double> heights(positions.size(), HUGE_VAL);
    // `support`: a triangle that may ask for most, as it did at a position nearby; then the one
    // that does.
    const auto at = [&](std::size_t i, std::int32_t& support) {
        if (!std::isfinite(z[i]) || !(away[i] > 0)) return z[i];
        const Vec3 under{positions[i][0], positions[i][1], z[i]};
        const auto asked = [&](std::int32_t t) {
            SpaceTriangle moved_triangle = triangles[index(t)];
            for (Vec3& corner : moved_triangle)
                corner = minus(corner, under);
            return over_triangle(moved_triangle, away[i]);
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
            if (!(higher > above)) return z[i] + above;
            above = higher;
        }
    };
    const std::vector<std::uint32_t> order = along_hilbert_curve(positions);
    parallel_ranges(positions.size(), kPositionsOfChunk, execution,
                    [&](std::size_t begin, std::size_t end) {
                        std::int32_t support = -1;
                        for (std::size_t k = begin; k < end; ++k)
                            heights[order[k]] = at(order[k], support);
                    });
    return heights;
}

namespace {

void require_finite(std::span<const PlanPosition> positions, const char* what) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (std::isfinite(positions[i][0]) && std::isfinite(positions[i][1])) continue;
        throw InputError("not_finite", what + (" " + std::to_string(i)) + " is not finite", -1,
                         {static_cast<std::int64_t>(i)});
    }
}

constexpr std::size_t kPositionsOfChunk = 1024;

/// The plane of a triangle, which shows of most positions that they are too far away. What
/// triangle_distance gives is never more than rounding nearer than the plane.
class TrianglePlane {
public:
    explicit TrianglePlane(const SpaceTriangle& triangle) : origin_(triangle[0]) {
        const Vec3 u = minus(triangle[1], origin_), v = minus(triangle[2], origin_);
        normal_ = cross(u, v);
        size_ = length(normal_);
        rounding_ = 1e-14 * length(u) * length(v);
        for (const Vec3& corner : triangle) {
            for (const double coordinate : corner)
                slack_ = std::max(slack_, 1e-14 * size_ * std::abs(coordinate));
        }
    }

    bool is_farther(const Vec3& p, double distance) const {
        const Vec3 apart = minus(p, origin_);
        return std::abs(dot(apart, normal_)) >
               distance * size_ + slack_ +
                   rounding_ * (std::abs(apart[0]) + std::abs(apart[1]) + std::abs(apart[2]));
    }

private:
    Vec3 origin_, normal_;
    double size_, rounding_, slack_ = 0;
};

}  // namespace

Nearest nearest_points(std::span<const PlanPosition> points,
                       std::span<const PlanPosition> positions, std::size_t count,
                       const Execution& execution) {
    if (points.empty()) throw InputError("no_points", "there are no points to be near to");
    checked_number(points.size(), "points");
    require_finite(points, "point");
    require_finite(positions, "node");
    const NearestPoints tree(points);
    Nearest nearest{std::vector<std::int32_t>(count * positions.size(), -1),
                    std::vector<double>(count * positions.size(), HUGE_VAL)};
    parallel_ranges(
        positions.size(), kPositionsOfChunk, execution, [&](std::size_t begin, std::size_t end) {
            std::vector<Neighbor> near;
            for (std::size_t i = begin; i < end; ++i) {
                tree.find(positions[i], count, near);
                for (std::size_t k = 0; k < near.size(); ++k) {
                    nearest.number[count * i + k] = near[k].point;
                    nearest.distance[count * i + k] = std::sqrt(near[k].squared_distance);
                }
            }
        });
    return nearest;
}

Nearest nearest_triangles(std::span<const SpaceTriangle> triangles, std::span<const Vec3> positions,
                          double reach, const Execution& execution) {
    const BoxTree tree(boxes_of(triangles), execution);
    const std::vector<TrianglePlane> planes(triangles.begin(), triangles.end());
    Nearest nearest{std::vector<std::int32_t>(positions.size(), -1),
                    std::vector<double>(positions.size(), HUGE_VAL)};
    parallel_for_each(positions.size(), execution, [&](std::size_t i) {
        std::int32_t& number = nearest.number[i];
        double& least = nearest.distance[i];
        const auto bound = [&] { return std::min(least, reach) * kRoundedDistance; };
        tree.approach(
            positions[i], [&] { return bound() * bound(); },
            [&](std::int32_t t) {
                if (planes[index(t)].is_farther(positions[i], bound())) return;
                const double away = triangle_distance(positions[i], triangles[index(t)]);
                if (!(away < reach) || away > least || (away == least && t > number)) return;
                least = away;
                number = t;
            });
    });
    return nearest;
}

std::vector<std::array<std::int64_t, 2>> meeting_boxes(std::span<const CornersOfBox> first,
                                                       std::span<const CornersOfBox> second) {
    const bool is_swapped = first.size() > second.size();
    if (is_swapped) std::swap(first, second);
    checked_number(second.size(), "triangles");
    std::vector<Box> boxes;
    for (const auto& [low, high] : second)
        boxes.push_back({low, high});
    const BoxTree tree(std::move(boxes));
    std::vector<std::array<std::int64_t, 2>> pairs;
    std::vector<std::int32_t> near;
    for (std::size_t i = 0; i < first.size(); ++i) {
        near.clear();
        tree.find({first[i][0], first[i][1]}, [&](std::int32_t other) { near.push_back(other); });
        std::ranges::sort(near, {}, [&](std::int32_t other) {
            return std::pair{second[index(other)][0][0], other};
        });
        const auto box = static_cast<std::int64_t>(i);
        for (const std::int64_t other : near)
            pairs.push_back(is_swapped ? std::array{other, box} : std::array{box, other});
    }
    return pairs;
}

std::vector<std::int8_t> turns(std::span<const PlanPosition> a, std::span<const PlanPosition> b,
                               std::span<const PlanPosition> c) {
    if (b.size() != a.size() || c.size() != a.size())
        throw InputError("bad_index", "paths: three points of each are needed");
    std::vector<std::int8_t> signs(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        signs[i] = static_cast<std::int8_t>(exact::orient2d(a[i], b[i], c[i]));
    return signs;
}

}  // namespace realmodel::spatial
