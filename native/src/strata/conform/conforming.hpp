// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/flat_array.hpp"
#include "realmodel/strata/stack.hpp"
#include "strata/conform/corner_offsets.hpp"
#include "strata/conform/matched_edges.hpp"
#include "strata/overlay/envelope.hpp"

namespace realmodel::strata {

/// Index of a place: one position in plan, however many points are named there.
using PlanVertexId = std::int32_t;

using PlanPosition = std::array<double, 2>;

/// A point that a line must pass, though no edge ends there: where heights of the columns on its
/// two sides cross.
struct ExtraPoint {
    LineId line;
    PointId point;
};

/// The points in use, those in the same position taken together, in order of rounded x, then y.
struct PlanVertices {
    FlatArray<PlanVertexId> of_point;      ///< -1 for points that no face uses
    FlatArray<PointId> representative;     ///< an input vertex where one is there
    FlatArray<PlanPosition> position;      ///< rounded
    FlatArray<std::uint64_t> same_x_bits;  ///< of 64 places each: see has_same_x_next
    std::vector<PlanVertexId>
        coincident;  ///< those that round to the position of the place before them

    std::size_t size() const { return representative.size(); }
    /// Whether the next place rounds to the same x.
    bool has_same_x_next(PlanVertexId place) const {
        const auto p = static_cast<std::size_t>(place);
        return (same_x_bits[p / 64] >> (p % 64) & 1) != 0;
    }
};
PlanVertices find_plan_vertices(const exact::PlanArrangement& geometry, const FaceList& faces,
                                const std::vector<ExtraPoint>& extra, int threads,
                                const Progress* progress);

/// The lines in use, those that run through the same places taken together, each with the face
/// edges on it. A track runs to rising x, or to rising y where x does not change.
struct CollinearEdges {
    FlatArray<LineId> representative;  ///< the lowest line of each track; tracks are in its order
    FlatArray<std::uint32_t> edge_offsets;
    FlatArray<LineEdge> edges;
    std::vector<PassedVertices> passed;  ///< by the edges of so many tracks each
    std::vector<MatchedEdges> paired;    ///< of the tracks that are left out above

    std::size_t size() const { return representative.size(); }
};
/// @param cell_is_thick  if given, tracks on which all edges are pairs (track_pairs.hpp) are left
/// out:
///     their walls are planned, and their edges pass only what others need
CollinearEdges find_collinear_edges(const exact::PlanArrangement& geometry, const FaceList& faces,
                                    const PlanVertices& places,
                                    const std::vector<ExtraPoint>& extra,
                                    const GrowingArray<std::uint8_t>* cell_is_thick, int threads,
                                    const Progress* progress);

/// A vertex on an edge that has no entry for it: it follows a given entry.
struct InsertedVertex {
    std::uint32_t entry;
    std::int32_t vertex;
};

/// The faces with every vertex that lies on their edges put in, and all vertices: on each place one
/// for each height that a corner or an edge needs there, ascending.
struct ConformedFaces {
    FlatArray<std::uint32_t> face_offsets;  ///< entries of each face
    CornerOffsets entries;                  ///< of each corner
    /// Of each entry, counter-clockwise in plan; -1 where an edge passes a place tentatively and
    /// nothing else is as high there.
    FlatArray<std::int32_t> vertices;
    std::vector<InsertedVertex> late;       ///< in order of entries
    FlatArray<std::int32_t> place_offsets;  ///< first vertex of each place
    /// Of the vertices, for so many places each: rounded, those of a place all different.
    std::vector<std::vector<double>> heights;
    static constexpr std::size_t kVerticesTogether = 1 << 11;
    GrowingArray<std::array<double, 3>> positions;  ///< empty until set_vertex_positions
};
/// Takes what it needs of the tracks: what they have `passed` is given back, and their edges name
/// the first of their entries from here on.
ConformedFaces conform_faces(const exact::PlanArrangement& geometry, const FaceList& faces,
                             const PlanVertices& places, CollinearEdges& tracks, int threads,
                             const Progress* progress);

/// Gives the vertices their positions, which takes the heights.
void set_vertex_positions(const PlanVertices& places, ConformedFaces& loops, int threads,
                          const Progress* progress);

}  // namespace realmodel::strata
