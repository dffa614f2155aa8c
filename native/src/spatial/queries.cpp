// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/spatial/queries.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "exact/orient2d.hpp"
#include "spatial/box_tree.hpp"
#include "spatial/nearest_points.hpp"
#include "spatial/space_triangles.hpp"

namespace realmodel::spatial {

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
    Nearest found{std::vector<std::int32_t>(count * positions.size(), -1),
                  std::vector<double>(count * positions.size(), HUGE_VAL)};
    parallel_ranges(positions.size(), kPositionsOfChunk, execution,
                    [&](std::size_t begin, std::size_t end) {
                        std::vector<Neighbor> near;
                        for (std::size_t i = begin; i < end; ++i) {
                            tree.find(positions[i], count, near);
                            for (std::size_t k = 0; k < near.size(); ++k) {
                                found.number[count * i + k] = near[k].point;
                                found.distance[count * i + k] = std::sqrt(near[k].squared_distance);
                            }
                        }
                    });
    return found;
}

Nearest nearest_triangles(std::span<const SpaceTriangle> triangles, std::span<const Vec3> positions,
                          double reach, const Execution& execution) {
    const BoxTree tree(boxes_of(triangles), execution);
    const std::vector<TrianglePlane> planes(triangles.begin(), triangles.end());
    Nearest found{std::vector<std::int32_t>(positions.size(), -1),
                  std::vector<double>(positions.size(), HUGE_VAL)};
    parallel_each(positions.size(), execution, [&](std::size_t i) {
        std::int32_t& number = found.number[i];
        double& least = found.distance[i];
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
    return found;
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
        const auto own = static_cast<std::int64_t>(i);
        for (const std::int64_t other : near)
            pairs.push_back(is_swapped ? std::array{other, own} : std::array{own, other});
    }
    return pairs;
}

std::vector<std::int8_t> turns(std::span<const PlanPosition> a, std::span<const PlanPosition> b,
                               std::span<const PlanPosition> c) {
    if (b.size() != a.size() || c.size() != a.size())
        throw InputError("bad_index", "paths: three points of each are needed");
    std::vector<std::int8_t> found(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        found[i] = static_cast<std::int8_t>(exact::orient2d(a[i], b[i], c[i]));
    return found;
}

}  // namespace realmodel::spatial
