// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/reach_filter.hpp"

namespace realmodel::exact {

ReachFilter reach_filter(const LocalArrangement& scope, DirectedLine line) {
    const LineFilter f = scope.filter(line.id());
    const double sign = line.is_reversed() ? -1.0 : 1.0;
    const PlanReach& reach = scope.shared().reach();
    return {sign * f.a, sign * f.b, sign * f.c,
            f.x0,       f.y0,       f.error_at(reach.width, reach.height, reach.point_error)};
}

}  // namespace realmodel::exact
