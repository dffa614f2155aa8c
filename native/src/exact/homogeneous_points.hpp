// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "exact/arithmetic.hpp"
#include "exact/fixed_integer.hpp"
#include "exact/space_points.hpp"

namespace realmodel::exact {

/// Points in homogeneous coordinates that are whole numbers of fixed width, for one question:
/// relative to an origin, in units of the finest of the doubles that they were made of. Points
/// given by rational numbers are not known.
class HomogeneousPoints {
public:
    using Integer = FixedInteger;
    using Intersection = SpacePoints::Intersection;
    struct Point {
        std::array<Integer, 3> at;
        Integer weight;
        bool is_whole = true;  ///< the weight is 1
    };

    HomogeneousPoints(const SpacePoints& points, std::span<const SpacePointId> asked)
        : points_(points) {
        for (const SpacePointId p : asked)
            include(p);
    }

    Point point(SpacePointId p) const {
        if (const auto* construction = points_.construction(p)) return point(construction->of);
        Point point;
        point.at = points_.is_double(p) ? minus(points_.rounded(p), origin_) : unknown();
        return point;
    }
    Point point(const Intersection& of) const {
        const auto [p, q, a, b, c] = of.of;
        const auto from = [&](SpacePointId end, SpacePointId o) {
            return minus(points_.rounded(end), points_.rounded(o));
        };
        const auto u = from(b, a), v = from(c, a), start = from(p, a), line = from(q, p);
        const std::array normal{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                u[0] * v[1] - u[1] * v[0]};
        const auto dot = [&normal](const std::array<Integer, 3>& w) {
            return normal[0] * w[0] + normal[1] * w[1] + normal[2] * w[2];
        };
        const Integer ratio = dot(start);
        Point point;
        point.is_whole = false;
        point.weight = dot(line);
        const auto first = minus(points_.rounded(p), origin_);
        for (std::size_t k = 0; k < 3; ++k)
            point.at[k] = first[k] * point.weight - ratio * line[k];
        return point;
    }
    /// The difference of two points, times both weights.
    static std::array<Integer, 3> minus(const Point& p, const Point& other) {
        std::array<Integer, 3> result;
        for (std::size_t k = 0; k < 3; ++k)
            result[k] = times(p.at[k], other) - times(other.at[k], p);
        return result;
    }
    static Integer times(const Integer& number, const Point& point) {
        return point.is_whole ? number : number * point.weight;
    }
    static int sign_of_weight(const Point& point) {
        return point.is_whole ? 1 : sign_of(point.weight);
    }
    /// The point that is best taken as the origin of the others: one whose weight is 1, if any.
    static std::size_t simplest(std::span<const Point> points) {
        const auto found = std::find_if(points.begin(), points.end(),
                                        [](const Point& point) { return point.is_whole; });
        return found == points.end() ? 0 : static_cast<std::size_t>(found - points.begin());
    }
    /// Whether an intersection is exactly at these doubles; nothing where that is not known.
    std::optional<bool> is_at(const Intersection& of, const SpacePosition& doubles) {
        for (const double x : doubles)
            unit_ = finest_exponent(x, unit_);
        const Point found = point(of);
        const auto at = minus(doubles, origin_);
        bool is_equal = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const Integer off = times(at[k], found) - found.at[k];
            if (!is_known(off)) return std::nullopt;
            is_equal = is_equal && sign_of(off) == 0;
        }
        return is_equal;
    }

private:
    void include(SpacePointId p) {
        if (const auto* construction = points_.construction(p)) {
            for (const SpacePointId q : construction->of.of)
                include(q);
            return;
        }
        if (!points_.is_double(p)) return;
        if (!has_origin_) origin_ = points_.rounded(p);
        has_origin_ = true;
        for (const double x : points_.rounded(p))
            unit_ = finest_exponent(x, unit_);
    }
    std::array<Integer, 3> minus(const SpacePosition& p, const SpacePosition& q) const {
        std::array<Integer, 3> result;
        for (std::size_t k = 0; k < 3; ++k)
            result[k] = Integer::of(p[k], unit_) - Integer::of(q[k], unit_);
        return result;
    }
    static std::array<Integer, 3> unknown() {
        return {Integer::unknown(), Integer::unknown(), Integer::unknown()};
    }

    const SpacePoints& points_;
    SpacePosition origin_{0, 0, 0};
    bool has_origin_ = false;
    int unit_ = 1024;
};

}  // namespace realmodel::exact
