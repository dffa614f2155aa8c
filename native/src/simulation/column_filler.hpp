// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/progress.hpp"
#include "realmodel/simulation/layered_mesh.hpp"
#include "simulation/column_fronts.hpp"
#include "simulation/column_heights.hpp"
#include "simulation/plan_topology.hpp"
#include "simulation/post_levels.hpp"
#include "simulation/vertical_faults.hpp"

namespace realmodel::simulation {

/// Fills the columns of all triangles from the bottom up. A front, one height at each corner, moves
/// up step by step; what lies between two fronts is an element. All three corners move by one
/// height each: a prism; two: a pyramid; one: a tetrahedron. Corners of elements are numbers of
/// heights (PostLevels::node_offset); faces between the columns of a step follow by finish_steps().
class ColumnFiller {
public:
    ColumnFiller(const PlanTopology& plan, const RockBlocks& blocks, const ColumnHeights& columns,
                 const PostLevels& levels, LayeredMesh& mesh, Progress* progress);

    /// Faces on steps that only one side has belong to the outside; of those that both have only
    /// those on faults are faces of the mesh.
    void finish_steps(const VerticalFaults& faults);

    const ColumnFronts& fronts() const { return made_; }

private:
    struct SideFace {
        std::array<std::int32_t, 4> key, corners;  // of a triangle the last corner is -1
        std::size_t number;
        std::array<PlanPoint, 2> edge;
        double height;  ///< of its center
        std::int32_t surface;
    };

    void find_parted();
    bool is_parted(std::size_t corner, std::size_t layer) const {
        return is_parted_[levels_.level_offset(post_[corner]) + layer] != 0;
    }
    bool load(std::size_t t);
    void find_step();
    void fill(std::size_t t);
    void pass_lines(const Front& top);
    void move(const Front& to);
    void advance(const Front& to);
    void add_element(const Front& to);
    void add_sides(const Front& to);
    void add_flat_face(std::int32_t next);
    void add_face(const std::array<std::int32_t, 4>& corners, std::int32_t surface);
    std::int32_t surface_between(std::int32_t below, std::int32_t above) const;
    Front points(const Front& front) const;
    double height(std::size_t corner, std::int32_t at) const {
        return levels_.heights(node_[corner])[index(at)];
    }
    template <std::size_t N>
    void add(LayeredMesh::Elements<N>& elements, const std::array<std::int32_t, N>& corners);

    const PlanTopology& plan_;
    const RockBlocks& blocks_;
    const ColumnHeights& columns_;
    const PostLevels& levels_;
    LayeredMesh& mesh_;
    ColumnFronts made_;
    std::vector<SideFace> step_faces_;
    std::vector<std::uint8_t> is_parted_;  ///< of each layer of each post: find_parted()

    // of the triangle whose column is filled
    std::size_t t_ = 0;
    std::int32_t rock_ = -1, block_ = -1, last_block_ = -1, layer_ = 0;
    std::array<std::size_t, 3> post_{};
    std::array<std::int32_t, 3> node_{};
    std::array<std::span<const std::int32_t>, 3> own_;  ///< the levels of its posts
    Front front_{};
    bool has_step_ = false;
    std::array<std::size_t, 2> step_{};               ///< the corners of its edge on a step
    std::vector<std::array<std::int32_t, 2>> lines_;  ///< the levels of the other side there
};

}  // namespace realmodel::simulation
