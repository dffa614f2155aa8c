// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "strata/overlay/envelope.hpp"
#include "strata/overlay/tiling_walk.hpp"

namespace realmodel::strata {

/// Where the surface lies against a facet of the envelope.
enum class PieceSide : std::int8_t {
    kBelow,     ///< below it somewhere and above it nowhere
    kNotBelow,  ///< on or above it: eroded away here
    kAbsent     ///< there is no surface
};

/// The intersection of a facet and one polygon of the tiling.
struct Piece {
    std::int32_t polygon;  ///< of the tiling
    PieceSide side;
    std::int64_t first;  ///< corners within Pieces::corners
    std::int64_t last;
};

/// The overlay of one facet with the tiling: convex pieces that tile the facet.
struct Pieces {
    Array<Piece> list;
    Array<Corner> corners;
    Array<std::uint8_t> touches;  ///< for each corner: 1 where facet and surface are equally high
    bool is_clear = true;  ///< all lie below the facet by far more than rounding moves heights

    void clear() {
        list.clear();
        corners.clear();
        touches.clear();
        is_clear = true;
    }
    PolygonView outline(const Piece& piece) const {
        return {corners.data() + piece.first, static_cast<std::size_t>(piece.last - piece.first)};
    }
};

/// Finds the pieces of facets, one after another, in one thread's scope.
class PieceFinder {
public:
    PieceFinder(LocalArrangement& scope, const SurfaceTiling& tiling)
        : scope_(scope), clipper_(scope), walk_(scope, tiling), tiling_(tiling) {}

    /// Pieces of the facet with this outline and plane. All that there is lies below the sky, and
    /// none of it below a void.
    /// @param may_stay  whether pieces may lack outlines where all of the facet stays as it is
    const Pieces& find(PolygonView outline, PlaneId plane, bool may_stay = false);
    /// Polygons of the tiling that share an area with the outline.
    std::span<const std::int32_t> overlapping(PolygonView outline);

private:
    /// A facet of the envelope.
    struct EnvelopeFacet {
        PolygonView outline;
        PlaneId plane;
        HeightRange heights;
    };
    PolygonView outline_of(std::int32_t polygon) const {
        return tiling_.polygons[static_cast<std::size_t>(polygon)];
    }
    void note_room(PlaneId surface, const EnvelopeFacet& facet, const HeightRange& heights,
                   PolygonView common);
    bool is_higher(std::int32_t polygon, const EnvelopeFacet& facet) const;
    bool is_expected(PolygonView outline) const;
    bool find_candidates(PolygonView outline);
    void add_common(std::int32_t polygon, PolygonView common, const EnvelopeFacet& facet);
    void add(std::int32_t polygon, PieceSide side, PolygonView outline);
    void classify(std::int32_t polygon, PlaneId facet_plane, PolygonView common);

    LocalArrangement& scope_;
    Clipper clipper_;
    TilingWalk walk_;
    const SurfaceTiling& tiling_;
    Pieces pieces_;
    /// Of surface less facet at the corners of a intersection, and of facet less surface.
    std::vector<std::int8_t> signs_, opposite_;
    Polygon half_;
    Array<std::int32_t> candidates_, overlapping_;
    std::size_t expected_ = 0;  ///< polygon after the last that was a facet: the next one's, often
};

/// Groups the pieces below a facet into cells. Pieces are joined across edges where the cell is
/// thick and the surface runs on; where joining would make a cell touch itself, every piece becomes
/// a cell of its own (each is a column under one plane over one plane, which never does).
class PieceGrouping {
public:
    PieceGrouping(LocalArrangement& scope, const SurfaceTiling& tiling)
        : scope_(scope), tiling_(tiling) {}

    /// group[i] is the cell of piece i, numbered from 0 in order of first piece; -1 if not below.
    /// Returns the number of cells.
    std::int32_t group(PolygonView facet, const Pieces& pieces, std::vector<std::int32_t>& group);

private:
    struct PieceEdge {
        PointId from, to;
        std::int32_t piece;
        bool below;  ///< the piece is
        bool thin;   ///< the cell has no thickness along it

        std::pair<PointId, PointId> key() const { return {std::min(from, to), std::max(from, to)}; }
    };
    bool joined(const Pieces& pieces, const PieceEdge& a, const PieceEdge& b);
    bool on_border(PolygonView facet, const PieceEdge& edge);
    void collect_edges(const Pieces& pieces);

    LocalArrangement& scope_;
    const SurfaceTiling& tiling_;
    std::vector<PieceEdge> edges_;
    std::vector<std::uint8_t> is_joined_;  ///< for each edge
    std::vector<std::pair<std::int32_t, PointId>> border_;
};

}  // namespace realmodel::strata
