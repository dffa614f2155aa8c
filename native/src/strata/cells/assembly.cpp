// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/assembly.hpp"

#include <algorithm>
#include <array>

#include "base/algorithms.hpp"
#include "base/parallel_counts.hpp"
#include "realmodel/base/memory.hpp"

namespace realmodel::strata {

namespace {

constexpr std::size_t kFacesCopied = 1 << 13;  // copied at a time
constexpr std::size_t kManyFaces = 1000000;

/// The faces on surfaces, which come first; those that only have a cell above are seen from below.
class SurfaceFaces {
public:
    SurfaceFaces(const FaceList& faces, const ConformedFaces& conformed, const Execution& execution)
        : faces_(faces), conformed_(conformed), execution_(execution) {
        first_corner_.resize((faces.size() + kFacesCopied - 1) / kFacesCopied);
        parallel_ranges(
            faces.size(), kFacesCopied, execution, [&](std::size_t begin, std::size_t end) {
                const std::uint32_t first = conformed.face_offsets[begin],
                                    last = conformed.face_offsets[end];
                const auto taken = std::count_if(conformed.vertices.begin() + first,
                                                 conformed.vertices.begin() + last,
                                                 [](std::int32_t v) { return v >= 0; });
                first_corner_[begin / kFacesCopied] =
                    static_cast<std::size_t>(taken + (late_from(last) - late_from(first)));
            });
        corners_ = exclusive_scan(first_corner_);
    }

    std::size_t corners() const { return corners_; }

    void copy(const std::vector<std::int32_t>& surface_of_plane, CellComplex& complex) const {
        parallel_ranges(
            faces_.size(), kFacesCopied, execution_, [&](std::size_t begin, std::size_t end) {
                auto late = late_from(conformed_.face_offsets[begin]);
                const auto start = complex.face_vertices.begin();
                auto next =
                    start + static_cast<std::ptrdiff_t>(first_corner_[begin / kFacesCopied]);
                for (std::size_t f = begin; f < end; ++f) {
                    const auto face = next;
                    for (auto e = conformed_.face_offsets[f]; e < conformed_.face_offsets[f + 1];
                         ++e) {
                        if (conformed_.vertices[e] >= 0) *next++ = conformed_.vertices[e];
                        for (; late != conformed_.inserted.end() && late->entry == e; ++late)
                            *next++ = late->vertex;
                    }
                    complex.face_offsets[f] = face - start;
                    complex.face_surface[f] = surface_of_plane[index(faces_.plane[f])];
                    if (faces_.below[f] >= 0) {
                        complex.face_cells[f] = {faces_.below[f], faces_.above[f]};
                    } else {
                        complex.face_cells[f] = {faces_.above[f], kOutsideCell};
                        std::reverse(face, next);
                    }
                }
            });
    }

private:
    /// The first late vertex of an entry, or of one after it.
    std::vector<InsertedVertex>::const_iterator late_from(std::uint32_t entry) const {
        return std::lower_bound(
            conformed_.inserted.begin(), conformed_.inserted.end(), entry,
            [](const InsertedVertex& late, std::uint32_t e) { return late.entry < e; });
    }

    const FaceList& faces_;
    const ConformedFaces& conformed_;
    Execution execution_;
    std::vector<std::size_t> first_corner_;  ///< of so many faces each
    std::size_t corners_ = 0;
};

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
                     ConformedFaces conformed, std::vector<WallBatch> walls,
                     Array<std::int32_t> cell_block, const Execution& execution) {
    CellComplex complex;
    complex.vertices = std::move(conformed.positions);
    complex.cell_block = std::move(cell_block);
    std::vector<std::size_t> first_wall, first_corner;
    for (const WallBatch& batch : walls) {
        first_wall.push_back(batch.sizes.size());
        first_corner.push_back(batch.vertices.size());
    }
    const std::size_t face_count = faces.size() + exclusive_scan(first_wall);
    const SurfaceFaces surface_faces(faces, conformed, execution);
    const std::size_t corners_of_faces = surface_faces.corners();
    complex.face_vertices.resize(corners_of_faces + exclusive_scan(first_corner));
    complex.face_offsets.resize(face_count + 1);
    complex.face_offsets[face_count] = static_cast<std::int64_t>(complex.face_vertices.size());
    complex.face_cells.resize(face_count);
    complex.face_surface.resize(face_count);
    // Of a small model, as of a compartment, it is worth less than the time, and others reuse it.
    const bool is_large = face_count > kManyFaces;
    if (is_large) give_back_memory();
    surface_faces.copy(surface_of_plane, complex);
    conformed = {};
    if (is_large) give_back_memory();
    parallel_chunks(walls.size(), execution, [&](std::size_t batch) {
        copy_walls(walls[batch], faces.size() + first_wall[batch],
                   corners_of_faces + first_corner[batch], complex);
        walls[batch] = {};
    });
    return complex;
}

bool are_closed(const CellComplex& complex) {
    struct CellEdgeUse {
        std::array<std::int32_t, 3> key;  ///< cell and edge, the lower vertex first
        std::int32_t direction;
    };
    std::vector<CellEdgeUse> uses;
    for (std::size_t f = 0; f < complex.face_cells.size(); ++f) {
        const std::int64_t begin = complex.face_offsets[f], end = complex.face_offsets[f + 1];
        for (std::int64_t i = begin; i < end; ++i) {
            const std::int32_t a = complex.face_vertices[static_cast<std::size_t>(i)];
            const std::int64_t next = i + 1 < end ? i + 1 : begin;
            const std::int32_t b = complex.face_vertices[static_cast<std::size_t>(next)];
            for (std::size_t side = 0; side < 2; ++side) {
                const std::int32_t cell = complex.face_cells[f][side];
                if (cell < 0) continue;
                const bool ahead = (a < b) == (side == 0);
                uses.push_back({{cell, std::min(a, b), std::max(a, b)}, ahead ? 1 : -1});
            }
        }
    }
    std::sort(uses.begin(), uses.end(),
              [](const CellEdgeUse& a, const CellEdgeUse& b) { return a.key < b.key; });
    for (const auto of_edge : groups_of(uses, &CellEdgeUse::key)) {
        std::int32_t sum = 0;
        for (const CellEdgeUse& use : of_edge)
            sum += use.direction;
        if (sum != 0) return false;
    }
    return true;
}

}  // namespace realmodel::strata
