// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "strata/overlay/envelope.hpp"

namespace realmodel::strata {

/// A face edge on its track.
struct LineEdge {
    std::int32_t from, to;  ///< its ends, counted along the track; at first, the places there
    std::uint32_t begin;  ///< the corner, of all faces, that it leaves; for loops: its first entry
    std::int32_t face;
};

/// Two edges of faces, one on either side of a track, that are one stretch of line in space.
struct EdgePair {
    std::uint32_t left, right;  ///< the corners that the edges leave
};

/// What is kept of tracks on which all edges are pairs.
///
/// There the columns on the two sides have the same curves, so no wall ends anywhere but at corners
/// of both curves that bound it, and which curves those are follows from the cells alone. Heights
/// need not be compared, and an edge need not pass the places where only others end.
struct MatchedEdges {
    /// Walls one after another: the cells left and right of the track; how many edges are above
    /// and how many beneath; the corners that the edges above leave, on the left and along the
    /// track, and the corner where they end; the same for those beneath.
    GrowingArray<std::int32_t> walls;
    std::size_t wall_count = 0;
    std::vector<EdgePair> passing;  ///< pairs that pass places tentatively
};

/// Finds the pairs of one track after another.
class TrackPairing {
public:
    TrackPairing(const exact::PlanArrangement& geometry, const FaceList& faces)
        : geometry_(geometry), faces_(faces) {}

    /// Pairs the edges of a track.
    /// @param edges  with their ends counted along the track, or places whose numbers rise along it
    /// @param line  the line of the track
    /// @return whether all are pairs and the walls between them follow from that; then pairs() and
    ///     add_walls() are of this track
    bool pair(std::span<const LineEdge> edges, LineId line);

    struct Pair {
        const LineEdge *left, *right;
    };
    const std::vector<Pair>& pairs() const { return pairs_; }
    /// Adds the walls of the track paired last.
    void add_walls(MatchedEdges& to) const;

private:
    /// An edge by its ends, in order along the track, and its side.
    struct Stretch {
        std::uint64_t ends_and_side;
        const LineEdge* edge;

        std::uint64_t ends() const { return ends_and_side >> 1; }
        bool is_right() const { return (ends_and_side & 1) != 0; }
    };
    /// What tells the line in space that an edge is on: the input edge over the line of the track
    /// (two space vertices), or its plane (-1 and the plane).
    using Name = std::array<std::int32_t, 2>;
    /// A pair that bounds a wall between two cells.
    struct Bound {
        std::uint64_t cells;   ///< left and right of the track
        std::uint64_t place;   ///< whether the wall stands on it, and where it begins
        const LineEdge* edge;  ///< the left one

        bool is_beneath() const { return place >> 32 != 0; }
    };
    /// Bounds of one wall, as ranges of bounds_.
    struct Wall {
        std::size_t above, beneath, above_end, beneath_end;
    };

    PlaneId plane_of(const LineEdge& edge) const {
        return faces_.plane[static_cast<std::size_t>(edge.face)];
    }
    Name over(PlaneId plane, const exact::Line& line) const;
    Name name(const LineEdge& edge, const exact::Line& line) const;
    bool find_pairs(std::span<const LineEdge> edges, LineId line);
    bool are_one_line(const LineEdge& left, const LineEdge& right, const exact::Line& line);
    bool match(std::span<Stretch> left, std::span<Stretch> right, const exact::Line& line);
    void find_bounds();
    bool find_walls();
    std::int32_t end_corner(const LineEdge& edge) const;

    const exact::PlanArrangement& geometry_;
    const FaceList& faces_;
    std::vector<Stretch> stretches_;
    std::array<PlaneId, 2> same_{-1, -1};  ///< planes that have the line of the track in common
    std::vector<std::pair<Name, const LineEdge*>> left_names_, right_names_;
    std::vector<Pair> pairs_;
    std::vector<Bound> bounds_, beneath_;
    std::vector<Wall> walls_;
};

}  // namespace realmodel::strata
