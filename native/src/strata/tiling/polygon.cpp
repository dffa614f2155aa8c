// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/polygon.hpp"

#include <algorithm>

namespace realmodel::strata {

void clip(LocalArrangement& scope, PolygonView polygon, DirectedLine line, std::vector<int>& sides,
          Polygon& result) {
    result.clear();
    sides.clear();
    bool any_left = false, any_right = false;
    for (const Corner& corner : polygon) {
        const int s = scope.side(line, corner.point);
        sides.push_back(s);
        any_left |= s > 0;
        any_right |= s < 0;
    }
    if (!any_left) return;
    if (!any_right) {
        result.assign(polygon.begin(), polygon.end());
        return;
    }
    keep_left(scope, polygon, line, sides, result);
}

PolygonView Clipper::intersect(PolygonView subject, PolygonView window) {
    if (separated(window, subject)) return {};
    current_.assign(subject.begin(), subject.end());
    for (const Corner& corner : window) {
        clip(scope_, current_, corner.line, sides_, next_);
        std::swap(current_, next_);
        if (current_.empty()) break;
    }
    return current_;
}

PolygonView Clipper::cut(PolygonView subject, DirectedLine line) {
    clip(scope_, subject, line, sides_, next_);
    return next_;
}

// Whether all of b lies to the right of one edge of a.
bool Clipper::separated(PolygonView a, PolygonView b) {
    return std::any_of(a.begin(), a.end(), [&](const Corner& edge) {
        return std::all_of(b.begin(), b.end(), [&](const Corner& corner) {
            return scope_.side(edge.line, corner.point) <= 0;
        });
    });
}

bool Clipper::overlap(PolygonView a, PolygonView b) {
    return !separated(a, b) && !separated(b, a);
}

}  // namespace realmodel::strata
