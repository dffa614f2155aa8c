// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "base/key_table.hpp"
#include "exact/double_double_interval.hpp"
#include "exact/orientation.hpp"

namespace realmodel::exact {

/// A point of space, or the difference of two, in rational coordinates.
using RationalPoint = std::array<mpq_class, 3>;

// Vectors in space, of numbers of any kind. What GMP makes of an expression has to become a number
// before what it refers to is gone.

template <class Number>
std::array<Number, 3> minus(const std::array<Number, 3>& u, const std::array<Number, 3>& v) {
    return {Number(u[0] - v[0]), Number(u[1] - v[1]), Number(u[2] - v[2])};
}
template <class Number>
Number dot(const std::array<Number, 3>& u, const std::array<Number, 3>& v) {
    return Number(u[0] * v[0] + u[1] * v[1] + u[2] * v[2]);
}
template <class Number>
std::array<Number, 3> cross(const std::array<Number, 3>& u, const std::array<Number, 3>& v) {
    return {Number(u[1] * v[2] - u[2] * v[1]), Number(u[2] * v[0] - u[0] * v[2]),
            Number(u[0] * v[1] - u[1] * v[0])};
}

/// The component of a cross product along an axis.
inline mpq_class cross(const RationalPoint& u, const RationalPoint& v, std::size_t axis) {
    const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
    return u[k] * v[l] - u[l] * v[k];
}

/// The point that divides the line from p to q, beginning at p, in this ratio.
inline RationalPoint interpolated(const RationalPoint& p, const RationalPoint& q,
                                  const mpq_class& ratio) {
    RationalPoint result;
    for (std::size_t k = 0; k < 3; ++k)
        result[k] = p[k] + ratio * (q[k] - p[k]);
    return result;
}

using SpacePosition = std::array<double, 3>;
/// The number of a point of SpacePoints.
using SpacePointId = Id<struct SpacePoint>;

/// Points of space, each known exactly, equal ones once: inputs, intersections of lines and planes
/// through them, and constructions of any depth in rational numbers. Any number of
/// threads may ask at once (below); one adds.
class SpacePoints {
public:
    /// Where a line passes through a plane: ends of the line, corners of the plane, both ascending.
    struct Intersection {
        std::array<SpacePointId, 5> of;
        bool operator==(const Intersection&) const = default;
        bool is_on_line(SpacePointId a, SpacePointId b) const { return of[0] == a && of[1] == b; }
        bool is_on_plane_of(const Intersection& i) const {
            return of[2] == i.of[2] && of[3] == i.of[3] && of[4] == i.of[4];
        }
    };
    /// An intersection of points given by doubles, and its coordinates to twice their precision.
    struct ConstructedPoint {
        Intersection of;
        std::array<DoubleDoubleInterval, 3> at;
    };

    using SpaceLine = std::array<SpacePointId, 2>;
    /// A point in fractions of one denominator, greater than 0, and its coordinates to twice the
    /// precision of doubles.
    struct Fractions {
        std::array<mpz_class, 3> at;
        mpz_class weight;
        std::array<DoubleDoubleInterval, 3> interval;
        /// Ends of lines that it was constructed on, ascending.
        std::array<SpaceLine, 2> lines{SpaceLine{kNone, kNone}, SpaceLine{kNone, kNone}};
    };

    /// The number of a point given by finite doubles.
    /// @throws InputError kind too_large, as everything that adds points
    SpacePointId add(const SpacePosition& p);
    /// The number of a point given in rational coordinates.
    SpacePointId add(RationalPoint&& p);

    /// Where the line through p and q passes through the plane of a, b and c, which it does.
    SpacePointId intersection(SpacePointId p, SpacePointId q, SpacePointId a, SpacePointId b,
                              SpacePointId c);
    /// Where the line through p and q passes through the one through a and b, in the view along
    /// `axis`; all four lie in one plane.
    SpacePointId intersection(std::size_t axis, SpacePointId p, SpacePointId q, SpacePointId a,
                              SpacePointId b) {
        return add(crossing(axis, p, q, a, b));
    }
    /// A point in fractions that have no common divisor, and the doubles nearest to it.
    struct Reduced {
        Fractions fractions;
        SpacePosition rounded;
        bool are_doubles;  ///< these doubles are the point
    };
    /// The same without its number, which add() gives it: what takes time in intersection().
    Reduced crossing(std::size_t axis, SpacePointId p, SpacePointId q, SpacePointId a,
                     SpacePointId b) const;
    SpacePointId add(Reduced&& p);
    /// p moved along `axis` into the plane of a, b, c.
    SpacePointId projected(std::size_t axis, SpacePointId p, SpacePointId a, SpacePointId b,
                           SpacePointId c);
    /// The point of the line through a and b that has p's coordinate `axis`.
    SpacePointId projected(std::size_t axis, SpacePointId p, SpacePointId a, SpacePointId b);
    /// The middle of three points.
    SpacePointId middle(const std::array<SpacePointId, 3>& corners);

    /// Makes room for so many more points.
    void reserve(std::size_t more);
    /// The same for points where lines pass through planes.
    void reserve_intersections(std::size_t more);

    std::size_t size() const { return rounded_.size(); }
    /// The doubles nearest to the point.
    const SpacePosition& rounded(SpacePointId p) const { return rounded_[index(p)]; }
    RationalPoint exact(SpacePointId p) const;
    /// Whether the doubles are the point.
    bool is_double(SpacePointId p) const { return source(p).kind == Source::Form::kDoubles; }
    /// How the point was constructed; nullptr where it is given by doubles or fractions.
    const ConstructedPoint* construction(SpacePointId p) const {
        const Source& of = source(p);
        return of.kind == Source::Form::kConstruction ? &constructions_[index(of.number)] : nullptr;
    }
    /// The fractions that a point is given by; nullptr where it is not.
    const Fractions* fractions(SpacePointId p) const {
        const Source& of = source(p);
        return of.kind == Source::Form::kFractions ? &fractions_[index(of.number)] : nullptr;
    }
    /// The lines that a point was constructed on; kNone for none.
    std::array<SpaceLine, 2> lines(SpacePointId p) const;
    /// Whether a point is known to lie on the line through a and b, as it was constructed there.
    bool was_constructed_on(SpacePointId p, SpacePointId a, SpacePointId b) const;

private:
    /// What a point is known by: its doubles, one of `constructions_`, or one of `fractions_`.
    struct Source {
        enum class Form : std::uint8_t {
            kDoubles,
            kConstruction,
            kFractions
        } kind = Form::kDoubles;
        std::int32_t number = 0;
    };

    const Source& source(SpacePointId p) const { return source_[index(p)]; }
    SpacePointId enter(const SpacePosition& rounded, Source source);
    static Reduced reduced(Fractions&& p);
    SpacePointId construct(const Intersection& of);
    SpacePointId in_fractions(const Intersection& of);
    std::array<DoubleDoubleInterval, 3> coordinates(const Intersection& of) const;

    std::vector<SpacePosition> rounded_;
    std::vector<Source> source_;
    std::vector<ConstructedPoint> constructions_;
    std::vector<Fractions> fractions_;
    KeyTable by_doubles_;       ///< points by their doubles
    KeyTable by_intersection_;  ///< positions in `intersections_`
    std::vector<std::pair<Intersection, SpacePointId>> intersections_;
};

// What is asked of points of space, always answered exactly: by doubles where their error bound
// allows it (orientation.hpp), by what the points were constructed of, by twice the precision of
// doubles, by whole numbers of fixed width, and only then by rational numbers.

/// Which side of the plane of a, b, c has d: 1 where a, b, c turn counter-clockwise seen from d, -1
/// the other, 0 on it.
int orient3d(const SpacePoints& points, SpacePointId a, SpacePointId b, SpacePointId c,
             SpacePointId d);
/// The same for the sides of several points, by a filter for all of them where that can tell.
class SidesOfPlane {
public:
    SidesOfPlane(const SpacePoints& points, const std::array<SpacePointId, 3>& corners);
    int operator()(SpacePointId d) const;

private:
    const SpacePoints& points_;
    std::array<SpacePointId, 3> corners_;
    SideFilter filter_;
};
/// Which way a, b, c turn in the view along `axis` from above: 1 left, -1 right, 0 straight on.
int orient2d(const SpacePoints& points, std::size_t axis, SpacePointId a, SpacePointId b,
             SpacePointId c);
/// -1 where a comes before b along an axis, 1 where it comes after, 0 where they are level.
int compare(const SpacePoints& points, std::size_t axis, SpacePointId a, SpacePointId b);
/// The lexicographic order. Points on a line are in this order along it, or in the opposite one.
int compare(const SpacePoints& points, SpacePointId a, SpacePointId b);

/// Whether a ray from p in the direction of `axis` crosses a triangle: 1 where that turns left seen
/// from where the ray goes to, -1 where it turns right, 0 where the ray misses it. A triangle that
/// p lies on is crossed where `from_below`: p is then just before it. Of triangles that share an
/// edge the ray crosses the same as one a little beside it would.
int ray_crosses(const SpacePoints& points, std::size_t axis, SpacePointId p,
                const std::array<SpacePointId, 3>& corners, bool from_below);
/// Whether p is farther than q from the line through a and b, in the view along `axis`; both are
/// on one side of it.
bool is_farther(const SpacePoints& points, std::size_t axis, SpacePointId a, SpacePointId b,
                SpacePointId p, SpacePointId q);

}  // namespace realmodel::exact
