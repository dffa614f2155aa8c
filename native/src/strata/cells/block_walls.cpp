// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/block_walls.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/parallel.hpp"
#include "strata/conform/interval_curves.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

struct ContactBatch {
    explicit ContactBatch(const PlanArrangement& geometry) : scope(geometry) {}
    LocalArrangement scope;
    TrackContacts found;
};

/// What touches on one track after another.
class TrackComparison {
public:
    TrackComparison(const FaceList& faces, const std::vector<std::int32_t>& node_block,
                    const PlanVertices& places, const CollinearEdges& tracks,
                    const ConformedFaces& loops, const BorderEdges& borders, ContactBatch& batch)
        : node_block_(node_block),
          places_(places),
          loops_(loops),
          borders_(borders),
          curves_(faces, tracks, loops),
          batch_(batch) {}

    void process(std::size_t track) {
        curves_.collect(track);
        for (std::size_t i = 0; i < curves_.intervals(); ++i) {
            const std::span<const Curve> curves = curves_.of_interval(i);
            if (curves.empty() || go_on(curves)) continue;
            if (may_have_walls(curves.front())) {
                compare_columns(track, i, curves);
            } else {
                continue_faces(curves);
            }
        }
    }

private:
    /// The common case: one face on either side, as high, between the same blocks. Their nodes hang
    /// together whether walls may stand here or not.
    bool go_on(std::span<const Curve> curves) {
        if (curves.size() != 2) return false;
        const Curve &a = curves[0], &b = curves[1];
        if (a.left == b.left || !a.as_high_as(b) || block(a.above) != block(b.above) ||
            block(a.below) != block(b.below))
            return false;
        link(a.above, b.above);
        link(a.below, b.below);
        return true;
    }

    bool may_have_walls(const Curve& curve) {
        const auto& p = loops_.positions[static_cast<std::size_t>(curve.start)];
        const auto& q = loops_.positions[static_cast<std::size_t>(curve.end)];
        const TileSpan span = borders_.tiles().span({std::min(p[0], q[0]), std::min(p[1], q[1]),
                                                     std::max(p[0], q[0]), std::max(p[1], q[1])});
        return borders_.near(span) &&
               borders_.run_between(batch_.scope, point_of(curve.start), point_of(curve.end), span);
    }
    PointId point_of(std::int32_t vertex) const {
        const auto& first = loops_.place_offsets;
        const auto after = std::upper_bound(first.begin(), first.end(), vertex);
        return places_.representative[static_cast<std::size_t>(after - first.begin()) - 1];
    }

    void link(std::int32_t a, std::int32_t b) {
        if (a != b && a >= 0 && b >= 0 && block(a) == block(b))
            batch_.found.links.emplace_back(a, b);
    }
    std::int32_t block(std::int32_t node) const {
        return node < 0 ? kOutsideCell : node_block_[static_cast<std::size_t>(node)];
    }

    /// No wall: what is above the uppermost face at a height, and what is below the lowest one,
    /// goes on beyond the track.
    void continue_faces(std::span<const Curve> curves) {
        for (std::size_t i = 0; i < curves.size();) {
            std::size_t right = i;  // the first curve to the left of the track at this height
            while (right < curves.size() && curves[right].as_high_as(curves[i]) &&
                   !curves[right].left)
                ++right;
            std::size_t level = right;
            while (level < curves.size() && curves[level].as_high_as(curves[i]))
                ++level;
            if (i < right && right < level) {
                link(curves[right - 1].above, curves[level - 1].above);
                link(curves[i].below, curves[right].below);
            }
            i = level;
        }
    }

    void compare_columns(std::size_t track, std::size_t interval, std::span<const Curve> curves) {
        const std::size_t known = batch_.found.missing.size();
        curves_.find_crossings(track, curves, batch_.scope, batch_.found.missing);
        if (batch_.found.missing.size() > known) return;
        for_each_gap(curves, [&](const Curve& low, const Curve& high, std::int32_t left,
                                 std::int32_t right) {
            if (block(left) != block(right)) {
                batch_.found.walls.push_back({static_cast<std::int32_t>(track),
                                              static_cast<std::int32_t>(interval),
                                              {low.start, low.end},
                                              {high.start, high.end},
                                              left,
                                              right});
            } else {
                link(left, right);
            }
        });
    }

    const std::vector<std::int32_t>& node_block_;
    const PlanVertices& places_;
    const ConformedFaces& loops_;
    const BorderEdges& borders_;
    IntervalCurves curves_;
    ContactBatch& batch_;
};

}  // namespace

TrackContacts find_contacts(PlanArrangement& geometry, const FaceList& faces,
                            const std::vector<std::int32_t>& node_block, const PlanVertices& places,
                            const CollinearEdges& tracks, const ConformedFaces& loops,
                            const BorderEdges& borders, int threads, const Progress* progress) {
    constexpr std::size_t kChunk = 1024;
    const std::size_t chunks = (tracks.size() + kChunk - 1) / kChunk;
    std::vector<std::unique_ptr<ContactBatch>> batches(chunks);
    parallel_chunks(chunks, threads, progress, [&](std::size_t chunk) {
        batches[chunk] = std::make_unique<ContactBatch>(geometry);
        TrackComparison comparison(faces, node_block, places, tracks, loops, borders,
                                   *batches[chunk]);
        for (std::size_t t = chunk * kChunk; t < std::min(tracks.size(), (chunk + 1) * kChunk); ++t)
            comparison.process(t);
    });
    TrackContacts contacts;
    for (auto& batch : batches) {
        batch->scope.commit(geometry);
        const TrackContacts& found = batch->found;
        for (const ExtraPoint& e : found.missing) {
            contacts.missing.push_back({e.line, batch->scope.shared_point(e.point)});
        }
        contacts.links.insert(contacts.links.end(), found.links.begin(), found.links.end());
        contacts.walls.insert(contacts.walls.end(), found.walls.begin(), found.walls.end());
        batch.reset();
    }
    return contacts;
}

namespace {

/// A wall that may go on in the next interval.
struct OpenWall {
    std::int32_t left, right;
    std::vector<std::int32_t> lower, upper;  ///< vertices along the track
};

/// Whether walls beside each other at a vertical edge make one face: where the edge is much longer
/// than what rounding moves places by, for rounded places are not quite on one line.
bool is_high(std::span<const std::array<double, 3>> positions, std::int32_t lower,
             std::int32_t upper) {
    const auto& p = positions[static_cast<std::size_t>(lower)];
    const auto& q = positions[static_cast<std::size_t>(upper)];
    return q[2] - p[2] > 0x1p-26 * std::max(std::abs(p[0]), std::abs(p[1]));
}

std::vector<OpenWall> joined(const std::vector<WallStretch>& stretches,
                             std::span<const std::array<double, 3>> positions) {
    std::vector<OpenWall> walls;
    std::vector<std::size_t> open, growing;  // of the interval before, of this one
    for (std::size_t i = 0; i < stretches.size();) {
        std::size_t end = i;
        while (end < stretches.size() && stretches[end].track == stretches[i].track &&
               stretches[end].interval == stretches[i].interval)
            ++end;
        const bool goes_on = i > 0 && stretches[i - 1].track == stretches[i].track &&
                             stretches[i - 1].interval + 1 == stretches[i].interval;
        if (!goes_on) open.clear();
        growing.clear();
        for (; i < end; ++i) {
            const WallStretch& s = stretches[i];
            const auto before = std::find_if(open.begin(), open.end(), [&](std::size_t w) {
                return walls[w].left == s.left && walls[w].right == s.right &&
                       walls[w].lower.back() == s.lower[0] && walls[w].upper.back() == s.upper[0] &&
                       is_high(positions, s.lower[0], s.upper[0]);
            });
            if (before == open.end()) {
                growing.push_back(walls.size());
                walls.push_back(
                    {s.left, s.right, {s.lower[0], s.lower[1]}, {s.upper[0], s.upper[1]}});
                continue;
            }
            walls[*before].lower.push_back(s.lower[1]);
            walls[*before].upper.push_back(s.upper[1]);
            growing.push_back(*before);
            open.erase(before);
        }
        std::swap(open, growing);
    }
    return walls;
}

}  // namespace

Walls join_walls(const std::vector<WallStretch>& stretches,
                 std::span<const std::array<double, 3>> positions,
                 const std::vector<std::uint8_t>& may_bend, std::vector<std::uint8_t>& is_needed) {
    const std::vector<OpenWall> open = joined(stretches, positions);
    for (const WallStretch& s : stretches) {
        for (const std::int32_t v : {s.lower[0], s.lower[1], s.upper[0], s.upper[1]})
            is_needed[static_cast<std::size_t>(v)] |= may_bend[static_cast<std::size_t>(v)];
    }
    for (const OpenWall& wall : open) {
        for (const std::int32_t v :
             {wall.lower.front(), wall.lower.back(), wall.upper.front(), wall.upper.back()})
            is_needed[static_cast<std::size_t>(v)] = 1;
    }
    Walls walls;
    for (const OpenWall& wall : open) {
        add_wall_loop(wall.lower, wall.upper, walls.vertices,
                      [&](std::int32_t v) { return is_needed[static_cast<std::size_t>(v)] != 0; });
        walls.offsets.push_back(static_cast<std::int64_t>(walls.vertices.size()));
        walls.cells.push_back({wall.left, wall.right});
    }
    return walls;
}

}  // namespace realmodel::strata
