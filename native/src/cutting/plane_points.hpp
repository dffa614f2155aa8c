// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include "cutting/plane_sides.hpp"
#include "cutting/triangulate.hpp"

namespace realmodel::cutting {

/// Turns and volumes of nodes of a plane cut where they are exactly: the model's vertices, and the
/// places where the plane cuts its edges, which are fractions. Floating point first, with a bound
/// of what rounding can do to it.
class PlanePoints : public CornerTurns {
public:
    PlanePoints(const ComplexView& model, const PlaneDistance& distance, const Crossings& crossings)
        : model_(model), distance_(distance), crossings_(crossings), view_(distance.normal()) {}

    const View& view() const { return view_; }
    Position rounded(NodeId node) const {
        return crossings_.is_crossing(node)
                   ? crossings_.position(index(node - crossings_.first_node()))
                   : model_.vertex(node);
    }
    int operator()(const LoopCorner& a, const LoopCorner& b, const LoopCorner& c) const override;
    /// The sign of the volume of the tetrahedron a, b, c, d.
    int tetrahedron(NodeId a, NodeId b, NodeId c, NodeId d) const;

private:
    using Fractions = std::array<mpq_class, 3>;
    Fractions exact(NodeId node) const;
    double slack(NodeId node) const;

    const ComplexView& model_;
    const PlaneDistance& distance_;
    const Crossings& crossings_;
    View view_;
};

}  // namespace realmodel::cutting
