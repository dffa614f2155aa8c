// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "strata/overlay/envelope.hpp"

namespace realmodel::strata {

/// Faces between cells, small enough to be counted by hand: triangles over five vertices. On the
/// line x = 0 lie 0, 1 and 2 at y = 0, 1 and 2; 3 is at (-1, 1), 4 at (1, 1.5).
struct SmallFaces {
    static constexpr std::array<std::array<double, 2>, 5> kPosition{
        {{0, 0}, {0, 1}, {0, 2}, {-1, 1}, {1, 1.5}}};

    /// @param levels  the heights at which there may be triangles
    explicit SmallFaces(const std::vector<double>& levels) {
        for (const auto& [x, y] : kPosition)
            vertex.push_back(geometry.add_vertex(x, y));
        for (const double z : levels) {
            space.emplace_back();
            for (const exact::VertexId v : vertex)
                space.back().push_back(geometry.add_space_vertex(v, z));
        }
        geometry.freeze_vertices();
    }

    /// Adds a triangle, counter-clockwise in plan.
    /// @return its face
    std::size_t add(std::size_t level, const std::array<std::size_t, 3>& corner,
                    std::int32_t cell_above, std::int32_t cell_below) {
        Polygon outline;
        for (std::size_t i = 0; i < 3; ++i) {
            const exact::VertexId from = vertex[corner[i]], to = vertex[corner[(i + 1) % 3]];
            outline.push_back({from, geometry.add_edge(from, to)});
        }
        const auto& at = space[level];
        const PlaneId plane = geometry.add_plane({at[corner[0]], at[corner[1]], at[corner[2]]});
        faces.add(outline, plane, static_cast<std::int32_t>(level), cell_above, cell_below);
        return faces.size() - 1;
    }

    /// One triangle left of the line, two right of it: the corner 1 of these is a T-vertex.
    void add_t_junction() {
        add(0, {3, 0, 2}, 0, kOutsideCell);
        add(0, {0, 4, 1}, 1, kOutsideCell);
        add(0, {1, 4, 2}, 1, kOutsideCell);
    }

    /// Two cells side by side between the levels 0 and 1: left of the line 0, right of it 1.
    void add_two_columns() {
        add(1, {3, 0, 2}, kOutsideCell, 0);
        add(1, {0, 4, 2}, kOutsideCell, 1);
        add(0, {3, 0, 2}, 0, kOutsideCell);
        add(0, {0, 4, 2}, 1, kOutsideCell);
    }

    LineId line(std::size_t from, std::size_t to) {
        return geometry.add_edge(vertex[from], vertex[to]).id();
    }

    exact::PlanArrangement geometry;
    std::vector<exact::VertexId> vertex;
    std::vector<std::vector<exact::SpaceId>> space;  ///< of each level
    FaceList faces;
};

}  // namespace realmodel::strata
