// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "exact/local_arrangement.hpp"

// The formulas of plan lines, crossings and heights, written once for every kind of number. An
// `Arithmetic` gives differences of input coordinates in its number type: dx(v, o), dy(v, o) of
// plan vertices and dz(s, t) of space vertices. Differences first keep numbers short far from the
// origin.
namespace realmodel::exact {

template <class Number>
struct LineCoefficients {
    Number a, b, c;
};

/// X / W and Y / W are a position relative to an origin.
template <class Number>
struct Homogeneous {
    Number x, y, w;
};

template <class Number>
struct Normal {
    Number a, b, c;
};

template <class Number, class Arithmetic>
Normal<Number> plane_normal(const Arithmetic& in, const PlanArrangement& g, PlaneId id) {
    const auto& corner = g.plane(id).corner;
    const VertexId p0 = g.space(corner[0]).plan, p1 = g.space(corner[1]).plan,
                   p2 = g.space(corner[2]).plan;
    const Number ux = in.dx(p1, p0), uy = in.dy(p1, p0), uz = in.dz(corner[1], corner[0]);
    const Number vx = in.dx(p2, p0), vy = in.dy(p2, p0), vz = in.dz(corner[2], corner[0]);
    return {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
}

/// a x + b y + c of a line relative to the plan vertex `origin`.
template <class Number, class Arithmetic>
LineCoefficients<Number> line_coefficients(const Arithmetic& in, const PlanArrangement& g,
                                           const Line& line, VertexId origin) {
    if (line.is_edge()) {
        const auto [from, to] = line.ends();
        const Number a = in.dy(from, to), b = in.dx(to, from);
        const Number px = in.dx(from, origin), py = in.dy(from, origin);
        return {a, b, Number(-(a * px + b * py))};
    }
    // h(x, y) = -(A (x - x0) + B (y - y0)) / C + z0 for either plane; C is positive, so the sign of
    // the difference of heights is that of the difference of the numerators.
    const auto [first, second] = line.planes();
    const Normal<Number> p = plane_normal<Number>(in, g, first);
    const Normal<Number> q = plane_normal<Number>(in, g, second);
    const SpaceId sp = g.plane(first).corner[0], sq = g.plane(second).corner[0];
    const VertexId vp = g.space(sp).plan, vq = g.space(sq).plan;
    const Number offset_p = p.a * in.dx(vp, origin) + p.b * in.dy(vp, origin);
    const Number offset_q = q.a * in.dx(vq, origin) + q.b * in.dy(vq, origin);
    const Number rise = in.dz(sp, sq);
    return {Number(q.a * p.c - p.a * q.c), Number(q.b * p.c - p.b * q.c),
            Number(offset_p * q.c - offset_q * p.c + rise * (p.c * q.c))};
}

/// The crossing of two lines, relative to the origin that both are relative to.
template <class Number>
Homogeneous<Number> cross(const LineCoefficients<Number>& l, const LineCoefficients<Number>& m) {
    return {Number(l.b * m.c - m.b * l.c), Number(l.c * m.a - m.c * l.a),
            Number(l.a * m.b - m.a * l.b)};
}

/// A point of a scope relative to a plan vertex.
template <class Number, class Arithmetic>
Homogeneous<Number> position_of(const Arithmetic& in, const LocalArrangement& scope, PointId id,
                                VertexId origin) {
    if (scope.is_vertex(id)) {
        const VertexId v = scope.vertex(id);
        return {in.dx(v, origin), in.dy(v, origin), Number(1)};
    }
    const Point& p = scope.point(id);
    return cross(line_coefficients<Number>(in, scope.shared(), scope.line(p.first), origin),
                 line_coefficients<Number>(in, scope.shared(), scope.line(p.second), origin));
}

/// A plan vertex that a line starts from.
inline VertexId anchor(const PlanArrangement& g, const Line& line) {
    return line.is_edge() ? line.ends()[0] : g.space(g.plane(line.planes()[0]).corner[0]).plan;
}

}  // namespace realmodel::exact
