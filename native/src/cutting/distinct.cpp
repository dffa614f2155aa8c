// SPDX-License-Identifier: GPL-3.0-or-later
#include "distinct.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace realmodel::cutting {

namespace {

double moved(double value, int units) {
    for (; units > 0; --units)
        value = std::nextafter(value, HUGE_VAL);
    for (; units < 0; ++units)
        value = std::nextafter(value, -HUGE_VAL);
    return value;
}

}  // namespace

Position free_position_beside(const Position& p, std::set<Position>& taken) {
    for (int reach = 1;; ++reach) {
        for (int x = -reach; x <= reach; ++x) {
            for (int y = -reach; y <= reach; ++y) {
                for (int z = -reach; z <= reach; ++z) {
                    if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != reach) continue;
                    const Position to{moved(p[0], x), moved(p[1], y), moved(p[2], z)};
                    if (taken.insert(to).second) return to;
                }
            }
        }
    }
}

}  // namespace realmodel::cutting
