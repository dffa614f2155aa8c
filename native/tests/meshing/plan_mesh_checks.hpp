// SPDX-License-Identifier: GPL-3.0-or-later
// What the meshing tests ask of a planar mesh.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "meshing/plan_predicates.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

inline double area_of(const PlanarMesh& mesh) {
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const PlanPoint &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
        area += 0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]));
    }
    return area;
}

/// Directed border edges: those whose opposite is not an edge of the mesh.
inline std::map<std::int32_t, std::vector<std::int32_t>> border_of(const PlanarMesh& mesh) {
    std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
    for (const auto& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i)
            ++uses[{t[i], t[(i + 1) % 3]}];
    }
    std::map<std::int32_t, std::vector<std::int32_t>> border;
    for (const auto& [edge, count] : uses) {
        EXPECT_EQ(count, 1) << "edge " << edge.first << "-" << edge.second << " twice one way";
        if (!uses.contains({edge.second, edge.first})) border[edge.first].push_back(edge.second);
    }
    return border;
}

/// Triangles counter-clockwise (exactly), every edge used at most once in each direction, no vertex
/// unused or repeated.
inline void expect_valid(const PlanarMesh& mesh) {
    std::vector<bool> used(mesh.vertices.size(), false);
    std::size_t turned = 0;
    for (const auto& t : mesh.triangles) {
        for (const std::int32_t v : t) {
            ASSERT_GE(v, 0);
            ASSERT_LT(static_cast<std::size_t>(v), mesh.vertices.size());
            used[v] = true;
        }
        turned += orient2d(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]) <= 0;
    }
    EXPECT_EQ(turned, 0U);
    EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
    std::vector<PlanPoint> sorted = mesh.vertices;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end());
    border_of(mesh);
}

/// Runs something that must be refused and gives back the error.
inline InputError refusal(const std::function<void()>& run) {
    try {
        run();
    } catch (const InputError& error) {
        EXPECT_STRNE(error.what(), "");
        return error;
    }
    ADD_FAILURE() << "not refused";
    return InputError("none", "none");
}

inline Ring rectangle(double x0, double y0, double x1, double y1) {
    return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

}  // namespace realmodel::meshing
