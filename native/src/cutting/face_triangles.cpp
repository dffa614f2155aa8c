// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <utility>

#include "base/parallel.hpp"
#include "cutting/cutter_surface.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {

namespace {

constexpr std::size_t kFacesOfChunk = 1 << 12;

void require_faces(const ComplexView& complex, std::size_t faces) {
    const auto refuse = [](std::size_t face, const char* what) {
        throw InputError("bad_index", "face " + std::to_string(face) + " " + what, -1,
                         {static_cast<std::int64_t>(face)});
    };
    for (std::size_t f = 0; f < faces; ++f) {
        const std::int64_t begin = complex.face_offsets[f], end = complex.face_offsets[f + 1];
        if (begin < 0 || end < begin + 3 || std::cmp_greater(end, complex.face_vertices.size()))
            refuse(f, "has corners that do not exist, or less than three");
        for (const std::int32_t v : complex.face(f)) {
            if (v < 0 || std::cmp_greater_equal(v, complex.vertex_count()))
                refuse(f, "refers to a vertex that does not exist");
        }
    }
}

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
    require_faces(complex, faces);
    const std::size_t chunks = (faces + kFacesOfChunk - 1) / kFacesOfChunk;
    std::vector<std::vector<std::array<std::int32_t, 3>>> of_chunk(chunks);
    FaceTriangles found;
    found.offsets.resize(faces + 1, 0);
    parallel_chunks(chunks, execution, [&](std::size_t chunk) {
        std::vector<std::array<std::int32_t, 3>> triangles;
        const std::size_t end = std::min(faces, (chunk + 1) * kFacesOfChunk);
        for (std::size_t f = chunk * kFacesOfChunk; f < end; ++f) {
            triangulate_face(complex, f, triangles);
            found.offsets[f + 1] = static_cast<std::int64_t>(triangles.size());
            of_chunk[chunk].insert(of_chunk[chunk].end(), triangles.begin(), triangles.end());
        }
    });
    for (std::size_t f = 0; f < faces; ++f)
        found.offsets[f + 1] += found.offsets[f];
    found.triangles.reserve(static_cast<std::size_t>(found.offsets.back()));
    for (const auto& triangles : of_chunk)
        found.triangles.insert(found.triangles.end(), triangles.begin(), triangles.end());
    return found;
}

}  // namespace realmodel::cutting
