// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/polygons.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/ulp.hpp"

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

Position polygon_normal(std::span<const Position> corners) {
    Position sum{0, 0, 0};
    const Position& o = corners[0];
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        Position a, b;
        for (std::size_t k = 0; k < 3; ++k) {
            a[k] = corners[i][k] - o[k];
            b[k] = corners[i + 1][k] - o[k];
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
            sum[k] += a[l] * b[m] - a[m] * b[l];
        }
    }
    return sum;
}

double rounding_of(std::span<const Position> positions) {
    double largest = 0;
    for (const Position& p : positions) {
        for (const double x : p)
            largest = std::max(largest, std::abs(x));
    }
    return kComputedUlps * ulp(largest);
}

double sixfold_volume(const Position& o, const Position& a, const Position& b, const Position& c) {
    Position u, v, w;
    for (std::size_t k = 0; k < 3; ++k) {
        u[k] = a[k] - o[k];
        v[k] = b[k] - o[k];
        w[k] = c[k] - o[k];
    }
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
}

}  // namespace realmodel::arrangement
