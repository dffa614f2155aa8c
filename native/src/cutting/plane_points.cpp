// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/plane_points.hpp"

#include <algorithm>
#include <cmath>

#include "exact/sign_filters.hpp"

namespace realmodel::cutting {

exact::RationalPoint PlanePoints::exact_point(NodeId node) const {
    if (cuts_.contains(node)) {
        const auto& [a, b] = cuts_.edge(node);
        return plane_.exact_intersection(model_.vertex(a), model_.vertex(b));
    }
    const Position p = model_.vertex(node);
    return {mpq_class(p[0]), mpq_class(p[1]), mpq_class(p[2])};
}

/// How far differences of a node's coordinates may be from the true ones, as that of
/// exact::SpacePoints: cut edges' positions are the nearest doubles.
double PlanePoints::inexactness(NodeId node) const {
    if (!cuts_.contains(node)) return 0;
    double largest = 0;
    for (const double x : cuts_.position(node))
        largest = std::max(largest, std::abs(x));
    return exact::inexactness_of_rounding(largest);
}

int PlanePoints::operator()(const LoopCorner& a, const LoopCorner& b, const LoopCorner& c) const {
    if (a.node == b.node || b.node == c.node || a.node == c.node) return 0;
    const double off = std::max({inexactness(a.node), inexactness(b.node), inexactness(c.node)});
    if (const auto sign = exact::orient2d_filter(a.at, b.at, c.at, off)) return *sign;
    const exact::RationalPoint o = exact_point(a.node);
    return view_.sign() * sgn(exact::cross(exact::minus(exact_point(b.node), o),
                                           exact::minus(exact_point(c.node), o), view_.axis()));
}

int PlanePoints::tetrahedron(NodeId a, NodeId b, NodeId c, NodeId d) const {
    const double off = std::max({inexactness(a), inexactness(b), inexactness(c), inexactness(d)});
    if (const auto sign =
            exact::orient3d_filter(rounded(a), rounded(b), rounded(c), rounded(d), off))
        return *sign;
    const exact::RationalPoint o = exact_point(a);
    const auto from_a = [&](NodeId node) { return exact::minus(exact_point(node), o); };
    return sgn(exact::determinant(from_a(b), from_a(c), from_a(d)));
}

}  // namespace realmodel::cutting
