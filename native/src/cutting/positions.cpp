// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/positions.hpp"

#include <algorithm>
#include <cstdlib>

#include "base/ulp.hpp"

namespace realmodel::cutting {

Position free_position_beside(const Position& p, Freedom freedom, Positions& taken) {
    constexpr int kUpright = 4;  // units up or down that are tried before a point is moved aside
    for (int reach = 1;; ++reach) {
        const int aside = freedom == Freedom::kUpright && reach <= kUpright ? 0 : reach;
        const int upward = freedom == Freedom::kLevel ? 0 : reach;
        for (int x = -aside; x <= aside; ++x) {
            for (int y = -aside; y <= aside; ++y) {
                for (int z = -upward; z <= upward; ++z) {
                    if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != reach) continue;
                    const Position to{moved_by_ulps(p[0], x), moved_by_ulps(p[1], y),
                                      moved_by_ulps(p[2], z)};
                    if (taken.insert(to)) return to;
                }
            }
        }
    }
}

}  // namespace realmodel::cutting
