// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "strata/conform/conforming.hpp"
#include "strata/overlay/border_edges.hpp"

namespace realmodel::strata {

/// A stretch of vertical face between two neighbouring places of a track, with nodes of different
/// blocks on its sides.
struct WallStretch {
    std::int32_t track, interval;
    std::array<std::int32_t, 2> lower, upper;  ///< vertices at the first place and the second
    std::int32_t left, right;                  ///< nodes, or kOutsideCell
};

/// What stands on the tracks of faces between nodes.
struct TrackContacts {
    std::vector<std::pair<std::int32_t, std::int32_t>> links;  ///< nodes of one block that touch
    std::vector<WallStretch> walls;                            ///< in order of track and interval
    std::vector<ExtraPoint> missing;  ///< points that tracks must pass before anything else
};

/// Where a border runs along a track all faces on both sides of it are there, and what is between
/// them is compared; elsewhere a face goes on beyond the track as it is, and so do the nodes above
/// and below it.
TrackContacts find_contacts(exact::PlanArrangement& geometry, const FaceList& faces,
                            const std::vector<std::int32_t>& node_block, const PlanVertices& places,
                            const CollinearEdges& tracks, const ConformedFaces& loops,
                            const BorderEdges& borders, int threads, const Progress* progress);

/// Walls between cells. Loops counter-clockwise seen from the right of their track.
struct Walls {
    std::vector<std::int64_t> offsets{0};
    std::vector<std::int32_t> vertices;
    std::vector<std::array<std::int32_t, 2>> cells;  ///< left and right of the track
};

/// Walls as faces between parts: stretches that go on without a change joined, vertices that
/// nothing needs left out. Marks in `is_needed` the vertices that end a vertical edge, and those of
/// `may_bend` that a wall passes: where heights of the two sides cross, no face has a corner.
Walls join_walls(const std::vector<WallStretch>& stretches,
                 std::span<const std::array<double, 3>> positions,
                 const std::vector<std::uint8_t>& may_bend, std::vector<std::uint8_t>& is_needed);

}  // namespace realmodel::strata
