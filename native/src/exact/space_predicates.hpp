// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "exact/sign_filters.hpp"
#include "exact/space_points.hpp"

namespace realmodel::exact {

// What is asked of points of space, always answered exactly: by doubles where their error bound
// allows it (sign_filters.hpp), by what the points were constructed of, by twice the precision of
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
