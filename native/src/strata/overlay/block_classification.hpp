// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "strata/overlay/block_facets.hpp"
#include "strata/overlay/block_overlay.hpp"

namespace realmodel::strata {

/// What the envelope is all over a tile that no border crosses.
enum Cover : std::uint8_t { kRock, kSkyOnly, kOutsideOnly };

/// Instead of a block: not known beside a border, none yet, several, the outside, the sky.
inline constexpr std::int32_t kBesideBorder = -5, kNoLabel = -4, kSeveral = -3, kOutsideLabel = -2,
                              kSkyLabel = -1;

/// Heights in every tile.
struct TileHeights {
    std::vector<double> low, high;
    explicit TileHeights(std::size_t tiles) : low(tiles, HUGE_VAL), high(tiles, -HUGE_VAL) {}
    void include(std::size_t tile, double from, double to) {
        low[tile] = std::min(low[tile], from);
        high[tile] = std::max(high[tile], to);
    }
};

/// Heights of a surface in every tile, and where there is none.
struct BlockOverlay::SurfaceTiles : TileHeights {
    explicit SurfaceTiles(std::size_t tiles) : TileHeights(tiles), is_empty(tiles, 0) {}
    std::vector<std::uint8_t> is_empty;  ///< of tiles without a border
};

/// Heights and blocks beneath the envelope in every tile.
struct BlockOverlay::EnvelopeTiles : TileHeights {
    explicit EnvelopeTiles(std::size_t tiles) : TileHeights(tiles), label(tiles, kNoLabel) {}
    std::vector<std::int32_t> label;  ///< the block beneath, or kSeveral
};

/// What bounds tell of a surface and the envelope above it.
struct BlockOverlay::Classified {
    enum Surface : std::uint8_t { kBelow, kGone, kUnclear };
    enum Facet : std::uint8_t { kClosed, kKept, kKeptBare, kExact, kToCompare };
    std::vector<Surface> surface;          ///< of each triangle
    std::vector<std::int32_t> label;       ///< of each triangle below: the block above it
    std::vector<std::int32_t> node;        ///< of each triangle below: the node above it
    std::vector<Facet> whole, part;        ///< of each facet
    std::vector<std::uint8_t> is_unclear;  ///< of each tile: an unclear triangle meets it
    std::vector<std::int32_t> polygon;  ///< of each triangle: in the part overlaid exactly, or -1
    std::vector<std::uint8_t> is_divided;  ///< of each polygon of that part
    std::vector<LoweredPiece> lowered;
    PolygonPool lowered_outlines;
    std::int32_t first_closed = 0;  ///< node beneath the first of these, one after another
    std::vector<PlaneId> closed_whole;
    std::vector<std::size_t> closed_parts;
};

/// The middle of some corners, as rounding leaves it.
template <class Corners, class PointOf>
std::array<double, 2> middle_of(const Corners& corners, const PointOf& point_of) {
    std::array<double, 2> middle{0, 0};
    const double share = 1.0 / static_cast<double>(corners.size());
    for (const auto& corner : corners) {
        const exact::Point& p = point_of(corner);
        middle[0] += p.x * share;
        middle[1] += p.y * share;
    }
    return middle;
}

/// Where a place that rounding may have moved lies: 1 in a triangle for certain, -1 outside of it
/// for certain, 0 near its border.
int side_of_border(const exact::PlanArrangement& geometry, const PlanTriangle& triangle,
                   const std::array<double, 2>& place);

/// Plan positions of a triangle's corners.
inline std::array<std::array<double, 2>, 3> corners_of(const exact::PlanArrangement& geometry,
                                                       const PlanTriangle& triangle) {
    std::array<std::array<double, 2>, 3> p;
    for (std::size_t i = 0; i < 3; ++i)
        p[i] = {geometry.point(triangle[i]).x, geometry.point(triangle[i]).y};
    return p;
}

}  // namespace realmodel::strata
