// SPDX-License-Identifier: GPL-3.0-or-later
// The faces of a model that bound its regions, the edges that a coarser mesh must keep, and how
// long the edges of tetrahedra should be.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshing/size_field.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/meshing/region_mesh.hpp"

namespace realmodel::simulation {

/// A triangle between two regions, 0 outside; its corners turn counter-clockwise seen from in
/// front.
struct BoundaryTriangle {
    std::array<std::int32_t, 3> corners;
    std::int32_t behind, in_front, surface;
};

struct BoundaryFaces {
    std::vector<BoundaryTriangle> triangles;  ///< none is degenerate
    /// Where patches (faces on one surface between the same two regions) meet or end, and where
    /// one has a sharp edge; vertices of the model, the lower first.
    std::vector<std::array<std::int32_t, 2>> sharp_edges;
};

/// @param cell_region  of each cell, from 0; in the result they count from 1
/// @throws InputError kind bad_index; Cancelled
BoundaryFaces boundary_faces(const ComplexView& model, std::span<const std::int32_t> cell_region,
                             std::span<const std::uint8_t> embedded, const Execution& execution);

/// Points on sharp edges, no two nearer than a part of the edge length there, corners first.
std::vector<std::array<double, 3>> points_on_edges(
    const ComplexView& model, std::span<const std::array<std::int32_t, 2>> sharp_edges,
    meshing::SizeField& lengths);

/// Vertices of the triangles that are no nearer to each other, and to `others`, than `share` of the
/// edge length there.
struct SurfaceSeed {
    std::array<double, 3> point;
    std::int32_t triangle;  ///< one that has it
};
std::vector<SurfaceSeed> surface_seeds(const ComplexView& model,
                                       std::span<const BoundaryTriangle> triangles,
                                       std::span<const std::array<double, 3>> others,
                                       meshing::SizeField& lengths, double share);

/// As mesh_region has them, and its gradation. A size without places means the sharp edges, seen
/// in plan.
/// @throws InputError kinds size (items: its number; a length that is below `tolerance`, or no
/// shorter than `edge_length`), too_large
meshing::SizeField edge_lengths(const ComplexView& model, const BoundaryFaces& faces,
                                double edge_length, double tolerance,
                                std::span<const meshing::LocalLength> sizes);

/// About how many cubes with these edges fill a box, of which any part of the plan has one at
/// least. @throws InputError kind too_large (where edges differ in length, and there are more than
/// `most`); Cancelled
double cubes_in(meshing::SizeField& lengths, const std::array<double, 3>& low,
                const std::array<double, 3>& high, double most, Progress* progress);

}  // namespace realmodel::simulation
