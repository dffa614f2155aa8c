// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "cutting/nearest_side.hpp"
#include "cutting/pieces.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::cutting {

/// The cells of a model that a surface may touch, as a model of their own: what is done to them
/// costs what they are, and the cells beside them stay as they are.
class NearPart {
public:
    /// @param is_near  of the model's cells: not 0 if it is one of them
    NearPart(const ComplexView& model, std::span<const std::uint8_t> is_near);

    ComplexView view() const;
    /// The model's cell that one of the part is.
    std::int32_t cell(std::int32_t own) const { return cells_[index(own)]; }
    /// Makes pieces of the part's faces, and parts of its cells, those of the whole model, in the
    /// order of its faces and cells: the other cells and faces are added.
    /// @param sides  of the model's cells that are none of the part's: kOn leaves them out
    /// @return false where rounding did not leave a face alone that lies beside another cell
    bool put_back(Pieces& pieces, std::vector<HalfCell>& half_cells,
                  std::span<const std::int8_t> sides) const;

private:
    void add_piece(const Polygons& polygons, std::size_t p, Piece piece, Pieces& pieces) const;

    ComplexView model_;
    std::vector<std::int32_t> number_;  ///< of the model's cells, -1 none of the part's
    std::vector<Position> vertices_;
    std::vector<std::int64_t> face_offsets_{0};
    std::vector<std::int32_t> face_vertices_, face_cells_, face_surface_, cell_block_;
    std::vector<std::int32_t> cells_, vertices_of_, faces_;
    /// Of faces: the model's cell beyond, where that is none of the part's; else -1.
    std::vector<std::int32_t> beyond_;
};

/// Where the cells of a model are.
struct CellBoxes {
    explicit CellBoxes(const ComplexView& model, const Progress* progress = nullptr);

    std::vector<spatial::Box> boxes;
    std::vector<NodeId> vertex;  ///< one of each cell, -1 of those without faces
    double rounding = 0;         ///< what its vertices may be off by
};

/// Of cells: 1 where they come near a surface, farther than SurfaceOverlay takes to be near.
std::vector<std::uint8_t> cells_near(const CellBoxes& cells, const NearestSide& surface,
                                     int threads, const Progress* progress);

/// Of cells that are not near a surface, the side of it that they are on; kOn of the others. What
/// is connected beside the surface is on one side.
/// @param is_near  of cells, not 0: near, or not asked for
std::vector<std::int8_t> sides_of_far_cells(const ComplexView& model, const CellBoxes& cells,
                                            const NearestSide& surface,
                                            std::span<const std::uint8_t> is_near,
                                            const Progress* progress);

}  // namespace realmodel::cutting
