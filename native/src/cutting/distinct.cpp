// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/distinct.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace realmodel::cutting {

namespace {

/// So many units up or down are tried before a place is moved aside.
constexpr int kStaying = 4;

double moved(double value, int units) {
    for (; units > 0; --units)
        value = std::nextafter(value, HUGE_VAL);
    for (; units < 0; ++units)
        value = std::nextafter(value, -HUGE_VAL);
    return value;
}

}  // namespace

Position free_position_beside(const Position& p, Freedom freedom, std::set<Position>& taken) {
    for (int reach = 1;; ++reach) {
        const int aside = freedom == Freedom::kUpright && reach <= kStaying ? 0 : reach;
        const int upward = freedom == Freedom::kLevel ? 0 : reach;
        for (int x = -aside; x <= aside; ++x) {
            for (int y = -aside; y <= aside; ++y) {
                for (int z = -upward; z <= upward; ++z) {
                    if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != reach) continue;
                    const Position to{moved(p[0], x), moved(p[1], y), moved(p[2], z)};
                    if (taken.insert(to).second) return to;
                }
            }
        }
    }
}

}  // namespace realmodel::cutting
