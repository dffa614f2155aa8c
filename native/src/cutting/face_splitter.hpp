// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "cutting/edge_intersections.hpp"
#include "cutting/polygons.hpp"

namespace realmodel::cutting {

/// Parts of one face, each on one side of the plane.
struct SplitFace {
    Polygons polygons;  ///< turning as the face does
    std::vector<std::int8_t> sides;

    void clear() {
        polygons.clear();
        sides.clear();
    }
};

/// Divides faces that have corners on both sides of a plane.
///
/// Most faces change sides twice: the line between the two points divides them. Others (walls need
/// not be convex) are divided as their triangulation is, and the parts of the triangles joined
/// again: which points a cut joins follows from the triangles alone, so that the parts fit together
/// whatever rounding did to the face.
class FaceSplitter {
public:
    FaceSplitter(const ComplexView& model, const std::vector<std::int8_t>& sides,
                 const EdgeIntersections& cuts)
        : model_(model), sides_(sides), cuts_(cuts) {}

    void split(std::span<const NodeId> face, SplitFace& parts);

private:
    struct TrianglePart;
    class Cuts;

    void split_triangle(const std::array<LoopCorner, 3>& t, const Cuts& cuts,
                        std::vector<TrianglePart>& parts) const;
    bool split_in_two(std::span<const NodeId> face, SplitFace& parts);
    void split_by_triangles(std::span<const NodeId> face, SplitFace& parts);
    std::int8_t side(NodeId v) const { return sides_[index(v)]; }

    const ComplexView& model_;
    const std::vector<std::int8_t>& sides_;
    const EdgeIntersections& cuts_;
    std::vector<NodeId> cycle_;
};

}  // namespace realmodel::cutting
