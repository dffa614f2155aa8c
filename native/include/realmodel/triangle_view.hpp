// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace realmodel {

/// A view of triangles that share vertices, wherever the arrays come from: of a surface in space,
/// three coordinates a vertex, or of a region in plan, two. Nothing is taken for granted about the
/// numbers inside.
struct TriangleView {
    std::span<const double> vertices;         ///< 3 V or 2 V coordinates, model units
    std::span<const std::int32_t> triangles;  ///< 3 T indices into the vertices, either orientation

    std::size_t triangle_count() const { return triangles.size() / 3; }
};

}  // namespace realmodel
