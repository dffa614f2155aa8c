// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutting/edge_intersections.hpp"
#include "cutting/polygons.hpp"

namespace realmodel::cutting {

/// Orientations of nodes of a plane cut where they are exactly: the model's vertices, and the
/// points where the plane cuts its edges, whose coordinates are rational numbers.
class PlanePoints : public CornerTurns {
public:
    PlanePoints(const ComplexView& model, const exact::OrientedPlane& plane,
                const EdgeIntersections& cuts)
        : model_(model), plane_(plane), cuts_(cuts), view_(plane.normal()) {}

    const View& view() const { return view_; }
    Position rounded(NodeId node) const {
        return cuts_.contains(node) ? cuts_.position(node) : model_.vertex(node);
    }
    /// Which way a, b, c turn in the view.
    int operator()(const LoopCorner& a, const LoopCorner& b, const LoopCorner& c) const override;
    /// Which side of the plane of a, b, c has d: exact::orient3d.
    int tetrahedron(NodeId a, NodeId b, NodeId c, NodeId d) const;

private:
    exact::RationalPoint exact_point(NodeId node) const;
    double inexactness(NodeId node) const;

    const ComplexView& model_;
    const exact::OrientedPlane& plane_;
    const EdgeIntersections& cuts_;
    View view_;
};

}  // namespace realmodel::cutting
