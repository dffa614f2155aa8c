// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "exact/local_arrangement.hpp"

namespace realmodel::exact {

namespace {

/// The side of a plane's triangle that stands on one of a crossing's two lines.
EdgeOrPlane standing_edge(const PlanArrangement& geometry, PlaneId plane,
                          const std::array<const Line*, 2>& lines) {
    const EdgeOrPlane first = geometry.plane(plane).above(*lines[0]);
    return first.is_edge() ? first : geometry.plane(plane).above(*lines[1]);
}

bool is_trace_of(const Line& line, PlaneId plane) {
    return !line.is_edge() && (line.planes()[0] == plane || line.planes()[1] == plane);
}

}  // namespace

HeightName LocalArrangement::height_name(PlaneId plane, PointId id) const {
    if (is_vertex(id)) {
        const SpaceId s = shared_.plane(plane).above(vertex(id));
        return s != kNone ? HeightName(s, s) : HeightName(plane);
    }
    const Point& p = point(id);
    const std::array<const Line*, 2> lines{&line(p.first), &line(p.second)};
    if (const auto edge = standing_edge(shared_, plane, lines); edge.is_edge()) return edge;
    for (std::size_t i = 0; i < 2; ++i) {
        const Line &trace = *lines[i], &other = *lines[1 - i];
        if (!is_trace_of(trace, plane)) continue;
        // along the trace another plane is equally high
        const auto [first, second] = trace.planes();
        const PlaneId partner = first == plane ? second : first;
        if (const auto edge = standing_edge(shared_, partner, lines); edge.is_edge()) return edge;
        const bool shared = is_trace_of(other, first) != is_trace_of(other, second);
        return HeightName(shared && is_trace_of(other, second) ? second : first);
    }
    return HeightName(plane);
}

}  // namespace realmodel::exact
