// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/model_check.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

namespace {

[[noreturn]] void refuse(const char* array, const char* what) {
    throw InputError("bad_model", std::string(array) + " of the model: " + what);
}

bool all_within(std::span<const std::int32_t> values, std::int32_t low, std::size_t end) {
    return std::all_of(values.begin(), values.end(), [&](std::int32_t i) {
        return i >= low && (i < 0 || static_cast<std::size_t>(i) < end);
    });
}

}  // namespace

void check_model(const ComplexView& model) {
    const std::size_t faces = model.face_count();
    if (model.face_offsets.size() != faces + 1) refuse("face_offsets", "one more than faces");
    if (model.face_cells.size() != 2 * faces) refuse("face_cells", "two for each face");
    if (model.face_surface.size() != faces) refuse("face_surface", "one for each face");
    if (model.face_offsets.front() != 0 ||
        model.face_offsets.back() != static_cast<std::int64_t>(model.face_vertices.size()))
        refuse("face_offsets", "they must end with face_vertices");
    for (std::size_t f = 0; f < faces; ++f) {
        if (model.face_offsets[f + 1] - model.face_offsets[f] < 3)
            refuse("face_offsets", "a face has three corners at least");
        if (model.cell(f, 0) < 0) refuse("face_cells", "the first cell of a face is never outside");
    }
    if (!all_within(model.face_vertices, 0, model.vertex_count()))
        refuse("face_vertices", "they must be numbers of vertices");
    if (!all_within(model.face_cells, -1, model.cell_block.size()))
        refuse("face_cells", "they must be numbers of cells, or -1");
    if (!all_within(model.cell_block, 0, model.blocks))
        refuse("cell_block", "they must be numbers of blocks");
    if (!std::all_of(model.vertices.begin(), model.vertices.end(),
                     [](double x) { return std::isfinite(x); }))
        refuse("vertices", "they must be finite");
}

}  // namespace realmodel::cutting
