// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "strata/overlay/envelope.hpp"

namespace realmodel::strata {

/// Marks all lines and points of polygons as used.
inline void mark_used(LocalArrangement& scope, const PolygonPool& pool) {
    for (const Corner& corner : pool.corners) {
        scope.mark_point_used(corner.point);
        scope.mark_line_used(corner.line.id());
    }
}

/// Writes the corners of polygons with their shared lines and points, which are committed.
inline void share(LocalArrangement& scope, const PolygonPool& pool, Corner* shared) {
    for (const Corner& corner : pool.corners)
        *shared++ = {scope.shared_point(corner.point), scope.shared_directed(corner.line)};
}

/// Gives polygons the shared lines and points.
inline void share(LocalArrangement& scope, PolygonPool& pool) {
    share(scope, pool, pool.corners.begin());
}

}  // namespace realmodel::strata
