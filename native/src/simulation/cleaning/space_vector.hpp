// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace realmodel::simulation {

struct SpaceVector {
    double x = 0, y = 0, z = 0;

    friend SpaceVector operator+(SpaceVector a, SpaceVector b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend SpaceVector operator-(SpaceVector a, SpaceVector b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    friend SpaceVector operator*(double s, SpaceVector a) { return {s * a.x, s * a.y, s * a.z}; }
};

inline double dot(SpaceVector a, SpaceVector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline SpaceVector cross(SpaceVector a, SpaceVector b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(SpaceVector a) {
    return std::sqrt(dot(a, a));
}

}  // namespace realmodel::simulation
