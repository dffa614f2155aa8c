// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <tuple>

#include "merged_columns.hpp"
#include "realmodel/strata/stack.hpp"

namespace realmodel::strata {

/// A surface that owns its arrays.
struct OwnedSurface {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;
    TriangleView view() const { return {vertices, triangles}; }

    std::int32_t vertex(double x, double y, double z) {
        vertices.insert(vertices.end(), {x, y, z});
        return static_cast<std::int32_t>(vertices.size() / 3) - 1;
    }
    void triangle(std::int32_t a, std::int32_t b, std::int32_t c) {
        triangles.insert(triangles.end(), {a, b, c});
    }
};

/// A grid of nx x ny quads over a box, heights by a function; `other` splits quads the other way.
inline OwnedSurface grid(int nx, int ny, double x0, double y0, double x1, double y1,
                         const std::function<double(double, double)>& height, bool other = false) {
    OwnedSurface s;
    for (int i = 0; i <= nx; ++i) {
        for (int j = 0; j <= ny; ++j) {
            const double x = x0 + (x1 - x0) * i / nx, y = y0 + (y1 - y0) * j / ny;
            s.vertex(x, y, height(x, y));
        }
    }
    for (int i = 0; i < nx; ++i) {
        for (int j = 0; j < ny; ++j) {
            const std::int32_t a = i * (ny + 1) + j, b = a + ny + 1, c = b + 1, d = a + 1;
            if (other) {
                s.triangle(a, b, d);
                s.triangle(b, c, d);
            } else {
                s.triangle(a, b, c);
                s.triangle(a, c, d);
            }
        }
    }
    return s;
}

/// A closed box.
inline OwnedSurface box(std::array<double, 3> low, std::array<double, 3> high) {
    OwnedSurface s;
    for (int i = 0; i < 8; ++i) {
        s.vertex((i & 4) != 0 ? high[0] : low[0], (i & 2) != 0 ? high[1] : low[1],
                 (i & 1) != 0 ? high[2] : low[2]);
    }
    for (const auto& q : std::vector<std::array<int, 4>>{
             {0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}) {
        s.triangle(q[0], q[1], q[2]);
        s.triangle(q[0], q[2], q[3]);
    }
    return s;
}

inline CellComplex build(const std::vector<OwnedSurface>& surfaces,
                         std::optional<double> base = std::nullopt, int threads = 1) {
    StackInput input;
    for (const OwnedSurface& s : surfaces)
        input.surfaces.push_back(s.view());
    input.base_elevation = base;
    return build_stack(input, {threads, nullptr});
}

/// The validity that docs/dev/geometry.md promises: cells closed, vertices distinct and in use, no
/// face with a vertex twice. With `blocks`, an edge may be used more than twice, as often either
/// way.
inline void expect_valid(const CellComplex& c, bool blocks = false) {
    ASSERT_EQ(c.face_offsets.size(), c.face_cells.size() + 1);
    ASSERT_EQ(c.face_surface.size(), c.face_cells.size());
    std::set<std::array<double, 3>> positions(c.vertices.begin(), c.vertices.end());
    EXPECT_EQ(positions.size(), c.vertices.size()) << "equal vertices";
    std::vector<bool> used(c.vertices.size(), false);
    std::map<std::tuple<std::int32_t, std::int32_t, std::int32_t>, std::pair<int, int>> edges;
    std::vector<bool> has_faces(c.cell_block.size(), false);
    for (std::size_t f = 0; f < c.face_cells.size(); ++f) {
        const auto begin = static_cast<std::size_t>(c.face_offsets[f]);
        const auto end = static_cast<std::size_t>(c.face_offsets[f + 1]);
        ASSERT_GE(end - begin, 3u);
        const std::set<std::int32_t> distinct(c.face_vertices.begin() + c.face_offsets[f],
                                              c.face_vertices.begin() + c.face_offsets[f + 1]);
        EXPECT_EQ(distinct.size(), end - begin) << "face " << f << " repeats a vertex";
        ASSERT_GE(c.face_cells[f][0], 0);
        ASSERT_NE(c.face_cells[f][0], c.face_cells[f][1]);
        for (std::size_t i = begin; i < end; ++i) {
            const std::int32_t a = c.face_vertices[i];
            const std::int32_t b = c.face_vertices[i + 1 < end ? i + 1 : begin];
            used[static_cast<std::size_t>(a)] = true;
            for (std::size_t side = 0; side < 2; ++side) {
                const std::int32_t cell = c.face_cells[f][side];
                if (cell < 0) continue;
                has_faces[static_cast<std::size_t>(cell)] = true;
                auto& uses = edges[{cell, std::min(a, b), std::max(a, b)}];
                ((a < b) == (side == 0) ? uses.first : uses.second) += 1;
            }
        }
    }
    for (const auto& [edge, uses] : edges) {
        EXPECT_EQ(uses.first, uses.second) << "cell " << std::get<0>(edge) << " is open";
        if (blocks) continue;
        EXPECT_EQ(uses.first, 1) << "cell " << std::get<0>(edge) << " touches itself";
    }
    EXPECT_TRUE(std::all_of(used.begin(), used.end(), [](bool u) { return u; }));
    EXPECT_TRUE(std::all_of(has_faces.begin(), has_faces.end(), [](bool u) { return u; }));
}

inline std::vector<int> cells_of_blocks(const CellComplex& c) {
    std::vector<int> count(c.volumes.size(), 0);
    for (const std::int32_t block : c.cell_block)
        ++count[static_cast<std::size_t>(block)];
    return count;
}

}  // namespace realmodel::strata
