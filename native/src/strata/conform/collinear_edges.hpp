// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "strata/conform/plan_vertices.hpp"

namespace realmodel::strata {

/// A face edge on its line.
struct LineEdge {
    std::int32_t from, to;  ///< its ends, counted along the line; at first, the plan vertices there
    std::uint32_t begin;    ///< the corner that it leaves; of conformed faces, its first entry
    std::int32_t face;
};

/// Two edges of faces, one on either side of a line, that are one segment in space.
struct MatchedPair {
    std::uint32_t left, right;  ///< the corners that the edges leave
};

/// What is kept of lines on which all edges match.
///
/// There the columns on the two sides have the same curves, so no wall ends anywhere but at corners
/// of both curves that bound it, and which curves those are follows from the cells alone. Heights
/// need not be compared, and an edge need not pass the plan vertices where only others end.
struct MatchedEdges {
    struct Wall {
        std::array<std::int32_t, 2> cells;  ///< left and right of the line
        std::uint32_t above, beneath;       ///< how many edges bound it there
    };
    Array<Wall> walls;
    /// Of each wall: the corners that the edges above it leave, on the left and along the line, and
    /// the corner where they end; the same for those beneath.
    Array<std::uint32_t> corners;
    std::vector<MatchedPair> passing;  ///< edges that pass plan vertices tentatively
};

/// The plan vertices that face edges pass between their ends, one edge after another.
struct PassedVertices {
    struct PassingEdge {
        std::uint32_t corner;  ///< that the edge leaves
        std::uint32_t count : 31;
        std::uint32_t is_tentative : 1;  ///< inserted only where something else needs a vertex
    };
    std::vector<PassingEdge> edges;
    std::vector<std::int32_t> vertices;  ///< `count` for each edge, in its direction
};

/// The supporting lines of face edges, each with the edges on it. Lines that run through the same
/// points are one supporting line; it runs to rising x, or to rising y where x does not change.
struct CollinearEdges {
    Array<LineId> representative;  ///< the lowest of its lines; supporting lines have this order
    Array<std::uint32_t> edge_offsets;
    Array<LineEdge> edges;
    std::vector<PassedVertices> passed;  ///< by the edges of so many lines each
    std::vector<MatchedEdges> matched;   ///< of the lines that are left out above

    std::size_t size() const { return representative.size(); }
};
/// @param cell_is_thick  if given, lines on which all edges match are left out: their walls are
///     planned, and their edges pass only what others need
CollinearEdges find_collinear_edges(const exact::PlanArrangement& geometry, const FaceList& faces,
                                    const PlanVertices& plan_vertices,
                                    const std::vector<ExtraPoint>& extra,
                                    const Array<std::uint8_t>* cell_is_thick,
                                    const Execution& execution,
                                    const std::vector<std::uint8_t>* left_out = nullptr);

}  // namespace realmodel::strata
