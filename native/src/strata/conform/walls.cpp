// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/walls.hpp"

#include <algorithm>
#include <cassert>
#include <memory>
#include <utility>

#include "base/parallel_counts.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

/// Asks for what is known of the edges after one.
[[gnu::always_inline]] inline void IntervalCurves::prefetch_edge(const LineEdge* edge) const {
    const std::ptrdiff_t left = collinear_.edges.end() - 1 - edge;
    const LineEdge& far = edge[std::min<std::ptrdiff_t>(24, left)];
    const auto face = static_cast<std::size_t>(far.face);
    prefetch(&conformed_.face_offsets[face]);
    prefetch(&faces_.above[face]);
    prefetch(&faces_.below[face]);
    const LineEdge& near = edge[std::min<std::ptrdiff_t>(8, left)];
    prefetch(&conformed_.vertices[near.begin]);
}

/// Ascending; where two curves start at one vertex the lower end comes first, and of equal
/// curves on one side the younger is the upper.
bool IntervalCurves::before(const IntervalCurve& a, const IntervalCurve& b) const {
    if (a.start != b.start) return a.start < b.start;
    if (a.end != b.end) return a.end < b.end;
    if (a.left != b.left) return b.left;
    const auto surface = [&](const IntervalCurve& curve) {
        return faces_.surface[static_cast<std::size_t>(curve.face)];
    };
    return std::pair(surface(a), a.face) < std::pair(surface(b), b.face);
}

void IntervalCurves::collect(std::size_t number) {
    const auto first = collinear_.edges.begin() + collinear_.edge_offsets[number];
    const auto last = collinear_.edges.begin() + collinear_.edge_offsets[number + 1];
    begins_.clear();
    for (auto edge = first; edge != last; ++edge) {
        const auto [low, high] = std::minmax(edge->from, edge->to);
        if (begins_.size() < static_cast<std::size_t>(high) + 1)
            begins_.resize(static_cast<std::size_t>(high) + 1, 0);
        for (std::int32_t i = low; i < high; ++i)
            ++begins_[static_cast<std::size_t>(i)];
    }
    std::uint32_t total = 0;
    for (std::uint32_t& begin : begins_)
        total += std::exchange(begin, total);
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
            std::sort(begin, end,
                      [&](const IntervalCurve& a, const IntervalCurve& b) { return before(a, b); });
        }
    }
}

void IntervalCurves::add_curves(const LineEdge& edge) {
    const auto face = static_cast<std::size_t>(edge.face);
    const bool left = edge.from < edge.to;
    IntervalCurve curve{0,   0, edge.face, cell_of(faces_.above[face]), cell_of(faces_.below[face]),
                        left};
    const std::int32_t steps = std::abs(edge.to - edge.from);
    std::uint32_t entry = edge.begin;
    std::int32_t vertex = conformed_.vertices[entry];
    std::int32_t interval = left ? edge.from : edge.from - 1;
    for (std::int32_t s = 0; s < steps; ++s) {
        ++entry;
        if (entry == conformed_.face_offsets[face + 1]) entry = conformed_.face_offsets[face];
        const std::int32_t next = conformed_.vertices[entry];
        curve.start = left ? vertex : next;
        curve.end = left ? next : vertex;
        assert(curve.start >= 0 && curve.end >= 0);
        curves_[free_[static_cast<std::size_t>(interval)]++] = curve;
        vertex = next;
        interval += left ? 1 : -1;
    }
}

std::int32_t below_all(std::span<const IntervalCurve> curves, bool left) {
    const auto lowest = std::find_if(curves.begin(), curves.end(), [&](const IntervalCurve& curve) {
        return curve.left == left;
    });
    return lowest == curves.end() ? kOutsideCell : lowest->below;
}

void IntervalCurves::find_crossings(std::size_t number, std::span<const IntervalCurve> curves,
                                    LocalArrangement& scope,
                                    std::vector<ExtraPoint>& missing) const {
    const auto plane = [&](const IntervalCurve& curve) {
        return faces_.plane[static_cast<std::size_t>(curve.face)];
    };
    for (std::size_t i = 0; i < curves.size(); ++i) {
        for (std::size_t j = i + 1; j < curves.size(); ++j) {
            const IntervalCurve &a = curves[i], &b = curves[j];
            if (a.start >= b.start || a.end <= b.end) continue;
            const LineId line = collinear_.representative[number];
            const LineId trace = scope.trace(plane(a), plane(b)).id();
            missing.push_back({line, scope.crossing(line, trace)});
        }
    }
}

namespace {

constexpr std::size_t kLines = 1 << 10;  // worked on at a time

/// Of the vertices on a wall, where none is left out.
constexpr auto keep_all = [](std::int32_t) { return true; };

/// What the walls of some lines are found in.
struct Batch {
    explicit Batch(const PlanArrangement& geometry) : scope(geometry) {}
    LocalArrangement scope;
    WallBatch walls;
    WallLists line_walls;
};

/// The walls of one line after another.
class LineWalls {
public:
    LineWalls(const FaceList& faces, const CollinearEdges& collinear,
              const ConformedFaces& conformed, const BlockLines* blocks, Batch& batch)
        : conformed_(conformed),
          blocks_(blocks),
          curves_(faces, collinear, conformed),
          batch_(batch) {}

    void process(std::size_t line) {
        const auto emit = [&](const OpenWall& wall) {
            batch_.walls.add(wall.lower, wall.upper, {wall.left, wall.right}, keep_all);
        };
        curves_.collect(line);
        for (std::size_t i = 0; i < curves_.intervals(); ++i) {
            process_interval(line, i, curves_.of_interval(i));
            joining_.end_interval(emit);
        }
        joining_.end_line(emit);
    }

private:
    /// Whether no wall stands between two cells: they are the same column, or of one block.
    bool is_same(std::int32_t a, std::int32_t b) const {
        return a == b || (blocks_ != nullptr && block(a) == block(b));
    }
    std::int32_t block(std::int32_t node) const {
        return node < 0 ? kOutsideCell : blocks_->node_block[static_cast<std::size_t>(node)];
    }
    void link(std::int32_t a, std::int32_t b) {
        if (blocks_ != nullptr && a != b && a >= 0 && b >= 0 && block(a) == block(b))
            batch_.line_walls.links.emplace_back(a, b);
    }

    void process_interval(std::size_t line, std::size_t interval,
                          std::span<const IntervalCurve> curves) {
        if (curves.empty()) return;
        // The common case: one face edge on either side, the same cells above and below. They hang
        // together whether walls may stand here or not.
        if (curves.size() == 2) {
            const IntervalCurve &a = curves[0], &b = curves[1];
            if (a.left != b.left && a.as_high_as(b) && is_same(a.above, b.above) &&
                is_same(a.below, b.below)) {
                link(a.above, b.above);
                link(a.below, b.below);
                return;
            }
        }
        if (blocks_ != nullptr && !may_have_walls(curves.front())) {
            continue_faces(curves);
            return;
        }
        auto& missing = batch_.line_walls.missing;
        const std::size_t known = missing.size();
        curves_.find_crossings(line, curves, batch_.scope, missing);
        if (missing.size() > known) return;
        for_each_gap(curves, blocks_ == nullptr,
                     [&](const IntervalCurve& low, const IntervalCurve& high, std::int32_t left,
                         std::int32_t right) {
                         const std::array lower{low.start, low.end}, upper{high.start, high.end};
                         if (is_same(left, right)) {
                             link(left, right);
                         } else if (blocks_ == nullptr) {
                             joining_.add(lower, upper, left, right, low.start != high.start);
                         } else {
                             batch_.line_walls.stretches.push_back(
                                 {static_cast<std::int32_t>(line),
                                  static_cast<std::int32_t>(interval), lower, upper, left, right});
                         }
                     });
    }

    bool may_have_walls(const IntervalCurve& curve) {
        const auto point_of = [&](std::int32_t vertex) {
            return blocks_->plan_vertices.representative[conformed_.plan_vertex_of(vertex)];
        };
        const PointId from = point_of(curve.start), to = point_of(curve.end);
        const exact::Point &p = batch_.scope.point(from), &q = batch_.scope.point(to);
        const TileSpan span = blocks_->borders.tiles().span(
            {std::min(p.x, q.x), std::min(p.y, q.y), std::max(p.x, q.x), std::max(p.y, q.y)});
        return blocks_->borders.near(span) &&
               blocks_->borders.run_between(batch_.scope, from, to, span);
    }

    /// No wall: what is above the uppermost face at a height, and what is below the lowest one,
    /// goes on beyond the line.
    void continue_faces(std::span<const IntervalCurve> curves) {
        for (std::size_t i = 0; i < curves.size();) {
            std::size_t left = i;  // the first curve to the left of the line at this height
            while (left < curves.size() && curves[left].as_high_as(curves[i]) && !curves[left].left)
                ++left;
            std::size_t level = left;
            while (level < curves.size() && curves[level].as_high_as(curves[i]))
                ++level;
            if (i < left && left < level) {
                link(curves[left - 1].above, curves[level - 1].above);
                link(curves[i].below, curves[left].below);
            }
            i = level;
        }
    }

    const ConformedFaces& conformed_;
    const BlockLines* blocks_;
    IntervalCurves curves_;
    Batch& batch_;
    WallJoining joining_;
};

/// The walls of lines on which all edges are pairs.
class PlannedWalls {
public:
    PlannedWalls(const ConformedFaces& conformed, WallBatch& walls)
        : conformed_(conformed), walls_(walls) {}

    void add(const MatchedEdges& matched) {
        if (matched.corners.empty()) return;
        const std::uint32_t* next = matched.corners.begin();
        last_ = matched.corners.end() - 1;
        for (const MatchedEdges::Wall& wall : matched.walls) {
            next = collect(next, wall.above, upper_);
            next = collect(next, wall.beneath, lower_);
            add_pieces(wall.cells);
        }
        assert(next == last_ + 1);
    }

private:
    /// The vertices along some edges that follow each other.
    /// @return the corner after theirs
    const std::uint32_t* collect(const std::uint32_t* corner, std::uint32_t count,
                                 std::vector<std::int32_t>& vertices) const {
        vertices.clear();
        for (const std::uint32_t* const end = corner + count; corner != end; ++corner) {
            prefetch_corner(corner);
            const auto [first, next] = conformed_.entries.entries(*corner);
            vertices.push_back(conformed_.vertices[first]);
            for (std::uint32_t e = first + 1; e < next; ++e) {
                if (conformed_.vertices[e] >= 0) vertices.push_back(conformed_.vertices[e]);
            }
        }
        vertices.push_back(conformed_.vertices[conformed_.entries.first(*corner)]);
        return corner + 1;
    }

    [[gnu::always_inline]] void prefetch_corner(const std::uint32_t* corner) const {
        const std::ptrdiff_t left = last_ - corner;
        conformed_.entries.prefetch(corner[std::min<std::ptrdiff_t>(64, left)]);
        prefetch(
            &conformed_
                 .vertices[conformed_.entries.near(corner[std::min<std::ptrdiff_t>(32, left)])]);
    }

    /// Adds the wall between upper_ and lower_, divided where these touch on the way.
    void add_pieces(const std::array<std::int32_t, 2>& cells) {
        std::size_t u = 0, l = 0;
        while (u + 1 < upper_.size() && l + 1 < lower_.size()) {
            const auto [next_u, next_l] = next_contact(u, l);
            const bool is_flat = next_u == u + 1 && next_l == l + 1 && upper_[u] == lower_[l] &&
                                 upper_[next_u] == lower_[next_l];
            if (!is_flat) {
                walls_.add(std::span(lower_).subspan(l, next_l - l + 1),
                           std::span(upper_).subspan(u, next_u - u + 1), cells, keep_all);
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

    const ConformedFaces& conformed_;
    WallBatch& walls_;
    const std::uint32_t* last_ = nullptr;  ///< of the corners
    std::vector<std::int32_t> upper_, lower_;
};

}  // namespace

WallLists find_walls(PlanArrangement& geometry, const FaceList& faces, CollinearEdges& collinear,
                     const ConformedFaces& conformed, const BlockLines* blocks,
                     const Execution& execution) {
    const std::size_t chunks = (collinear.size() + kLines - 1) / kLines;
    WallLists walls;
    walls.walls.resize(chunks);
    std::vector<std::unique_ptr<Batch>> batches(chunks);  // of which more is asked below
    parallel_ranges(collinear.size(), kLines, execution, [&](std::size_t begin, std::size_t end) {
        auto batch = std::make_unique<Batch>(geometry);
        LineWalls of_line(faces, collinear, conformed, blocks, *batch);
        for (std::size_t t = begin; t < end; ++t)
            of_line.process(t);
        walls.walls[begin / kLines] = std::move(batch->walls);
        if (blocks != nullptr || !batch->line_walls.missing.empty())
            batches[begin / kLines] = std::move(batch);
    });
    for (const auto& batch : batches) {
        if (batch == nullptr) continue;
        if (!batch->line_walls.missing.empty()) batch->scope.commit(geometry);
        for (const ExtraPoint& e : batch->line_walls.missing)
            walls.missing.push_back({e.line, batch->scope.shared_point(e.point)});
        const WallLists& batch_walls = batch->line_walls;
        walls.links.insert(walls.links.end(), batch_walls.links.begin(), batch_walls.links.end());
        walls.stretches.insert(walls.stretches.end(), batch_walls.stretches.begin(),
                               batch_walls.stretches.end());
    }
    if (!walls.missing.empty()) return {std::move(walls.missing), {}, {}, {}};
    walls.walls.resize(chunks + collinear.matched.size());
    parallel_chunks(collinear.matched.size(), execution, [&](std::size_t chunk) {
        const MatchedEdges matched = std::move(collinear.matched[chunk]);
        WallBatch& batch = walls.walls[chunks + chunk];
        batch.sizes.reserve(matched.walls.size());
        batch.cells.reserve(matched.walls.size());
        PlannedWalls(conformed, batch).add(matched);
    });
    return walls;
}

}  // namespace realmodel::strata
