// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/edge_intersections.hpp"

#include <algorithm>
#include <cmath>

#include "base/keep_single.hpp"
#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

exact::OrientedPlane checked_plane(const Plane& plane) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (!std::isfinite(plane.point[k]) || !std::isfinite(plane.normal[k]))
            throw InputError("not_finite", "the plane's point and normal must be finite numbers");
    }
    if (plane.normal == Position{0, 0, 0})
        throw InputError("bad_plane", "the plane's normal is zero");
    return {plane.point, plane.normal};
}

std::vector<std::int8_t> vertex_sides(const ComplexView& model, const exact::OrientedPlane& plane,
                                      const Execution& execution) {
    std::vector<std::int8_t> sides(model.vertex_count());
    parallel_ranges(sides.size(), 1 << 14, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            sides[v] = plane.side(model.vertex(static_cast<NodeId>(v)));
    });
    return sides;
}

EdgeIntersections::EdgeIntersections(const ComplexView& model, const exact::OrientedPlane& plane,
                                     std::vector<std::array<NodeId, 2>> edges)
    : first_(static_cast<NodeId>(model.vertex_count())), edges_(std::move(edges)) {
    sort_unique(edges_);
    checked_number(model.vertex_count() + edges_.size(), "vertices and cut edges");
    positions_.reserve(edges_.size());
    for (const auto& [a, b] : edges_)
        positions_.push_back(plane.intersection(model.vertex(a), model.vertex(b)));
}

NodeId EdgeIntersections::node(NodeId a, NodeId b) const {
    const std::array<NodeId, 2> edge = unordered(a, b);
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), edge);
    assert(found != edges_.end() && *found == edge);
    return first_ + static_cast<NodeId>(found - edges_.begin());
}

}  // namespace realmodel::cutting
