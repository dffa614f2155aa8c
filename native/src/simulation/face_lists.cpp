// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/face_lists.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "base/algorithms.hpp"
#include "base/checked_indices.hpp"
#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::simulation {

namespace {

[[noreturn]] void refuse(std::int64_t number, const char* what) {
    throw InputError("bad_index", std::string(what) + ": " + std::to_string(number), -1, {number});
}

std::span<const std::int32_t> loop_of(const FaceLoops& faces, std::int64_t face) {
    if (face < 0 || face + 1 >= static_cast<std::int64_t>(faces.offsets.size()))
        refuse(face, "there is no such face");
    return checked_corners("face", index(face), faces.offsets, faces.vertices, 1);
}

constexpr std::size_t kCells = 2048;  ///< described at a time
constexpr std::size_t kFaces = 8192;  ///< put in order at a time

}  // namespace

CellDescriptions describe_cells(const FaceLoops& faces, std::span<const std::uint32_t> begin,
                                std::span<const std::uint32_t> cell_faces) {
    CellDescriptions made;
    const std::size_t cells = begin.empty() ? 0 : begin.size() - 1;
    made.lengths.resize(cells);
    made.counts.resize(cells);
    const auto faces_of = [&](std::size_t c) {
        return cell_faces.subspan(begin[c], begin[c + 1] - begin[c]);
    };
    std::vector<std::size_t> first_number((cells + kCells - 1) / kCells);
    parallel_ranges(cells, kCells, {0, nullptr}, [&](std::size_t from, std::size_t to) {
        std::size_t total = 0;
        for (std::size_t c = from; c < to; ++c) {
            if (begin[c] > begin[c + 1] || begin[c + 1] > cell_faces.size())
                refuse(static_cast<std::int64_t>(c), "the cell has sides that do not exist");
            std::size_t length = 1;
            for (const std::uint32_t cell_face : faces_of(c))
                length += 1 + loop_of(faces, cell_face >> 1).size();
            made.lengths[c] = static_cast<std::int64_t>(length);
            total += length;
        }
        first_number[from / kCells] = total;
    });
    made.faces.resize(exclusive_scan(first_number));
    std::vector<std::vector<std::int64_t>> vertices(first_number.size());
    parallel_ranges(cells, kCells, {0, nullptr}, [&](std::size_t from, std::size_t to) {
        std::int64_t* number = made.faces.data() + first_number[from / kCells];
        auto& corners = vertices[from / kCells];
        std::vector<std::int32_t> distinct;
        for (std::size_t c = from; c < to; ++c) {
            const auto faces_of_cell = faces_of(c);
            distinct.clear();
            *number++ = static_cast<std::int64_t>(faces_of_cell.size());
            for (const std::uint32_t cell_face : faces_of_cell) {
                const auto loop = loop_of(faces, cell_face >> 1);
                *number++ = static_cast<std::int64_t>(loop.size());
                number = (cell_face & 1) == 0 ? std::copy(loop.begin(), loop.end(), number)
                                              : std::reverse_copy(loop.begin(), loop.end(), number);
                distinct.insert(distinct.end(), loop.begin(), loop.end());
            }
            sort_unique(distinct);
            corners.insert(corners.end(), distinct.begin(), distinct.end());
            made.counts[c] = static_cast<std::int64_t>(distinct.size());
        }
    });
    std::vector<std::size_t> first_corner;
    for (const auto& chunk : vertices)
        first_corner.push_back(chunk.size());
    made.vertices.resize(exclusive_scan(first_corner));
    parallel_chunks(vertices.size(), {0, nullptr}, [&](std::size_t chunk) {
        std::copy(vertices[chunk].begin(), vertices[chunk].end(),
                  made.vertices.data() + first_corner[chunk]);
        vertices[chunk] = {};
    });
    return made;
}

Array<std::int64_t> inner_faces(std::span<const std::array<std::int32_t, 2>> face_cells,
                                std::size_t cells) {
    struct Inner {
        std::int32_t higher;
        std::uint32_t face;
        auto operator<=>(const Inner&) const = default;
    };
    check_total(face_cells.size(), UINT32_MAX);
    const auto produce = [&](std::size_t chunk, const auto& put) {
        const std::size_t end = std::min(face_cells.size(), (chunk + 1) * kFaces);
        for (std::size_t f = chunk * kFaces; f < end; ++f) {
            const auto [low, high] = std::minmax(face_cells[f][0], face_cells[f][1]);
            if (high < 0 || index(high) >= cells) refuse(high, "there is no such cell");
            if (low >= 0) put(index(low), Inner{high, static_cast<std::uint32_t>(f)});
        }
    };
    const auto sorted = sorted_in_buckets<Inner>(cells, (face_cells.size() + kFaces - 1) / kFaces,
                                                 produce, {0, nullptr});
    Array<std::int64_t> order(sorted.values.size());
    parallel_ranges(order.size(), kFaces, {0, nullptr}, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i)
            order[i] = sorted.values[i].face;
    });
    return order;
}

OrderedFaces ordered_faces(const FaceLoops& faces,
                           std::span<const std::array<std::int32_t, 2>> face_cells,
                           std::span<const std::int64_t> order) {
    if (face_cells.size() + 1 != faces.offsets.size())
        refuse(static_cast<std::int64_t>(face_cells.size()), "cells: two for each face, not of");
    OrderedFaces made;
    const std::size_t count = order.size();
    made.offsets.resize(count + 1);
    made.owner.resize(count);
    made.neighbor.resize(count);
    made.turned.resize(count);
    parallel_ranges(count, kFaces, {0, nullptr}, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            made.offsets[i] = static_cast<std::int32_t>(loop_of(faces, order[i]).size());
            const auto [a, b] = face_cells[index(order[i])];
            made.turned[i] = b >= 0 && a > b ? 1 : 0;
            made.owner[i] = made.turned[i] != 0 ? b : a;
            made.neighbor[i] = made.turned[i] != 0 ? a : b;
        }
    });
    running_totals(made.offsets, INT32_MAX, {0, nullptr});
    made.vertices.resize(index(made.offsets[count]));
    parallel_ranges(count, kFaces, {0, nullptr}, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const auto loop = loop_of(faces, order[i]);
            std::int32_t* const corners = made.vertices.data() + made.offsets[i];
            corners[0] = loop[0];
            if (made.turned[i] == 0)
                std::copy(loop.begin() + 1, loop.end(), corners + 1);
            else
                std::reverse_copy(loop.begin() + 1, loop.end(), corners + 1);
        }
    });
    return made;
}

}  // namespace realmodel::simulation
