// SPDX-License-Identifier: GPL-3.0-or-later
// What tests ask of refinements.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "realmodel/booleans/intersect.hpp"
#include "small_meshes.hpp"

namespace realmodel::booleans {

using Row = std::array<std::int32_t, 3>;

/// Triangles of a refinement as a mesh of its own.
inline Mesh mesh_of(const Refinement& r, const std::vector<Row>& triangles) {
    Mesh mesh;
    std::vector<std::int32_t> number(r.vertices.size() / 3, -1);
    for (const Row& t : triangles) {
        for (const std::int32_t v : t) {
            std::int32_t& own = number[static_cast<std::size_t>(v)];
            if (own < 0) {
                own = static_cast<std::int32_t>(mesh.vertices.size() / 3);
                const auto first = r.vertices.begin() + 3 * static_cast<std::ptrdiff_t>(v);
                mesh.vertices.insert(mesh.vertices.end(), first, first + 3);
            }
            mesh.triangles.push_back(own);
        }
    }
    return mesh;
}

inline void rotate(Mesh& mesh, double angle, std::size_t axis) {
    const double c = std::cos(angle), s = std::sin(angle);
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 3) {
        const double x = mesh.vertices[i + u], y = mesh.vertices[i + v];
        mesh.vertices[i + u] = c * x - s * y;
        mesh.vertices[i + v] = s * x + c * y;
    }
}

/// The four volumes, which must make up the given ones.
inline void expect_sums(const Refinement& r, double first, double second, double allowed) {
    std::array<double, 4> v{};
    for (std::size_t i = 0; i < 4; ++i)
        v[i] = mesh_of(r, r.boundary(static_cast<Operation>(i))).volume();
    EXPECT_NEAR(v[0] + v[1], first + second, allowed);
    EXPECT_NEAR(v[2] + v[1], first, allowed);
    EXPECT_NEAR(v[3] + v[1], second, allowed);
}

/// Intersected with itself the refinement stays as it is.
inline void expect_settled(const Refinement& r) {
    std::vector<Row> all(r.triangles.begin(), r.triangles.end());
    const Mesh mesh = mesh_of(r, all);
    const Refinement again = intersect(mesh.view(), mesh.view());
    EXPECT_EQ(again.triangles.size(), 2 * r.triangles.size());
    EXPECT_EQ(again.vertices.size(), mesh.vertices.size());
}

}  // namespace realmodel::booleans
