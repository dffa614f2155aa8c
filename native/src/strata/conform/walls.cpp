// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <utility>

#include "base/parallel_counts.hpp"
#include "strata/conform/interval_curves.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kTracks = 1 << 10;  // worked on at a time

/// What the walls of some tracks are found in.
struct Batch {
    explicit Batch(const PlanArrangement& geometry) : scope(geometry) {}
    LocalArrangement scope;
    WallBatch walls;
    std::vector<ExtraPoint> missing;
};

/// The walls of one track after another.
class TrackWalls {
public:
    TrackWalls(const FaceList& faces, const CollinearEdges& tracks, const ConformedFaces& loops,
               Batch& batch)
        : curves_(faces, tracks, loops), batch_(batch) {}

    void process(std::size_t track) {
        curves_.collect(track);
        for (std::size_t i = 0; i < curves_.intervals(); ++i) {
            process_interval(track, curves_.of_interval(i));
            // what did not go on in this interval is finished
            finish_open();
            std::swap(open_, growing_);
        }
        finish_open();
    }

private:
    void process_interval(std::size_t track, std::span<const Curve> curves) {
        // The common case: one face edge on either side, the same cells above and below.
        if (curves.size() == 2) {
            const Curve &a = curves[0], &b = curves[1];
            if (a.left != b.left && a.as_high_as(b) && a.above == b.above && a.below == b.below) {
                return;
            }
        }
        const std::size_t known = batch_.missing.size();
        curves_.find_crossings(track, curves, batch_.scope, batch_.missing);
        if (batch_.missing.size() > known) return;
        for_each_gap(curves, [&](const Curve& low, const Curve& high, std::int32_t left,
                                 std::int32_t right) {
            if (left != right) add_wall(low, high, left, right);
        });
    }

    /// A wall between two cells that may go on in the next interval.
    struct OpenWall {
        std::int32_t left = kOutsideCell, right = kOutsideCell;
        std::vector<std::int32_t> lower, upper;  ///< vertices along the track
    };

    /// Walls that keep their memory when they are removed.
    struct OpenWalls {
        std::vector<OpenWall> all;
        std::size_t count = 0;

        OpenWall& add() {
            if (count == all.size()) all.emplace_back();
            return all[count++];
        }
        OpenWall* begin() { return all.data(); }
        OpenWall* end() { return all.data() + count; }
    };

    // Walls of neighbouring intervals between the same cells are one face where they share a whole
    // vertical edge: it would bound nothing.
    void add_wall(const Curve& low, const Curve& high, std::int32_t left, std::int32_t right) {
        const auto continues = [&](const OpenWall& wall) {
            return wall.left == left && wall.right == right && wall.lower.back() == low.start &&
                   wall.upper.back() == high.start && low.start != high.start;
        };
        OpenWall* before = std::find_if(open_.begin(), open_.end(), continues);
        OpenWall& wall = growing_.add();
        if (before == open_.end()) {
            wall.left = left;
            wall.right = right;
            wall.lower.assign({low.start, low.end});
            wall.upper.assign({high.start, high.end});
            return;
        }
        std::swap(wall, *before);
        std::rotate(before, before + 1, open_.end());
        --open_.count;
        wall.lower.push_back(low.end);
        wall.upper.push_back(high.end);
    }

    void finish_open() {
        for (const OpenWall& wall : open_)
            emit(wall);
        open_.count = 0;
    }

    void emit(const OpenWall& wall) {
        auto& loop = batch_.walls.vertices;
        const std::size_t first = loop.size();
        add_wall_loop(wall.lower, wall.upper, loop, [](std::int32_t) { return true; });
        batch_.walls.sizes.push_back(static_cast<std::int32_t>(loop.size() - first));
        batch_.walls.cells.push_back({wall.left, wall.right});
    }

    IntervalCurves curves_;
    Batch& batch_;
    OpenWalls open_, growing_;
};

/// The walls of tracks on which all edges are pairs.
class PlannedWalls {
public:
    PlannedWalls(const ConformedFaces& loops, WallBatch& walls) : loops_(loops), walls_(walls) {}

    void add(const MatchedEdges& paired) {
        const std::int32_t* next = paired.walls.data();
        const std::int32_t* const end = next + paired.walls.size();
        while (next < end) {
            for (std::ptrdiff_t ahead = 0; ahead < 8; ++ahead) {
                const auto corner = [&](std::ptrdiff_t further) {
                    return corner_of(next[std::min(further + ahead, end - 1 - next)]);
                };
                loops_.entries.prefetch(corner(96));
                prefetch(&loops_.vertices[loops_.entries.first(corner(48))]);
            }
            const std::array cells{next[0], next[1]};
            const std::int32_t above = next[2], beneath = next[3];
            next = collect(next + 4, above, upper_);
            next = collect(next, beneath, lower_);
            add_parts(cells);
        }
    }

private:
    /// A number of the plan as that of a corner: counts and cells are those of some corner, too.
    std::size_t corner_of(std::int32_t number) const {
        const auto corner = static_cast<std::size_t>(std::max(number, 0));
        return std::min(corner, loops_.entries.corners() - 1);
    }

    /// The vertices along some edges that follow each other.
    /// @return what comes after them in the plan
    const std::int32_t* collect(const std::int32_t* corner, std::int32_t count,
                                std::vector<std::int32_t>& vertices) const {
        vertices.clear();
        for (std::int32_t i = 0; i < count; ++i, ++corner) {
            const auto c = static_cast<std::size_t>(*corner);
            const std::uint32_t end = loops_.entries.first(c + 1);
            for (std::uint32_t e = loops_.entries.first(c); e < end; ++e) {
                if (loops_.vertices[e] >= 0) vertices.push_back(loops_.vertices[e]);
            }
        }
        const auto end = static_cast<std::size_t>(*corner);
        vertices.push_back(loops_.vertices[loops_.entries.first(end)]);
        return corner + 1;
    }

    /// Adds the wall between upper_ and lower_, divided where these touch on the way.
    void add_parts(const std::array<std::int32_t, 2>& cells) {
        std::size_t u = 0, l = 0;
        while (u + 1 < upper_.size() && l + 1 < lower_.size()) {
            const auto [next_u, next_l] = next_contact(u, l);
            const bool is_flat = next_u == u + 1 && next_l == l + 1 && upper_[u] == lower_[l] &&
                                 upper_[next_u] == lower_[next_l];
            if (!is_flat) {
                auto& loop = walls_.vertices;
                const std::size_t first = loop.size();
                add_wall_loop(std::span(lower_).subspan(l, next_l - l + 1),
                              std::span(upper_).subspan(u, next_u - u + 1), loop,
                              [](std::int32_t) { return true; });
                walls_.sizes.push_back(static_cast<std::int32_t>(loop.size() - first));
                walls_.cells.push_back(cells);
            }
            u = next_u;
            l = next_l;
        }
    }

    /// Where upper_ and lower_ have a vertex in common next, or end.
    std::pair<std::size_t, std::size_t> next_contact(std::size_t u, std::size_t l) const {
        for (std::size_t i = u + 1; i < upper_.size(); ++i) {
            const auto at = std::find(lower_.begin() + static_cast<std::ptrdiff_t>(l) + 1,
                                      lower_.end(), upper_[i]);
            if (at != lower_.end()) return {i, static_cast<std::size_t>(at - lower_.begin())};
        }
        return {upper_.size() - 1, lower_.size() - 1};
    }

    const ConformedFaces& loops_;
    WallBatch& walls_;
    std::vector<std::int32_t> upper_, lower_;
};

}  // namespace

std::vector<WallBatch> find_walls(PlanArrangement& geometry, const FaceList& faces,
                                  CollinearEdges& tracks, const ConformedFaces& loops,
                                  std::vector<ExtraPoint>& missing, int threads,
                                  const Progress* progress) {
    const std::size_t chunks = (tracks.size() + kTracks - 1) / kTracks;
    std::vector<WallBatch> walls(chunks);
    std::vector<std::unique_ptr<Batch>> with_missing(chunks);
    parallel_ranges(tracks.size(), kTracks, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        auto batch = std::make_unique<Batch>(geometry);
                        TrackWalls of_track(faces, tracks, loops, *batch);
                        for (std::size_t t = begin; t < end; ++t)
                            of_track.process(t);
                        walls[begin / kTracks] = std::move(batch->walls);
                        if (!batch->missing.empty())
                            with_missing[begin / kTracks] = std::move(batch);
                    });
    missing.clear();
    for (const auto& batch : with_missing) {
        if (batch == nullptr) continue;
        batch->scope.commit(geometry);
        for (const ExtraPoint& e : batch->missing)
            missing.push_back({e.line, batch->scope.shared_point(e.point)});
    }
    if (!missing.empty()) return {};
    walls.resize(chunks + tracks.paired.size());
    parallel_chunks(tracks.paired.size(), threads, progress, [&](std::size_t chunk) {
        const MatchedEdges paired = std::move(tracks.paired[chunk]);
        WallBatch& batch = walls[chunks + chunk];
        batch.sizes.reserve(paired.wall_count);
        batch.cells.reserve(paired.wall_count);
        PlannedWalls(loops, batch).add(paired);
    });
    return walls;
}

}  // namespace realmodel::strata
