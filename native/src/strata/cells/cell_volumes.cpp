// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/cell_volumes.hpp"

#include <string>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

namespace {

[[noreturn]] void refuse(std::size_t face, const char* what) {
    throw InputError("bad_index", "face " + std::to_string(face) + " names " + what, -1,
                     {static_cast<std::int64_t>(face)});
}

}  // namespace

std::vector<double> cell_volumes(std::span<const Vec3> vertices,
                                 std::span<const std::int64_t> face_offsets,
                                 std::span<const std::int32_t> face_vertices,
                                 std::span<const std::array<std::int32_t, 2>> face_cells,
                                 std::size_t cells, const Execution& execution) {
    const std::size_t faces = face_cells.size();
    if (face_offsets.size() != faces + 1) refuse(faces, "more or fewer offsets than faces");
    const auto loop_of = [&](std::size_t f) {
        const std::int64_t begin = face_offsets[f], end = face_offsets[f + 1];
        if (begin < 0 || begin >= end || end > static_cast<std::int64_t>(face_vertices.size()))
            refuse(f, "corners that do not exist");
        return face_vertices.subspan(static_cast<std::size_t>(begin),
                                     static_cast<std::size_t>(end - begin));
    };
    std::vector<std::int32_t> origin(cells, -1);  // a corner of each cell
    for (std::size_t f = 0; f < faces; ++f) {
        poll(execution.progress, f);
        const auto loop = loop_of(f);
        for (const std::int32_t v : loop) {
            if (v < 0 || static_cast<std::size_t>(v) >= vertices.size())
                refuse(f, "a vertex that does not exist");
        }
        for (const std::int32_t cell : face_cells[f]) {
            if (cell < -1 || cell >= static_cast<std::int64_t>(cells))
                refuse(f, "a cell that does not exist");
            if (cell >= 0 && origin[static_cast<std::size_t>(cell)] < 0)
                origin[static_cast<std::size_t>(cell)] = loop[0];
        }
    }
    // the shares of the faces on several threads; then in order, so that sums do not depend on them
    std::vector<std::array<double, 2>> share(faces);
    parallel_each(faces, execution, [&](std::size_t f) {
        const auto loop = loop_of(f);
        const auto at = [&](std::size_t i) -> const Vec3& { return vertices[index(loop[i])]; };
        const Vec3 area = polygon_normal(loop.size(), at);  // twice as long
        for (std::size_t side = 0; side < 2; ++side) {
            const std::int32_t cell = face_cells[f][side];
            if (cell < 0) continue;
            const Vec3& o = vertices[index(origin[index(cell)])];
            const double volume = dot(minus(at(0), o), area) / 6;
            share[f][side] = side == 0 ? volume : -volume;
        }
    });
    std::vector<double> volume(cells, 0.0);
    for (std::size_t f = 0; f < faces; ++f) {
        poll(execution.progress, f);
        for (std::size_t side = 0; side < 2; ++side) {
            const std::int32_t cell = face_cells[f][side];
            if (cell >= 0) volume[static_cast<std::size_t>(cell)] += share[f][side];
        }
    }
    return volume;
}

}  // namespace realmodel::strata
