// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "cutting/cutter.hpp"
#include "exact/space_points.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

/// On which side of a cutter positions are.
class NearestSide {
public:
    explicit NearestSide(const Cutter& cutter, const Execution& execution = {1, nullptr});

    /// Of any cutter: the side of the triangle that is nearest; of several that are, of the one
    /// seen most squarely: whose plane is farthest. Exact; on its plane is above.
    /// @param at_border  set where a border edge is nearest, of triangles that share vertices
    std::int8_t operator()(const Position& p, bool* at_border = nullptr) const;
    /// The same of all positions in a ball, where that needs no look at each.
    /// @param at_border  set where a border edge may be nearest to one
    std::optional<std::int8_t> of_ball(const Position& center, double radius,
                                       bool& at_border) const;
    /// Of a closed cutter: below if the point is inside, so that a ray from it crosses the cutter
    /// an odd number of times. Exact.
    std::int8_t within(const Position& p) const;
    /// The same of one of some points, which get the cutter's: by a ray along an axis.
    /// @param from_below  a triangle that the point is on is crossed, too
    std::int8_t within(exact::SpacePoints& points, exact::SpacePointId p, std::size_t axis,
                       bool from_below) const;
    /// One of the two: `within` of a closed cutter.
    std::int8_t side(const Position& p) const { return cutter_.is_closed ? within(p) : (*this)(p); }
    /// Whether a triangle may come as near to a box as `margin`.
    bool is_near(const spatial::Box& box, double margin) const;

    const Cutter& cutter() const { return cutter_; }

private:
    std::array<Position, 3> corners(std::int32_t triangle) const {
        return cutter_.corners(index(triangle));
    }
    unsigned border_within(std::int32_t triangle, const Position& p, double distance) const;

    const Cutter& cutter_;
    spatial::BoxTree tree_;
    std::vector<std::uint8_t> border_;  ///< of triangles: bit i for the edge after corner i
};

}  // namespace realmodel::cutting
