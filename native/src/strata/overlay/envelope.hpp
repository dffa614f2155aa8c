// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "realmodel/base/array.hpp"
#include "strata/tiling/polygon.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

/// Instead of a node or a cell.
inline constexpr std::int32_t kOutsideCell = -1;
/// Instead of a node that is left out and may be thin; what is outside otherwise is thick.
inline constexpr std::int32_t kLeftOut = -2;
/// The node, or the outside also for one that is left out.
constexpr std::int32_t cell_of(std::int32_t node) {
    return node == kLeftOut ? kOutsideCell : node;
}

/// Convex plan polygons, the points of their corners and the lines of the edges that leave these
/// apart: who reads all of them wants one of the two.
struct SplitPolygons {
    Array<std::uint32_t> offsets{0};
    Array<PointId> points;
    Array<DirectedLine> lines;

    std::size_t size() const { return offsets.size() - 1; }
    void add(PolygonView polygon) {
        for (const Corner& corner : polygon) {
            points.push_back(corner.point);
            lines.push_back(corner.line);
        }
        offsets.push_back(static_cast<std::uint32_t>(points.size()));
    }
    Polygon operator[](std::size_t i) const {
        Polygon polygon;
        for (std::size_t c = offsets[i]; c < offsets[i + 1]; ++c)
            polygon.push_back({points[c], lines[c]});
        return polygon;
    }
};

/// Faces that are finished: convex plan polygons, each in the plane of a triangle, between two
/// nodes.
template <class Polygons>
struct FacesOf {
    Polygons polygons;
    Array<PlaneId> plane;
    Array<std::int32_t> surface;  ///< number of the surface that the face lies on, -1 the base
    Array<std::int32_t> above;    ///< node, kOutsideCell or kLeftOut
    Array<std::int32_t> below;

    std::size_t size() const { return plane.size(); }
    void add(PolygonView polygon, PlaneId in_plane, std::int32_t in_surface,
             std::int32_t node_above, std::int32_t node_below) {
        polygons.add(polygon);
        plane.push_back(in_plane);
        surface.push_back(in_surface);
        above.push_back(node_above);
        below.push_back(node_below);
    }
};
using FaceList = FacesOf<SplitPolygons>;

/// The lower envelope of the surfaces seen so far, youngest first: what survives of them, as convex
/// facets that tile the frame. Each facet lies in one plane and carries the faces that nodes above
/// it already have there; they tile the facet.
struct Envelope {
    PolygonPool outlines;
    Array<PlaneId> plane;               ///< kSky, kOutside, or the plane of a triangle
    Array<std::int32_t> surface;        ///< surface of the facet, -1 for the sky
    Array<std::int32_t> block_beneath;  ///< the last surface seen here, -1 the sky
    Array<std::int64_t> face_offsets{0};
    PolygonPool face_polygons;
    Array<std::int32_t> face_above;  ///< node above each face, kOutsideCell or kLeftOut

    std::size_t size() const { return plane.size(); }
    std::pair<std::size_t, std::size_t> faces_of(std::size_t facet) const {
        return {static_cast<std::size_t>(face_offsets[facet]),
                static_cast<std::size_t>(face_offsets[facet + 1])};
    }
    void add_facet(PolygonView outline, PlaneId in_plane, std::int32_t in_surface,
                   std::int32_t block) {
        outlines.add(outline);
        plane.push_back(in_plane);
        surface.push_back(in_surface);
        block_beneath.push_back(block);
        face_offsets.push_back(face_offsets.back());
    }
    /// Adds a facet of another envelope, with its faces.
    void add_facet_of(const Envelope& other, std::size_t facet, std::int32_t block) {
        add_facet(other.outlines[facet], other.plane[facet], other.surface[facet], block);
        const auto [begin, end] = other.faces_of(facet);
        for (std::size_t f = begin; f < end; ++f)
            add_face(other.face_polygons[f], other.face_above[f]);
    }
    /// Adds a face to the facet added last.
    void add_face(PolygonView polygon, std::int32_t node_above) {
        face_polygons.add(polygon);
        face_above.push_back(node_above);
        ++face_offsets.back();
    }
};

/// Nodes and faces made so far. A node is a piece of a block: a column, or what links join to the
/// cell of a whole block.
struct Construction {
    FaceList faces;
    Array<std::int32_t> node_block;
    /// Of each node: 1 where its top is above its bottom everywhere, its border included, by far
    /// more than rounding moves heights.
    Array<std::uint8_t> node_is_thick;
    std::vector<std::pair<std::int32_t, std::int32_t>> links;  ///< nodes of one block that touch
    bool may_lack_nodes = false;                               ///< whether kLeftOut stands for some
    bool is_local = false;  ///< edges have all vertices that lie on them

    /// @throws InputError kind too_large, where there are more nodes than numbers for them
    std::int32_t add_node(std::int32_t block, bool is_thick);
    /// Finishes the faces of a facet: the node beneath it is known now.
    void seal(const Envelope& envelope, std::size_t facet, std::int32_t node);
    /// Counts the blocks of a rock mass, whose nodes begin at `first_node`, among those of all.
    void count_blocks_from(std::size_t first_node, std::int32_t first_block);
};

/// @throws InputError kind too_large, where so many nodes have no numbers
void check_nodes(std::int64_t count);

/// The envelope before the first overlay: the youngest surface itself, or the region under the sky.
Envelope initial_envelope(const SurfaceTiling& tiling, std::int32_t number);

/// The lowest position of the facets that lie on surfaces.
std::array<double, 3> lowest_position(const exact::PlanArrangement& geometry,
                                      const Envelope& envelope);

/// Closes what is left: block 0 down to a flat base where there is one, the outside elsewhere.
/// @param is_thick  whether the base is far below all, see Construction
void finish(const Envelope& envelope, std::optional<PlaneId> base, bool is_thick,
            Construction& construction);

/// Pieces of a surface that lie below the envelope.
struct PiecesBelow {
    PolygonPool outlines;
    Array<std::int32_t> polygon;     ///< of the tiling
    Array<std::int32_t> node_above;  ///< node, kOutsideCell or kLeftOut
};

/// The pieces of each polygon.
struct PiecesOfPolygons {
    Array<std::uint32_t> offsets;
    Array<std::uint32_t> pieces;  ///< ascending for each polygon

    std::span<const std::uint32_t> operator[](std::size_t polygon) const {
        return {pieces.begin() + offsets[polygon], pieces.begin() + offsets[polygon + 1]};
    }
};
/// @throws InputError kind too_large, where there are more pieces than numbers for them
PiecesOfPolygons sort_by_polygon(const PiecesBelow& below, std::size_t polygons,
                                 const Execution& execution);

/// What becomes of a polygon of the surface: one facet, one of each piece, or nothing here.
enum PolygonUse : std::uint8_t { kUndivided, kDivided, kElsewhere };

/// Adds the facets of a surface to the envelope, in order of the tiling's polygons. One that
/// lies below the envelope all over becomes one facet again with the pieces as its faces, so that
/// the overlay does not compound; of divided ones each piece is a facet.
/// @param use  PolygonUse of each polygon
void add_surface_facets(const NumberedTiling& surface, const std::vector<std::uint8_t>& use,
                        const PiecesBelow& below, const PiecesOfPolygons& of_polygon,
                        Envelope& next, const Execution& execution);

}  // namespace realmodel::strata
