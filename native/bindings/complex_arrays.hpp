// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "arrays.hpp"
#include "realmodel/strata/stack.hpp"

namespace realmodel::bindings {

/// The arrays of a complex as NumPy arrays, under the names of docs/geometry.md; the complex is
/// left without them.
inline pybind11::dict complex_arrays(strata::CellComplex& complex) {
    pybind11::dict result;
    result["vertices"] = to_array(std::move(complex.vertices));
    result["face_offsets"] = to_array(std::move(complex.face_offsets));
    result["face_vertices"] = to_array(std::move(complex.face_vertices));
    result["face_cells"] = to_array(std::move(complex.face_cells));
    result["face_surface"] = to_array(std::move(complex.face_surface));
    result["cell_block"] = to_array(std::move(complex.cell_block));
    result["volumes"] = to_array(std::move(complex.volumes));
    return result;
}

}  // namespace realmodel::bindings
