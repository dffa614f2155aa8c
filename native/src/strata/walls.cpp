// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <utility>

#include "conforming.hpp"
#include "parallel_counts.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;

namespace {

constexpr std::size_t kTracks = 1 << 10;  // worked on at a time

/// A face edge over one interval of a track: a straight line in height between two verticals.
struct Curve {
    std::int32_t start, end;  ///< vertices on the two verticals; ascending means rising
    std::int32_t face;
    std::int32_t above, below;  ///< cells
    bool left;                  ///< the face lies left of the track

    bool as_high_as(const Curve& other) const { return start == other.start && end == other.end; }
};

/// What the walls of some tracks are found in.
struct Batch {
    explicit Batch(const PlanGeometry& geometry) : scope(geometry) {}
    Scope scope;
    WallBatch walls;
    std::vector<ExtraPoint> missing;
};

/// The walls of one track after another.
class TrackWalls {
public:
    TrackWalls(const FaceList& faces, const Tracks& tracks, const Loops& loops, Batch& batch)
        : faces_(faces), tracks_(tracks), loops_(loops), batch_(batch) {}

    void process(std::size_t track) {
        collect(track);
        for (std::size_t i = 0; i + 1 < begins_.size(); ++i) {
            process_interval(track, begins_[i], begins_[i + 1]);
            // what did not go on in this interval is finished
            finish_open();
            std::swap(open_, growing_);
        }
        finish_open();
    }

private:
    /// Ascending; where two curves start at one vertex the lower end comes first, and of equal
    /// curves on one side the younger is the upper.
    bool before(const Curve& a, const Curve& b) const {
        if (a.start != b.start) return a.start < b.start;
        if (a.end != b.end) return a.end < b.end;
        if (a.left != b.left) return b.left;
        const auto layer = [&](const Curve& curve) {
            return faces_.layer[static_cast<std::size_t>(curve.face)];
        };
        return std::pair(layer(a), a.face) < std::pair(layer(b), b.face);
    }

    /// Puts the curves of a track in order of intervals, and those of each in order of height.
    void collect(std::size_t track) {
        const auto first = tracks_.edges.begin() + tracks_.edge_offsets[track];
        const auto last = tracks_.edges.begin() + tracks_.edge_offsets[track + 1];
        begins_.clear();
        for (auto edge = first; edge != last; ++edge) {
            const auto [low, high] = std::minmax(edge->from, edge->to);
            if (begins_.size() < static_cast<std::size_t>(high) + 1)
                begins_.resize(static_cast<std::size_t>(high) + 1, 0);
            for (std::int32_t i = low; i < high; ++i)
                ++begins_[static_cast<std::size_t>(i)];
        }
        std::uint32_t total = 0;
        for (std::uint32_t& begin : begins_) {
            const std::uint32_t own = begin;
            begin = total;
            total += own;
        }
        curves_.resize(total);
        free_.assign(begins_.begin(), begins_.end());
        for (auto edge = first; edge != last; ++edge) {
            prefetch_edge(edge);
            add_curves(*edge);
        }
        for (std::size_t i = 0; i + 1 < begins_.size(); ++i) {
            const auto begin = curves_.begin() + begins_[i], end = curves_.begin() + begins_[i + 1];
            if (end - begin == 2) {
                if (before(begin[1], begin[0])) std::swap(begin[0], begin[1]);
            } else {
                std::sort(begin, end, [&](const Curve& a, const Curve& b) { return before(a, b); });
            }
        }
    }

    /// Asks for what is known of the edges after one.
    [[gnu::always_inline]] void prefetch_edge(const TrackEdge* edge) const {
        const std::ptrdiff_t left = tracks_.edges.end() - 1 - edge;
        const TrackEdge& far = edge[std::min<std::ptrdiff_t>(24, left)];
        const auto face = static_cast<std::size_t>(far.face);
        prefetch(&loops_.edge_begin[far.corner]);
        prefetch(&loops_.face_offsets[face]);
        prefetch(&faces_.above[face]);
        prefetch(&faces_.below[face]);
        const TrackEdge& near = edge[std::min<std::ptrdiff_t>(8, left)];
        prefetch(&loops_.vertices[loops_.edge_begin[near.corner]]);
    }

    void add_curves(const TrackEdge& edge) {
        const auto face = static_cast<std::size_t>(edge.face);
        const bool left = edge.from < edge.to;
        Curve curve{0, 0, edge.face, faces_.above[face], faces_.below[face], left};
        const std::int32_t steps = std::abs(edge.to - edge.from);
        std::uint32_t entry = loops_.edge_begin[edge.corner];
        std::int32_t vertex = loops_.vertices[entry];
        std::int32_t interval = left ? edge.from : edge.from - 1;
        for (std::int32_t s = 0; s < steps; ++s) {
            ++entry;
            if (entry == loops_.face_offsets[face + 1]) entry = loops_.face_offsets[face];
            const std::int32_t next = loops_.vertices[entry];
            curve.start = left ? vertex : next;
            curve.end = left ? next : vertex;
            curves_[free_[static_cast<std::size_t>(interval)]++] = curve;
            vertex = next;
            interval += left ? 1 : -1;
        }
    }

    void process_interval(std::size_t track, std::size_t begin, std::size_t end) {
        // The common case: one face edge on either side, the same cells above and below.
        if (end - begin == 2) {
            const Curve &a = curves_[begin], &b = curves_[begin + 1];
            if (a.left != b.left && a.as_high_as(b) && a.above == b.above && a.below == b.below) {
                return;
            }
        }
        bool crossed = false;
        for (std::size_t i = begin; i < end; ++i) {
            for (std::size_t j = i + 1; j < end; ++j) {
                if (curves_[i].start < curves_[j].start && curves_[i].end > curves_[j].end) {
                    add_missing(track, curves_[i], curves_[j]);
                    crossed = true;
                }
            }
        }
        if (crossed) return;
        std::int32_t left = cell_below_all(begin, end, true);
        std::int32_t right = cell_below_all(begin, end, false);
        for (std::size_t i = begin; i < end;) {
            std::size_t level = i;  // past the curves at this height
            for (; level < end && curves_[level].as_high_as(curves_[i]); ++level) {
                (curves_[level].left ? left : right) = curves_[level].above;
            }
            if (level == end) break;
            if (left != right) add_wall(curves_[i], curves_[level], left, right);
            i = level;
        }
    }

    std::int32_t cell_below_all(std::size_t begin, std::size_t end, bool left) const {
        for (std::size_t i = begin; i < end; ++i) {
            if (curves_[i].left == left) return curves_[i].below;
        }
        return kOutsideCell;
    }

    void add_missing(std::size_t track, const Curve& a, const Curve& b) {
        const auto plane = [&](const Curve& curve) {
            return faces_.plane[static_cast<std::size_t>(curve.face)];
        };
        const LineId line = tracks_.representative[track];
        const LineId trace = exact::line_of(batch_.scope.trace(plane(a), plane(b)));
        batch_.missing.push_back({line, batch_.scope.crossing(line, trace)});
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
        loop.insert(loop.end(), wall.lower.begin(), wall.lower.end());
        // up the far vertical and down the near one, through every vertex on them
        for (std::int32_t v = wall.lower.back() + 1; v < wall.upper.back(); ++v)
            loop.push_back(v);
        const std::size_t skip = wall.upper.back() == wall.lower.back() ? 1 : 0;
        const std::size_t keep = wall.upper.front() == wall.lower.front() ? 1 : 0;
        loop.insert(loop.end(), wall.upper.rbegin() + static_cast<std::ptrdiff_t>(skip),
                    wall.upper.rend() - static_cast<std::ptrdiff_t>(keep));
        for (std::int32_t v = wall.upper.front() - 1; v > wall.lower.front(); --v)
            loop.push_back(v);
        batch_.walls.sizes.push_back(static_cast<std::int32_t>(loop.size() - first));
        batch_.walls.cells.push_back({wall.left, wall.right});
    }

    const FaceList& faces_;
    const Tracks& tracks_;
    const Loops& loops_;
    Batch& batch_;
    std::vector<Curve> curves_;
    std::vector<std::uint32_t> begins_, free_;  ///< curves of each interval, and where more go
    OpenWalls open_, growing_;
};

}  // namespace

std::vector<WallBatch> find_walls(PlanGeometry& geometry, const FaceList& faces,
                                  const Tracks& tracks, const Loops& loops,
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
        batch->scope.hand_over(geometry);
        for (const ExtraPoint& e : batch->missing)
            missing.push_back({e.line, batch->scope.shared_point(e.point)});
    }
    if (!missing.empty()) return {};
    return walls;
}

}  // namespace realmodel::strata
