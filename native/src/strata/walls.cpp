// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <tuple>

#include "conforming.hpp"
#include "parallel_chunks.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;

namespace {

/// A face edge over one interval of a track: a straight line in height between two verticals.
struct Curve {
    std::int32_t interval;
    bool left;                  ///< the face lies left of the track
    std::int32_t start, end;    ///< vertices on the two verticals; ascending means rising
    std::int32_t layer;         ///< of equal curves on one side the younger is the upper
    std::int32_t above, below;  ///< cells
    PlaneId plane;

    std::pair<std::int32_t, std::int32_t> height() const { return {start, end}; }
};

struct WallBatch {
    explicit WallBatch(const PlanGeometry& geometry) : scope(geometry) {}
    Scope scope;
    Walls walls;
    std::vector<ExtraPoint> missing;
};

/// The walls of one track.
class TrackWalls {
public:
    TrackWalls(const FaceList& faces, const Tracks& tracks, const Loops& loops,
               const std::vector<std::int32_t>& face_of_corner, WallBatch& batch)
        : faces_(faces),
          tracks_(tracks),
          loops_(loops),
          face_of_corner_(face_of_corner),
          batch_(batch) {}

    void process(std::size_t track) {
        collect(track);
        for (std::size_t i = 0; i < curves_.size();) {
            std::size_t end = i + 1;
            while (end < curves_.size() && curves_[end].interval == curves_[i].interval)
                ++end;
            process_interval(track, i, end);
            // what did not go on in this interval is finished
            for (const OpenWall& wall : open_)
                emit(wall);
            std::swap(open_, growing_);
            growing_.clear();
            i = end;
        }
        for (const OpenWall& wall : open_)
            emit(wall);
        open_.clear();
    }

private:
    void collect(std::size_t track) {
        curves_.clear();
        for (auto i = tracks_.edge_offsets[track]; i < tracks_.edge_offsets[track + 1]; ++i) {
            const auto e = static_cast<std::size_t>(tracks_.edges[static_cast<std::size_t>(i)]);
            const auto face = static_cast<std::size_t>(face_of_corner_[e]);
            const bool forward = tracks_.forward[e] != 0;
            const std::int32_t steps = tracks_.high[e] - tracks_.low[e];
            for (std::int32_t s = 0; s < steps; ++s) {
                const std::int64_t here = loops_.edge_offsets[e] + s;
                const std::int64_t there =
                    here + 1 < loops_.face_offsets[face + 1] ? here + 1 : loops_.face_offsets[face];
                const std::int32_t a = loops_.vertices[static_cast<std::size_t>(here)];
                const std::int32_t b = loops_.vertices[static_cast<std::size_t>(there)];
                curves_.push_back({forward ? tracks_.low[e] + s : tracks_.high[e] - s - 1, forward,
                                   forward ? a : b, forward ? b : a, faces_.layer[face],
                                   faces_.above[face], faces_.below[face], faces_.plane[face]});
            }
        }
        std::sort(curves_.begin(), curves_.end(), [](const Curve& a, const Curve& b) {
            return std::tuple(a.interval, a.start, a.end, a.left, a.layer) <
                   std::tuple(b.interval, b.start, b.end, b.left, b.layer);
        });
    }

    void process_interval(std::size_t track, std::size_t begin, std::size_t end) {
        // The common case: one face edge on either side, the same cells above and below.
        if (end - begin == 2) {
            const Curve &a = curves_[begin], &b = curves_[begin + 1];
            if (a.left != b.left && a.height() == b.height() && a.above == b.above &&
                a.below == b.below) {
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
            for (; level < end && curves_[level].height() == curves_[i].height(); ++level) {
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
        const LineId line = tracks_.representative[track];
        const LineId trace = exact::line_of(batch_.scope.trace(a.plane, b.plane));
        batch_.missing.push_back({line, batch_.scope.crossing(line, trace)});
    }

    /// A wall between two cells that may go on in the next interval.
    struct OpenWall {
        std::int32_t left, right;
        std::vector<std::int32_t> lower, upper;  ///< vertices along the track
    };

    // Walls of neighbouring intervals between the same cells are one face where they share a whole
    // vertical edge: it would bound nothing.
    void add_wall(const Curve& low, const Curve& high, std::int32_t left, std::int32_t right) {
        const auto continues = [&](const OpenWall& wall) {
            return wall.left == left && wall.right == right && wall.lower.back() == low.start &&
                   wall.upper.back() == high.start && low.start != high.start;
        };
        const auto before = std::find_if(open_.begin(), open_.end(), continues);
        if (before == open_.end()) {
            growing_.push_back({left, right, {low.start, low.end}, {high.start, high.end}});
            return;
        }
        growing_.push_back(std::move(*before));
        open_.erase(before);
        growing_.back().lower.push_back(low.end);
        growing_.back().upper.push_back(high.end);
    }

    void emit(const OpenWall& wall) {
        auto& loop = batch_.walls.vertices;
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
        batch_.walls.offsets.push_back(static_cast<std::int64_t>(loop.size()));
        batch_.walls.cells.push_back({wall.left, wall.right});
    }

    const FaceList& faces_;
    const Tracks& tracks_;
    const Loops& loops_;
    const std::vector<std::int32_t>& face_of_corner_;
    WallBatch& batch_;
    std::vector<Curve> curves_;
    std::vector<OpenWall> open_, growing_;
};

}  // namespace

Walls find_walls(PlanGeometry& geometry, const FaceList& faces, const Tracks& tracks,
                 const Loops& loops, std::vector<ExtraPoint>& missing, int threads,
                 const Progress* progress) {
    std::vector<std::int32_t> face_of_corner(faces.polygons.corners.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        for (auto c = faces.polygons.offsets[f]; c < faces.polygons.offsets[f + 1]; ++c) {
            face_of_corner[static_cast<std::size_t>(c)] = static_cast<std::int32_t>(f);
        }
    }
    constexpr std::size_t kChunk = 2048;
    const std::size_t chunks = (tracks.size() + kChunk - 1) / kChunk;
    std::vector<std::unique_ptr<WallBatch>> batches(chunks);
    parallel_chunks(chunks, threads, progress, [&](std::size_t chunk) {
        batches[chunk] = std::make_unique<WallBatch>(geometry);
        TrackWalls walls(faces, tracks, loops, face_of_corner, *batches[chunk]);
        for (std::size_t t = chunk * kChunk; t < std::min(tracks.size(), (chunk + 1) * kChunk);
             ++t) {
            walls.process(t);
        }
    });
    missing.clear();
    Walls walls;
    for (auto& batch : batches) {
        if (progress != nullptr) progress->check();
        batch->scope.hand_over(geometry);
        for (const ExtraPoint& e : batch->missing) {
            missing.push_back({e.line, batch->scope.shared_point(e.point)});
        }
        const auto base = static_cast<std::int64_t>(walls.vertices.size());
        for (std::size_t w = 1; w < batch->walls.offsets.size(); ++w) {
            walls.offsets.push_back(base + batch->walls.offsets[w]);
        }
        walls.vertices.insert(walls.vertices.end(), batch->walls.vertices.begin(),
                              batch->walls.vertices.end());
        walls.cells.insert(walls.cells.end(), batch->walls.cells.begin(), batch->walls.cells.end());
        batch.reset();
    }
    if (!missing.empty()) return {};
    return walls;
}

}  // namespace realmodel::strata
