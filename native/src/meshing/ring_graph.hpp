// SPDX-License-Identifier: GPL-3.0-or-later
// Rings as a graph, and the refusal of two of its edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshing/constrained_delaunay.hpp"
#include "realmodel/meshing/rings.hpp"

namespace realmodel::meshing {

/// Rings as points and segments. @throws InputError "no_outline", "not_finite" and
/// "outline_degenerate" as triangulate_region does.
RingGraph ring_graph(std::span<const Ring> rings);

/// Rings in a constrained Delaunay triangulation of their corners. They do not cross; some may
/// share edges.
struct ConstrainedRings {
    RingGraph graph;
    std::vector<CoveredEdge> edges;  ///< of the triangulation, by the segments that run along them
    ConstrainedTriangulation triangulation;
};

/// @throws InputError as ring_graph does, and "outline_crosses"; Cancelled.
ConstrainedRings constrained_rings(std::span<const Ring> rings, Progress* progress);

/// Refuses two segments that run along one edge, as "outline_overlaps".
[[noreturn]] void refuse_overlap(const RingGraph& graph, const CoveredEdge& first,
                                 const CoveredEdge& second);

/// The first of the places that is equal to each.
std::vector<std::int32_t> first_equal(std::span<const PlanPoint> places);

/// Which triangles lie inside an odd number of rings: going from one to the next changes that
/// across the sides for which `is_ring(triangle, side)`. The hull is walked into from outside.
template <class IsRing>
std::vector<bool> inside_rings(const ConstrainedTriangulation& mesh, IsRing&& is_ring) {
    constexpr signed char kUnknown = -1;
    std::vector<signed char> parity(mesh.triangles.size(), kUnknown);
    std::vector<std::int32_t> open;
    const auto reach = [&](std::int32_t triangle, int value) {
        if (parity[triangle] != kUnknown) return;
        parity[triangle] = static_cast<signed char>(value);
        open.push_back(triangle);
    };
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto first = static_cast<std::int32_t>(t);
        for (int i = 0; i < 3; ++i)
            if (mesh.neighbors[t][i] < 0) reach(first, is_ring(first, i) ? 1 : 0);
        while (!open.empty()) {
            const std::int32_t from = open.back();
            open.pop_back();
            for (int i = 0; i < 3; ++i) {
                const std::int32_t to = mesh.neighbors[from][i];
                if (to >= 0) reach(to, is_ring(from, i) ? 1 - parity[from] : parity[from]);
            }
        }
    }
    return {parity.begin(), parity.end()};
}

}  // namespace realmodel::meshing
