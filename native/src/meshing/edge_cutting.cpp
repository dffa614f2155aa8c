// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/edge_cutting.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <optional>

#include "base/algorithms.hpp"
#include "base/vectors.hpp"
#include "meshing/plan_predicates.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::meshing {

namespace {

/// The point, or one of the eight doubles around it, at which an edge can be cut.
std::optional<PlanPoint> point_with_room(const FlatMesh& mesh, HalfEdge edge, const PlanPoint& p) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto beside = [](double x) {
        return std::array{x, std::nextafter(x, -kInfinity), std::nextafter(x, kInfinity)};
    };
    for (const double x : beside(p[0]))
        for (const double y : beside(p[1]))
            if (can_cut(mesh, edge, {x, y})) return PlanPoint{x, y};
    return std::nullopt;
}

}  // namespace

double rounding_slack(std::span<const PlanPoint> points) {
    double largest = 0;
    for (const PlanPoint& p : points)
        largest = std::max({largest, std::abs(p[0]), std::abs(p[1])});
    // a + t (b - a) is off by 5 half units in the last place of the largest coordinate at most, on
    // either axis, so by less than 4 units in all.
    return 4 * largest * std::numeric_limits<double>::epsilon();
}

bool has_room(const FlatMesh& mesh, HalfEdge edge, double nearest, double slack) {
    const PlanPoint &a = mesh.origin_point(edge), &b = mesh.target_point(edge),
                    &c = mesh.apex_point(edge);
    const double length = std::sqrt(squared_distance(a, b));
    const double height = twice_area(a, b, c) / length;
    // Both edges may be bent, and the height is itself rounded.
    const double needed = 4 * slack;
    const double farther = std::sqrt(std::max(squared_distance(a, c), squared_distance(b, c)));
    return height > needed && nearest * height > needed * farther;
}

bool can_cut(const FlatMesh& mesh, HalfEdge edge, const PlanPoint& p) {
    const auto fits = [&](HalfEdge s) {
        const PlanPoint& apex = mesh.apex_point(s);
        return orient2d(apex, mesh.origin_point(s), p) > 0 &&
               orient2d(p, mesh.target_point(s), apex) > 0;
    };
    return fits(edge) && (mesh.is_border(edge) || fits(mesh.twin(edge)));
}

EdgeCutting::EdgeCutting(const ConstrainedTriangulation& triangulation,
                         const std::vector<bool>& inside, std::vector<PlanPoint> points)
    : inside_(inside), at_(points.size()) {
    const auto count = static_cast<std::int32_t>(triangulation.triangles.size());
    mesh_.points = std::move(points);
    mesh_.corners = triangulation.triangles;
    mesh_.twins.resize(count);
    mesh_.marks.resize(count);
    mesh_.for_each_edge([&](HalfEdge edge) {
        const std::int32_t t = edge.triangle();
        const int i = edge.index();
        at_[mesh_.from(edge)] = edge;
        if (triangulation.constrained[t][i]) mesh_.fix(edge);
        const std::int32_t other = triangulation.neighbors[t][i];
        if (other < 0) return;
        const auto& corners = mesh_.corners[other];
        const auto twin = std::find(corners.begin(), corners.end(), mesh_.to(edge));
        assert(twin != corners.end());
        mesh_.twins[t][i] = {other, static_cast<int>(twin - corners.begin())};
    });
}

void EdgeCutting::add_points(std::span<const PlanPoint> points) {
    const auto more = points.subspan(mesh_.points.size());
    mesh_.points.insert(mesh_.points.end(), more.begin(), more.end());
    at_.resize(points.size());
}

HalfEdge EdgeCutting::between(std::int32_t a, std::int32_t b) const {
    HalfEdge joining_edge = HalfEdge::none();
    mesh_.visit_star(at_[a], [&](HalfEdge edge) {
        if (!joining_edge.is_none()) return;
        if (mesh_.to(edge) == b) joining_edge = edge;
        if (mesh_.apex(edge) == b) joining_edge = edge.prev();
    });
    return joining_edge;
}

bool EdgeCutting::insert(HalfEdge edge, std::int32_t point) {
    const std::optional<PlanPoint> p = point_with_room(mesh_, edge, mesh_.points[point]);
    if (!p) return false;
    mesh_.points[point] = *p;
    const HalfEdge other = mesh_.twin(edge);
    inside_.push_back(inside_[edge.triangle()]);
    if (!other.is_none()) inside_.push_back(inside_[other.triangle()]);
    mesh_.visit_star(mesh_.insert_on(edge, point), [&](HalfEdge e) {
        at_[mesh_.from(e)] = e;
        at_[mesh_.to(e)] = e.next();
        at_[mesh_.apex(e)] = e.prev();
    });
    assert(inside_.size() == mesh_.corners.size());
    return true;
}

void EdgeCutting::cut(std::span<const CutEdge> edges, const Check& check) {
    Ticker tick(check, 1024);
    std::deque<CutEdge> open(edges.begin(), edges.end());
    while (!open.empty()) {
        tick(0);
        const auto [edge, first, last] = open.front();
        open.pop_front();
        const HalfEdge whole = between(edge[0], edge[1]);
        assert(!whole.is_none() && mesh_.is_fixed(whole));
        // The middle one; where that has no room any other.
        std::int32_t point = first + (last - first) / 2;
        bool is_cut = first < last && insert(whole, point);
        for (std::int32_t i = first; i < last && !is_cut; ++i) {
            point = i;
            is_cut = insert(whole, point);
        }
        if (!is_cut) continue;
        if (first < point) open.push_back({{edge[0], point}, first, point});
        if (point + 1 < last) open.push_back({{point, edge[1]}, point + 1, last});
    }
}

FlatMesh EdgeCutting::take_inside(double nearest, double slack) && {
    const auto count = static_cast<std::int32_t>(mesh_.corners.size());
    for (std::int32_t t = 0; t < count; ++t) {
        for (int i = 0; i < 3 && inside_[t]; ++i) {
            const HalfEdge edge(t, i), other = mesh_.twin(edge);
            if (other.is_none() || is_inside(other)) continue;
            if (!has_room(mesh_, other, nearest, slack)) mesh_.fix(edge, true, true);
            mesh_.twins[t][i] = HalfEdge::none();
        }
    }
    for (std::int32_t t = 0; t < count; ++t)
        if (!inside_[t]) mesh_.corners[t] = {-1, -1, -1};
    mesh_.compact();
    return std::move(mesh_);
}

namespace {

constexpr double kLongestPiece = 1.4;  // lengths wanted: above it two pieces fit better than one
constexpr double kSharpAngle = std::numbers::pi / 3;

double length_of(const RegionGraph& graph, const VertexSegment& edge) {
    return distance(graph.points[edge[0]], graph.points[edge[1]]);
}

/// For each point the distance at which its edges are cut because two of them meet at a sharp angle
/// inside the region; 0 where none do.
std::vector<double> tip_lengths(const RegionGraph& graph, SizeField& size) {
    struct Spoke {
        std::int32_t corner;
        double direction;
        bool inside_left;  // the region is counter-clockwise of it
        double length;
        auto operator<=>(const Spoke&) const = default;
    };
    std::vector<Spoke> spokes;
    spokes.reserve(2 * (graph.border.size() + graph.inner.size()));
    const auto add = [&](const VertexSegment& edge, bool is_inner) {
        const PlanPoint &a = graph.points[edge[0]], &b = graph.points[edge[1]];
        const double length = length_of(graph, edge);
        spokes.push_back({edge[0], elementary::atan2(b[1] - a[1], b[0] - a[0]), true, length});
        spokes.push_back({edge[1], elementary::atan2(a[1] - b[1], a[0] - b[0]), is_inner, length});
    };
    for (const VertexSegment& edge : graph.border)
        add(edge, false);
    for (const VertexSegment& edge : graph.inner)
        add(edge, true);
    std::sort(spokes.begin(), spokes.end());
    std::vector<double> lengths(graph.points.size(), 0.0);
    for (const auto around : groups_of(spokes, &Spoke::corner)) {
        if (around.size() == 1) continue;
        const std::int32_t corner = around[0].corner;
        const double shortest = std::ranges::min(around, {}, &Spoke::length).length;
        for (std::size_t i = 0; i < around.size(); ++i) {
            if (!around[i].inside_left) continue;
            const Spoke& next = around[(i + 1) % around.size()];
            double angle = next.direction - around[i].direction;
            if (angle <= 0) angle += 2 * std::numbers::pi;
            if (angle < kSharpAngle) {
                // A tip so far from the corner that the triangle there is wide enough to be refined
                // (shortest_edge in region_mesh.cpp); room for the tips at both ends of an edge.
                const double wide = std::min(size.largest(), 4e-3 * size.largest() / angle);
                lengths[corner] =
                    std::min(std::max(size.at(graph.points[corner]), wide), shortest / 2.5);
            }
        }
    }
    return lengths;
}

std::size_t piece_count(double lengths) {
    return static_cast<std::size_t>(std::max(1.0, std::ceil(lengths - (kLongestPiece - 1))));
}

/// Shares of the way from a to b, between `begin` and `end`, at which to cut.
std::vector<double> cuts(const PlanPoint& a, const PlanPoint& b, double begin, double end,
                         SizeField& size) {
    std::vector<double> shares;
    if (begin > 0) shares.push_back(begin);
    const double length = distance(a, b);
    if (size.is_uniform()) {
        const std::size_t count = piece_count((end - begin) * length / size.largest());
        for (std::size_t i = 1; i < count; ++i) {
            shares.push_back(begin +
                             (end - begin) * static_cast<double>(i) / static_cast<double>(count));
        }
    } else {
        // How many lengths wanted lie between the beginning and each of some places.
        std::vector<std::array<double, 2>> sums{{begin, 0.0}};
        const auto wanted = [&](double t) { return size.at(moved(a, t, minus(b, a))); };
        double here = wanted(begin);
        while (sums.back()[0] < end) {
            const double t = std::min(end, sums.back()[0] + 0.3 * here / length);
            const double length_ahead = wanted(t);
            const double step = (t - sums.back()[0]) * length;
            sums.push_back({t, sums.back()[1] + step * 0.5 * (1 / here + 1 / length_ahead)});
            if (t == sums[sums.size() - 2][0]) break;
            here = length_ahead;
        }
        const double all = sums.back()[1];
        const std::size_t count = piece_count(all);
        std::size_t at = 0;
        for (std::size_t i = 1; i < count; ++i) {
            const double sum = all * static_cast<double>(i) / static_cast<double>(count);
            while (sums[at + 1][1] < sum)
                ++at;
            const double fraction = (sum - sums[at][1]) / (sums[at + 1][1] - sums[at][1]);
            shares.push_back(sums[at][0] + fraction * (sums[at + 1][0] - sums[at][0]));
        }
    }
    if (end < 1) shares.push_back(end);
    return shares;
}

/// The edges of a graph, border and inner, cut at the shares of their length that
/// `shares_of(edge)` gives; cuts that there is no room for are left out.
class Cutter {
public:
    Cutter(const RegionGraph& graph, double finest, const Check& check)
        : graph_(graph), finest_(finest), check_(check) {}

    template <class SharesOf>
    BorderPieces run(SharesOf&& shares_of) {
        pieces_.points = graph_.points;
        for (const auto* edges : {&graph_.border, &graph_.inner}) {
            for (const VertexSegment& edge : *edges) {
                if (pieces_.edges.size() % 1024 == 0) check_(0);
                // Always from the lesser end, so that a border read in the other direction is cut
                // alike.
                const bool is_reversed = graph_.points[edge[1]] < graph_.points[edge[0]];
                const VertexSegment way = is_reversed ? VertexSegment{edge[1], edge[0]} : edge;
                std::vector<double> shares = shares_of(way);
                if (is_reversed) std::reverse(shares.begin(), shares.end());
                add(edge, way, shares);
            }
        }
        settle();
        return std::move(pieces_);
    }

private:
    void add(const VertexSegment& edge, const VertexSegment& way, std::span<const double> shares) {
        const PlanPoint &a = graph_.points[way[0]], &b = graph_.points[way[1]];
        const auto first = static_cast<std::int32_t>(pieces_.points.size());
        double nearest = 1;
        for (const double t : shares) {
            pieces_.points.push_back(moved(a, t, minus(b, a)));
            nearest = std::min({nearest, t, 1 - t});
        }
        if (static_cast<double>(pieces_.points.size()) > kMostFlatTriangles) {
            throw InputError("too_large",
                             "the outlines need more pieces than 32-bit numbers can "
                             "count; use a larger edge length");
        }
        pieces_.edges.push_back({edge, first, static_cast<std::int32_t>(pieces_.points.size())});
        nearest_.push_back(nearest * length_of(graph_, edge));
    }

    bool is_border(std::size_t edge) const { return edge < graph_.border.size(); }

    /// Where others come close, points are added one by one, as far as there is room.
    void settle() {
        const double slack = rounding_slack(graph_.points);
        EdgeCutting cutting(graph_.triangulation, graph_.inside, pieces_.points);
        const FlatMesh& mesh = cutting.mesh();
        std::vector<CutEdge> tight;
        std::vector<bool> is_tight(pieces_.edges.size()), is_crowded(pieces_.edges.size());
        for (std::size_t k = 0; k < pieces_.edges.size(); ++k) {
            const HalfEdge edge =
                is_border(k) ? graph_.border_at[k] : graph_.inner_at[k - graph_.border.size()];
            const HalfEdge other = mesh.twin(edge);
            const bool is_cut = pieces_.edges[k].first < pieces_.edges[k].last;
            const double nearest = is_border(k) ? std::min(nearest_[k], finest_) : nearest_[k];
            const bool has_room_beyond = other.is_none() || has_room(mesh, other, nearest, slack);
            is_crowded[k] = is_border(k) && !has_room_beyond;
            is_tight[k] = is_cut && !(has_room_beyond && has_room(mesh, edge, nearest_[k], slack));
            if (is_tight[k]) tight.push_back(pieces_.edges[k]);
        }
        cutting.cut(tight, check_);
        std::vector<PlanPoint> points = graph_.points;
        for (std::size_t k = 0; k < pieces_.edges.size(); ++k) {
            auto& [edge, first, last] = pieces_.edges[k];
            VertexSegment before = edge,
                          piece = edge;  // by the numbers of before, and those from now on
            const auto end_piece = [&](std::int32_t old_end, std::int32_t end) {
                before[1] = old_end;
                piece[1] = end;
                (is_border(k) ? pieces_.border : pieces_.inner).push_back(piece);
                if (is_crowded[k] && !may_be_cut(cutting, before, slack))
                    pieces_.locked.push_back(piece);
                before[0] = old_end;
                piece[0] = end;
            };
            const auto begin = static_cast<std::int32_t>(points.size());
            for (std::int32_t point = first; point < last; ++point) {
                if (is_tight[k] && !cutting.has(point)) continue;
                points.push_back(mesh.points[point]);
                end_piece(point, static_cast<std::int32_t>(points.size()) - 1);
            }
            end_piece(edge[1], edge[1]);
            first = begin;
            last = static_cast<std::int32_t>(points.size());
        }
        pieces_.points = std::move(points);
        std::sort(pieces_.locked.begin(), pieces_.locked.end());
    }

    /// Whether there is room outside of the region for cuts in a piece of the border.
    bool may_be_cut(const EdgeCutting& cutting, const VertexSegment& piece, double slack) const {
        HalfEdge edge = cutting.between(piece[0], piece[1]);
        if (cutting.is_inside(edge)) edge = cutting.mesh().twin(edge);
        return edge.is_none() || has_room(cutting.mesh(), edge, finest_, slack);
    }

    const RegionGraph& graph_;
    double finest_;
    const Check& check_;
    BorderPieces pieces_;
    std::vector<double> nearest_;  ///< of each edge: from an end to what cuts it next to that
};

}  // namespace

BorderPieces cut_border(const RegionGraph& graph, SizeField& size, double finest,
                        const Check& check) {
    const std::vector<double> tips = tip_lengths(graph, size);
    return Cutter(graph, finest, check).run([&](const VertexSegment& edge) {
        const double length = length_of(graph, edge);
        return cuts(graph.points[edge[0]], graph.points[edge[1]], tips[edge[0]] / length,
                    1 - tips[edge[1]] / length, size);
    });
}

BorderPieces cut_border_by_grid(const RegionGraph& graph, const PlanPoint& origin, double spacing,
                                double closest, double finest, const Check& check) {
    return Cutter(graph, finest, check).run([&](const VertexSegment& edge) {
        const PlanPoint &a = graph.points[edge[0]], &b = graph.points[edge[1]];
        std::vector<double> crossings;
        for (int k = 0; k < 2; ++k) {
            if (a[k] == b[k]) continue;
            const auto [low, high] = std::minmax(a[k], b[k]);
            const auto last = static_cast<std::int64_t>(std::floor((high - origin[k]) / spacing));
            for (auto i = static_cast<std::int64_t>(std::ceil((low - origin[k]) / spacing));
                 i <= last; ++i) {
                crossings.push_back((origin[k] + static_cast<double>(i) * spacing - a[k]) /
                                    (b[k] - a[k]));
            }
        }
        std::sort(crossings.begin(), crossings.end());
        const double apart = closest * spacing / length_of(graph, edge);
        std::vector<double> cuts;
        for (const double t : crossings) {
            if (t >= (cuts.empty() ? 0 : cuts.back()) + apart && t <= 1 - apart) cuts.push_back(t);
        }
        return cuts;
    });
}

double estimate_pieces(const RegionGraph& graph, double edge_length) {
    double pieces = 0;
    for (const auto* edges : {&graph.border, &graph.inner}) {
        for (const VertexSegment& edge : *edges)
            pieces += 2 + length_of(graph, edge) / edge_length;
    }
    return pieces;
}

}  // namespace realmodel::meshing
