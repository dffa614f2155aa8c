// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/collinear_edges.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel_counts.hpp"
#include "strata/conform/plan_vertices.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kEdges = 1 << 14;         // in a bucket: they fit the cache of a core
constexpr std::size_t kMostEdges = 2000000000;  // so that plan vertices on lines can be numbered
constexpr std::size_t kFacesSorted = 1 << 15,
                      kMostFaceChunks = 64;  // sorted into buckets at a time

/// The edges of faces in buckets of as many lines each, so that those of a bucket fit the cache:
/// they are put in order by lines, with their ends, when it is their turn. Half of the buckets are
/// filled at a time, as all edges would take nearly as much memory as the faces.
class LineBuckets {
public:
    /// @throws InputError kind too_large, where edges cannot be numbered
    LineBuckets(const FaceList& faces, const CollinearLines& lines) : faces_(faces), lines_(lines) {
        const std::size_t edges = faces.polygons.lines.size();
        check_total(edges, kMostEdges);
        const std::size_t of_line =
            edges / std::max<std::size_t>(lines.representative.size(), 1) + 1;
        together_ = std::bit_floor(std::max<std::size_t>(kEdges / of_line, 1));
    }

    std::size_t size() const { return (lines_.representative.size() + together_ - 1) / together_; }
    std::size_t first_line(std::size_t bucket) const {
        return std::min(bucket * together_, lines_.representative.size());
    }
    /// Fills some buckets, and empties all others.
    void fill(std::size_t begin, std::size_t end, const Execution& execution) {
        edges_ = {};
        first_filled_ = begin;
        const std::uint32_t* const offsets = faces_.polygons.offsets.begin();
        const std::size_t first = first_line(begin), count = first_line(end) - first;
        const int shift = std::countr_zero(together_);
        const std::size_t chunks =
            std::clamp<std::size_t>(faces_.size() / kFacesSorted, 1, kMostFaceChunks);
        const auto produce = [&](std::size_t chunk, const auto& put) {
            const std::size_t past_last = faces_.size() * (chunk + 1) / chunks;
            for (std::size_t f = faces_.size() * chunk / chunks; f < past_last; ++f) {
                for (std::uint32_t c = offsets[f]; c < offsets[f + 1]; ++c) {
                    const std::size_t line = joined_line(c) - first;  // huge, where before
                    if (line < count) put(line >> shift, FaceEdge{c, static_cast<std::int32_t>(f)});
                }
            }
        };
        edges_ = bucketize_in_order<FaceEdge>(end - begin, chunks, produce, execution, 0.1);
    }
    /// The edges of a bucket that is filled by its lines; their ends are plan vertices.
    Buckets<LineEdge> by_lines(std::size_t bucket, const PlanVertices& plan_vertices) const {
        const std::uint32_t* const offsets = faces_.polygons.offsets.begin();
        const PointId* const points = faces_.polygons.points.begin();
        const PlanVertexId* const of_point = plan_vertices.of_point.begin();
        const std::size_t first = first_line(bucket);
        const std::span<const FaceEdge> edges = edges_[bucket - first_filled_];
        const auto produce = [&](const auto& put) {
            for (const FaceEdge& edge : edges) {
                prefetch_edge(&edge, edges.data() + edges.size());
                const std::size_t face = index(edge.face);
                const std::size_t next =
                    edge.corner + 1 < offsets[face + 1] ? edge.corner + 1 : offsets[face];
                put(joined_line(edge.corner) - first,
                    LineEdge{of_point[index(points[edge.corner])], of_point[index(points[next])],
                             edge.corner, edge.face});
            }
        };
        return bucketize<LineEdge>(first_line(bucket + 1) - first, produce);
    }

private:
    struct FaceEdge {
        std::uint32_t corner;  ///< that it leaves
        std::int32_t face;
    };
    /// Of the edge that leaves a corner.
    std::size_t joined_line(std::size_t corner) const {
        return static_cast<std::size_t>(lines_.of_line[index(faces_.polygons.lines[corner].id())]);
    }
    /// Asks for what will be read of the edges after one, and for what matching will want to know.
    [[gnu::always_inline]] void prefetch_edge(const FaceEdge* edge, const FaceEdge* end) const {
        const FaceEdge& far = edge[std::min<std::ptrdiff_t>(32, end - edge - 1)];
        const std::size_t face = index(far.face);
        prefetch(&faces_.polygons.points[far.corner]);
        prefetch(&faces_.polygons.lines[far.corner]);
        prefetch(&faces_.polygons.offsets[face]);
        prefetch(&faces_.plane[face]);
        prefetch(&faces_.above[face]);
        prefetch(&faces_.below[face]);
    }

    const FaceList& faces_;
    const CollinearLines& lines_;
    std::size_t together_;  ///< lines in a bucket
    std::size_t first_filled_ = 0;
    Buckets<FaceEdge> edges_;  ///< of those that are filled
};

/// Finds the matches of one line after another.
class EdgeMatching {
public:
    EdgeMatching(const exact::PlanArrangement& geometry, const FaceList& faces,
                 const Array<std::uint8_t>* cell_is_thick)
        : geometry_(geometry), faces_(faces), cell_is_thick_(cell_is_thick) {}

    /// Matches the edges of a line.
    /// @param edges  with their ends counted along the line, or plan vertices whose numbers rise
    /// along it
    /// @param line  the plan line that carries the edges
    /// @return whether all match and the walls between them follow from that; then thin() and
    ///     add_walls() are of this line
    bool match_all(std::span<const LineEdge> edges, LineId line) {
        same_ = {kNone, kNone};
        thin_.clear();
        bounds_.clear();
        beneath_.clear();
        if (!find_matches(edges, line)) return false;
        sort_bounds();
        return find_walls();
    }

    struct EdgePair {
        const LineEdge *left, *right;
    };
    /// The matches beside which a cell, or what was left out, is not thick.
    const std::vector<EdgePair>& thin() const { return thin_; }
    /// Adds the walls of the line matched last.
    void add_walls(MatchedEdges& to) const {
        for (const WallBounds& wall : walls_) {
            const std::uint64_t cells = bounds_[wall.above].cells;
            to.walls.push_back({{static_cast<std::int32_t>(cells >> 32),
                                 static_cast<std::int32_t>(cells & 0xffffffff)},
                                static_cast<std::uint32_t>(wall.above_end - wall.above),
                                static_cast<std::uint32_t>(wall.beneath_end - wall.beneath)});
            const auto add_corners = [&](std::size_t begin, std::size_t end) {
                assert(begin < end);
                for (std::size_t i = begin; i < end; ++i)
                    to.corners.push_back(bounds_[i].edge->begin);
                to.corners.push_back(end_corner(*bounds_[end - 1].edge));
            };
            add_corners(wall.above, wall.above_end);
            add_corners(wall.beneath, wall.beneath_end);
        }
    }

private:
    /// An edge by its ends, in order along the line, and its side.
    struct SidedEdge {
        std::uint64_t ends_and_side;
        const LineEdge* edge;

        std::uint64_t ends() const { return ends_and_side >> 1; }
        bool is_right() const { return (ends_and_side & 1) != 0; }
    };
    /// The name of the line in space that an edge is on: the input edge above the plan line, or the
    /// plane of its face.
    using Name = exact::EdgeOrPlane;
    /// A pair that bounds a wall between two cells.
    struct CellBound {
        std::uint64_t cells;        ///< left and right of the line
        std::uint64_t plan_vertex;  ///< whether the wall stands on it, and where it begins
        const LineEdge* edge;       ///< the left one

        bool is_beneath() const { return plan_vertex >> 32 != 0; }
    };
    /// Bounds of one wall, as ranges of bounds_.
    struct WallBounds {
        std::size_t above, beneath, above_end, beneath_end;
    };

    PlaneId plane_of(const LineEdge& edge) const {
        return faces_.plane[static_cast<std::size_t>(edge.face)];
    }
    Name name(const LineEdge& edge, const exact::Line& line) const {
        const PlaneId plane = plane_of(edge);
        const Name first = geometry_.plane(plane).above(line);
        if (first.is_edge()) return first;
        // several edges in a row are one line, each on a line of its own
        const auto edge_line = faces_.polygons.lines[edge.begin].id();
        const Name second = geometry_.plane(plane).above(geometry_.line(edge_line));
        return second.is_edge() ? second : Name(plane);
    }
    bool find_matches(std::span<const LineEdge> edges, LineId line_id) {
        segments_.resize(edges.size());
        SidedEdge* next = segments_.begin();
        for (const LineEdge& edge : edges) {
            const bool is_right = edge.from > edge.to;
            const auto [low, high] =
                is_right ? std::pair(edge.to, edge.from) : std::pair(edge.from, edge.to);
            *next++ = {packed_pair(low, high) << 1 | (is_right ? 1 : 0), &edge};
        }
        std::sort(segments_.begin(), segments_.end(), [](const SidedEdge& a, const SidedEdge& b) {
            return a.ends_and_side < b.ends_and_side;
        });
        const exact::Line& line = geometry_.line(line_id);
        for (SidedEdge *begin = segments_.begin(), *const last = segments_.end(); begin != last;) {
            if (begin->is_right() || begin + 1 == last) return false;
            if (begin[1].ends_and_side == begin->ends_and_side + 1) {  // one edge on each side
                if (!are_one_line(*begin->edge, *begin[1].edge, line)) return false;
                add({begin->edge, begin[1].edge});
                begin += 2;
                continue;
            }
            const auto right =
                std::find_if(begin, last, [](const SidedEdge& s) { return s.is_right(); });
            const auto count = static_cast<std::size_t>(right - begin);
            if (static_cast<std::size_t>(last - right) < count ||
                right[count - 1].ends_and_side != begin->ends_and_side + 1 ||
                begin[count - 1].ends() != begin->ends() ||
                !match({begin, count}, {right, count}, line))
                return false;
            begin = right + count;
        }
        return true;
    }
    /// Whether two edges of the same ends are one segment in space.
    bool are_one_line(const LineEdge& left, const LineEdge& right, const exact::Line& line) {
        const std::array planes{plane_of(left), plane_of(right)};
        if (planes[0] == planes[1] || planes == same_) return true;
        const Name of_left = name(left, line);
        if (of_left != name(right, line)) return false;
        // Segments that follow each other mostly lie between the same two triangles.
        if (of_left == geometry_.plane(planes[0]).above(line)) same_ = planes;
        return true;
    }
    /// Matches several edges of the same ends.
    bool match(std::span<SidedEdge> left, std::span<SidedEdge> right, const exact::Line& line) {
        const auto find_names = [&](std::span<SidedEdge> segments, auto& names) {
            names.clear();
            for (const SidedEdge& s : segments)
                names.emplace_back(name(*s.edge, line), s.edge);
            std::sort(names.begin(), names.end(),
                      [](const auto& a, const auto& b) { return a.first < b.first; });
        };
        find_names(left, left_names_);
        find_names(right, right_names_);
        for (std::size_t i = 0; i < left_names_.size(); ++i) {
            const Name& known = left_names_[i].first;
            if (known != right_names_[i].first) return false;
            if (i > 0 && known == left_names_[i - 1].first) return false;  // which is whose?
            add({left_names_[i].second, right_names_[i].second});
        }
        return true;
    }
    /// Adds a match, and what walls it bounds. A face is known to be as high as no other where it
    /// lies between thick cells, or those and the outside.
    void add(const EdgePair& pair) {
        const std::size_t left = index(pair.left->face), right = index(pair.right->face);
        const std::array above{faces_.above[left], faces_.above[right]};
        const std::array below{faces_.below[left], faces_.below[right]};
        const auto is_thick = [&](std::int32_t cell) {
            return cell < 0 ? cell == kOutsideCell : (*cell_is_thick_)[index(cell)] != 0;
        };
        if (!is_thick(above[0]) || !is_thick(above[1]) || !is_thick(below[0]) ||
            !is_thick(below[1]))
            thin_.push_back(pair);
        if (above[0] != above[1]) add_bound(above, 1, *pair.left);
        if (below[0] != below[1]) add_bound(below, 0, *pair.left);
    }
    void add_bound(const std::array<std::int32_t, 2>& nodes, std::int32_t is_beneath,
                   const LineEdge& left) {
        const std::array cells{cell_of(nodes[0]), cell_of(nodes[1])};
        if (cells[0] == cells[1]) return;
        (is_beneath != 0 ? beneath_ : bounds_)
            .push_back(
                {packed_pair(cells[0], cells[1]), packed_pair(is_beneath, left.from), &left});
    }
    void sort_bounds() {
        bounds_.append(beneath_.begin(), beneath_.end());
        const auto differs = [&](const CellBound& bound) {
            return bound.cells != bounds_[0].cells;
        };
        if (std::none_of(bounds_.begin(), bounds_.end(), differs)) return;  // found along the line
        std::sort(bounds_.begin(), bounds_.end(), [](const CellBound& a, const CellBound& b) {
            return a.cells != b.cells ? a.cells < b.cells : a.plan_vertex < b.plan_vertex;
        });
    }
    /// Bounds that follow each other without a gap are those of one wall; above and beneath there
    /// must be the same segments.
    bool find_walls() {
        walls_.clear();
        const auto end_of_segments = [&](std::size_t i, std::size_t end) {
            for (++i; i < end && bounds_[i].edge->from == bounds_[i - 1].edge->to;)
                ++i;
            return i;
        };
        for (std::size_t begin = 0, end = 0; begin < bounds_.size(); begin = end) {
            std::size_t beneath = begin;
            for (end = begin; end < bounds_.size() && bounds_[end].cells == bounds_[begin].cells;
                 ++end)
                beneath += bounds_[end].is_beneath() ? 0 : 1;
            const std::size_t last_above = beneath;
            for (std::size_t above = begin; above < last_above || beneath < end;) {
                if (above == last_above || beneath == end) return false;
                const WallBounds wall{above, beneath, end_of_segments(above, last_above),
                                      end_of_segments(beneath, end)};
                if (bounds_[wall.above].edge->from != bounds_[wall.beneath].edge->from ||
                    bounds_[wall.above_end - 1].edge->to != bounds_[wall.beneath_end - 1].edge->to)
                    return false;
                walls_.push_back(wall);
                above = wall.above_end;
                beneath = wall.beneath_end;
            }
        }
        return true;
    }
    std::uint32_t end_corner(const LineEdge& edge) const {
        const auto& offsets = faces_.polygons.offsets;
        const auto face = static_cast<std::size_t>(edge.face);
        return edge.begin + 1 < offsets[face + 1] ? edge.begin + 1 : offsets[face];
    }

    const exact::PlanArrangement& geometry_;
    const FaceList& faces_;
    const Array<std::uint8_t>* cell_is_thick_;
    Array<SidedEdge> segments_;
    /// Planes that meet above the plan line.
    std::array<PlaneId, 2> same_{kNone, kNone};
    std::vector<std::pair<Name, const LineEdge*>> left_names_, right_names_;
    std::vector<EdgePair> thin_;
    Array<CellBound> bounds_, beneath_;
    std::vector<WallBounds> walls_;
};

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
        for (std::size_t i = added_.size(), least = i > kRecent ? i - kRecent : 0; i > least; --i) {
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
    static constexpr std::size_t kRecent = 16;

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
void join_unmatched(std::vector<UnmatchedLines> lines, CollinearEdges& result,
                    const Execution& execution) {
    std::vector<std::size_t> first_line, first_edge;
    for (const UnmatchedLines& some : lines) {
        first_line.push_back(some.representative.size());
        first_edge.push_back(some.edges.size());
    }
    result.representative = Array<LineId>(exclusive_scan(first_line));
    result.edge_offsets = Array<std::uint32_t>(result.size() + 1);
    result.edges = Array<LineEdge>(exclusive_scan(first_edge));
    result.edge_offsets[result.size()] = static_cast<std::uint32_t>(result.edges.size());
    parallel_chunks(lines.size(), execution, [&](std::size_t i) {
        std::size_t line = first_line[i], edge = first_edge[i];
        std::copy(lines[i].edges.begin(), lines[i].edges.end(), result.edges.begin() + edge);
        for (std::size_t t = 0; t < lines[i].representative.size(); ++t, ++line) {
            result.representative[line] = lines[i].representative[t];
            result.edge_offsets[line] = static_cast<std::uint32_t>(edge);
            edge += lines[i].edge_counts[t];
        }
        lines[i] = {};
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
                                    const Execution& execution,
                                    const std::vector<std::uint8_t>* left_out) {
    const CollinearLines lines = join_lines(geometry, faces, execution, left_out);
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
    std::vector<UnmatchedLines> unmatched(buckets.size());
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
                unmatched[bucket].add(lines.representative[t], of_line);
            }
            result.matched[bucket] = matched;  // without room for more
        };
        parallel_chunks(end - first, execution, match, 0.4);
    }
    join_unmatched(std::move(unmatched), result, execution);
    return result;
}

}  // namespace realmodel::strata
