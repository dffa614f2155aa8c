// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/exact/plan_geometry.hpp"

namespace realmodel::exact {

inline KeyTable::Key line_key_of(const Line& line) {
    return {static_cast<std::int32_t>(line.kind), line.first, line.second, 0};
}

/// The name of a crossing: the edge and the plane that it pierces, or its two lines.
inline KeyTable::Key point_key_of(const Point& point) {
    if (point.edge_from >= 0) return {0, point.edge_from, point.edge_to, point.pierced};
    return {1, std::min(point.first, point.second), std::max(point.first, point.second), 0};
}

}  // namespace realmodel::exact
