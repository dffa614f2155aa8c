// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutting/cutter.hpp"

namespace realmodel::cutting {

/// One level triangle that reaches far beyond the unit square, about the middle of that.
inline Cutter level_cutter(double height, bool upward = true) {
    Cutter surface;
    surface.vertices = {{-8, -8, height}, {17.5, -8, height}, {-8, 17.5, height}};
    surface.triangles = {{0, upward ? 1 : 2, upward ? 2 : 1}};
    return surface;
}

/// A tetrahedron with an upright edge of height 0.5, wholly within the lower unit cube.
inline Cutter closed_cutter() {
    return {{{0.25, 0.25, 0.25}, {0.75, 0.25, 0.25}, {0.25, 0.75, 0.25}, {0.25, 0.25, 0.75}},
            {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
            true};
}

}  // namespace realmodel::cutting
