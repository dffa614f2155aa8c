// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/collinear_edges.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "base/parallel_counts.hpp"
#include "strata/conform/collinear_lines.hpp"
#include "strata/conform/line_buckets.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

/// The plan vertices on one line, put in order. Rounded coordinates keep the order of plan vertices
/// along a line, and exact ones decide where they are equal.
class VerticesOnLine {
public:
    VerticesOnLine(const PlanArrangement& geometry, const PlanVertices& plan_vertices)
        : scope_(geometry), plan_vertices_(plan_vertices) {}

    void clear() {
        added_.clear();
        known_.clear();
    }

    /// Adds a plan vertex, which may be there already.
    /// @return a number to ask rank() with
    [[gnu::always_inline]] std::int32_t add(PlanVertexId plan_vertex) {
        // Most lines have a handful of plan vertices, each the end of several edges, and the last
        // ones are met again soonest.
        for (std::size_t i = added_.size(), least = i > kFew ? i - kFew : 0; i > least; --i) {
            if (added_[i - 1] == plan_vertex) return static_cast<std::int32_t>(i - 1);
        }
        added_.push_back(plan_vertex);
        return static_cast<std::int32_t>(added_.size()) - 1;
    }

    /// To be called when all are there, with one of the lines that run through them.
    void sort(LineId line) {
        order_.resize(added_.size());
        std::iota(order_.begin(), order_.end(), 0);
        // plan vertices are in order of x, so only where two have the same x more is to be asked
        std::sort(order_.begin(), order_.end(),
                  [&](std::int32_t a, std::int32_t b) { return added(a) < added(b); });
        if (same_x()) {
            const auto [x, y] = scope_.direction_signs(line);
            const int rise = x == 0 ? 1 : x * y;
            std::sort(order_.begin(), order_.end(), [&](std::int32_t a, std::int32_t b) {
                return added(a) != added(b) && before(rise, added(a), added(b));
            });
        }
        rank_.resize(added_.size());
        for (const std::int32_t i : order_) {
            if (known_.empty() || known_.back() != added(i)) known_.push_back(added(i));
            rank_[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(known_.size()) - 1;
        }
        assert(are_sorted(line));
    }

    /// The plan vertices in order along the line, each once.
    const std::vector<PlanVertexId>& in_order() const { return known_; }
    /// Which of them was added under a number.
    std::int32_t rank(std::int32_t number) const { return rank_[static_cast<std::size_t>(number)]; }
    /// Which of them a plan vertex is, where no two have the same x.
    std::int32_t number_of(PlanVertexId plan_vertex) const {
        return static_cast<std::int32_t>(
            std::lower_bound(known_.begin(), known_.end(), plan_vertex) - known_.begin());
    }

private:
    static constexpr std::size_t kFew = 16;

    PlanVertexId added(std::int32_t i) const { return added_[static_cast<std::size_t>(i)]; }
    PointId point(PlanVertexId plan_vertex) const {
        return plan_vertices_.representative[static_cast<std::size_t>(plan_vertex)];
    }
    const exact::Point& position(PlanVertexId plan_vertex) const {
        return scope_.shared().point(point(plan_vertex));
    }

    /// Whether two different plan vertices have the same x.
    bool same_x() const {
        for (std::size_t i = 1; i < order_.size(); ++i) {
            const PlanVertexId a = added(order_[i - 1]), b = added(order_[i]);
            if (plan_vertices_.has_same_x_next(a) && a != b && position(a).x == position(b).x)
                return true;
        }
        return false;
    }

    /// Whether the vertices are in order along a line, exactly.
    bool are_sorted(LineId line) {
        const int axis = scope_.direction_signs(line)[0] != 0 ? 0 : 1;
        return std::is_sorted(known_.begin(), known_.end(), [&](PlanVertexId a, PlanVertexId b) {
            return scope_.compare(axis, point(a), point(b)) > 0;
        });
    }

    /// Whether plan vertex a comes before plan vertex b along a line that runs to rising x (and
    /// rising or falling y).
    bool before(int rise, PlanVertexId a, PlanVertexId b) {
        const exact::Point &p = position(a), &q = position(b);
        if (p.x != q.x) return p.x < q.x;
        if (p.y != q.y && rise != 0) return (p.y < q.y) == (rise > 0);
        const int x = scope_.compare(0, point(a), point(b));
        if (x != 0) return x > 0;
        return scope_.compare(1, point(a), point(b)) * rise > 0;
    }

    LocalArrangement scope_;
    const PlanVertices& plan_vertices_;
    std::vector<PlanVertexId> added_;  ///< some of them twice, where there are many
    std::vector<PlanVertexId> known_;  ///< along the line
    std::vector<std::int32_t> order_, rank_;
};

/// Supporting lines whose edges do not all match.
struct UnmatchedLines {
    std::vector<LineId> representative;
    std::vector<std::uint32_t> edge_counts;
    Array<LineEdge> edges;

    void add(LineId line, std::span<const LineEdge> of_line) {
        representative.push_back(line);
        edge_counts.push_back(static_cast<std::uint32_t>(of_line.size()));
        edges.append(of_line.begin(), of_line.end());
    }
};

/// Puts the lines that are left together, which are given back on the way.
void join_unmatched(std::vector<UnmatchedLines> kept, CollinearEdges& result,
                    const Execution& execution) {
    std::vector<std::size_t> first_line, first_edge;
    for (const UnmatchedLines& some : kept) {
        first_line.push_back(some.representative.size());
        first_edge.push_back(some.edges.size());
    }
    result.representative = Array<LineId>(count_before(first_line));
    result.edge_offsets = Array<std::uint32_t>(result.size() + 1);
    result.edges = Array<LineEdge>(count_before(first_edge));
    result.edge_offsets[result.size()] = static_cast<std::uint32_t>(result.edges.size());
    parallel_chunks(kept.size(), execution, [&](std::size_t i) {
        std::size_t line = first_line[i], edge = first_edge[i];
        std::copy(kept[i].edges.begin(), kept[i].edges.end(), result.edges.begin() + edge);
        for (std::size_t t = 0; t < kept[i].representative.size(); ++t, ++line) {
            result.representative[line] = kept[i].representative[t];
            result.edge_offsets[line] = static_cast<std::uint32_t>(edge);
            edge += kept[i].edge_counts[t];
        }
        kept[i] = {};
    });
}

/// Matches the edges of some lines, or puts their plan vertices in order, and finds which of them
/// edges pass.
class LineChunk {
public:
    LineChunk(const PlanArrangement& geometry, const FaceList& faces,
              const PlanVertices& plan_vertices, const Array<std::uint8_t>* cell_is_thick,
              PassedVertices& passed)
        : plan_vertices_(plan_vertices),
          passed_(passed),
          on_line_(geometry, plan_vertices),
          matching_(geometry, faces, cell_is_thick) {}

    /// Begins with a line.
    /// @param edges  its edges, whose ends are plan vertices
    void begin(std::span<LineEdge> edges, LineId line) {
        edges_ = edges;
        line_ = line;
        is_ranked_ = false;
    }

    /// Numbers the ends of the edges along the line; an edge passes all plan vertices between its
    /// ends.
    /// @param extra  plan vertices that the line must pass besides the ends of its edges
    void pass_all(std::span<const std::pair<std::int32_t, PlanVertexId>> extra) {
        if (!is_ranked_) put_in_order(extra);
        for (const LineEdge& edge : edges_)
            pass(edge, edge.from, edge.to, false);
    }

    /// Where the cells on both sides of a pair are thick, no other face is as high as the pair
    /// where it passes a plan vertex: around it all columns have one of its two faces.
    /// @return whether all edges of the line match; if not, nothing was passed
    bool pass_matched(MatchedEdges& matched) {
        // Plan vertices have numbers in order of x, and hardly ever the same x. Each end of a pair
        // is where an edge begins.
        bool same_x = false;
        for (const LineEdge& edge : edges_)
            same_x |= plan_vertices_.has_same_x_next(edge.from);
        if (same_x) put_in_order({});
        if (!matching_.match_all(edges_, line_)) return false;
        matching_.add_walls(matched);
        if (!matching_.thin().empty() && !is_ranked_) sort_ends_of_matches();
        for (const auto& [left, right] : matching_.thin()) {
            const std::int32_t from = is_ranked_ ? left->from : on_line_.number_of(left->from);
            const std::int32_t to = is_ranked_ ? left->to : on_line_.number_of(left->to);
            if (to - from == 1) continue;
            pass(*left, from, to, true);
            matched.passing.push_back({left->begin, right->begin});
        }
        return true;
    }

private:
    void put_in_order(std::span<const std::pair<std::int32_t, PlanVertexId>> extra) {
        on_line_.clear();
        for (const auto& [_, plan_vertex] : extra)
            on_line_.add(plan_vertex);
        for (LineEdge& edge : edges_) {
            edge.from = on_line_.add(edge.from);
            edge.to = on_line_.add(edge.to);
        }
        on_line_.sort(line_);
        for (LineEdge& edge : edges_) {
            edge.from = on_line_.rank(edge.from);
            edge.to = on_line_.rank(edge.to);
        }
        is_ranked_ = true;
    }
    void sort_ends_of_matches() {
        on_line_.clear();
        for (const LineEdge& edge : edges_)
            on_line_.add(edge.from);
        on_line_.sort(line_);
    }

    /// @param from, to  the ends of the edge, counted along the line
    void pass(const LineEdge& edge, std::int32_t from, std::int32_t to, bool is_tentative) {
        assert(from != to && std::max(from, to) < static_cast<int>(on_line_.in_order().size()));
        const std::int32_t between = std::abs(to - from) - 1;
        if (between == 0) return;
        passed_.edges.push_back(
            {edge.begin, static_cast<std::uint32_t>(between), is_tentative ? 1U : 0U});
        const PlanVertexId* vertex = on_line_.in_order().data() + from;
        for (std::int32_t i = 0, step = from < to ? 1 : -1; i < between; ++i)
            passed_.vertices.push_back(*(vertex += step));
    }

    const PlanVertices& plan_vertices_;
    PassedVertices& passed_;
    VerticesOnLine on_line_;
    EdgeMatching matching_;
    std::span<LineEdge> edges_;
    LineId line_ = kNone;
    bool is_ranked_ = false;  ///< whether ends of edges are counted along the line
};

}  // namespace

CollinearEdges find_collinear_edges(const PlanArrangement& geometry, const FaceList& faces,
                                    const PlanVertices& plan_vertices,
                                    const std::vector<ExtraPoint>& extra,
                                    const Array<std::uint8_t>* cell_is_thick,
                                    const Execution& execution) {
    const CollinearLines lines = join_lines(geometry, faces, execution);
    std::vector<std::pair<std::int32_t, PlanVertexId>>
        extra_vertices;  // line and plan vertex, ascending
    for (const ExtraPoint& e : extra) {
        extra_vertices.emplace_back(lines.of_line[index(e.line)],
                                    plan_vertices.of_point[index(e.point)]);
    }
    std::sort(extra_vertices.begin(), extra_vertices.end());
    const auto extra_from = [&](std::size_t line) {
        const auto first = std::pair(static_cast<std::int32_t>(line), PlanVertexId{-1});
        return static_cast<std::size_t>(
            std::lower_bound(extra_vertices.begin(), extra_vertices.end(), first) -
            extra_vertices.begin());
    };
    CollinearEdges result;
    LineBuckets buckets(faces, lines);
    result.passed.resize(buckets.size());
    result.matched.resize(buckets.size());
    std::vector<UnmatchedLines> kept(buckets.size());
    for (const std::size_t half : {0, 1}) {
        const std::size_t first = buckets.size() * half / 2, end = buckets.size() * (half + 1) / 2;
        buckets.fill(first, end, execution);
        const auto match = [&](std::size_t i) {
            const std::size_t bucket = first + i;
            auto edges = buckets.by_lines(bucket, plan_vertices);
            LineChunk chunk(geometry, faces, plan_vertices, cell_is_thick, result.passed[bucket]);
            MatchedEdges matched;
            const std::size_t begin = buckets.first_line(bucket);
            std::size_t next_extra = extra_from(begin);
            for (std::size_t t = begin; t < buckets.first_line(bucket + 1); ++t) {
                const std::size_t first_extra = next_extra;
                while (next_extra < extra_vertices.size() &&
                       extra_vertices[next_extra].first == static_cast<std::int32_t>(t))
                    ++next_extra;
                const std::span<LineEdge> of_line = edges[t - begin];
                chunk.begin(of_line, lines.representative[t]);
                if (cell_is_thick != nullptr && first_extra == next_extra &&
                    chunk.pass_matched(matched))
                    continue;
                chunk.pass_all(
                    {extra_vertices.begin() + first_extra, extra_vertices.begin() + next_extra});
                kept[bucket].add(lines.representative[t], of_line);
            }
            result.matched[bucket] = matched;  // without room for more
        };
        parallel_chunks(end - first, execution, match, 0.4);
    }
    join_unmatched(std::move(kept), result, execution);
    return result;
}

}  // namespace realmodel::strata
