// SPDX-License-Identifier: GPL-3.0-or-later
/// Tetrahedra for models that have no columns (docs/dev/simulation.md, section 7): with faults that
/// are not vertical, with bodies, or cut.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/meshing/region_mesh.hpp"

namespace realmodel::simulation {

/// Tetrahedra, positive and conforming. Corners as VolumeMesh of
/// addon/realmodel/core/simulation/volume_mesh.py has them.
struct FilledMesh {
    std::vector<std::array<double, 3>> points;
    std::vector<std::array<std::int32_t, 4>> tetrahedra;
    std::vector<std::int32_t> region;  ///< of each tetrahedron
    /// Outside (counter-clockwise seen from there), between regions, and on kept surfaces inside a
    /// region.
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::vector<std::int32_t> surface;  ///< that each triangle lies on, as face_surface of a model
};

/// Each region filled with tetrahedra whose edges are about `edge_length` long. Boundaries lie
/// within about `tolerance` of the exact ones; where that takes edges shorter than `tolerance`
/// (between surfaces that are as near), it is not reached.
/// @param cell_region  of each cell; cells of one region need not be connected
/// @param embedded     of each surface: whether its faces matter inside a region, too
/// @param sizes        where edges are shorter, in plan; those without places: near sharp edges.
///                     None may be below `tolerance`
/// @throws InputError kinds bad_index, size (items: its number), too_large, nothing (no tetrahedron
/// is left), flat (place), endless (refinement was given up); Cancelled
FilledMesh filled_mesh(const ComplexView& model, std::span<const std::int32_t> cell_region,
                       std::span<const std::uint8_t> embedded, double edge_length, double tolerance,
                       std::span<const meshing::LocalLength> sizes, const Execution& execution);

}  // namespace realmodel::simulation
