// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "arrangement/polygons.hpp"
#include "exact/space_points.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::arrangement {

/// A corner of a loop: its node, and where it lies in the view.
struct LoopCorner {
    NodeId node;
    PlanePosition at;
};
using Loop = std::vector<LoopCorner>;

/// Twice the area of a loop; positive where it is counter-clockwise.
double twice_loop_area(const Loop& loop);

/// Which way corners turn: 1 left, -1 right, 0 straight on. By itself it tells that of the places
/// in the view, exactly; others know better where the corners are than their rounded places say.
class CornerTurns {
public:
    virtual ~CornerTurns() = default;
    virtual int operator()(const LoopCorner& a, const LoopCorner& b, const LoopCorner& c) const;
};

/// The same of exact points.
/// @tparam PointOf  point_of(node): the point of a corner's node
template <class PointOf>
class PointTurns : public CornerTurns {
public:
    PointTurns(const exact::SpacePoints& points, const View& view, const PointOf& point_of)
        : points_(points), view_(view), point_of_(point_of) {}
    int operator()(const LoopCorner& a, const LoopCorner& b, const LoopCorner& c) const override {
        const auto p = point_of_(a.node), q = point_of_(b.node), r = point_of_(c.node);
        return view_.sign() * exact::orient2d(points_, view_.axis(), p, q, r);
    }

private:
    const exact::SpacePoints& points_;
    const View& view_;
    const PointOf& point_of_;
};

/// Which ears are cut off, and which before others.
enum class EarChoice : std::uint8_t {
    kAny,   ///< fat ones first, in the end any: whatever loops look like, all corners get triangles
    kRound  ///< true ears only, first those that are hardly flipped when edges are made Delaunay
};

/// Cuts the ears off an outline (counter-clockwise) and holes in it (clockwise; one may be a slit
/// of two corners), which are joined to it by bridges (G. H. Meisters 1975; D. Eberly,
/// "Triangulation by ear clipping", 2002). Corners in the way are found in nested grids, and a tip
/// that cannot be cut off waits for the one in its way.
/// @param loops      the outline first
/// @param triangles  corners, counted through all loops, are appended
/// @return whether all are ears, and each hole saw a corner to be joined with
/// @throws Cancelled
bool cut_ears(std::span<const Loop> loops, const PlanePosition& rounding, const CornerTurns& turns,
              EarChoice choice, std::vector<std::array<std::int32_t, 3>>& triangles,
              Progress* progress = nullptr);

/// Divides the region that loops bound (outlines counter-clockwise, holes clockwise; a hole may be
/// a slit of two corners) into triangles without new nodes, by cutting off ears.
///
/// Each edge of each loop belongs to exactly one triangle, and every other edge to two, whatever
/// the loops look like: where rounding has made them cross, triangles may overlap by as much, but
/// nothing gapes. `rounding` is how far corners may be from their places on either axis:
/// triangles that have an area whatever it does are preferred. False where loops do cross, or
/// pass over themselves.
bool triangulate(std::span<const Loop> loops, const PlanePosition& rounding,
                 std::vector<std::array<LoopCorner, 3>>& triangles, const CornerTurns& turns = {});

/// The same region in convex polygons, up to `rounding`: triangles merged wherever that leaves a
/// convex one (S. Hertel and K. Mehlhorn 1983). `slits` are edges that must stay, as (lesser,
/// greater) node, sorted.
bool divide_convex(std::span<const Loop> loops, const PlanePosition& rounding,
                   std::span<const std::array<NodeId, 2>> slits, Polygons& result,
                   const CornerTurns& turns = {});

/// Whether a loop turns left everywhere, up to `rounding`, and passes no node twice.
bool is_convex(const Loop& loop, const PlanePosition& rounding);

}  // namespace realmodel::arrangement
