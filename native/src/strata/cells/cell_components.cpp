// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/cell_components.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "base/counting_sort.hpp"
#include "base/disjoint_sets.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

namespace {

void check_cells(const std::array<std::int32_t, 2>& sides, std::size_t face, std::size_t cells) {
    const auto count = static_cast<std::int64_t>(cells);
    if (std::max(sides[0], sides[1]) < count && std::min(sides[0], sides[1]) >= -1) return;
    throw InputError("bad_index",
                     "face " + std::to_string(face) + " refers to a cell that does not exist", -1,
                     {static_cast<std::int64_t>(face)});
}

}  // namespace

std::vector<std::int32_t> cell_components(std::span<const std::array<std::int32_t, 2>> face_cells,
                                          std::span<const std::int32_t> cell_block,
                                          Progress* progress) {
    const auto cells = static_cast<std::int32_t>(cell_block.size());
    DisjointSets parts(cell_block.size());
    for (std::size_t f = 0; f < face_cells.size(); ++f) {
        poll(progress, f);
        const auto [first, second] = face_cells[f];
        check_cells(face_cells[f], f, cell_block.size());
        if (first < 0 || second < 0) continue;
        if (cell_block[index(first)] == cell_block[index(second)]) {
            parts.join(first, second);
        }
    }
    std::vector<std::int32_t> component(cell_block.size());
    for (std::int32_t c = 0; c < cells; ++c) {
        poll(progress, static_cast<std::size_t>(c));
        component[index(c)] = parts.find(c);
    }
    return component;
}

CellSides cell_sides(std::span<const std::array<std::int32_t, 2>> face_cells, std::size_t cells,
                     Progress* progress) {
    constexpr std::size_t kFaces = 8192;  // at a time
    check_total(face_cells.size(), UINT32_MAX / 2);
    const auto produce = [&](std::size_t chunk, const auto& put) {
        const std::size_t end = std::min(face_cells.size(), (chunk + 1) * kFaces);
        for (std::size_t f = chunk * kFaces; f < end; ++f) {
            check_cells(face_cells[f], f, cells);
            for (std::size_t second = 0; second < 2; ++second) {
                const std::int32_t cell = face_cells[f][second];
                if (cell >= 0) put(index(cell), static_cast<std::uint32_t>(2 * f + second));
            }
        }
    };
    auto sides = sorted_in_buckets<std::uint32_t>(cells, (face_cells.size() + kFaces - 1) / kFaces,
                                                  produce, {0, progress});
    return {std::move(sides.offsets), std::move(sides.values)};
}

}  // namespace realmodel::strata
