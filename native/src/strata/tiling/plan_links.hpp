// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "exact/plan_arrangement.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::strata {

/// A plan edge (low < high) that more triangles pass in one direction than in the other.
struct BorderEdge {
    exact::VertexId low, high;
    std::int32_t net;  ///< passes from low to high less passes from high to low
};

/// How triangles that turn counter-clockwise in plan are connected.
struct PlanLinks {
    /// Across edge i, from corner i to corner i + 1: the one triangle that passes it the other way,
    /// where there is no third; -1 where there is none.
    std::vector<std::array<std::int32_t, 3>> neighbor;
    /// The border in the sense of homology: how often a position is covered changes only here.
    std::vector<BorderEdge> border;
};

using PlanTriangle = std::array<exact::VertexId, 3>;

/// Half-edges of a mesh are 32-bit numbers.
/// @throws InputError kind too_large
void check_triangle_count(std::size_t triangles);

/// Links triangles.
/// @throws InputError kind too_large
PlanLinks link_triangles(std::span<const PlanTriangle> triangles, Progress* progress);

/// Plan vertices around everything: the four corners of a rectangle, counter-clockwise, then others
/// on its sides.
using Frame = std::vector<exact::VertexId>;

/// A constrained Delaunay triangulation of the frame by a border.
struct FrameTriangles {
    std::vector<PlanTriangle> triangles;
    std::vector<std::int32_t> covered;  ///< how many of the linked triangles lie over each of them

    bool is_covered_twice() const {
        return std::ranges::any_of(covered, [](std::int32_t times) { return times > 1; });
    }
};

/// Where the linked triangles lie and where they do not. Outside of the border nothing is covered,
/// and crossing an edge of it changes the number by its `net`: so it is known everywhere without
/// looking at a single triangle.
/// @return nothing where edges of the border cross: then triangles overlap
std::optional<FrameTriangles> fill_frame(const exact::PlanArrangement& geometry,
                                         std::span<const BorderEdge> border, const Frame& frame);

}  // namespace realmodel::strata
