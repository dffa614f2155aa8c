// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "strata/conform/collinear_edges.hpp"

namespace realmodel::strata {

/// A vertex on an edge that has no entry for it: it follows a given entry.
struct InsertedVertex {
    std::uint32_t entry;
    std::int32_t vertex;
};

/// The faces with every vertex that lies on their edges put in, and all vertices: on each plan
/// vertex one for each height that a corner or an edge needs there, ascending.
struct ConformedFaces {
    Array<std::uint32_t> face_offsets;  ///< entries of each face
    CornerOffsets entries;              ///< of each corner
    /// Of each entry, counter-clockwise in plan; -1 where an edge passes a plan vertex tentatively
    /// and nothing else is as high there.
    Array<std::int32_t> vertices;
    std::vector<InsertedVertex> inserted;  ///< in order of entries
    Array<std::int32_t> vertex_offsets;    ///< first vertex of each plan vertex
    /// Of the vertices, for so many plan vertices each: rounded, those of a plan vertex all
    /// different.
    std::vector<std::vector<double>> heights;
    static constexpr std::size_t kVerticesTogether = 1 << 11;
    Array<std::array<double, 3>> positions;  ///< empty until set_vertex_positions

    std::size_t plan_vertex_of(std::int32_t vertex) const {
        const auto next = std::upper_bound(vertex_offsets.begin(), vertex_offsets.end(), vertex);
        return static_cast<std::size_t>(next - vertex_offsets.begin()) - 1;
    }
};
/// Takes what it needs of the lines: what they have `passed` is given back, and their edges name
/// the first of their entries from here on.
/// @param points  the faces', to be given back as soon as entries have their plan vertices
ConformedFaces conform_faces(const exact::PlanArrangement& geometry, const FaceList& faces,
                             const PlanVertices& plan_vertices, CollinearEdges& collinear,
                             const Execution& execution, Array<PointId>* points = nullptr);

/// Points where the corners of conformed faces are.
Array<PointId> points_of_corners(const PlanVertices& plan_vertices, const ConformedFaces& conformed,
                                 const Execution& execution);

/// Gives the vertices their positions, which takes the heights.
void set_vertex_positions(const PlanVertices& plan_vertices, ConformedFaces& conformed,
                          const Execution& execution);

}  // namespace realmodel::strata
