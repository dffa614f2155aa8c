// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/border_edges.hpp"

#include <algorithm>

#include "base/algorithms.hpp"
#include "exact/orientation.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

BorderEdges::BorderEdges(PlanArrangement& geometry, const PlanTiles& tiles,
                         std::vector<VertexPair> edges)
    : tiles_(tiles) {
    for (auto& [from, to] : edges) {
        if (from > to) std::swap(from, to);
    }
    sort_unique(edges);
    segments_.reserve(edges.size());
    for (const auto& [from, to] : edges) {
        const auto &p = geometry.point(from), &q = geometry.point(to);
        const PlanBox box{std::min(p.x, q.x), std::min(p.y, q.y), std::max(p.x, q.x),
                          std::max(p.y, q.y)};
        segments_.push_back({from, to, geometry.add_edge(from, to).id(), box});
    }
    in_tiles_ = bucketize<std::uint32_t>(tiles.size(), [&](const auto& put) {
        for (std::size_t s = 0; s < segments_.size(); ++s) {
            tiles_.for_each(tiles_.span(segments_[s].box),
                            [&](std::size_t tile) { put(tile, static_cast<std::uint32_t>(s)); });
        }
    });
}

template <class Holds>
bool BorderEdges::any_in(const TileSpan& span, const Holds& holds) const {
    return tiles_.any(span, [&](std::size_t tile) {
        return std::ranges::any_of(in_tiles_[tile],
                                   [&](std::uint32_t s) { return holds(segments_[s]); });
    });
}

/// Whether a segment has a point inside a convex polygon. What is convex lies apart where a line
/// along an edge of either separates the two.
/// @param side_of_segment  side_of_segment(i): on which side of the segment corner i lies
/// @param side_of_edge     side_of_edge(i, end): on which side of the edge from there the end lies
template <class SideOfSegment, class SideOfEdge>
bool BorderEdges::reaches_inside(const BorderSegment& segment, std::size_t corners,
                                 const SideOfSegment& side_of_segment,
                                 const SideOfEdge& side_of_edge) {
    bool any_left = false, any_right = false;
    for (std::size_t i = 0; i < corners; ++i) {
        const int side = side_of_segment(i);
        any_left |= side > 0;
        any_right |= side < 0;
    }
    if (!any_left || !any_right) return false;
    for (std::size_t i = 0; i < corners; ++i) {
        if (side_of_edge(i, segment.from) <= 0 && side_of_edge(i, segment.to) <= 0) return false;
    }
    return true;
}

bool BorderEdges::divide(LocalArrangement& scope, PolygonView polygon, const TileSpan& span) const {
    return any_in(span, [&](const BorderSegment& segment) {
        const exact::DirectedLine line(segment.line);
        return reaches_inside(
            segment, polygon.size(),
            [&](std::size_t i) { return scope.side(line, polygon[i].point); },
            [&](std::size_t i, PointId end) { return scope.side(polygon[i].line, end); });
    });
}

bool BorderEdges::divide(const PlanArrangement& geometry, const PlanTriangle& triangle,
                         const TileSpan& span) const {
    const auto position = [&](exact::VertexId v) -> spatial::PlanPosition {
        return {geometry.point(v).x, geometry.point(v).y};
    };
    const std::array corners{position(triangle[0]), position(triangle[1]), position(triangle[2])};
    const PlanBox box = spatial::box_around(corners);
    return any_in(span, [&](const BorderSegment& segment) {
        const PlanBox& extent = segment.box;
        if (extent.high_x <= box.low_x || extent.low_x >= box.high_x ||
            extent.high_y <= box.low_y || extent.low_y >= box.high_y)
            return false;
        const auto from = position(segment.from), to = position(segment.to);
        return reaches_inside(
            segment, corners.size(),
            [&](std::size_t i) { return exact::orient2d(from, to, corners[i]); },
            [&](std::size_t i, exact::VertexId end) {
                return exact::orient2d(corners[i], corners[(i + 1) % 3],
                                       end == segment.from ? from : to);
            });
    });
}

bool BorderEdges::run_between(LocalArrangement& scope, PointId a, PointId b,
                              const TileSpan& span) const {
    return any_in(span, [&](const BorderSegment& segment) {
        const exact::DirectedLine line(segment.line);
        if (scope.side(line, a) != 0 || scope.side(line, b) != 0) return false;
        const int axis = scope.compare(0, segment.from, segment.to) != 0 ? 0 : 1;
        const auto before = [&](PointId p, PointId q) { return scope.compare(axis, p, q) > 0; };
        const auto [low, high] = std::minmax(segment.from, segment.to, before);
        const auto [first, last] = std::minmax(a, b, before);
        return before(low, last) && before(first, high);
    });
}

}  // namespace realmodel::strata
