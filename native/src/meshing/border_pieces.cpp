// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/border_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace realmodel::meshing {

namespace {

constexpr double kLongestPiece = 1.4;  // lengths wanted: above it two pieces fit better than one
constexpr double kSharpAngle = std::numbers::pi / 3;

double length_of(const RegionGraph& graph, const Segment& edge) {
    const PlanPoint &a = graph.points[edge[0]], &b = graph.points[edge[1]];
    return std::hypot(b[0] - a[0], b[1] - a[1]);
}

/// For each point the distance at which its edges are cut because two of them meet at a sharp angle
/// inside the region; 0 where none do.
std::vector<double> tip_lengths(const RegionGraph& graph, const SizeField& size) {
    struct Spoke {
        std::int32_t corner;
        double direction;
        bool inside_left;  // the region is counter-clockwise of it
        double length;
    };
    std::vector<Spoke> spokes;
    spokes.reserve(2 * (graph.border.size() + graph.inner.size()));
    const auto add = [&](const Segment& edge, bool is_inner) {
        const PlanPoint &a = graph.points[edge[0]], &b = graph.points[edge[1]];
        const double length = length_of(graph, edge);
        spokes.push_back({edge[0], std::atan2(b[1] - a[1], b[0] - a[0]), true, length});
        spokes.push_back({edge[1], std::atan2(a[1] - b[1], a[0] - b[0]), is_inner, length});
    };
    for (const Segment& edge : graph.border)
        add(edge, false);
    for (const Segment& edge : graph.inner)
        add(edge, true);
    std::sort(spokes.begin(), spokes.end(), [](const Spoke& s, const Spoke& t) {
        if (s.corner != t.corner) return s.corner < t.corner;
        return s.direction != t.direction ? s.direction < t.direction
                                          : s.inside_left < t.inside_left;
    });
    std::vector<double> lengths(graph.points.size(), 0.0);
    for (std::size_t begin = 0, end = 0; begin < spokes.size(); begin = end) {
        double shortest = std::numeric_limits<double>::infinity();
        for (end = begin; end < spokes.size() && spokes[end].corner == spokes[begin].corner;
             ++end) {
            shortest = std::min(shortest, spokes[end].length);
        }
        const std::int32_t corner = spokes[begin].corner;
        for (std::size_t i = begin; i < end && end - begin > 1; ++i) {
            if (!spokes[i].inside_left) continue;
            const Spoke& next = spokes[i + 1 < end ? i + 1 : begin];
            double angle = next.direction - spokes[i].direction;
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
                         const SizeField& size) {
    std::vector<double> shares;
    if (begin > 0) shares.push_back(begin);
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    if (size.is_uniform()) {
        const std::size_t count = piece_count((end - begin) * length / size.largest());
        for (std::size_t i = 1; i < count; ++i) {
            shares.push_back(begin +
                             (end - begin) * static_cast<double>(i) / static_cast<double>(count));
        }
    } else {
        // How many lengths wanted lie between the beginning and each of some places.
        std::vector<std::array<double, 2>> sums{{begin, 0.0}};
        const auto wanted = [&](double t) {
            return size.at({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
        };
        double here = wanted(begin);
        while (sums.back()[0] < end) {
            const double t = std::min(end, sums.back()[0] + 0.3 * here / length);
            const double there = wanted(t);
            const double step = (t - sums.back()[0]) * length;
            sums.push_back({t, sums.back()[1] + step * 0.5 * (1 / here + 1 / there)});
            if (t == sums[sums.size() - 2][0]) break;
            here = there;
        }
        const double all = sums.back()[1];
        const std::size_t count = piece_count(all);
        std::size_t at = 0;
        for (std::size_t i = 1; i < count; ++i) {
            const double sum = all * static_cast<double>(i) / static_cast<double>(count);
            while (sums[at + 1][1] < sum)
                ++at;
            const double part = (sum - sums[at][1]) / (sums[at + 1][1] - sums[at][1]);
            shares.push_back(sums[at][0] + part * (sums[at + 1][0] - sums[at][0]));
        }
    }
    if (end < 1) shares.push_back(end);
    return shares;
}

/// Cuts edges at the shares of their length that `shares_of(edge)` gives.
template <class SharesOf>
BorderPieces cut_edges(const RegionGraph& graph, const Check& check, SharesOf&& shares_of) {
    BorderPieces pieces;
    pieces.points = graph.points;
    std::size_t seen = 0;
    const auto cut = [&](const Segment& edge, std::vector<Segment>& out) {
        if (++seen % 1024 == 0) check(0);
        // Always from the lesser end, so that a border read in the other direction is cut alike.
        const bool turns = graph.points[edge[1]] < graph.points[edge[0]];
        const Segment way = turns ? Segment{edge[1], edge[0]} : edge;
        const PlanPoint &a = graph.points[way[0]], &b = graph.points[way[1]];
        std::vector<double> shares = shares_of(way);
        if (turns) std::reverse(shares.begin(), shares.end());
        std::int32_t last = edge[0];
        for (const double t : shares) {
            const auto next = static_cast<std::int32_t>(pieces.points.size());
            pieces.points.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
            out.push_back({last, next});
            last = next;
        }
        out.push_back({last, edge[1]});
    };
    for (const Segment& edge : graph.border)
        cut(edge, pieces.border);
    for (const Segment& edge : graph.inner)
        cut(edge, pieces.inner);
    return pieces;
}

}  // namespace

BorderPieces cut_border(const RegionGraph& graph, const SizeField& size, const Check& check) {
    const std::vector<double> tips = tip_lengths(graph, size);
    return cut_edges(graph, check, [&](const Segment& edge) {
        const double length = length_of(graph, edge);
        return cuts(graph.points[edge[0]], graph.points[edge[1]], tips[edge[0]] / length,
                    1 - tips[edge[1]] / length, size);
    });
}

BorderPieces cut_border_by_grid(const RegionGraph& graph, const PlanPoint& origin, double side,
                                double closest, const Check& check) {
    return cut_edges(graph, check, [&](const Segment& edge) {
        const PlanPoint &a = graph.points[edge[0]], &b = graph.points[edge[1]];
        std::vector<double> crossings;
        for (int k = 0; k < 2; ++k) {
            if (a[k] == b[k]) continue;
            const auto [low, high] = std::minmax(a[k], b[k]);
            const auto last = static_cast<std::int64_t>(std::floor((high - origin[k]) / side));
            for (auto i = static_cast<std::int64_t>(std::ceil((low - origin[k]) / side)); i <= last;
                 ++i) {
                crossings.push_back((origin[k] + static_cast<double>(i) * side - a[k]) /
                                    (b[k] - a[k]));
            }
        }
        std::sort(crossings.begin(), crossings.end());
        const double apart = closest * side / length_of(graph, edge);
        std::vector<double> kept;
        for (const double t : crossings) {
            if (t >= (kept.empty() ? 0 : kept.back()) + apart && t <= 1 - apart) kept.push_back(t);
        }
        return kept;
    });
}

double estimate_pieces(const RegionGraph& graph, double edge_length) {
    double pieces = 0;
    for (const auto* edges : {&graph.border, &graph.inner}) {
        for (const Segment& edge : *edges)
            pieces += 2 + length_of(graph, edge) / edge_length;
    }
    return pieces;
}

}  // namespace realmodel::meshing
