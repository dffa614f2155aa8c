// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "cutting/polygons.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::cutting {

/// The cells of a model that a surface may touch, as a model of their own: what is done to them
/// costs what they are, and the cells beside them stay as they are.
class NearPart {
public:
    /// @param is_near  of the model's cells: not 0 if it is one of them
    NearPart(const ComplexView& model, std::span<const std::uint8_t> is_near);

    ComplexView view() const;
    /// The model's cell, vertex, face that one of the part is. Faces that lie between a cell of the
    /// part and another may turn the other way round.
    std::int32_t cell(std::int32_t own) const { return cells_[index(own)]; }
    std::int32_t vertex(NodeId own) const { return vertices_of_[index(own)]; }
    std::size_t face(std::size_t own) const { return index(faces_[own]); }
    /// The model's cell beyond a face of the part, -1 none: it is none of the part's.
    std::int32_t beyond(std::size_t own) const { return beyond_[own]; }

private:
    const ComplexView& model_;
    std::vector<Position> vertices_;
    std::vector<std::int64_t> face_offsets_{0};
    std::vector<std::int32_t> face_vertices_, face_cells_, face_surface_, cell_block_;
    std::vector<std::int32_t> cells_, vertices_of_, faces_, beyond_;
};

}  // namespace realmodel::cutting
