// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that tests and the benchmark of Booleans begin with.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "realmodel/booleans/intersect.hpp"

namespace realmodel::booleans {

struct Mesh {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;

    TriangleView view() const { return {vertices, triangles}; }
    void add(const Mesh& other) {
        const auto first = static_cast<std::int32_t>(vertices.size() / 3);
        vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
        for (const std::int32_t v : other.triangles)
            triangles.push_back(first + v);
    }
    double volume() const {
        double sum = 0;
        for (std::size_t t = 0; t < triangles.size(); t += 3) {
            std::array<const double*, 3> p;
            for (std::size_t k = 0; k < 3; ++k)
                p[k] = &vertices[3 * static_cast<std::size_t>(triangles[t + k])];
            sum += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
                   p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
                   p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
        }
        return sum / 6;
    }
};

inline Mesh cube(const std::array<double, 3>& low, double size) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.insert(
            mesh.vertices.end(),
            {low[0] + size * (i & 1), low[1] + size * (i >> 1 & 1), low[2] + size * (i >> 2)});
    mesh.triangles = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                      2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    return mesh;
}

/// A level square that is seen from above.
inline Mesh square(const std::array<double, 3>& low, double size) {
    const auto [x, y, z] = low;
    return {{x, y, z, x + size, y, z, x, y + size, z, x + size, y + size, z}, {0, 1, 2, 1, 3, 2}};
}

/// A square across x.
inline Mesh upright(const std::array<double, 3>& low, double size) {
    const auto [x, y, z] = low;
    return {{x, y, z, x, y + size, z, x, y, z + size, x, y + size, z + size}, {0, 1, 2, 1, 3, 2}};
}

/// A sphere of 4 rings (rings - 1) triangles.
inline Mesh sphere(const std::array<double, 3>& middle, double radius, int rings) {
    Mesh mesh;
    const auto add = [&](double latitude, double longitude) {
        mesh.vertices.insert(mesh.vertices.end(),
                             {middle[0] + radius * std::cos(latitude) * std::cos(longitude),
                              middle[1] + radius * std::cos(latitude) * std::sin(longitude),
                              middle[2] + radius * std::sin(latitude)});
    };
    const int around = 2 * rings;
    add(-std::numbers::pi / 2, 0);
    for (int i = 1; i < rings; ++i) {
        for (int j = 0; j < around; ++j)
            add(std::numbers::pi * (static_cast<double>(i) / rings - 0.5),
                2 * std::numbers::pi * j / around);
    }
    add(std::numbers::pi / 2, 0);
    const int last = static_cast<int>(mesh.vertices.size() / 3) - 1;
    const auto at = [&](int i, int j) {
        if (i == 0) return 0;
        return i == rings ? last : 1 + (i - 1) * around + j % around;
    };
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < around; ++j) {
            if (i > 0)
                mesh.triangles.insert(mesh.triangles.end(), {at(i, j), at(i, j + 1), at(i + 1, j)});
            if (i + 1 < rings)
                mesh.triangles.insert(mesh.triangles.end(),
                                      {at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
        }
    }
    return mesh;
}

}  // namespace realmodel::booleans
