// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "realmodel/simulation/layered_mesh.hpp"

namespace realmodel::simulation {

/// The planar mesh with what lies beside each triangle, and the segments that its edges lie on.
/// Edge i of a triangle goes from its corner i to its corner (i + 1) % 3.
class PlanTopology {
public:
    /// Border triangles with two edges outside are turned where that leaves no sharp angle, else
    /// divided: an element there would have neighbors in one direction only. Triangles that steps
    /// bound are divided until each has at most one edge on a step, and the corner across from it
    /// has one post. Sharp angles that are left from this are made better by turning edges and
    /// moving nodes.
    PlanTopology(const PlanLines& lines, meshing::PlanarMesh mesh);

    const meshing::PlanarMesh& mesh() const { return mesh_; }
    meshing::PlanarMesh&& take_mesh() { return std::move(mesh_); }
    std::size_t triangles() const { return mesh_.triangles.size(); }
    std::size_t nodes() const { return mesh_.vertices.size(); }
    std::int32_t node(std::size_t corner) const { return mesh_.triangles[corner / 3][corner % 3]; }
    std::int32_t neighbor(std::size_t t, std::size_t edge) const { return neighbor_[t][edge]; }
    /// The segment that an edge lies on, or -1.
    std::int32_t segment(std::size_t t, std::size_t edge) const { return segment_[t][edge]; }
    /// Whether an edge lies between triangles whose heights may differ there.
    bool is_step(std::size_t t, std::size_t edge) const;
    std::int32_t rock(std::size_t t) const { return rock_[t]; }

    /// The part of the surroundings of its node that each corner (3 a triangle) lies in, numbered
    /// from 0: parts are divided by steps.
    const std::vector<std::int32_t>& posts() const { return post_; }
    std::size_t post_count() const { return post_node_.size(); }
    std::int32_t post_node(std::size_t post) const { return post_node_[post]; }
    /// Whether a node may have heights that are not of all its triangles: it is an end of an edge
    /// on a step with triangles on both sides, or the region touches itself there.
    bool is_divided(std::int32_t node) const {
        return is_divided_[static_cast<std::size_t>(node)] != 0;
    }

private:
    void link();
    void mark_segments();
    void spread_rocks();
    void find_posts();
    bool turn_border_triangles();
    bool divide_between_steps();
    void refresh();
    void improve();
    void turn_and_move();
    bool divide_lines();
    bool turn_edges();
    std::int32_t corner_across(std::size_t t, std::int32_t a, std::int32_t b) const;
    bool has_border_corner(std::size_t t, std::size_t n, std::size_t i) const;
    bool move_nodes();
    std::vector<std::uint8_t> free_nodes() const;

    const PlanLines& lines_;
    meshing::PlanarMesh mesh_;
    std::vector<std::array<std::int32_t, 3>> neighbor_, segment_;
    std::vector<std::int32_t> rock_, post_, post_node_;
    std::vector<std::uint8_t> is_divided_;
};

}  // namespace realmodel::simulation
