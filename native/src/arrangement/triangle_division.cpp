// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles divided along what they intersect.
#include <algorithm>
#include <cassert>
#include <numeric>
#include <unordered_map>

#include "arrangement/triangle_arrangement.hpp"
#include "arrangement/triangle_regions.hpp"
#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "base/parallel_sort.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::arrangement {

using exact::compare;
using spatial::Box;

namespace {

/// So many lines of triangles are one piece of work.
constexpr std::size_t kChunk = 1 << 8;

/// Rounding keeps the order of numbers: what has no point in common with the box of rounded points
/// has none with the exact ones.
Box box_of(const exact::SpacePoints& points, std::span<const SpacePointId> corners) {
    return spatial::bounding_box(corners, [&](SpacePointId p) { return points.rounded(p); });
}

}  // namespace

std::vector<std::int32_t> TriangleArrangement::all_triangles() const {
    std::vector<std::int32_t> all(triangles_.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
}

/// Some lines of a triangle: all of them, unless they are many.
struct TriangleArrangement::LineRange {
    std::int32_t triangle;
    std::size_t begin, end;
    std::int32_t shared = -1;  ///< which of the triangles that are in several chunks
};

/// The lines of some triangles, count(triangle) of each, in pieces of work of about the same size.
template <class Count>
std::vector<std::vector<TriangleArrangement::LineRange>> TriangleArrangement::line_chunks(
    std::span<const std::int32_t> among, const Count& count) {
    std::vector<std::vector<LineRange>> chunks;
    std::size_t lines = kChunk;  // of the last chunk
    std::int32_t shared = 0;
    for (const std::int32_t triangle : among) {
        const std::size_t line_count = count(triangle);
        const bool is_shared = line_count > 2 * kChunk;
        for (std::size_t begin = 0; begin < line_count; begin += kChunk) {
            if (is_shared || lines >= kChunk) {
                chunks.emplace_back();
                lines = 0;
            }
            const std::size_t end = is_shared ? std::min(line_count, begin + kChunk) : line_count;
            chunks.back().push_back({triangle, begin, end, is_shared ? shared : -1});
            lines += is_shared ? kChunk : line_count;
            if (!is_shared) break;
        }
        shared += is_shared ? 1 : 0;
    }
    return chunks;
}

/// Calls visit(chunk, range, prepared) for all ranges, those of a chunk one after another on one
/// thread. What is prepared for a triangle is made once.
template <class Prepared, class Visit>
void TriangleArrangement::for_each_range(const std::vector<std::vector<LineRange>>& chunks,
                                         const Execution& execution, const Visit& visit) const {
    std::vector<std::int32_t> shared;
    for (const auto& chunk : chunks) {
        if (chunk[0].shared == static_cast<std::int32_t>(shared.size()))
            shared.push_back(chunk[0].triangle);
    }
    std::vector<std::optional<Prepared>> prepared(shared.size());
    parallel_chunks(
        shared.size(), execution,
        [&](std::size_t i) { prepared[i].emplace(*this, triangles_[index(shared[i])]); }, 0.02);
    parallel_chunks(chunks.size(), execution, [&](std::size_t i) {
        for (const LineRange& range : chunks[i]) {
            if (range.shared >= 0) {
                visit(i, range, *prepared[index(range.shared)]);
            } else {
                visit(i, range, Prepared(*this, triangles_[index(range.triangle)]));
            }
        }
    });
}

/// Finds the nodes of one triangle on lines in it.
class TriangleArrangement::NodesOnLines {
public:
    NodesOnLines(const TriangleArrangement& arrangement, const ArrangedTriangle& t)
        : arrangement_(arrangement), points_(arrangement.points_), t_(t), in_order_(t.points) {
        const Box box = box_of(points_, t.corners);
        for (std::size_t k = 1; k < 3; ++k) {
            if (box.high[k] - box.low[k] > box.high[axis_] - box.low[axis_]) axis_ = k;
        }
        std::sort(in_order_.begin(), in_order_.end(), [this](SpacePointId p, SpacePointId q) {
            return std::pair(coordinate(p), p) < std::pair(coordinate(q), q);
        });
    }

    /// The nodes between two others, in order from the first to the second.
    void find(const std::array<SpacePointId, 2>& line, std::vector<SpacePointId>& nodes) const {
        const SpacePointId a = line[0], b = line[1];
        nodes.clear();
        const auto visit = [&](SpacePointId p) {
            if (is_between(p, a, b)) nodes.push_back(p);
        };
        std::ranges::for_each(t_.corners, visit);
        const auto [low, high] = std::minmax({coordinate(a), coordinate(b)});
        auto next =
            std::lower_bound(in_order_.begin(), in_order_.end(), low,
                             [this](SpacePointId p, double x) { return coordinate(p) < x; });
        for (; next != in_order_.end() && coordinate(*next) <= high; ++next) {
            if (std::ranges::find(t_.corners, *next) == t_.corners.end()) visit(*next);
        }
        if (nodes.size() < 2) return;
        const int direction = compare(points_, a, b);
        std::sort(nodes.begin(), nodes.end(), [this, direction](SpacePointId p, SpacePointId q) {
            return compare(points_, p, q) * direction > 0;
        });
    }

private:
    double coordinate(SpacePointId p) const { return points_.rounded(p)[axis_]; }
    /// In the view in which the triangle has an area, nothing in its plane falls together.
    bool is_between(SpacePointId p, SpacePointId a, SpacePointId b) const {
        if (p == a || p == b) return false;
        const Position &r = points_.rounded(p), &s = points_.rounded(a), &e = points_.rounded(b);
        for (std::size_t k = 0; k < 3; ++k) {
            if (r[k] < std::min(s[k], e[k]) || r[k] > std::max(s[k], e[k])) return false;
        }
        if (!points_.was_constructed_on(p, a, b) && arrangement_.orientation(t_, a, b, p) != 0)
            return false;
        return compare(points_, a, p) * compare(points_, p, b) > 0;
    }

    const TriangleArrangement& arrangement_;
    const exact::SpacePoints& points_;
    const ArrangedTriangle& t_;
    std::size_t axis_ = 0;                ///< along which the triangle is longest
    std::vector<SpacePointId> in_order_;  ///< its points, in the order of that coordinate
};

/// Puts the points and segments of all triangles in order, each once.
void TriangleArrangement::sort_all(const Execution& execution) {
    parallel_for_each(triangles_.size(), execution, [this](std::size_t i) {
        sort_unique(triangles_[i].points);
        sort_unique(triangles_[i].segments);
    });
}

/// Whether segments of a triangle whose boxes meet cross each other.
bool TriangleArrangement::do_cross(const ArrangedTriangle& t, const SegmentPair& pair) const {
    const auto& [a, b, c, d] = pair;
    if (a == c || a == d || b == c || b == d) return false;
    return orientation(t, a, b, c) * orientation(t, a, b, d) < 0 &&
           orientation(t, c, d, a) * orientation(t, c, d, b) < 0;
}

/// The segments of a triangle with the boxes around them, in the order of one coordinate of these.
/// Of those with the same ends, which follow one another and come from triangles in one plane, the
/// first.
struct TriangleArrangement::BoxedSegments {
    struct Boxed {
        const SharedSegment* segment;
        Box box;
    };

    BoxedSegments(const TriangleArrangement& arrangement, const ArrangedTriangle& t)
        : axis((t.axis + 1) % 3) {
        in_order.reserve(t.segments.size());
        for (const SharedSegment& s : t.segments) {
            if (in_order.empty() || in_order.back().segment->ends != s.ends)
                in_order.push_back({&s, box_of(arrangement.points_, s.ends)});
        }
        std::sort(in_order.begin(), in_order.end(), [this](const Boxed& s, const Boxed& r) {
            const double x = s.box.low[axis], y = r.box.low[axis];
            return x != y ? x < y : *s.segment < *r.segment;
        });
    }

    std::size_t axis;
    std::vector<Boxed> in_order;
};

/// Where two triangles lie in one plane, what meets one of them there divides the other as well,
/// whether or not the two were asked for.
void TriangleArrangement::exchange_segments() {
    struct ExchangedSegment {
        SharedSegment segment;
        std::int32_t of, into;
    };
    std::unordered_map<std::int32_t, spatial::BoxTree> trees;
    const auto tree_of = [&](std::int32_t triangle) -> const spatial::BoxTree& {
        const auto at = trees.find(triangle);
        if (at != trees.end()) return at->second;
        auto boxes = transformed(triangles_[index(triangle)].segments,
                                 [&](const SharedSegment& s) { return box_of(points_, s.ends); });
        return trees.try_emplace(triangle, std::move(boxes)).first->second;
    };
    std::vector<ExchangedSegment> clips;
    for (const auto& [one, other] : in_one_plane_) {
        for (const auto& pair : {std::pair(one, other), std::pair(other, one)}) {
            const std::int32_t of = pair.first, into = pair.second;
            const auto& segments = triangles_[index(of)].segments;
            const std::size_t first = clips.size();
            tree_of(of).find(box_of(points_, triangles_[index(into)].corners), [&](std::int32_t n) {
                const SharedSegment& s = segments[index(n)];
                if (s.other != into) clips.push_back({s, of, into});
            });
            const auto begin = clips.begin() + static_cast<std::ptrdiff_t>(first);
            std::sort(begin, clips.end(), [](const ExchangedSegment& a, const ExchangedSegment& b) {
                return a.segment < b.segment;
            });
            clips.erase(std::unique(begin, clips.end(),
                                    [](const ExchangedSegment& a, const ExchangedSegment& b) {
                                        return a.segment.ends == b.segment.ends;
                                    }),
                        clips.end());
        }
    }
    for (const auto& [segment, of, into] : clips)
        clip_segment(segment.ends[0], segment.ends[1], of, into);
}

/// Notes where segments of one triangle cross each other: only where the triangles of a group do
/// cross.
void TriangleArrangement::intersect_segments(const Execution& execution) {
    const auto chunks = line_chunks(all_triangles(), [this](std::int32_t i) -> std::size_t {
        const ArrangedTriangle& t = triangles_[index(i)];
        return t.facing == 0 || t.segments.size() < 2 ? 0 : t.segments.size();
    });
    std::vector<std::vector<std::pair<std::size_t, SegmentPair>>> crossings(chunks.size());
    for_each_range<BoxedSegments>(
        chunks, execution,
        [&](std::size_t chunk, const LineRange& range, const BoxedSegments& segments) {
            const auto& [axis, boxed] = segments;
            const ArrangedTriangle& t = triangles_[index(range.triangle)];
            for (std::size_t i = range.begin; i < std::min(range.end, boxed.size()); ++i) {
                const auto [a, b] = boxed[i].segment->ends;
                for (std::size_t j = i + 1; j < boxed.size(); ++j) {
                    if (boxed[j].box.low[axis] > boxed[i].box.high[axis]) break;
                    if (!boxed[i].box.meets(boxed[j].box)) continue;
                    const auto [c, d] = boxed[j].segment->ends;
                    if (do_cross(t, {a, b, c, d}))
                        crossings[chunk].push_back({index(range.triangle), {a, b, c, d}});
                }
            }
        });
    const auto pairs = concatenated(crossings);
    // where they do is found on all threads and numbered in order
    constexpr std::size_t kAtOnce = 1 << 14;
    std::vector<exact::SpacePoints::Reduced> at;
    for (std::size_t first = 0; first < pairs.size(); first += kAtOnce) {
        at.resize(std::min(kAtOnce, pairs.size() - first));
        parallel_ranges(
            at.size(), kChunk, execution,
            [&](std::size_t begin, std::size_t end) {
                for (std::size_t k = begin; k < end; ++k) {
                    const auto& [i, pair] = pairs[first + k];
                    const auto& [a, b, c, d] = pair;
                    at[k] = points_.crossing(triangles_[i].axis, a, b, c, d);
                }
            },
            0.02);
        for (std::size_t k = 0; k < at.size(); ++k)
            triangles_[pairs[first + k].first].points.push_back(points_.add(std::move(at[k])));
    }
}

/// The points on some lines of a triangle, for the others that share these; and what they divide
/// the lines into.
void TriangleArrangement::messages_of(const LineRange& range, const NodesOnLines& nodes_on,
                                      std::vector<Message>& messages,
                                      std::vector<SpaceEdge>& edges) {
    const std::int32_t triangle = range.triangle;
    const ArrangedTriangle& t = triangles_[index(triangle)];
    const auto send = [&](std::int32_t to, SpacePointId p) {
        const ArrangedTriangle& other = triangles_[index(to)];
        if (to == triangle ||
            std::find(other.corners.begin(), other.corners.end(), p) != other.corners.end() ||
            std::binary_search(other.points.begin(), other.points.end(), p))
            return;
        messages.push_back({to, p});
    };
    std::vector<SpacePointId> on;
    for (std::size_t i = range.begin; i < range.end; ++i) {
        const auto [a, b] = t.line(i);
        nodes_on.find({a, b}, on);
        SpacePointId last = a;
        for (const SpacePointId p : on) {
            edges.push_back(unordered(last, p));
            last = p;
        }
        edges.push_back(unordered(last, b));
        if (i < t.segments.size()) {
            const std::int32_t other = t.segments[i].other;
            if (other < 0) within_lines_[index(-1 - other)] = on;
            for (std::size_t k = 0; other >= 0 && k < on.size(); ++k)
                send(other, on[k]);
            continue;
        }
        if (on.empty()) continue;
        const auto edge = unordered(a, b);
        for (auto other = std::lower_bound(of_edge_.begin(), of_edge_.end(), std::pair(edge, 0));
             other != of_edge_.end() && other->first == edge; ++other) {
            for (const SpacePointId p : on)
                send(other->second, p);
        }
    }
}

/// Sends the points on edges and segments to the other triangles that share these, until all of
/// them know them.
/// @return for each triangle what its lines are divided into; none where nothing divides it
std::vector<std::vector<TriangleArrangement::SpaceEdge>> TriangleArrangement::exchange_points(
    const Execution& execution) {
    std::vector<std::vector<SpaceEdge>> edges(triangles_.size());
    std::vector<std::int32_t> changed = all_triangles();
    while (!changed.empty()) {
        // of a triangle without area one corner may lie on the edge between the others
        const auto chunks = line_chunks(changed, [this](std::int32_t i) -> std::size_t {
            const ArrangedTriangle& t = triangles_[index(i)];
            return t.points.empty() && t.facing != 0 ? 0 : t.line_count();
        });
        for (const std::int32_t triangle : changed)
            edges[index(triangle)].clear();
        std::vector<std::vector<Message>> messages(chunks.size());
        std::vector<std::vector<SpaceEdge>> of_shared(
            chunks.size());  // each the only one of its chunk
        for_each_range<NodesOnLines>(
            chunks, execution,
            [&](std::size_t chunk, const LineRange& range, const NodesOnLines& nodes_on) {
                messages_of(range, nodes_on, messages[chunk],
                            range.shared >= 0 ? of_shared[chunk] : edges[index(range.triangle)]);
            });
        for (std::size_t i = 0; i < chunks.size(); ++i) {
            auto& triangle_edges = edges[index(chunks[i][0].triangle)];
            triangle_edges.insert(triangle_edges.end(), of_shared[i].begin(), of_shared[i].end());
        }
        changed.clear();
        for (const auto& chunk : messages) {
            for (const Message& message : chunk) {
                auto& points = triangles_[index(message.to)].points;
                const auto at = std::lower_bound(points.begin(), points.end(), message.point);
                if (at != points.end() && *at == message.point) continue;
                points.insert(at, message.point);
                changed.push_back(message.to);
            }
        }
        sort_unique(changed);
    }
    return edges;
}

/// Finds the regions of one triangle after another in the same memory.
class TriangleArrangement::RegionFinder {
public:
    explicit RegionFinder(const TriangleArrangement& arrangement)
        : arrangement_(arrangement), graph_(arrangement.points_) {}

    /// @param edges  all that its lines are divided into; put in order. None: nothing divides it
    void add_regions(std::int32_t triangle, std::vector<SpaceEdge>& edges, Regions& regions) {
        const ArrangedTriangle& t = arrangement_.triangles_[index(triangle)];
        if (t.facing == 0) return;
        if (edges.empty()) {
            regions.loops.add_loop(t.corners);
            regions.loops.end_region();
            regions.triangles.push_back(triangle);
            return;
        }
        [[maybe_unused]] const std::size_t first = regions.size();
        sort_unique(edges);
        graph_.add_regions({t.axis, t.facing}, edges, regions.loops);
        regions.triangles.resize(regions.loops.size(), triangle);
        assert(tile(t, regions, first));
    }

private:
    /// Whether regions tile a triangle: of their edges, those have no twin that lie on its outline.
    bool tile(const ArrangedTriangle& t, const Regions& regions, std::size_t first) const {
        std::vector<std::pair<SpaceEdge, int>> edges;
        for (std::size_t r = first; r < regions.size(); ++r) {
            for (const auto loop : regions.loops[r]) {
                for (std::size_t i = 0; i < loop.size(); ++i) {
                    const SpacePointId a = loop[i], b = loop[(i + 1) % loop.size()];
                    edges.push_back({unordered(a, b), a < b ? 1 : -1});
                }
            }
        }
        std::sort(edges.begin(), edges.end());
        std::size_t corners = 0;
        for (std::size_t i = 0; i < edges.size(); ++i) {
            const auto& [edge, direction] = edges[i];
            if (i + 1 < edges.size() && edges[i + 1].first == edge) {
                if (direction != -1 || edges[++i].second != 1) return false;
                continue;
            }
            std::size_t k = 0;
            while (
                k < 3 &&
                (arrangement_.orientation(t, t.corners[k], t.corners[(k + 1) % 3], edge[0]) != 0 ||
                 arrangement_.orientation(t, t.corners[k], t.corners[(k + 1) % 3], edge[1]) != 0))
                ++k;
            if (k == 3) return false;
            for (const SpacePointId p : edge)
                corners += std::ranges::count(t.corners, p) != 0 ? 1U : 0U;
        }
        return corners == 6;  // each is an end of two edges of the outline
    }

    const TriangleArrangement& arrangement_;
    PlaneGraph graph_;
};

namespace {

/// The regions of several ranges of triangles, one after another.
Regions joined(std::vector<Regions>& ranges, const Execution& execution) {
    std::vector<std::size_t> regions, loops, nodes;  // before each range
    for (const Regions& range : ranges) {
        regions.push_back(range.size());
        loops.push_back(range.loops.loop_begins.size() - 1);
        nodes.push_back(range.loops.nodes.size());
    }
    Regions all;
    const std::size_t count = exclusive_scan(regions);
    checked_number(count, "regions of triangles");
    all.triangles.resize(count);
    all.loops.region_begins.resize(count + 1);
    all.loops.loop_begins.resize(exclusive_scan(loops) + 1);
    all.loops.nodes.resize(exclusive_scan(nodes));
    parallel_chunks(ranges.size(), execution, [&](std::size_t i) {
        const Regions range = std::move(ranges[i]);
        std::ranges::copy(range.triangles, all.triangles.begin() + regions[i]);
        std::ranges::copy(range.loops.nodes, all.loops.nodes.begin() + nodes[i]);
        const auto moved = [](const Array<std::size_t>& begins, std::size_t by, std::size_t* to) {
            for (std::size_t k = 1; k < begins.size(); ++k)
                to[k] = begins[k] + by;
        };
        moved(range.loops.region_begins, loops[i], all.loops.region_begins.data() + regions[i]);
        moved(range.loops.loop_begins, nodes[i], all.loops.loop_begins.data() + loops[i]);
    });
    return all;
}

}  // namespace

/// @param edges  of each triangle, as exchange_points() gives them
void TriangleArrangement::find_all_regions(std::vector<std::vector<SpaceEdge>>& edges,
                                           const Execution& execution) {
    // those of triangles with many lines are begun first
    struct Range {
        std::size_t lines, begin, end;
    };
    std::vector<Range> ranges;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
        const std::size_t lines = edges[i].size() + 1;
        if (ranges.empty() || ranges.back().lines + lines > 4 * kChunk) ranges.push_back({0, i, i});
        ranges.back().lines += lines;
        ranges.back().end = i + 1;
    }
    std::vector<std::size_t> order(ranges.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater<>(),
                             [&](std::size_t r) { return ranges[r].lines; });
    std::vector<Regions> regions(ranges.size());
    parallel_workers(ranges.size(), execution, [&] {
        return [&, finder = RegionFinder(*this)](std::size_t at) mutable {
            const std::size_t r = order[at];
            for (std::size_t i = ranges[r].begin; i < ranges[r].end; ++i)
                finder.add_regions(static_cast<std::int32_t>(i), edges[i], regions[r]);
        };
    });
    regions_ = joined(regions, execution);
}

void TriangleArrangement::divide(const Execution& execution) {
    parallel_sort(of_edge_, std::less<>(), execution);
    sort_all(execution);
    exchange_segments();
    sort_all(execution);
    intersect_segments(execution);
    sort_all(execution);
    auto edges = exchange_points(execution);
    assert(std::ranges::all_of(
        triangles_, [](const ArrangedTriangle& t) { return std::ranges::is_sorted(t.points); }));
    find_all_regions(edges, execution);
}

}  // namespace realmodel::arrangement
