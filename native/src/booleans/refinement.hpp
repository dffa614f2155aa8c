// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "realmodel/booleans/intersect.hpp"

namespace realmodel::booleans {

using Position = std::array<double, 3>;

/// A triangle of one of the surfaces, or a part of it.
struct Part {
    std::array<std::int32_t, 3> corners;
    std::int32_t origin;  ///< the triangle of the input that it is part of
    std::uint8_t source;  ///< which surface

    bool operator==(const Part&) const = default;
};

/// Triangles that meet in common edges and vertices only, or coincide.
struct Parts {
    std::vector<Position> vertices;  ///< all different, each a corner of a triangle
    std::vector<Part> triangles;     ///< by source, then by origin
};

/// Divides the triangles of both surfaces along one another and themselves.
///
/// What meets in something that doubles cannot keep is brought together first. Then, in rounds:
/// triangles are divided exactly, new vertices are rounded, and what meets out of order after that
/// is brought together or divided again, until nothing does. Where that takes many rounds, vertices
/// are rounded to coarser and coarser steps, which merges them.
///
/// @throws InputError kinds not_finite, bad_index, no_triangles, too_large, too_close; Cancelled
Parts refine(const std::array<TriangleMesh, 2>& surfaces, const Execution& execution);

}  // namespace realmodel::booleans
