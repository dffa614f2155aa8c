// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <type_traits>

#include "exact/arithmetic.hpp"
#include "exact/space_points.hpp"

namespace realmodel::exact {

/// Points in homogeneous coordinates that are whole numbers, for one question: relative to an
/// origin, in units of the finest of the doubles that they were made of. Signs of them take no
/// common denominators, as those of rational numbers do.
/// @tparam Integer  Int126, whose answers may be unknown, or mpz_class
template <class Integer>
class HomogeneousPoints {
public:
    using Intersection = SpacePoints::Intersection;
    struct HomogeneousPoint {
        std::array<Integer, 3> at;
        Integer weight;
        bool is_whole = true;  ///< the weight is 1
    };

    HomogeneousPoints(const SpacePoints& points, std::span<const SpacePointId> asked)
        : points_(points) {
        for (const SpacePointId p : asked)
            include(p);
    }

    /// Whether all points are given in a way that these whole numbers allow for.
    bool are_known() const { return are_known_; }
    HomogeneousPoint point(SpacePointId p) const {
        if (const auto* construction = points_.construction(p)) return point(construction->of);
        if constexpr (std::is_same_v<Integer, mpz_class>) {
            if (const auto* fractions = points_.fractions(p)) return point(*fractions);
        }
        return {minus(points_.rounded(p), origin_), Integer(1)};
    }
    HomogeneousPoint point(const Intersection& of) const {
        const auto [p, q, a, b, c] = of.of;
        const bool of_doubles = std::ranges::all_of(
            of.of, [this](SpacePointId corner) { return points_.is_double(corner); });
        if (!of_doubles) {
            const HomogeneousPoint o = point(a);
            const auto u = minus(point(b), o), v = minus(point(c), o);
            return divided(point(p), point(q), o, cross(u, v));
        }
        const auto from = [&](SpacePointId end, SpacePointId o) {
            return minus(points_.rounded(end), points_.rounded(o));
        };
        const auto start = from(p, a), line = from(q, p), normal = cross(from(b, a), from(c, a));
        const Integer ratio = dot(normal, start);
        HomogeneousPoint point;
        point.is_whole = false;
        point.weight = dot(normal, line);
        const auto first = minus(points_.rounded(p), origin_);
        for (std::size_t k = 0; k < 3; ++k)
            point.at[k] = first[k] * point.weight - ratio * line[k];
        return point;
    }
    /// Where the lines through p and q and through a and b cross, in the view along `axis`.
    HomogeneousPoint crossing(std::size_t axis, SpacePointId p, SpacePointId q, SpacePointId a,
                              SpacePointId b) const {
        const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
        const HomogeneousPoint o = point(a);
        const auto along = minus(point(b), o);
        std::array<Integer, 3> normal;
        normal[axis] = 0;
        normal[k] = -along[l];
        normal[l] = along[k];
        return divided(point(p), point(q), o, normal);
    }
    /// A point relative to no origin, in units of 1.
    HomogeneousPoint absolute(HomogeneousPoint p) const {
        const bool is_finer = unit_ < 0;
        const auto size = static_cast<unsigned>(std::abs(unit_));
        for (std::size_t k = 0; k < 3; ++k) {
            p.at[k] += whole_number(origin_[k], unit_) * p.weight;
            if (!is_finer) p.at[k] <<= size;
        }
        if (is_finer) p.weight <<= size;
        p.is_whole = false;
        return p;
    }
    /// The difference of two points, times both weights.
    static std::array<Integer, 3> minus(const HomogeneousPoint& p, const HomogeneousPoint& other) {
        std::array<Integer, 3> result;
        for (std::size_t k = 0; k < 3; ++k)
            result[k] = p.is_whole && other.is_whole
                            ? Integer(p.at[k] - other.at[k])
                            : Integer(times(p.at[k], other) - times(other.at[k], p));
        return result;
    }
    static Integer times(const Integer& number, const HomogeneousPoint& point) {
        return point.is_whole ? number : Integer(number * point.weight);
    }
    /// The point that is best taken as the origin of the others: one whose weight is 1, if any.
    static std::size_t simplest(std::span<const HomogeneousPoint> points) {
        const auto whole =
            std::find_if(points.begin(), points.end(),
                         [](const HomogeneousPoint& point) { return point.is_whole; });
        return whole == points.end() ? 0 : static_cast<std::size_t>(whole - points.begin());
    }
    /// Whether an intersection of points given by doubles is exactly at these doubles; nothing
    /// where that is not known.
    std::optional<bool> is_at(const Intersection& of, const SpacePosition& doubles) {
        for (const double x : doubles)
            unit_ = finest_exponent(x, unit_);
        const HomogeneousPoint intersection = point(of);
        const auto at = minus(doubles, origin_);
        bool is_equal = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const Integer off = times(at[k], intersection) - intersection.at[k];
            if (!is_known(off)) return std::nullopt;
            is_equal = is_equal && sign_of(off) == 0;
        }
        return is_equal;
    }

private:
    /// Where the line through p and q passes through the plane through o with this normal.
    static HomogeneousPoint divided(const HomogeneousPoint& p, const HomogeneousPoint& q,
                                    const HomogeneousPoint& o,
                                    const std::array<Integer, 3>& normal) {
        const auto line = minus(q, p);
        const Integer from = dot(normal, minus(p, o)), change = times(dot(normal, line), o);
        HomogeneousPoint point;
        point.is_whole = false;
        for (std::size_t k = 0; k < 3; ++k)
            point.at[k] = p.at[k] * change - from * line[k];
        point.weight = times(change, p);
        return point;
    }
    HomogeneousPoint point(const SpacePoints::Fractions& p) const {
        HomogeneousPoint point;
        point.is_whole = false;
        point.weight = p.weight;
        for (std::size_t k = 0; k < 3; ++k) {
            point.at[k] = p.at[k] << static_cast<unsigned>(-unit_);
            point.at[k] -= whole_number(origin_[k], unit_) * p.weight;
        }
        return point;
    }
    void include(SpacePointId p) {
        if (const auto* construction = points_.construction(p)) {
            for (const SpacePointId q : construction->of.of)
                include(q);
            return;
        }
        if (points_.fractions(p) != nullptr) {
            are_known_ = are_known_ && std::is_same_v<Integer, mpz_class>;
            unit_ = std::min(unit_, 0);
            return;
        }
        if (!has_origin_) origin_ = points_.rounded(p);
        has_origin_ = true;
        for (const double x : points_.rounded(p))
            unit_ = finest_exponent(x, unit_);
    }
    std::array<Integer, 3> minus(const SpacePosition& p, const SpacePosition& q) const {
        std::array<Integer, 3> result;
        for (std::size_t k = 0; k < 3; ++k) {
            if constexpr (std::is_same_v<Integer, Int126>) {
                result[k] = Int126::difference(p[k], q[k], std::ldexp(1.0, -unit_));
            } else {
                if (p[k] != q[k]) result[k] = whole_difference(p[k], q[k], unit_);
            }
        }
        return result;
    }

    const SpacePoints& points_;
    SpacePosition origin_{0, 0, 0};
    bool has_origin_ = false, are_known_ = true;
    int unit_ = 1024;
};

/// The answer ask(in) of points in whole numbers, short ones first.
template <class Ask>
auto by_integers(const SpacePoints& points, std::span<const SpacePointId> asked, const Ask& ask) {
    HomogeneousPoints<Int126> in(points, asked);
    if (in.are_known()) {
        if (const auto answer = ask(in)) return *answer;
    }
    return *ask(HomogeneousPoints<mpz_class>(points, asked));
}

}  // namespace realmodel::exact
