// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/cell_components.hpp"

#include <algorithm>
#include <utility>

#include "base/checked_indices.hpp"
#include "base/counting_sort.hpp"
#include "base/disjoint_sets.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"

namespace realmodel::strata {

std::vector<std::int32_t> cell_components(std::span<const std::array<std::int32_t, 2>> face_cells,
                                          std::span<const std::int32_t> cell_block,
                                          Progress* progress) {
    const auto cells = static_cast<std::int32_t>(cell_block.size());
    DisjointSets components(cell_block.size());
    for (std::size_t f = 0; f < face_cells.size(); ++f) {
        poll(progress, f);
        const auto [first, second] = face_cells[f];
        require_cells(f, face_cells[f], cell_block.size());
        if (first < 0 || second < 0) continue;
        if (cell_block[index(first)] == cell_block[index(second)]) {
            components.join(first, second);
        }
    }
    std::vector<std::int32_t> component(cell_block.size());
    for (std::int32_t c = 0; c < cells; ++c) {
        poll(progress, static_cast<std::size_t>(c));
        component[index(c)] = components.find(c);
    }
    return component;
}

CellFaces faces_of_cells(std::span<const std::array<std::int32_t, 2>> face_cells, std::size_t cells,
                         Progress* progress) {
    constexpr std::size_t kFaces = 8192;  // at a time
    check_total(face_cells.size(), UINT32_MAX / 2);
    const auto produce = [&](std::size_t chunk, const auto& put) {
        const std::size_t end = std::min(face_cells.size(), (chunk + 1) * kFaces);
        for (std::size_t f = chunk * kFaces; f < end; ++f) {
            require_cells(f, face_cells[f], cells);
            for (std::size_t second = 0; second < 2; ++second) {
                const std::int32_t cell = face_cells[f][second];
                if (cell >= 0) put(index(cell), static_cast<std::uint32_t>(2 * f + second));
            }
        }
    };
    auto faces = sorted_in_buckets<std::uint32_t>(cells, (face_cells.size() + kFaces - 1) / kFaces,
                                                  produce, {0, progress});
    return {std::move(faces.offsets), std::move(faces.values)};
}

}  // namespace realmodel::strata
