// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/plane_points.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::cutting {

PlanePoints::Fractions PlanePoints::exact(NodeId node) const {
    const auto fractions = [this](NodeId v) {
        const Position p = model_.vertex(v);
        return Fractions{mpq_class(p[0]), mpq_class(p[1]), mpq_class(p[2])};
    };
    if (!crossings_.is_crossing(node)) return fractions(node);
    const auto& edge = crossings_.edge(index(node - crossings_.first_node()));
    Fractions a = fractions(edge[0]);
    const Fractions b = fractions(edge[1]);
    const mpq_class from = distance_.exact(model_.vertex(edge[0]));
    const mpq_class share = from / (from - distance_.exact(model_.vertex(edge[1])));
    for (std::size_t k = 0; k < 3; ++k)
        a[k] += share * (b[k] - a[k]);
    return a;
}

/// How far a node's doubles may be from where it is.
double PlanePoints::slack(NodeId node) const {
    if (!crossings_.is_crossing(node)) return 0;
    double largest = 0;
    for (const double x : rounded(node))
        largest = std::max(largest, std::abs(x));
    return 0x1p-50 * largest;  // rounded once, perhaps moved by a unit or two
}

int PlanePoints::operator()(const LoopCorner& a, const LoopCorner& b, const LoopCorner& c) const {
    if (a.node == b.node || b.node == c.node || a.node == c.node) return 0;
    const double ux = b.at[0] - a.at[0], uy = b.at[1] - a.at[1];
    const double vx = c.at[0] - a.at[0], vy = c.at[1] - a.at[1];
    const double left = ux * vy, right = uy * vx;
    const double largest = std::max({std::abs(ux), std::abs(uy), std::abs(vx), std::abs(vy)});
    const double off = std::max({slack(a.node), slack(b.node), slack(c.node)});
    const double error =
        0x1p-49 * (std::abs(left) + std::abs(right)) + 16 * off * (largest + off) + 1e-280;
    if (left - right > error) return 1;
    if (left - right < -error) return -1;
    const Fractions o = exact(a.node), p = exact(b.node), q = exact(c.node);
    const std::size_t k = (view_.axis() + 1) % 3, l = (view_.axis() + 2) % 3;
    const mpq_class turned = (p[k] - o[k]) * (q[l] - o[l]) - (p[l] - o[l]) * (q[k] - o[k]);
    return view_.sign() * sgn(turned);
}

int PlanePoints::tetrahedron(NodeId a, NodeId b, NodeId c, NodeId d) const {
    const Fractions o = exact(a), p = exact(b), q = exact(c), r = exact(d);
    mpq_class sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
        sum += (p[k] - o[k]) * ((q[l] - o[l]) * (r[m] - o[m]) - (q[m] - o[m]) * (r[l] - o[l]));
    }
    return sgn(sum);
}

}  // namespace realmodel::cutting
