// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace realmodel {
class Progress;
}

namespace realmodel::interpolation {

/// What the heights of a mesh's nodes have to obey beside the points; empty: nothing, NaN at a
/// node: nothing there.
struct NodeConstraints {
    std::span<const double> equal;  ///< heights that nodes have, such as a fixed border
    std::span<const double> least;  ///< heights that nodes are not below
    std::span<const double> most;   ///< heights that nodes are not above
};

struct DsiOptions {
    double weight = 0;  ///< of a point's misfit against the roughness of one node; 0: points hold
    int threads = 0;    ///< 0: as many as there are
};

struct DsiHeights {
    std::vector<double> z;     ///< of each node
    std::int64_t outside = 0;  ///< points that lie in no triangle, and did not count
    std::int64_t missed = 0;   ///< points that hold and could not all be met
    double misfit = 0;         ///< the largest of theirs
    int iterations = 0;        ///< of conjugate gradients, in all
    bool converged = true;     ///< whether the heights are as smooth as can be, to 1e-9
};

/// Discrete smooth interpolation (Mallet 1989, 1992; with the roughness of Frank, Tertois and
/// Mallet 2007, "3D-reconstruction of complex geological interfaces from irregularly distributed
/// and noisy point data", section 3): of all heights of the nodes those for which the slope changes
/// least from triangle to triangle, sum of L^2 / (A + B) * (jump of the slope across the edge)^2
/// over inner edges of length L between triangles of areas A and B, while points that lie anywhere
/// in the triangles hold, or their misfits count with a weight. A plane has no roughness at all, so
/// it comes out exactly, and slopes go on where points end.
///
/// The system is solved by conjugate gradients, preconditioned by multigrid on grids of quadratic
/// B-splines (Hoellig 2003, "Finite element methods with B-splines"), which have the second
/// derivatives that piecewise linear coarse functions lack; what has to hold is met by augmented
/// Lagrangians (Nocedal and Wright 2006, section 17.3), heights not to be passed too.
/// @param points     x, y, z
/// @param nodes      x, y
/// @param triangles  node numbers
/// @return           the same bytes for any number of threads
/// Throws InputError of kind "no_points", "not_finite", "contradicting_points", "bad_index",
/// "option" (also where a node should be above what it should be below; items: the node);
/// Cancelled.
DsiHeights dsi(std::span<const std::array<double, 3>> points,
               std::span<const std::array<double, 2>> nodes,
               std::span<const std::array<std::int32_t, 3>> triangles,
               const NodeConstraints& constraints, const DsiOptions& options,
               Progress* progress = nullptr);

}  // namespace realmodel::interpolation
