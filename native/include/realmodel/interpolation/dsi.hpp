// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/interpolation/dips.hpp"

namespace realmodel::interpolation {

/// Constraints of a mesh's heights beside the points. Of nodes, empty: none; NaN: none at this
/// node.
struct DsiConstraints {
    std::span<const double> equal;  ///< heights that nodes have, such as a fixed border
    std::span<const double> least;  ///< lower bounds
    std::span<const double> most;   ///< upper bounds
    Dips dips{};  ///< slopes that triangles have; met as points are. The baseline is not used
};

struct DsiHeights {
    std::vector<double> z;          ///< of each node
    std::int64_t outside = 0;       ///< points that lie in no triangle and were left out
    std::int64_t missed = 0;        ///< points that should be met exactly and are not
    double misfit = 0;              ///< the largest of theirs
    std::int64_t dips_outside = 0;  ///< as of points
    std::int64_t dips_missed = 0;
    int iterations = 0;     ///< of conjugate gradients, in all
    bool converged = true;  ///< whether the heights are as smooth as possible, to 1e-9
};

/// Discrete smooth interpolation (Mallet 1989, 1992; with the roughness of Frank, Tertois and
/// Mallet 2007, "3D-reconstruction of complex geological interfaces from irregularly distributed
/// and noisy point data", section 3): of all heights of the nodes those for which the slope changes
/// least from triangle to triangle, sum of L^2 / (A + B) * (jump of the slope across the edge)^2
/// over inner edges of length L between triangles of areas A and B, while points that lie anywhere
/// in the triangles are met exactly, or their misfits count with a weight. A plane has no roughness
/// at all, so it comes out exactly, and slopes continue beyond the points.
///
/// The system is solved by conjugate gradients, preconditioned by multigrid on grids of quadratic
/// B-splines (Hoellig 2003, "Finite element methods with B-splines"), which have the second
/// derivatives that piecewise linear coarse functions lack. Exact points and bounds are met by
/// augmented Lagrangians (Nocedal and Wright 2006, section 17.3).
/// @param points     x, y, z
/// @param nodes      x, y
/// @param triangles  node numbers
/// @return           the same bytes for any number of threads
/// @throws InputError kind "no_points", "not_finite", "contradicting_points", "bad_index",
///         "too_large" or "option" (also where the bounds of a node contradict each other; items:
///         the node)
/// @throws Cancelled
DsiHeights dsi(std::span<const std::array<double, 3>> points,
               std::span<const std::array<double, 2>> nodes,
               std::span<const std::array<std::int32_t, 3>> triangles,
               const DsiConstraints& constraints, double weight, const Execution& execution = {});

}  // namespace realmodel::interpolation
