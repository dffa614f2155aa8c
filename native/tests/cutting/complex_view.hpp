// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "../strata/complex_checks.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {

/// A built complex as the cutting takes it.
inline ComplexView view(const strata::CellComplex& c, bool blocks = false) {
    ComplexView v;
    v.vertices = {c.vertices.data()->data(), 3 * c.vertices.size()};
    v.face_offsets = c.face_offsets;
    v.face_vertices = c.face_vertices;
    v.face_cells = {c.face_cells.data()->data(), 2 * c.face_cells.size()};
    v.face_surface = c.face_surface;
    v.cell_block = c.cell_block;
    v.blocks = c.volumes.size();
    v.cells_are_blocks = blocks;
    return v;
}

}  // namespace realmodel::cutting
