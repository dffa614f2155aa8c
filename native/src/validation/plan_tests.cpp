// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/plan_tests.hpp"

#include <algorithm>
#include <cmath>

#include "exact/orient2d.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::validation {

int winding(std::span<const PlanPosition> loop, const PlanPosition& place) {
    int turns = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const PlanPosition& p = loop[i];
        const PlanPosition& q = loop[i + 1 < loop.size() ? i + 1 : 0];
        if (p[1] <= place[1]) {
            if (q[1] > place[1] && exact::orient2d(p, q, place) > 0) ++turns;
        } else if (q[1] <= place[1] && exact::orient2d(p, q, place) < 0) {
            --turns;
        }
    }
    return turns;
}

bool passes(const PlanPosition& from, const PlanPosition& to, const PlanPosition& place,
            double reach) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
        if (place[axis] < std::min(from[axis], to[axis]) - reach) return false;
        if (place[axis] > std::max(from[axis], to[axis]) + reach) return false;
    }
    const double dx = to[0] - from[0], dy = to[1] - from[1];
    const double off = dx * (place[1] - from[1]) - dy * (place[0] - from[0]);
    return std::abs(off) <= 1.001 * reach * elementary::hypot(dx, dy) + 1e-290;
}

}  // namespace realmodel::validation
