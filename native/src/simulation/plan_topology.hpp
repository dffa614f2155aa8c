// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "meshing/flat_mesh.hpp"
#include "realmodel/simulation/layered_mesh.hpp"

namespace realmodel::simulation {

/// Which edges of a planar mesh lie on the lines of a model. Edges are named by their nodes, so
/// flips of other edges change nothing.
class LineEdges {
public:
    /// @throws InputError kind bad_index (items: the segment; place) where the mesh lacks the end
    /// of a segment
    LineEdges(const PlanLines& lines, const meshing::FlatMesh& mesh);

    /// The segment that the edge between two nodes lies on, or -1.
    std::int32_t segment(std::int32_t a, std::int32_t b) const {
        if (!is_on_line(a) || !is_on_line(b)) return -1;
        const auto segment = segments_.find(unordered(a, b));
        return segment == segments_.end() ? -1 : segment->second;
    }
    /// Whether an edge lies between triangles whose heights may differ there.
    bool is_step(std::int32_t a, std::int32_t b) const {
        const std::int32_t line = segment(a, b);
        return line >= 0 && lines_->segments[index(line)].is_step;
    }
    /// A node was added, which divides an edge.
    void divide(std::int32_t a, std::int32_t b, std::int32_t middle);

private:
    bool is_on_line(std::int32_t node) const {
        return index(node) < is_on_line_.size() && is_on_line_[index(node)];
    }

    const PlanLines* lines_;
    std::map<std::array<std::int32_t, 2>, std::int32_t> segments_;
    std::vector<bool> is_on_line_;  ///< of each node, or of the first
};

/// Steps, and the border where it touches itself, divide the surroundings of a node into sectors.
/// Each sector has a pillar.
struct Pillars {
    std::vector<std::int32_t> of_corner;  ///< 3 a triangle
    std::vector<std::int32_t> node;       ///< of each pillar
    /// Of each node: whether it may have heights that are not of all its triangles. It is an end of
    /// an edge on a step with triangles on both sides, or has several pillars.
    std::vector<std::uint8_t> is_divided;

    Pillars() = default;
    Pillars(const meshing::FlatMesh& mesh, const LineEdges& edges);
};

/// Makes a planar mesh fit for columns, in this order:
/// 1. Border triangles with two edges outside are divided: an element there would have neighbors in
///    one direction only.
/// 2. Triangles that steps bound are divided until each has at most one edge on a step, and the
///    corner across from it has one pillar.
/// 3. Sharp angles, which the first two leave behind, are made larger by flips and moves of nodes
///    that are on no line, and where that is not enough by dividing edges on lines.
void adapt_plan(meshing::FlatMesh& mesh, LineEdges& edges);

/// The planar mesh that columns stand on, with the segments that its edges lie on, the rock mass of
/// each triangle and the pillars of its nodes. Edge i of a triangle goes from its corner i to its
/// corner (i + 1) % 3.
class PlanTopology {
public:
    /// @param mesh  adapted first: adapt_plan()
    PlanTopology(const PlanLines& lines, meshing::PlanarMesh mesh);

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

    Buckets<std::int32_t> triangles_at_nodes() const;

    std::size_t pillar(std::size_t t, std::size_t corner) const {
        return index(pillars_.of_corner[3 * t + corner]);
    }
    /// The pillars at both ends of an edge, as the triangle beyond has them.
    std::array<std::size_t, 2> pillars_beyond(std::size_t t, std::size_t edge) const {
        const meshing::HalfEdge other = twin(t, edge);
        const auto pillar_at = [&](meshing::HalfEdge from) {
            return pillar(index(from.triangle()), index(from.index()));
        };
        return {pillar_at(other.next()), pillar_at(other)};
    }
    std::size_t pillar_count() const { return pillars_.node.size(); }
    std::int32_t pillar_node(std::size_t pillar) const { return pillars_.node[pillar]; }
    /// Pillars::is_divided
    bool is_divided(std::int32_t node) const { return pillars_.is_divided[index(node)] != 0; }

private:
    void spread_rocks(const PlanLines& lines);
    bool is_valid() const;

    meshing::FlatMesh mesh_;
    std::vector<std::array<std::int32_t, 3>> segment_;
    std::vector<std::array<bool, 3>> is_step_;
    std::vector<std::int32_t> rock_;
    Pillars pillars_;
};

}  // namespace realmodel::simulation
