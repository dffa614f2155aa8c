// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/face_splitter.hpp"

#include <algorithm>
#include <array>

#include "arrangement/joined_polygons.hpp"
#include "cutting/cutter_surface.hpp"

namespace realmodel::cutting {

/// A part of a triangle on one side of the plane. Its edges are those of the triangle, or the cut.
struct FaceSplitter::TrianglePart {
    std::vector<NodeId> nodes;
    std::int8_t side = kOn;
};

/// Nodes where the plane cuts the edges of a face's triangles. Those of diagonals are negative
/// numbers, for no one else knows them.
class FaceSplitter::Cuts {
public:
    Cuts(std::span<const NodeId> face, std::span<const std::array<LoopCorner, 3>> triangles,
         const EdgeIntersections& of_edges)
        : of_edges_(of_edges) {
        for (std::size_t i = 0; i < face.size(); ++i)
            border_.push_back(unordered(face[i], face[(i + 1) % face.size()]));
        for (const auto& t : triangles) {
            for (std::size_t i = 0; i < 3; ++i)
                edges_.push_back(unordered(t[i].node, t[(i + 1) % 3].node));
        }
        std::sort(border_.begin(), border_.end());
        std::sort(edges_.begin(), edges_.end());
    }
    NodeId node(NodeId a, NodeId b) const {
        if (std::binary_search(border_.begin(), border_.end(), unordered(a, b)))
            return of_edges_.node(a, b);
        const auto at = std::lower_bound(edges_.begin(), edges_.end(), unordered(a, b));
        return static_cast<NodeId>(-1 - (at - edges_.begin()));
    }

private:
    const EdgeIntersections& of_edges_;
    std::vector<std::array<NodeId, 2>> border_, edges_;
};

void FaceSplitter::split(std::span<const NodeId> face, SplitFace& parts) {
    if (!split_in_two(face, parts)) split_by_triangles(face, parts);
}

bool FaceSplitter::split_in_two(std::span<const NodeId> face, SplitFace& parts) {
    cycle_.clear();
    std::array<std::size_t, 2> on{};
    std::size_t found = 0;
    for (std::size_t i = 0; i < face.size(); ++i) {
        const NodeId a = face[i], b = face[i + 1 < face.size() ? i + 1 : 0];
        if (side(a) == kOn) {
            if (found == 2) return false;
            on[found++] = cycle_.size();
        }
        cycle_.push_back(a);
        if (side(a) * side(b) < 0) {
            if (found == 2) return false;
            on[found++] = cycle_.size();
            cycle_.push_back(cuts_.node(a, b));
        }
    }
    if (found != 2 || on[1] - on[0] < 2 || on[0] + cycle_.size() - on[1] < 2) return false;
    const auto side_after = [&](std::size_t i) { return side(cycle_[(i + 1) % cycle_.size()]); };
    for (const auto& [from, to] : {std::pair(on[0], on[1]), std::pair(on[1], on[0])}) {
        parts.sides.push_back(side_after(from));
        for (std::size_t i = from;; i = (i + 1) % cycle_.size()) {
            parts.polygons.nodes.push_back(cycle_[i]);
            if (i == to) break;
        }
        parts.polygons.close();
    }
    return true;
}

/// The parts of a triangle above the plane and below it; the whole of it where it lies in the
/// plane.
void FaceSplitter::split_triangle(const std::array<LoopCorner, 3>& t, const Cuts& cuts,
                                  std::vector<TrianglePart>& parts) const {
    TrianglePart above{{}, kAbove}, below{{}, kBelow}, level{{}, kOn};
    bool has_above = false, has_below = false;
    for (std::size_t i = 0; i < 3; ++i) {
        const NodeId a = t[i].node, b = t[(i + 1) % 3].node;
        level.nodes.push_back(a);
        if (side(a) >= 0) above.nodes.push_back(a);
        if (side(a) <= 0) below.nodes.push_back(a);
        has_above = has_above || side(a) > 0;
        has_below = has_below || side(a) < 0;
        if (side(a) * side(b) < 0) {
            const NodeId c = cuts.node(a, b);
            above.nodes.push_back(c);
            below.nodes.push_back(c);
        }
    }
    if (has_above) parts.push_back(std::move(above));
    if (has_below) parts.push_back(std::move(below));
    if (!has_above && !has_below) parts.push_back(std::move(level));
}

void FaceSplitter::split_by_triangles(std::span<const NodeId> face, SplitFace& parts) {
    const auto [loop, rounding] = loop_of(model_, face);
    std::vector<std::array<LoopCorner, 3>> triangles;
    triangulate(std::span(&loop, 1), rounding, triangles);
    const Cuts cuts(face, triangles, cuts_);
    std::vector<TrianglePart> pieces;
    for (const auto& t : triangles)
        split_triangle(t, cuts, pieces);

    // Parts are joined wherever they do not lie on different sides; those in the plane take the
    // side of a neighbor.
    arrangement::JoinedPolygons joined;
    for (std::size_t p = 0; p < pieces.size(); ++p)
        joined.add(pieces[p].nodes, static_cast<std::int32_t>(p));
    const auto side_of = [&pieces](std::int32_t p) -> std::int8_t& {
        return pieces[index(p)].side;
    };
    joined.pair(
        [&](const auto&, std::int32_t p, std::int32_t q) { return side_of(p) * side_of(q) >= 0; });
    for (bool changed = true; changed;) {
        changed = false;
        joined.each_pair([&](std::int32_t p, std::int32_t q) {
            if (side_of(p) != kOn || side_of(q) == kOn) return;
            side_of(p) = side_of(q);
            changed = true;
        });
    }
    joined.part([&](std::int32_t p, std::int32_t q) { return side_of(p) == side_of(q); });
    joined.each_outline([&](std::span<const arrangement::JoinedPolygons::HalfEdge> outline) {
        for (const auto& edge : outline) {
            if (edge.from >= 0) parts.polygons.nodes.push_back(edge.from);
        }
        parts.polygons.close();
        parts.sides.push_back(side_of(outline[0].polygon));
    });
}

}  // namespace realmodel::cutting
