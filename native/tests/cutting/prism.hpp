// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "../validation/small_complex.hpp"

namespace realmodel::cutting {

using Outline = std::vector<std::array<double, 2>>;

/// One cell between y = 0 and y = 1 over an outline in x and z, counter-clockwise seen from
/// negative y: first the face there, then the one at y = 1, then one along each of its edges.
/// Vertices of the near end come first.
inline validation::OwnedComplex prism(const Outline& outline) {
    validation::OwnedComplex o;
    const auto n = static_cast<std::int32_t>(outline.size());
    std::vector<std::int32_t> near, far;
    for (const double y : {0.0, 1.0}) {
        for (const auto& [x, z] : outline)
            o.vertices.push_back({x, y, z});
    }
    for (std::int32_t i = 0; i < n; ++i) {
        near.push_back(i);
        far.insert(far.begin(), i + n);
    }
    o.add_face(near, 0, -1, kWall);
    o.add_face(far, 0, -1, kWall);
    for (std::int32_t i = 0; i < n; ++i) {
        const std::int32_t j = (i + 1) % n;
        o.add_face({j, i, i + n, j + n}, 0, -1, 0);
    }
    o.block = {0};
    o.volume = {0};
    o.surfaces = 1;
    return o;
}

/// Two towers of width 1 and height 2 on a foot of height 1: an upright U.
inline validation::OwnedComplex u_shape() {
    return prism({{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
}

}  // namespace realmodel::cutting
