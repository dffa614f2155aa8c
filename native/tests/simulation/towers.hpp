// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "realmodel/complex.hpp"

namespace realmodel::simulation {

/// Boxes of 10 by 6, one above another, that share faces; each has a block of its own.
struct Tower {
    std::vector<double> vertices;
    std::vector<std::int64_t> offsets{0};
    std::vector<std::int32_t> corners, cells, surface, block;
    ComplexView view;

    explicit Tower(const std::vector<double>& heights) {
        const auto layers = static_cast<std::int32_t>(heights.size()) - 1;
        for (const double z : heights)
            vertices.insert(vertices.end(), {0, 0, z, 10, 0, z, 10, 6, z, 0, 6, z});
        add({3, 2, 1, 0}, 0, -1, -2);
        for (std::int32_t k = 0; k < layers; ++k) {
            const std::int32_t a = 4 * k, b = a + 4;
            for (std::int32_t i = 0; i < 4; ++i)
                add({a + i, a + (i + 1) % 4, b + (i + 1) % 4, b + i}, k, -1, -1);
            add({b, b + 1, b + 2, b + 3}, k, k + 1 < layers ? k + 1 : -1, k);
            block.push_back(k);
        }
        view = {.vertices = vertices,
                .face_offsets = offsets,
                .face_vertices = corners,
                .face_cells = cells,
                .face_surface = surface,
                .cell_block = block,
                .blocks = block.size(),
                .surfaces = layers};
    }
    void add(const std::array<std::int32_t, 4>& loop, std::int32_t first, std::int32_t second,
             std::int32_t on) {
        corners.insert(corners.end(), loop.begin(), loop.end());
        offsets.push_back(static_cast<std::int64_t>(corners.size()));
        cells.insert(cells.end(), {first, second});
        surface.push_back(on);
    }
};

}  // namespace realmodel::simulation
