// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

enum class Mesher : std::uint8_t {
    kDelaunay,  ///< constrained Delaunay refinement around a lattice
    kFrontal,   ///< the same, filled by a front and smoothed: better triangles, more time
    kGrid,      ///< a regular grid of squares, halved, that ends at the outline
};

/// Their names in files, in the order of Mesher.
inline constexpr std::string_view kMesherNames[] = {"delaunay", "frontal", "grid"};

/// What a mesh must contain beside the outlines. Lines may cross one another and the outlines; what
/// of them lies outside the region is left out. Points must lie in it.
struct Constraints {
    std::vector<std::vector<PlanPoint>> lines;
    std::vector<PlanPoint> points;
};

/// Edges are `length` long within `distance` of a line (one point: of that point) and grow from
/// there on.
struct LocalLength {
    std::vector<PlanPoint> line;  ///< empty: the outlines
    double length;
    double distance;
};

struct MeshRequest {
    Mesher mesher = Mesher::kDelaunay;
    double edge_length = 0;            ///< of most edges; not used where `triangles` is above 0
    double triangles = 0;              ///< how many there should be, within 5 %
    std::vector<LocalLength> sizes{};  ///< where edges are shorter
    std::vector<PlanPoint>
        density{};  ///< where there are any: edges half as long as these are apart,
                    ///< and `edge_length` only bounds them where it is above 0
    Constraints constraints{};
};

/// What a mesh will take, told before it is made.
struct MeshEstimate {
    double triangles;
    double bytes;  ///< at the peak
};

/// Estimates mesh_region's work from the region's area, border and lengths. Throws as mesh_region
/// does.
MeshEstimate estimate_region_mesh(std::span<const Ring> rings, const MeshRequest& request,
                                  Progress* progress = nullptr);

/// Meshes what lies inside an odd number of rings.
///
/// The border of the mesh is the outlines' corners, where constraints meet them, and points added
/// on their edges, nothing else. Vertices: the outlines' corners in order of appearance, what
/// constraints bring, points added on edges, the others.
///
/// `delaunay`: equilateral triangles of side `edge_length` fill the open; the border is cut into
/// pieces of about that length, and the band between is a constrained Delaunay triangulation,
/// refined until no angle is below 27 degrees but those between two given edges, grading down to
/// their detail (detail below a thousandth of the edge length is kept but not graded to).
/// `frontal`: sizes grow gently from small detail to large, a front fills what is graded, and all
/// but the lattice is smoothed.
/// `grid`: the nodes of a grid along the axes that lie inside, and where its lines meet the
/// outlines.
///
/// Every valid outline is meshed, down to gaps of one unit in the last place: where there is no
/// room for points, edges stay as they are given. Of a constraint what cannot be told from its
/// crossings with others in doubles is left out.
///
/// The same input gives the same mesh. `progress` may be null.
/// @throws InputError as triangulate_region does (rings.hpp), and of kind
/// - "edge_length" (not positive and finite, or too small for doubles to tell points apart here),
/// - "triangles" (not a number that this region can be meshed with; says the nearest that can),
/// - "size" (items: its number; a length or distance that is none, or no shorter than edge_length),
/// - "constraint_not_finite" (items: line, or -1 for the points, and point),
/// - "constraint_outside" (items: the point; place),
/// - "density" (points that are fewer than two or not finite),
/// - "too_large" (more triangles than memory or 32-bit numbers allow; says how many, and the least
///   edge length that fits);
/// Cancelled within 0.2 s of Progress::cancel.
PlanarMesh mesh_region(std::span<const Ring> rings, const MeshRequest& request,
                       Progress* progress = nullptr);

}  // namespace realmodel::meshing
