// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "exact/double_double_interval.hpp"
#include "exact/space_points.hpp"

namespace realmodel::exact {

/// A plane through a point with a normal, both of which are exactly the doubles given.
class OrientedPlane {
public:
    /// @param normal  finite and not zero; its length does not matter
    OrientedPlane(const SpacePosition& point, const SpacePosition& normal);

    /// 1 above (where the normal points), -1 below, 0 on the plane.
    std::int8_t side(const SpacePosition& p) const;
    /// The signed distance times the length of `normal()`.
    DoubleDoubleInterval distance(const SpacePosition& p) const;
    /// How much of that kComputedUlps of the coordinates may make.
    double rounding(const SpacePosition& p) const;
    /// Whether the plane passes within half a unit in the last place of one of the coordinates.
    bool is_beside(const SpacePosition& p) const;
    /// The point where the line from p to q, which lie on different sides, passes through the
    /// plane, and the doubles nearest to it.
    RationalPoint exact_intersection(const SpacePosition& p, const SpacePosition& q) const;
    SpacePosition intersection(const SpacePosition& p, const SpacePosition& q) const;
    const SpacePosition& normal() const { return normal_; }

private:
    mpq_class exact_distance(const SpacePosition& p) const;

    SpacePosition point_, normal_;
};

}  // namespace realmodel::exact
