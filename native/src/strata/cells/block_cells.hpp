// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "realmodel/strata/stack.hpp"
#include "strata/conform/conformed_faces.hpp"
#include "strata/conform/walls.hpp"
#include "strata/overlay/whole_triangles.hpp"

namespace realmodel::strata {

/// Joins nodes of one block that links, or whole triangles in common, join: on either side of a
/// whole triangle a block is thick along every edge, as bounds or the overlay found.
/// @param cell_block  filled with the block of each cell; cells are numbered in order of their
/// first
///     node
/// @return the cell of each node
std::vector<std::int32_t> cells_of_nodes(const Construction& construction,
                                         const TriangleLinks& links, const WholeTriangles& wholes,
                                         Array<std::int32_t>& cell_block,
                                         const Execution& execution);

/// Walls, and the new number of each vertex; -1 of those that are gone.
struct JoinedWalls {
    WallBatch walls;
    std::vector<std::int32_t> number;
};

/// Walls between cells from their stretches: those that go on without a change are joined, and only
/// vertices that faces or ends of walls need are kept. Afterwards the vertices of the conformed
/// faces and their positions are those that are left.
/// @param cell_of_node  of the nodes that stretches name
/// @param crossings  where heights of two columns cross, no face has a corner
JoinedWalls join_stretches(std::span<const WallStretch> stretches,
                           const std::vector<std::int32_t>& cell_of_node, const FaceList& faces,
                           std::span<const ExtraPoint> crossings, const PlanVertices& plan_vertices,
                           ConformedFaces& conformed, const Execution& execution);

/// Adds the whole triangles on whose edges vertices may lie to the faces that are conformed: those
/// looked at exactly, and the neighbors of divided ones. The others are touched by nothing.
void add_touched_triangles(exact::PlanArrangement& geometry, const TriangleLinks& links,
                           WholeTriangles& wholes, FaceList& faces, const Execution& execution);

/// The whole triangles that are taken as they are.
class UntouchedTriangles {
public:
    /// Finds the vertices that the conformed faces have of them; `conformed` are not needed
    /// afterwards.
    UntouchedTriangles(const exact::PlanArrangement& geometry, const WholeTriangles& wholes,
                       const std::vector<std::int32_t>& surface_of_plane, const FaceList& faces,
                       const ConformedFaces& conformed, const Execution& execution);

    /// Adds them as faces, and the vertices that only they have.
    void add_to(CellComplex& complex, const std::vector<std::int32_t>& cell_of_node);

private:
    bool is_face(std::size_t plane) const {
        return wholes_.is_added[plane] == 0 && wholes_.face[plane].is_face();
    }
    void number_vertices(CellComplex& complex);
    void add_triangles(CellComplex& complex, const std::vector<std::int32_t>& cell_of_node) const;
    void add_bases(CellComplex& complex, const std::vector<std::int32_t>& cell_of_node);

    const exact::PlanArrangement& geometry_;
    const WholeTriangles& wholes_;
    const std::vector<std::int32_t>& surface_of_plane_;
    Execution execution_;
    std::vector<std::int32_t> of_space_;  ///< vertex of each space vertex, -1 where there is none
    std::vector<std::int32_t> of_base_;   ///< the same on flat bases, of each plan vertex
};

}  // namespace realmodel::strata
