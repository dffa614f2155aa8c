// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "random_source.hpp"
#include "stack_case.hpp"

namespace realmodel::fuzz {

/// Triangulations in plan over 0 ... n, on the integer lattice or fractions of it, exactly
/// single-valued.
enum class Plan {
    kLattice,    ///< n x n squares, each cut along a diagonal or into four
    kGiant,      ///< the square in two triangles, or one triangle round it
    kScattered,  ///< lattice points taken at random, triangulated at random
    kFan,        ///< all triangles round one point
    kBricks,     ///< rows of rectangles with joints of their own: T-junctions
    kNeedles,    ///< triangles as thin as 1e-6 to 1e-9
    kTiny        ///< a lattice of half steps
};

PlanMesh make_plan(RandomSource& random, Plan plan, int n);

/// A part of a triangulation: holes, an island, a half, all but one, one alone; never nothing.
std::vector<Triangle> some_triangles(RandomSource& random, const PlanMesh& mesh);

/// The Delaunay-free sweep triangulation of distinct points, all of their hull; none where they lie
/// in one line.
std::vector<Triangle> triangulated(const std::vector<PlanPoint>& points);

/// Flips up to `count` inner edges, taken at random, whose quadrilateral is strictly convex.
void flip_edges(RandomSource& random, PlanMesh& mesh, int count);

}  // namespace realmodel::fuzz
