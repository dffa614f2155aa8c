// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/polygons.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/floating_point.hpp"

namespace realmodel::arrangement {

View::View(const Position& normal) {
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    }
    u_ = (axis + 1) % 3;
    v_ = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(u_, v_);
}

PlanePosition View::rounding(std::span<const Position> positions) const {
    PlanePosition largest{0, 0};
    for (const Position& p : positions) {
        largest[0] = std::max(largest[0], std::abs(p[u_]));
        largest[1] = std::max(largest[1], std::abs(p[v_]));
    }
    for (double& x : largest)
        x = kComputedUlps * ulp(x);
    return largest;
}

double rounding_of(std::span<const Position> positions) {
    double largest = 0;
    for (const Position& p : positions) {
        for (const double x : p)
            largest = std::max(largest, std::abs(x));
    }
    return kComputedUlps * ulp(largest);
}

}  // namespace realmodel::arrangement
