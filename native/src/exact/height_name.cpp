// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <optional>

#include "exact/local_arrangement.hpp"

namespace realmodel::exact {

namespace {

/// The side of a plane's triangle that stands on one of a crossing's two lines.
std::optional<HeightName> standing_edge(const PlanArrangement& geometry, PlaneId plane,
                                        const std::array<const Line*, 2>& lines) {
    const Plane& triangle = geometry.plane(plane);
    for (const Line* line : lines) {
        if (line->kind != Line::Kind::kEdge) continue;
        const SpaceId s = triangle.above(line->first);
        const SpaceId t = s < 0 ? -1 : triangle.above(line->second);
        if (t >= 0) return HeightName{std::min(s, t), std::max(s, t)};
    }
    return std::nullopt;
}

bool is_trace_of(const Line& line, PlaneId plane) {
    return line.kind == Line::Kind::kTrace && (line.first == plane || line.second == plane);
}

}  // namespace

HeightName LocalArrangement::height_name(PlaneId plane, PointId id) const {
    if (is_vertex(id)) {
        const SpaceId s = shared_.corner_above(plane, id);
        return s >= 0 ? HeightName{s, s} : HeightName{-1, plane};
    }
    const Point& p = point(id);
    const std::array<const Line*, 2> lines{&line(p.first), &line(p.second)};
    if (const auto edge = standing_edge(shared_, plane, lines)) return *edge;
    for (std::size_t i = 0; i < 2; ++i) {
        const Line &trace = *lines[i], &other = *lines[1 - i];
        if (!is_trace_of(trace, plane)) continue;
        // along the trace another plane is equally high
        const PlaneId partner = trace.first == plane ? trace.second : trace.first;
        if (const auto edge = standing_edge(shared_, partner, lines)) return *edge;
        const bool shared = is_trace_of(other, trace.first) != is_trace_of(other, trace.second);
        return {-1, shared && is_trace_of(other, trace.second) ? trace.second : trace.first};
    }
    return {-1, plane};
}

}  // namespace realmodel::exact
