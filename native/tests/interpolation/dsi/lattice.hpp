// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

namespace realmodel::interpolation {

struct Lattice {
    std::vector<std::array<double, 2>> nodes;
    std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Rows of right triangles, their diagonals alternating, jittered inside.
inline Lattice lattice(int columns, int rows, double jitter = 0.2) {
    std::mt19937 random(7);
    const auto shift = [&] {
        return jitter * (static_cast<double>(random()) / 4294967296.0 - 0.5);
    };
    Lattice out;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const bool inner = i > 0 && j > 0 && i < columns - 1 && j < rows - 1;
            out.nodes.push_back({i + (inner ? shift() : 0), j + (inner ? shift() : 0)});
            if (i == columns - 1 || j == rows - 1) continue;
            const std::int32_t a = j * columns + i, b = a + 1, c = a + columns, d = c + 1;
            if ((i + j) % 2 == 0) {
                out.triangles.push_back({a, b, d});
                out.triangles.push_back({a, d, c});
            } else {
                out.triangles.push_back({a, b, c});
                out.triangles.push_back({b, d, c});
            }
        }
    }
    return out;
}

}  // namespace realmodel::interpolation
