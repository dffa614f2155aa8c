// SPDX-License-Identifier: GPL-3.0-or-later
// What lies inside of segments of a triangulation, found by walking over its triangles.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

/// A value of each triangle, found by walking over the triangles from outside the hull, where it is
/// `outside`: cross(triangle, side, value) gives it beyond a side that is walked over, of the
/// triangle before, or at the hull of the first one. No value is the least of its type.
template <class Value, class Cross>
std::vector<Value> spread_inward(const ConstrainedTriangulation& mesh, Value outside,
                                 const Cross& cross) {
    constexpr Value kUnknown = std::numeric_limits<Value>::min();
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

/// How often closed chains of directed segments, none of which is at the hull, wind around each
/// triangle: each counts as often as its weight says, for what lies on its left.
std::vector<std::int32_t> winding_numbers(const ConstrainedTriangulation& mesh,
                                          std::span<const PlanPoint> points,
                                          std::span<const std::array<std::int32_t, 2>> segments,
                                          std::span<const std::int32_t> weights);

}  // namespace realmodel::meshing
