// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/plan_tests.hpp"

#include <algorithm>
#include <cmath>

#include "base/vectors.hpp"
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
    return std::abs(twice_area(from, to, place)) <= 1.001 * reach * distance(from, to) + 1e-290;
}

}  // namespace realmodel::validation
