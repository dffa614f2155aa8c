// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "conforming.hpp"
#include "parallel_counts.hpp"

namespace realmodel::strata {

namespace {

constexpr std::size_t kFaces = 1 << 13;  // copied at a time

/// Copies the faces on surfaces, which come first; those that only have a cell above are seen from
/// below.
void copy_faces(const FaceList& faces, const std::vector<std::int32_t>& surface_of_plane,
                const Loops& loops, CellComplex& complex, int threads, const Progress* progress) {
    parallel_ranges(
        faces.size(), kFaces, threads, progress, [&](std::size_t begin, std::size_t end) {
            for (std::size_t f = begin; f < end; ++f) {
                const std::uint32_t first = loops.face_offsets[f], last = loops.face_offsets[f + 1];
                complex.face_offsets[f] = first;
                complex.face_surface[f] =
                    surface_of_plane[static_cast<std::size_t>(faces.plane[f])];
                const auto from = loops.vertices.begin();
                const auto to = complex.face_vertices.begin() + first;
                if (faces.below[f] >= 0) {
                    complex.face_cells[f] = {faces.below[f], faces.above[f]};
                    std::copy(from + first, from + last, to);
                } else {
                    complex.face_cells[f] = {faces.above[f], kOutsideCell};
                    std::reverse_copy(from + first, from + last, to);
                }
            }
        });
}

/// Copies some walls, the first of them as a given face.
void copy_walls(const WallBatch& walls, std::size_t face, std::size_t corner,
                CellComplex& complex) {
    auto from = walls.vertices.begin();
    for (std::size_t w = 0; w < walls.sizes.size(); ++w, ++face) {
        const std::int32_t size = walls.sizes[w];
        const auto to = complex.face_vertices.begin() + static_cast<std::ptrdiff_t>(corner);
        const auto [left, right] = walls.cells[w];
        complex.face_offsets[face] = static_cast<std::int64_t>(corner);
        complex.face_surface[face] = kWall;
        if (left >= 0) {
            complex.face_cells[face] = {left, right};
            std::copy(from, from + size, to);
        } else {
            complex.face_cells[face] = {right, kOutsideCell};
            std::reverse_copy(from, from + size, to);
        }
        from += size;
        corner += static_cast<std::size_t>(size);
    }
}

}  // namespace

CellComplex assemble(const FaceList& faces, const std::vector<std::int32_t>& surface_of_plane,
                     Loops loops, std::vector<WallBatch> walls,
                     GrowingArray<std::int32_t> cell_block, int threads, const Progress* progress) {
    CellComplex complex;
    complex.vertices = std::move(loops.positions);
    complex.cell_block = std::move(cell_block);
    std::vector<std::size_t> first_wall, first_corner;
    for (const WallBatch& batch : walls) {
        first_wall.push_back(batch.sizes.size());
        first_corner.push_back(batch.vertices.size());
    }
    const std::size_t face_count = faces.size() + count_before(first_wall);
    const std::size_t corners_of_faces = loops.vertices.size();
    complex.face_vertices.resize(corners_of_faces + count_before(first_corner));
    complex.face_offsets.resize(face_count + 1);
    complex.face_offsets[face_count] = static_cast<std::int64_t>(complex.face_vertices.size());
    complex.face_cells.resize(face_count);
    complex.face_surface.resize(face_count);
    copy_faces(faces, surface_of_plane, loops, complex, threads, progress);
    loops = {};
    parallel_chunks(walls.size(), threads, progress, [&](std::size_t batch) {
        copy_walls(walls[batch], faces.size() + first_wall[batch],
                   corners_of_faces + first_corner[batch], complex);
        walls[batch] = {};
    });
    return complex;
}

}  // namespace realmodel::strata
