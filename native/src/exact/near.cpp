// SPDX-License-Identifier: GPL-3.0-or-later
#include "near.hpp"

#include <cfloat>
#include <cmath>
#include <utility>

namespace realmodel::exact {

namespace {

using Extended = long double;

/// Bound on the relative error of one operation: 2^-64, and a little for the bounds' own rounding.
/// The exponents of extended numbers are so wide that nothing made of a few doubles leaves them.
constexpr Extended kUnit = 0x1.001p-64L;

/// Whether operations round to 64 bits here, as they may not under an emulator or where another
/// library changed the precision.
bool is_extended() {
    if constexpr (LDBL_MANT_DIG != 64) return false;
    volatile Extended one = 1.0L, small = 0x1p-63L;
    volatile Extended sum = one + small;
    return sum != one;
}
const bool kExtended = is_extended();

constexpr Extended kUnknown = HUGE_VALL;

Extended size(Extended value) {
    return std::fabs(value);
}

/// A quotient and a bound on its error.
struct NearQuotient {
    Extended value, error;
};
NearQuotient near_quotient(Extended numerator, Extended numerator_error, Extended denominator,
                           Extended denominator_error) {
    const Extended least = size(denominator) - denominator_error;
    if (!(least > 0)) return {0, kUnknown};
    const Extended value = numerator / denominator;
    return {value, (numerator_error + size(value) * denominator_error) / least * (1 + 8 * kUnit) +
                       kUnit * size(value)};
}

/// The double nearest to the true value, or nothing where the bound leaves two to choose from.
std::optional<double> nearest(Extended value, Extended error) {
    const Extended slack = error == 0 ? 0 : error * (1 + 8 * kUnit) + 2 * kUnit * size(value);
    const auto up = static_cast<double>(value + slack);
    const auto down = static_cast<double>(value - slack);
    if (up == down && std::isfinite(up)) return up;
    return std::nullopt;
}

}  // namespace

NearGradient near_gradient(const PlanGeometry& g, PlaneId plane) {
    const auto& corner = g.plane(plane).corner;
    const SpaceVertex &s0 = g.space(corner[0]), &s1 = g.space(corner[1]), &s2 = g.space(corner[2]);
    const Point &p0 = g.point(s0.plan), &p1 = g.point(s1.plan), &p2 = g.point(s2.plan);
    const Extended ux = Extended(p1.x) - p0.x, uy = Extended(p1.y) - p0.y;
    const Extended vx = Extended(p2.x) - p0.x, vy = Extended(p2.y) - p0.y;
    const Extended uz = Extended(s1.z) - s0.z, vz = Extended(s2.z) - s0.z;
    // Each product of two differences errs by three units, their difference by one more.
    const Extended a1 = uz * vy, a2 = uy * vz, b1 = ux * vz, b2 = uz * vx, c1 = ux * vy,
                   c2 = uy * vx;
    const Extended error_c = 5 * kUnit * (size(c1) + size(c2));
    const NearQuotient x =
        near_quotient(a1 - a2, 5 * kUnit * (size(a1) + size(a2)), c1 - c2, error_c);
    const NearQuotient y =
        near_quotient(b1 - b2, 5 * kUnit * (size(b1) + size(b2)), c1 - c2, error_c);
    if (!kExtended) return {0, 0, kUnknown, kUnknown};
    return {x.value, y.value, x.error, y.error};
}

NearLine near_line(const PlanGeometry& g, const Line& line, VertexId origin) {
    const Point& o = g.point(origin);
    if (line.kind == Line::Kind::kEdge) {
        const Point &p = g.point(line.first), &q = g.point(line.second);
        const Extended a = Extended(p.y) - q.y, b = Extended(q.x) - p.x;
        if (!kExtended) return {0, 0, 0, kUnknown, kUnknown, kUnknown};
        if (line.first == origin) return {a, b, 0, kUnit * size(a), kUnit * size(b), 0};
        const Extended u = a * (Extended(p.x) - o.x), v = b * (Extended(p.y) - o.y);
        return {a, b, -(u + v), kUnit * size(a), kUnit * size(b), 5 * kUnit * (size(u) + size(v))};
    }
    const NearGradient p = near_gradient(g, line.first), q = near_gradient(g, line.second);
    const SpaceVertex& sp = g.space(g.plane(line.first).corner[0]);
    const SpaceVertex& sq = g.space(g.plane(line.second).corner[0]);
    const Point &vp = g.point(sp.plan), &vq = g.point(sq.plan);
    const Extended px = Extended(vp.x) - o.x, py = Extended(vp.y) - o.y;
    const Extended qx = Extended(vq.x) - o.x, qy = Extended(vq.y) - o.y;
    const Extended p1 = p.x * px, p2 = p.y * py, q1 = q.x * qx, q2 = q.y * qy;
    const Extended rise = Extended(sp.z) - sq.z;
    return {p.x - q.x,
            p.y - q.y,
            rise - (p1 + p2) + (q1 + q2),
            p.error_x + q.error_x + 2 * kUnit * (size(p.x) + size(q.x)),
            p.error_y + q.error_y + 2 * kUnit * (size(p.y) + size(q.y)),
            (p.error_x * size(px) + p.error_y * size(py) + q.error_x * size(qx) +
             q.error_y * size(qy)) *
                    (1 + 8 * kUnit) +
                8 * kUnit * (size(rise) + size(p1) + size(p2) + size(q1) + size(q2))};
}

std::optional<double> nearest_sum(double from, Extended value, Extended error) {
    const Extended sum = from + value;
    return nearest(sum, error == 0 && value == 0 ? 0 : error + kUnit * size(sum));
}

std::optional<double> near_height(const PlanGeometry& g, PlaneId plane, const NearPoint& p) {
    const SpaceVertex& corner = g.space(g.plane(plane).corner[0]);
    const Point &c = g.point(corner.plan), &o = g.point(p.origin);
    const NearGradient slope = near_gradient(g, plane);
    const Extended from_x = Extended(o.x) - c.x, from_y = Extended(o.y) - c.y;
    const Extended dx = from_x + p.x, dy = from_y + p.y;
    const Extended error_dx = p.error_x + kUnit * (size(from_x) + size(dx));
    const Extended error_dy = p.error_y + kUnit * (size(from_y) + size(dy));
    const Extended u = slope.x * dx, v = slope.y * dy;
    const Extended error = slope.error_x * size(dx) + (size(slope.x) + slope.error_x) * error_dx +
                           slope.error_y * size(dy) + (size(slope.y) + slope.error_y) * error_dy +
                           3 * kUnit * (size(u) + size(v));
    return nearest_sum(corner.z, u + v, error * (1 + 16 * kUnit));
}

std::optional<std::array<double, 3>> near_line_key(const NearLine& l) {
    const Extended a = size(l.a), b = size(l.b);
    const Extended either = l.error_a + l.error_b + kUnit * (a + b);
    const bool steep = a - b > either;
    if (!steep && !(b - a > either)) return std::nullopt;
    const NearQuotient slope = steep ? near_quotient(l.b, l.error_b, l.a, l.error_a)
                                     : near_quotient(l.a, l.error_a, l.b, l.error_b);
    const NearQuotient offset = steep ? near_quotient(l.c, l.error_c, l.a, l.error_a)
                                      : near_quotient(l.c, l.error_c, l.b, l.error_b);
    const auto s = nearest(slope.value, slope.error), t = nearest(offset.value, offset.error);
    if (!s || !t) return std::nullopt;
    return std::array<double, 3>{steep ? 1.0 : 0.0, *s, *t};
}

NearPoint Scope::near(PointId id) const {
    if (is_vertex(id)) return {id, 0, 0, 0, 0};
    return near(point(id));
}

NearPoint Scope::near(const Point& p) const {
    const Line* l = &line(p.first);
    const Line* m = &line(p.second);
    if (l->kind == Line::Kind::kTrace) std::swap(l, m);
    const VertexId origin = l->kind == Line::Kind::kEdge
                                ? l->first
                                : shared_.space(shared_.plane(l->first).corner[0]).plan;
    const NearLine a = near_line(shared_, *l, origin), b = near_line(shared_, *m, origin);
    // a product of two inexact numbers, less another one
    const auto error = [](Extended s, Extended es, Extended t, Extended et, Extended u, Extended eu,
                          Extended v, Extended ev) {
        return (size(s) * et + (size(t) + et) * es + size(u) * ev + (size(v) + ev) * eu) *
                   (1 + 8 * kUnit) +
               3 * kUnit * (size(s * t) + size(u * v));
    };
    const Extended w = a.a * b.b - b.a * a.b;
    const Extended error_w = error(a.a, a.error_a, b.b, b.error_b, b.a, b.error_a, a.b, a.error_b);
    const Extended error_x = error(a.b, a.error_b, b.c, b.error_c, b.b, b.error_b, a.c, a.error_c);
    const Extended error_y = error(a.c, a.error_c, b.a, b.error_a, b.c, b.error_c, a.a, a.error_a);
    const NearQuotient x = near_quotient(a.b * b.c - b.b * a.c, error_x, w, error_w);
    const NearQuotient y = near_quotient(a.c * b.a - b.c * a.a, error_y, w, error_w);
    return {origin, x.value, y.value, x.error, y.error};
}

}  // namespace realmodel::exact
