// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/pieces.hpp"

#include <cmath>
#include <string>

#include "base/algorithms.hpp"
#include "base/checked_indices.hpp"
#include "base/parallel.hpp"
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

std::vector<Position> positions_of(const ComplexView& model, std::span<const NodeId> polygon) {
    return transformed(polygon, [&](NodeId v) { return model.vertex(v); });
}

std::pair<Loop, PlanePosition> loop_of(const ComplexView& model, std::span<const NodeId> polygon) {
    const std::vector<Position> positions = positions_of(model, polygon);
    const View view(polygon_normal(positions));
    Loop loop;
    loop.reserve(polygon.size());
    for (std::size_t i = 0; i < polygon.size(); ++i)
        loop.push_back({polygon[i], view(positions[i])});
    return {std::move(loop), view.rounding(positions)};
}

void divide_face(const ComplexView& model, std::size_t face, Polygons& polygons) {
    const auto [loop, rounding] = loop_of(model, model.face(face));
    divide_convex(std::span(&loop, 1), rounding, {}, polygons);
}

void triangulate_face(const ComplexView& model, std::size_t face,
                      std::vector<std::array<std::int32_t, 3>>& triangles) {
    const auto corners = model.face(face);
    triangles.clear();
    if (corners.size() == 3) {
        triangles.push_back({corners[0], corners[1], corners[2]});
        return;
    }
    const auto [loop, rounding] = loop_of(model, model.face(face));
    std::vector<std::array<LoopCorner, 3>> loop_triangles;
    triangulate(std::span(&loop, 1), rounding, loop_triangles);
    for (const auto& t : loop_triangles)
        triangles.push_back({t[0].node, t[1].node, t[2].node});
}

namespace {

constexpr std::size_t kFacesOfChunk = 1 << 12;

}  // namespace

FaceTriangles triangulate_faces(std::span<const double> vertices,
                                std::span<const std::int64_t> face_offsets,
                                std::span<const std::int32_t> face_vertices,
                                const Execution& execution) {
    ComplexView complex;
    complex.vertices = vertices;
    complex.face_offsets = face_offsets;
    complex.face_vertices = face_vertices;
    const std::size_t faces = face_offsets.empty() ? 0 : face_offsets.size() - 1;
    for (std::size_t f = 0; f < faces; ++f)
        require_vertices("face", f, checked_corners("face", f, face_offsets, face_vertices, 3),
                         complex.vertex_count());
    FaceTriangles face_triangles;
    face_triangles.offsets.resize(faces + 1, 0);
    face_triangles.triangles = collect_ranges<std::array<std::int32_t, 3>>(
        faces, kFacesOfChunk, execution, [&](std::size_t begin, std::size_t end, auto& of_chunk) {
            std::vector<std::array<std::int32_t, 3>> triangles;
            for (std::size_t f = begin; f < end; ++f) {
                triangulate_face(complex, f, triangles);
                face_triangles.offsets[f + 1] = static_cast<std::int64_t>(triangles.size());
                of_chunk.insert(of_chunk.end(), triangles.begin(), triangles.end());
            }
        });
    for (std::size_t f = 0; f < faces; ++f)
        face_triangles.offsets[f + 1] += face_triangles.offsets[f];
    return face_triangles;
}

}  // namespace realmodel::cutting
