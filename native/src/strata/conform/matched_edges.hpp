// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "strata/overlay/envelope.hpp"

namespace realmodel::strata {

/// A face edge on its line.
struct LineEdge {
    std::int32_t from, to;  ///< its ends, counted along the line; at first, the plan vertices there
    std::uint32_t
        begin;  ///< the corner, of all faces, that it leaves; for conformed: its first entry
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

/// Finds the matches of one line after another.
class EdgeMatching {
public:
    EdgeMatching(const exact::PlanArrangement& geometry, const FaceList& faces,
                 const Array<std::uint8_t>* cell_is_thick)
        : geometry_(geometry), faces_(faces), cell_is_thick_(cell_is_thick) {}

    /// Matches the edges of a line.
    /// @param edges  with their ends counted along the line, or plan vertices whose numbers rise
    /// along it
    /// @param line  the line of the line
    /// @return whether all match and the walls between them follow from that; then thin() and
    ///     add_walls() are of this line
    bool match_all(std::span<const LineEdge> edges, LineId line);

    struct Pair {
        const LineEdge *left, *right;
    };
    /// The matches beside which a cell, or what was left out, is not thick.
    const std::vector<Pair>& thin() const { return thin_; }
    /// Adds the walls of the line matched last.
    void add_walls(MatchedEdges& to) const;

private:
    /// An edge by its ends, in order along the line, and its side.
    struct Segment {
        std::uint64_t ends_and_side;
        const LineEdge* edge;

        std::uint64_t ends() const { return ends_and_side >> 1; }
        bool is_right() const { return (ends_and_side & 1) != 0; }
    };
    /// What tells the line in space that an edge is on: the input edge over the line of the line,
    /// or its plane.
    using Name = exact::EdgeOrPlane;
    /// A pair that bounds a wall between two cells.
    struct Bound {
        std::uint64_t cells;        ///< left and right of the line
        std::uint64_t plan_vertex;  ///< whether the wall stands on it, and where it begins
        const LineEdge* edge;       ///< the left one

        bool is_beneath() const { return plan_vertex >> 32 != 0; }
    };
    /// Bounds of one wall, as ranges of bounds_.
    struct Wall {
        std::size_t above, beneath, above_end, beneath_end;
    };

    PlaneId plane_of(const LineEdge& edge) const {
        return faces_.plane[static_cast<std::size_t>(edge.face)];
    }
    Name name(const LineEdge& edge, const exact::Line& line) const;
    bool find_matches(std::span<const LineEdge> edges, LineId line);
    bool are_one_line(const LineEdge& left, const LineEdge& right, const exact::Line& line);
    bool match(std::span<Segment> left, std::span<Segment> right, const exact::Line& line);
    void add(const Pair& pair);
    void add_bound(const std::array<std::int32_t, 2>& nodes, std::int32_t is_beneath,
                   const LineEdge& left);
    void sort_bounds();
    bool find_walls();
    std::uint32_t end_corner(const LineEdge& edge) const;

    const exact::PlanArrangement& geometry_;
    const FaceList& faces_;
    const Array<std::uint8_t>* cell_is_thick_;
    Array<Segment> segments_;
    std::array<PlaneId, 2> same_{kNone,
                                 kNone};  ///< planes that have the line of the line in common
    std::vector<std::pair<Name, const LineEdge*>> left_names_, right_names_;
    std::vector<Pair> thin_;
    Array<Bound> bounds_, beneath_;
    std::vector<Wall> walls_;
};

}  // namespace realmodel::strata
