// SPDX-License-Identifier: GPL-3.0-or-later
// A vertical section between two points: the section of the whole plane, cut off at both ends.
#include <algorithm>
#include <map>
#include <utility>

#include "cutting/edge_intersections.hpp"
#include "cutting/polygons.hpp"

namespace realmodel::cutting {

namespace {

/// The part of a section above a plane. Convex polygons stay convex and in one piece (I. E.
/// Sutherland and G. W. Hodgman 1974); neighbors are cut in the same points.
class SectionClip {
public:
    SectionClip(const Section& section, const exact::OrientedPlane& plane)
        : section_(section), plane_(plane), number_(section.vertices.size(), -1) {}

    Section above() {
        for (const Position& p : section_.vertices)
            sides_.push_back(plane_.side(p));
        std::vector<NodeId> polygon;
        for (std::size_t k = 0; k < section_.cells.size(); ++k) {
            const auto begin = static_cast<std::size_t>(section_.offsets[k]);
            const auto end = static_cast<std::size_t>(section_.offsets[k + 1]);
            polygon.clear();
            bool any = false;
            for (std::size_t i = begin; i < end; ++i) {
                const NodeId a = section_.polygon_vertices[i];
                const NodeId b = section_.polygon_vertices[i + 1 < end ? i + 1 : begin];
                any = any || side(a) == kAbove;
                if (side(a) != kBelow) polygon.push_back(kept(a));
                if (side(a) * side(b) < 0) polygon.push_back(intersection(a, b));
            }
            if (!any || polygon.size() < 3) continue;
            result_.polygon_vertices.insert(result_.polygon_vertices.end(), polygon.begin(),
                                            polygon.end());
            result_.offsets.push_back(static_cast<std::int64_t>(result_.polygon_vertices.size()));
            result_.cells.push_back(section_.cells[k]);
        }
        drop_unused();
        return std::move(result_);
    }

private:
    std::int8_t side(NodeId v) const { return sides_[index(v)]; }

    NodeId add(const Position& p) {
        result_.vertices.push_back(p);
        return static_cast<NodeId>(result_.vertices.size()) - 1;
    }
    NodeId kept(NodeId v) {
        NodeId& number = number_[index(v)];
        if (number < 0) number = add(section_.vertices[index(v)]);
        return number;
    }
    NodeId intersection(NodeId a, NodeId b) {
        const auto [found, is_new] =
            intersections_.try_emplace(std::pair(std::min(a, b), std::max(a, b)), -1);
        if (is_new) {
            found->second = add(plane_.intersection(section_.vertices[index(found->first.first)],
                                                    section_.vertices[index(found->first.second)]));
        }
        return found->second;
    }
    /// Nodes of polygons that merely touch the plane.
    void drop_unused() {
        std::vector<NodeId> renumbered(result_.vertices.size(), -1);
        Array<Position> used;
        for (NodeId& v : result_.polygon_vertices) {
            NodeId& number = renumbered[index(v)];
            if (number < 0) {
                number = static_cast<NodeId>(used.size());
                used.push_back(result_.vertices[index(v)]);
            }
            v = number;
        }
        result_.vertices = std::move(used);
    }

    const Section& section_;
    const exact::OrientedPlane& plane_;
    std::vector<std::int8_t> sides_;
    std::vector<NodeId> number_;
    std::map<std::pair<NodeId, NodeId>, NodeId> intersections_;
    Section result_;
};

}  // namespace

Section fence_panel(const ComplexView& model, const std::array<double, 2>& start,
                    const std::array<double, 2>& end, const Execution& execution) {
    const double dx = end[0] - start[0], dy = end[1] - start[1];
    const Position first{start[0], start[1], 0}, last{end[0], end[1], 0};
    const Section whole = section_by_plane(model, {first, {dy, -dx, 0}}, execution);
    const Section begun = SectionClip(whole, checked_plane({first, {dx, dy, 0}})).above();
    return SectionClip(begun, checked_plane({last, {-dx, -dy, 0}})).above();
}

}  // namespace realmodel::cutting
