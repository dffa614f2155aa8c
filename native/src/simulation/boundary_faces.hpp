// SPDX-License-Identifier: GPL-3.0-or-later
/// The faces of a model that bound its regions, and the edges that a coarser mesh must keep.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshing/size_field.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"

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
                             std::span<const std::uint8_t> kept, const Execution& execution);

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

}  // namespace realmodel::simulation
