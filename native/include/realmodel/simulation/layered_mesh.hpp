// SPDX-License-Identifier: GPL-3.0-or-later
/// Meshes of prisms for solvers, made from a model (docs/dev/simulation.md): lines of the plan are
/// simplified, a planar mesh is made with them (realmodel/meshing), and columns of elements stand
/// on it. Names, in the order in which things are made:
///
/// - trace: in plan, an edge of the top or the bottom of a block that ends or steps there.
/// - anchor: a point on traces. What of these is nearest to an anchor moves to it.
/// - segment: a line between two anchors, in the place of traces. A step has other heights on its
///   other side; along other segments blocks end without thickness.
/// - node: a vertex of the planar mesh. Segments are chains of its edges.
/// - pillar: one sector of the surroundings of a node, between steps; a node on no step has one.
/// - rock mass, block, layer: a rock mass has blocks, oldest first; a block is divided into layers.
/// - level: l of a pillar is the height at which layer l of its rock mass begins; two are equal
///   where the layer is absent.
/// - height: h of a node, ascending. Pillars of one node share heights; each level is the number of
///   one. A point of the mesh is a node with a height.
/// - front: one height at each corner of a triangle of the planar mesh.
/// - element: what lies between two fronts that differ by one height at one corner (tetrahedron),
///   two (pyramid) or three (prism). All over one triangle are its column.
/// - removal: a height is given up; what had it takes the next one below or above.
///
/// The repair of columns asks for elements and faces that are weak (thin ends), steep, failing
/// (whatever OpenFOAM's checkMesh does) or skewed: src/simulation/layered_mesh.cpp has the steps.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::simulation {

using meshing::PlanPoint;

/// The edges of the planar mesh are `length` long within `distance` of these points or line; no
/// points: along all lines.
struct LineLength {
    std::vector<PlanPoint> line;
    double length, distance;
};

/// A straight line between two points of PlanLines that the planar mesh must contain.
struct PlanSegment {
    std::int32_t from, to;
    std::int32_t left_rock, right_rock;  ///< rock masses on both sides, -1 outside
    bool is_step;                        ///< heights may differ on both sides
};

/// The lines of a model in plan, simplified to an edge length: its outline, lines where layers end,
/// steps and walls. Segments meet in their ends only, at angles of 28 degrees and more, and are
/// about as long as edges of the planar mesh.
struct PlanLines {
    std::vector<PlanPoint> points;
    std::vector<PlanSegment> segments;
    std::vector<meshing::Ring> rings;             ///< bound the region; even-odd
    std::vector<std::int32_t> ending_offsets;     ///< one more than segments
    std::vector<std::int32_t> ending_blocks;      ///< the blocks that end at each segment
    std::vector<std::array<PlanPoint, 2>> steps;  ///< steps and walls as the model has them
};

/// @param block_rock  the rock mass of each block; blocks of one rock mass stand together, oldest
/// first
/// @throws InputError kinds not_layered (place), nothing; Cancelled
PlanLines plan_lines(const ComplexView& model, std::span<const std::int32_t> block_rock,
                     double edge_length, std::span<const LineLength> lengths,
                     const Execution& execution);

/// How columns are divided.
struct Layering {
    double minimum_thickness = 0;
    std::vector<std::int32_t> layers;  ///< of each block, at most; 0: see layer_thickness
    double layer_thickness = 0;        ///< 0: each block into `layers` everywhere, or, if these are
                                       ///< 0, into one, and more where it is too tall for its top
                                       ///< or base; else into layers no thicker than this, as far
                                       ///< as there are that many
    bool divided = false;  ///< elements will be divided into tetrahedra: these are judged
};

/// Columns of prisms, of pyramids and tetrahedra where layers end. Corners as VolumeMesh of
/// addon/realmodel/core/simulation/volume_mesh.py has them.
struct LayeredMesh {
    std::vector<std::array<double, 3>> points;
    template <std::size_t N>
    struct Elements {
        std::vector<std::array<std::int32_t, N>> corners;
        std::vector<std::int32_t> block, column, layer;  ///< layer 0: the highest
    };
    Elements<4> tetrahedra;
    Elements<5> pyramids;
    Elements<6> prisms;
    template <std::size_t N>
    struct Faces {
        std::vector<std::array<std::int32_t, N>> corners;
        std::vector<std::int32_t> surface;
    };
    Faces<3> triangles;
    Faces<4> quadrilaterals;
    meshing::PlanarMesh plan;
    std::int32_t layers = 0;                 ///< of the rock mass that has most
    std::vector<double> volumes;             ///< of each block
    std::vector<std::int32_t> block_layers;  ///< of each block, as Layering::layers
    /// Faces whose skewness, as OpenFOAM's checkMesh measures it, stays above 4.
    struct Skewed {
        std::size_t faces = 0;
        double most = 0;
        std::array<double, 3> place{};   ///< of the worst
        std::vector<std::int32_t> tall;  ///< blocks that are too thick at the top or base for that
    } skewed;
    /// Blocks that keep elements of bad shape: without these they would lose or gain too much.
    std::vector<std::int32_t> unrepaired_blocks;
};

/// @param plan  a mesh of the region that contains the segments of `lines`
/// @throws InputError kinds not_layered (place), too_large; Cancelled
LayeredMesh layered_mesh(const ComplexView& model, std::span<const std::int32_t> block_rock,
                         const PlanLines& lines, meshing::PlanarMesh plan, Layering layering,
                         const Execution& execution);

}  // namespace realmodel::simulation
