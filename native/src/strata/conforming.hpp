// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "envelope.hpp"

namespace realmodel::strata {

/// Index of a place: one position in plan, however many points are named there.
using PlaceId = std::int32_t;

/// A point that a line must pass, though no edge ends there: where heights of the columns on its
/// two sides cross.
struct ExtraPoint {
    LineId line;
    PointId point;
};

/// The points in use, those in the same position taken together.
struct Places {
    std::vector<PlaceId> of_point;        ///< -1 for points that no face uses
    std::vector<PointId> representative;  ///< an input vertex where one is there
};
Places find_places(const exact::PlanGeometry& geometry, const FaceList& faces,
                   const std::vector<ExtraPoint>& extra, int threads, const Progress* progress);

/// The lines in use, those that run through the same places taken together, and their face edges.
/// Face edge e is the one that leaves corner e of the faces' corners.
struct Tracks {
    std::vector<std::int32_t> of_line;   ///< track of each line, -1 where unused
    std::vector<LineId> representative;  ///< a line of each track
    std::vector<std::uint8_t> against;   ///< for each line: 1 if it runs to falling x (or y)
    std::vector<std::int64_t> place_offsets;
    std::vector<PlaceId> places;  ///< of each track, in order along it
    std::vector<std::int64_t> edge_offsets;
    std::vector<std::int64_t> edges;      ///< of each track
    std::vector<std::int32_t> low, high;  ///< for each face edge: its ends, counted along its track
    std::vector<std::uint8_t> forward;    ///< for each face edge: 1 if it runs along its track

    std::size_t size() const { return representative.size(); }
};
Tracks find_tracks(const exact::PlanGeometry& geometry, const FaceList& faces, const Places& places,
                   const std::vector<ExtraPoint>& extra, int threads, const Progress* progress);

/// The faces with every vertex that lies on their edges put in, and all vertices: on each place one
/// for each height that a face has there, ascending.
struct Loops {
    std::vector<std::int64_t> face_offsets;        ///< entries of each face
    std::vector<std::int64_t> edge_offsets;        ///< first entry of each face edge
    std::vector<std::int32_t> vertices;            ///< of each entry, counter-clockwise in plan
    std::vector<std::int32_t> place_offsets;       ///< first vertex of each place
    std::vector<std::array<double, 3>> positions;  ///< rounded, all different
};
Loops find_loops(const exact::PlanGeometry& geometry, const FaceList& faces, const Places& places,
                 const Tracks& tracks, int threads, const Progress* progress);

/// A vertical face between two columns. Loop counter-clockwise seen from the right of its track.
struct Walls {
    std::vector<std::int64_t> offsets{0};
    std::vector<std::int32_t> vertices;
    std::vector<std::array<std::int32_t, 2>> cells;  ///< left and right of the track, -1 outside
};
/// The walls between columns; where columns left and right of a track cross in height, nothing but
/// the points that the tracks must pass first are returned in `missing`.
Walls find_walls(exact::PlanGeometry& geometry, const FaceList& faces, const Tracks& tracks,
                 const Loops& loops, std::vector<ExtraPoint>& missing, int threads,
                 const Progress* progress);

}  // namespace realmodel::strata
