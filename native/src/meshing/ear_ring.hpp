// SPDX-License-Identifier: GPL-3.0-or-later
// One ring of a polygon's outline with its holes joined to it, for ear clipping.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshing/flat_mesh.hpp"

namespace realmodel::meshing {

/// A corner in a ring, and the edge from it to the next.
struct EarNode {
    PlanPoint place;
    std::int32_t corner;
    std::int32_t previous, next;
    std::int32_t twin = -1;              ///< for a bridge: the node whose edge runs the other way
    HalfEdge behind = HalfEdge::none();  ///< what lies behind the edge, once it is known
    HalfEdge placed = HalfEdge::none();  ///< for a bridge: the edge that was made of its edge
};

/// The rings of a polygon, the outline counter-clockwise and holes clockwise, joined into one.
class EarRing {
public:
    /// Corners are numbered through the rings.
    explicit EarRing(std::span<const Ring> rings);

    /// Joins the holes to the outline. False where a bridge cannot be told from the rounding of
    /// what it has to pass.
    bool join_holes();

    std::vector<EarNode> nodes;
    std::int32_t first() const { return outline_; }
    const PlanPoint& place(std::int32_t node) const { return nodes[node].place; }
    /// Whether the way from a node towards a place begins inside of the ring. Exact.
    bool opens_towards(std::int32_t node, const PlanPoint& p) const;

private:
    std::int32_t add_ring(const Ring& ring, std::int32_t first_corner, bool is_outline);
    std::int32_t find_bridge(std::int32_t hole) const;
    void join(std::int32_t hole, std::int32_t outline);
    void enter_rows(std::int32_t node);
    std::size_t row_of(double y) const;

    std::int32_t outline_ = -1;
    std::vector<std::int32_t> holes_;  ///< a leftmost node of each
    // Nodes by the rows of the plan that their edges pass.
    std::vector<std::vector<std::int32_t>> rows_;
    double low_ = 0, row_height_ = 1;
};

}  // namespace realmodel::meshing
