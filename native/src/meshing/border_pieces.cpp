// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/border_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace realmodel::meshing {

namespace {

constexpr double longest_piece = 1.4;  // edge lengths: above it two pieces fit better than one
constexpr double sharp_angle = std::numbers::pi / 3;

double length_of(const RingGraph& graph, const Segment& edge) {
    const PlanPoint &a = graph.points[edge[0]], &b = graph.points[edge[1]];
    return std::hypot(b[0] - a[0], b[1] - a[1]);
}

/// Edges between the region and what is not, the region on their left.
std::vector<Segment> border_edges(const RingTriangulation& region) {
    std::vector<Segment> edges;
    for (std::size_t t = 0; t < region.inside.size(); ++t) {
        if (!region.inside[t]) continue;
        const auto& corners = region.triangulation.triangles[t];
        for (int i = 0; i < 3; ++i) {
            if (!region.triangulation.constrained[t][i]) continue;
            edges.push_back({corners[i], corners[(i + 1) % 3]});
        }
    }
    return edges;
}

/// For each point the distance at which its edges are cut because two of them meet at a sharp angle
/// inside the region; 0 where none do.
std::vector<double> tip_lengths(const RingGraph& graph, const std::vector<Segment>& edges,
                                double edge_length) {
    struct Spoke {
        std::int32_t corner;
        double direction;
        bool leaves;  // the region is to the left of a spoke that leaves, to the right of one that
                      // comes
        double length;
    };
    std::vector<Spoke> spokes;
    spokes.reserve(2 * edges.size());
    for (const Segment& edge : edges) {
        const PlanPoint &a = graph.points[edge[0]], &b = graph.points[edge[1]];
        const double length = length_of(graph, edge);
        spokes.push_back({edge[0], std::atan2(b[1] - a[1], b[0] - a[0]), true, length});
        spokes.push_back({edge[1], std::atan2(a[1] - b[1], a[0] - b[0]), false, length});
    }
    std::sort(spokes.begin(), spokes.end(), [](const Spoke& s, const Spoke& t) {
        return s.corner != t.corner ? s.corner < t.corner : s.direction < t.direction;
    });
    std::vector<double> lengths(graph.points.size(), 0.0);
    for (std::size_t begin = 0, end = 0; begin < spokes.size(); begin = end) {
        double shortest = std::numeric_limits<double>::infinity();
        for (end = begin; end < spokes.size() && spokes[end].corner == spokes[begin].corner;
             ++end) {
            shortest = std::min(shortest, spokes[end].length);
        }
        for (std::size_t i = begin; i < end; ++i) {
            const Spoke& next = spokes[i + 1 < end ? i + 1 : begin];
            if (!spokes[i].leaves || next.leaves) continue;  // the sector is outside the region
            double angle = next.direction - spokes[i].direction;
            if (angle <= 0) angle += 2 * std::numbers::pi;
            if (angle < sharp_angle) {
                // Room for the tips at both ends of the shortest edge.
                lengths[spokes[i].corner] = std::min(edge_length, shortest / 2.5);
            }
        }
    }
    return lengths;
}

std::size_t piece_count(double length, double edge_length) {
    return static_cast<std::size_t>(
        std::max(1.0, std::ceil(length / edge_length - (longest_piece - 1))));
}

}  // namespace

BorderPieces cut_border(const RingTriangulation& region, double edge_length) {
    const RingGraph& graph = region.graph;
    const std::vector<Segment> edges = border_edges(region);
    const std::vector<double> tips = tip_lengths(graph, edges, edge_length);

    BorderPieces border;
    border.points = graph.points;
    for (const Segment& edge : edges) {
        const PlanPoint &a = graph.points[edge[0]], &b = graph.points[edge[1]];
        const double length = length_of(graph, edge);
        const double begin = tips[edge[0]] / length;
        const double end = 1 - tips[edge[1]] / length;
        const std::size_t count = piece_count((end - begin) * length, edge_length);
        std::int32_t last = edge[0];
        const auto cut_at = [&](double t) {
            const auto next = static_cast<std::int32_t>(border.points.size());
            // From the nearer end, so that a border read in the other direction is cut alike.
            border.points.push_back(
                t <= 0.5
                    ? PlanPoint{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])}
                    : PlanPoint{b[0] + (1 - t) * (a[0] - b[0]), b[1] + (1 - t) * (a[1] - b[1])});
            border.pieces.push_back({last, next});
            last = next;
        };
        if (begin > 0) cut_at(begin);
        for (std::size_t i = 1; i < count; ++i) {
            cut_at(begin + (end - begin) * static_cast<double>(i) / static_cast<double>(count));
        }
        if (end < 1) cut_at(end);
        border.pieces.push_back({last, edge[1]});
    }
    return border;
}

double estimate_pieces(const RingTriangulation& region, double edge_length) {
    double pieces = 0;
    for (const Segment& edge : border_edges(region)) {
        pieces += 2 + length_of(region.graph, edge) / edge_length;
    }
    return pieces;
}

}  // namespace realmodel::meshing
