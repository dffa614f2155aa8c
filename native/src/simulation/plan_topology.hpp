// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "meshing/flat_mesh.hpp"
#include "realmodel/simulation/layered_mesh.hpp"
#include "simulation/posts.hpp"

namespace realmodel::simulation {

/// The planar mesh that columns stand on, with the segments that its edges lie on, the rock mass of
/// each triangle and the posts of its nodes. Edge i of a triangle goes from its corner i to its
/// corner (i + 1) % 3.
class PlanTopology {
public:
    /// @param mesh  adapted first: adapt_plan()
    PlanTopology(const PlanLines& lines, meshing::PlanarMesh mesh);

    const meshing::FlatMesh& mesh() const { return mesh_; }
    meshing::PlanarMesh take_mesh() { return {std::move(mesh_.points), std::move(mesh_.corners)}; }
    std::size_t triangles() const { return mesh_.corners.size(); }
    std::size_t nodes() const { return mesh_.points.size(); }
    const std::array<std::int32_t, 3>& corners(std::size_t t) const { return mesh_.corners[t]; }
    const PlanPoint& point(std::int32_t node) const { return mesh_.points[index(node)]; }
    /// The same edge in the triangle beyond; none at the border.
    meshing::HalfEdge twin(std::size_t t, std::size_t edge) const { return mesh_.twins[t][edge]; }
    /// -1 at the border.
    std::int32_t neighbor(std::size_t t, std::size_t edge) const {
        return twin(t, edge).triangle();
    }
    /// The segment that an edge lies on, or -1.
    std::int32_t segment(std::size_t t, std::size_t edge) const { return segment_[t][edge]; }
    /// Whether an edge lies between triangles whose heights may differ there.
    bool is_inner_step(std::size_t t, std::size_t edge) const {
        return is_step_[t][edge] && !twin(t, edge).is_none();
    }
    std::int32_t rock(std::size_t t) const { return rock_[t]; }

    std::size_t post(std::size_t t, std::size_t corner) const {
        return index(posts_.of_corner[3 * t + corner]);
    }
    /// The posts at both ends of an edge, as the triangle beyond has them.
    std::array<std::size_t, 2> posts_beyond(std::size_t t, std::size_t edge) const {
        const meshing::HalfEdge other = twin(t, edge);
        const auto own = [&](meshing::HalfEdge from) {
            return post(index(from.triangle()), index(from.index()));
        };
        return {own(other.next()), own(other)};
    }
    std::size_t post_count() const { return posts_.node.size(); }
    std::int32_t post_node(std::size_t post) const { return posts_.node[post]; }
    /// Posts::is_divided
    bool is_divided(std::int32_t node) const { return posts_.is_divided[index(node)] != 0; }

private:
    void spread_rocks(const PlanLines& lines);
    bool is_valid() const;

    meshing::FlatMesh mesh_;
    std::vector<std::array<std::int32_t, 3>> segment_;
    std::vector<std::array<bool, 3>> is_step_;
    std::vector<std::int32_t> rock_;
    Posts posts_;
};

}  // namespace realmodel::simulation
