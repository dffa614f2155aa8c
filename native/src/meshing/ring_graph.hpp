// SPDX-License-Identifier: GPL-3.0-or-later
// Rings as a graph, and the refusal of two of its edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshing/constrained_delaunay.hpp"
#include "realmodel/meshing/rings.hpp"

namespace realmodel::meshing {

/// Rings in a constrained Delaunay triangulation of their corners. They do not cross; some may
/// share edges.
struct ConstrainedRings {
    RingGraph graph;
    std::vector<CoveredEdge> edges;  ///< of the triangulation, by the segments that run along them
    ConstrainedTriangulation triangulation;
};

/// @throws InputError "no_outline", "not_finite", "outline_degenerate" and "outline_crosses" as
/// triangulate_region does; Cancelled.
ConstrainedRings constrained_rings(std::span<const Ring> rings, Progress* progress);

/// Refuses two segments that run along one edge, as "outline_overlaps".
[[noreturn]] void refuse_overlap(const RingGraph& graph, const CoveredEdge& first,
                                 const CoveredEdge& second);

/// The first of the places that is equal to each.
std::vector<std::int32_t> first_equal(std::span<const PlanPoint> places);

/// A value of each triangle, found by walking over the triangles from outside the hull, where it is
/// `outside`: cross(triangle, side, value) gives it beyond a side that is walked over, of the
/// triangle before, or at the hull of the first one. No value is -2.
template <class Value, class Cross>
std::vector<Value> spread_inward(const ConstrainedTriangulation& mesh, Value outside,
                                 const Cross& cross) {
    constexpr Value kUnknown = -2;
    std::vector<Value> values(mesh.triangles.size(), kUnknown);
    std::vector<std::int32_t> open;
    const auto reach = [&](std::int32_t to, std::int32_t from, int side, Value value) {
        if (values[to] != kUnknown) return;
        values[to] = cross(from, side, value);
        open.push_back(to);
    };
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto first = static_cast<std::int32_t>(t);
        for (int i = 0; i < 3; ++i)
            if (mesh.neighbors[t][i] < 0) reach(first, first, i, outside);

        while (!open.empty()) {
            const std::int32_t from = open.back();
            open.pop_back();
            for (int i = 0; i < 3; ++i) {
                const std::int32_t to = mesh.neighbors[from][i];
                if (to >= 0) reach(to, from, i, values[from]);
            }
        }
    }
    return values;
}

/// Which triangles lie inside an odd number of rings: going from one to the next changes that
/// across the sides for which `is_ring(triangle, side)`.
template <class IsRing>
std::vector<bool> inside_rings(const ConstrainedTriangulation& mesh, const IsRing& is_ring) {
    const auto parity =
        spread_inward<signed char>(mesh, 0, [&](std::int32_t t, int side, signed char before) {
            return static_cast<signed char>(is_ring(t, side) ? 1 - before : before);
        });
    return {parity.begin(), parity.end()};
}

}  // namespace realmodel::meshing
