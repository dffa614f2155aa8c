// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/stl.h>

#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "arrays.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::bindings {

/// The arrays of a complex as NumPy arrays, under the names of docs/dev/geometry.md; the complex is
/// left without them.
inline pybind11::dict complex_arrays(CellComplex& complex) {
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

/// The arrays, and what is known of how they were built.
inline pybind11::dict built_arrays(CellComplex&& complex) {
    pybind11::dict result = complex_arrays(complex);
    pybind11::list warnings;
    for (const Warning& w : complex.warnings) {
        warnings.append(pybind11::make_tuple(w.kind, w.surface, w.items, w.text));
    }
    result["warnings"] = warnings;
    result["decisions"] = complex.decisions;
    result["exact_decisions"] = complex.exact_decisions;
    return result;
}

inline CellKind kind_of(const std::string& cells) {
    if (cells != "columns" && cells != "blocks") {
        throw pybind11::value_error("cells: \"columns\" or \"blocks\", got \"" + cells + "\"");
    }
    return cells == "blocks" ? CellKind::kBlocks : CellKind::kColumns;
}

/// The arrays of a complex that come under these names, kept alive while the view is in use. How
/// many blocks there are, and what their cells are, is left to the caller.
struct ComplexArrays {
    NumpyArray<double> vertices;
    NumpyArray<std::int64_t> face_offsets;
    NumpyArray<std::int32_t> face_vertices, face_cells, face_surface, cell_block;
    ComplexView complex;

    explicit ComplexArrays(const pybind11::dict& arrays) {
        take(arrays, "vertices", vertices, complex.vertices);
        take(arrays, "face_offsets", face_offsets, complex.face_offsets);
        take(arrays, "face_vertices", face_vertices, complex.face_vertices);
        take(arrays, "face_cells", face_cells, complex.face_cells);
        take(arrays, "face_surface", face_surface, complex.face_surface);
        take(arrays, "cell_block", cell_block, complex.cell_block);
        require_columns(vertices, 3, "vertices");
        require_columns(face_cells, 2, "face_cells");
    }

    template <class T>
    static void take(const pybind11::dict& arrays, const char* name, NumpyArray<T>& holder,
                     std::span<const T>& seen) {
        holder = arrays[name].cast<NumpyArray<T>>();
        seen = {holder.data(), static_cast<std::size_t>(holder.size())};
    }
};

}  // namespace realmodel::bindings
