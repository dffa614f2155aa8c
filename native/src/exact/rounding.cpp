// SPDX-License-Identifier: GPL-3.0-or-later
// Where constructed points and heights become doubles, always the nearest ones: equal however they
// are computed and whichever way a position, a height or a line is named. So the quickest way that
// is sure of its answer may give it: extended precision, then twice that of doubles, then GMP.
#include "exact/rounding.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <utility>

#include "exact/arithmetic.hpp"
#include "exact/local_arrangement.hpp"

namespace realmodel::exact {

namespace {

using Extended = long double;

/// Has this thread's operations round to 64 bits, before any number is read that they are done
/// with. Windows begins threads with 53, where no other code uses these registers. Checking takes a
/// hundredth of what follows.
void keep_extended() {
#if defined(_WIN32) && defined(__x86_64__)
    constexpr unsigned short kAllBits = 0x300;
    unsigned short control = 0;
    asm volatile("fnstcw %0" : "=m"(control) : : "memory");
    if ((control & kAllBits) == kAllBits) return;
    control |= kAllBits;
    asm volatile("fldcw %0" : : "m"(control) : "memory");
#endif
}

/// Whether operations round to 64 bits here, as they may not under an emulator or where another
/// library changed the precision.
bool is_extended() {
#if defined(REALMODEL_PLAIN_DOUBLE)
    return false;
#endif
    if constexpr (LDBL_MANT_DIG != 64) return false;
    keep_extended();
    volatile Extended one = 1.0L, small = 0x1p-63L;
    volatile Extended sum = one + small;
    return sum != one;
}
const bool kExtended = is_extended();

/// The size of a number as far as bounds need it.
double size(Extended value) {
    return std::abs(static_cast<double>(value));
}

ExtendedInterval sum(const ExtendedInterval& a, const ExtendedInterval& b) {
    const Extended value = a.value + b.value;
    return {value, a.error + b.error + kExtendedUnit * size(value)};
}

ExtendedInterval operator-(const ExtendedInterval& a) {
    return {-a.value, a.error};
}

/// s * t - u * v of numbers with errors.
ExtendedInterval determinant(const ExtendedInterval& s, const ExtendedInterval& t,
                             const ExtendedInterval& u, const ExtendedInterval& v) {
    const Extended st = s.value * t.value, uv = u.value * v.value;
    const double error = size(s.value) * t.error + (size(t.value) + t.error) * s.error +
                         size(u.value) * v.error + (size(v.value) + v.error) * u.error +
                         3 * kExtendedUnit * (size(st) + size(uv));
    return {st - uv, error == 0 && st == 0 && uv == 0 ? 0 : error + kExtendedUnderflow};
}

/// The same of differences of doubles, each of which errs by one unit: three for a product.
ExtendedInterval determinant(Extended s, Extended t, Extended u, Extended v) {
    const Extended st = s * t, uv = u * v;
    return {st - uv, st == 0 && uv == 0
                         ? 0
                         : 5 * kExtendedUnit * (size(st) + size(uv)) + kExtendedUnderflow};
}

ExtendedInterval quotient(const ExtendedInterval& numerator, const ExtendedInterval& denominator) {
    const double least = size(denominator.value) * (1 - kNarrowing) - denominator.error;
    if (!(least > 0)) return {0, HUGE_VAL};
    const Extended value = numerator.value / denominator.value;
    const double error =
        (numerator.error + size(value) * denominator.error) / least + kExtendedUnit * size(value);
    return {value, error == 0 && value == 0 ? 0 : error + kExtendedUnderflow};
}

/// The double that all numbers are nearest to which are within a bound of one, if they are.
std::optional<double> nearest_within(Extended value, double bound) {
    const auto up = static_cast<double>(value + bound);
    const auto down = static_cast<double>(value - bound);
    if (up == down && std::isfinite(up)) return up + 0.0;  // 0 is not negative
    return std::nullopt;
}

/// The double nearest to the true value, or nothing where the bound leaves two to choose from.
std::optional<double> nearest(Extended value, double error) {
    return nearest_within(value, error == 0
                                     ? 0
                                     : error * (kBoundSlack) + 2 * kExtendedUnit * size(value) +
                                           8 * kExtendedUnderflow);
}

/// The normal of a plane.
struct NearNormal {
    ExtendedInterval a, b, c;
};
NearNormal near_normal(const PlanArrangement& g, PlaneId plane) {
    const auto& [corner, plan] = g.plane(plane);
    const SpaceVertex &s0 = g.space(corner[0]), &s1 = g.space(corner[1]), &s2 = g.space(corner[2]);
    const Point &p0 = g.point(plan[0]), &p1 = g.point(plan[1]), &p2 = g.point(plan[2]);
    const Extended ux = Extended(p1.x) - p0.x, uy = Extended(p1.y) - p0.y;
    const Extended vx = Extended(p2.x) - p0.x, vy = Extended(p2.y) - p0.y;
    const Extended uz = Extended(s1.z) - s0.z, vz = Extended(s2.z) - s0.z;
    return {determinant(uy, vz, uz, vy), determinant(uz, vx, ux, vz), determinant(ux, vy, uy, vx)};
}

/// What is added to a height along x and along y.
struct NearGradient {
    ExtendedInterval x, y;
};
NearGradient near_gradient(const PlanArrangement& g, PlaneId plane) {
    const NearNormal n = near_normal(g, plane);
    return {quotient(-n.a, n.c), quotient(-n.b, n.c)};
}

/// b - a of doubles.
ExtendedInterval difference(double a, double b) {
    const Extended value = Extended(b) - a;
    return {value, kExtendedUnit * size(value)};
}

/// Which share of the way along an edge lies before its crossing with another one. Bounds are found
/// in doubles alone: to ask an extended number for its size takes longer than to calculate with it.
struct Share {
    Extended value;
    double most, error;  ///< bounds of its size and of its error
};
Share share_of_way(const PlanArrangement& g, const Line& l, const Line& m) {
    const Point &o = g.point(l.ends()[0]), &p = g.point(l.ends()[1]);
    const Point &s = g.point(m.ends()[0]), &t = g.point(m.ends()[1]);
    const auto across = [&](auto number, const Point& to) {  // the way from o to there x the other
        using Number = decltype(number);
        return std::array{(Number(to.x) - o.x) * (Number(t.y) - s.y),
                          (Number(to.y) - o.y) * (Number(t.x) - s.x)};
    };
    const auto [dx, dy] = across(0.0, p);
    const auto [nx, ny] = across(0.0, s);
    const double size = std::abs(dx) + std::abs(dy), around = std::abs(nx) + std::abs(ny);
    const double least = std::abs(dx - dy) - (kDeterminant * size + kTermUnderflow);
    if (!(least > 0)) return {0, 0, HUGE_VAL};
    const double inverse = kBoundSlack / least;
    const double most = (std::abs(nx - ny) + kDeterminant * around + kTermUnderflow) * inverse;
    const auto d = across(Extended{}, p), n = across(Extended{}, s);
    return {(n[0] - n[1]) / (d[0] - d[1]), most,
            kExtendedUnit * (5 * around * inverse + most * (1 + 5 * size * inverse))};
}

/// That share of the way from one double to another.
ExtendedInterval interpolated(const Share& share, double from, double to) {
    const double way = std::abs(to - from);
    return {share.value * (Extended(to) - from),
            way == 0 ? 0
                     : way * (share.error + 3 * kExtendedUnit * share.most) * kBoundSlack +
                           kTermUnderflow};
}

/// Where two edges cross, relative to the first one's first vertex.
NearPoint near_crossing(const PlanArrangement& g, const Line& l, const Line& m) {
    const Point &o = g.point(l.ends()[0]), &p = g.point(l.ends()[1]);
    const Share share = share_of_way(g, l, m);
    return {l.ends()[0], interpolated(share, o.x, p.x), interpolated(share, o.y, p.y)};
}

}  // namespace

NearLine near_line(const PlanArrangement& g, const Line& line, VertexId origin) {
    keep_extended();
    const Point& o = g.point(origin);
    if (line.is_edge()) {
        const auto [from, to] = line.ends();
        const Point &p = g.point(from), &q = g.point(to);
        const ExtendedInterval a = difference(q.y, p.y), b = difference(p.x, q.x);
        if (from == origin) return {a, b, {0, 0}};
        // a (x - px) + b (y - py) at the origin
        return {a, b, determinant(a, difference(p.x, o.x), -b, difference(p.y, o.y))};
    }
    const auto [first, second] = line.planes();
    const NearGradient p = near_gradient(g, first), q = near_gradient(g, second);
    const SpaceVertex& sp = g.space(g.plane(first).corner[0]);
    const SpaceVertex& sq = g.space(g.plane(second).corner[0]);
    const Point &vp = g.point(sp.plan), &vq = g.point(sq.plan);
    const ExtendedInterval p_rise =
        determinant(p.x, difference(vp.x, o.x), -p.y, difference(vp.y, o.y));
    const ExtendedInterval q_rise =
        determinant(q.x, difference(vq.x, o.x), -q.y, difference(vq.y, o.y));
    const ExtendedInterval p_height = sum({sp.z, 0}, p_rise), q_height = sum({sq.z, 0}, q_rise);
    return {sum(p.x, -q.x), sum(p.y, -q.y), sum(p_height, -q_height)};
}

std::optional<double> nearest_sum(double from, const ExtendedInterval& value) {
    if (!kExtended) return std::nullopt;
    keep_extended();
    const Extended whole = from + value.value;
    const bool exact = value.error == 0 && value.value == 0;
    return nearest(whole, exact ? 0 : value.error + kExtendedUnit * size(whole));
}

std::optional<double> near_height(const PlanArrangement& g, PlaneId plane, const NearPoint& p) {
    keep_extended();
    const SpaceVertex& corner = g.space(g.plane(plane).corner[0]);
    const Point &c = g.point(corner.plan), &o = g.point(p.origin);
    const NearNormal n = near_normal(g, plane);
    const ExtendedInterval dx = sum(difference(c.x, o.x), p.x), dy = sum(difference(c.y, o.y), p.y);
    return nearest_sum(corner.z, -quotient(determinant(n.a, dx, -n.b, dy), n.c));
}

std::optional<double> near_edge_height(const PlanArrangement& g, SpaceId from, SpaceId to,
                                       const NearPoint& point) {
    keep_extended();
    const SpaceVertex &s = g.space(from), &t = g.space(to);
    const Point &p = g.point(s.plan), &q = g.point(t.plan), &o = g.point(point.origin);
    const ExtendedInterval x = difference(p.x, q.x), y = difference(p.y, q.y);
    const bool is_x = size(x.value) >= size(y.value);
    const ExtendedInterval way =
        is_x ? sum(difference(p.x, o.x), point.x) : sum(difference(p.y, o.y), point.y);
    const ExtendedInterval rise = determinant(way, difference(s.z, t.z), {0, 0}, {0, 0});
    return nearest_sum(s.z, quotient(rise, is_x ? x : y));
}

std::optional<std::array<double, 3>> near_line_key(const NearLine& l) {
    if (!kExtended) return std::nullopt;
    keep_extended();
    const double a = size(l.a.value), b = size(l.b.value);
    const double either = l.a.error + l.b.error + kNarrowing * (a + b);
    const bool steep = a - b > either;
    if (!steep && !(b - a > either)) return std::nullopt;
    const ExtendedInterval& divisor = steep ? l.a : l.b;
    const ExtendedInterval slope = quotient(steep ? l.b : l.a, divisor),
                           offset = quotient(l.c, divisor);
    const auto s = nearest(slope.value, slope.error), t = nearest(offset.value, offset.error);
    if (!s || !t) return std::nullopt;
    return std::array<double, 3>{steep ? 1.0 : 0.0, *s, *t};
}

NearPoint LocalArrangement::approximate(PointId id) const {
    if (is_vertex(id)) return {vertex(id), {0, 0}, {0, 0}};
    return approximate(point(id));
}

NearPoint LocalArrangement::approximate(const Point& p) const {
    keep_extended();
    const Line* l = &line(p.first);
    const Line* m = &line(p.second);
    if (!l->is_edge()) std::swap(l, m);
    const VertexId origin = anchor(shared_, *l);
    if (m->is_edge()) return near_crossing(shared_, *l, *m);
    const NearLine a = near_line(shared_, *l, origin), b = near_line(shared_, *m, origin);
    const ExtendedInterval w = determinant(a.a, b.b, b.a, a.b);
    return {origin, quotient(determinant(a.b, b.c, b.b, a.c), w),
            quotient(determinant(a.c, b.a, b.c, a.a), w)};
}

namespace {

/// The side of a plane's triangle that stands on one of a crossing's two lines.
EdgeOrPlane standing_edge(const PlanArrangement& geometry, PlaneId plane,
                          const std::array<const Line*, 2>& lines) {
    const EdgeOrPlane first = geometry.plane(plane).above(*lines[0]);
    return first.is_edge() ? first : geometry.plane(plane).above(*lines[1]);
}

bool is_trace_of(const Line& line, PlaneId plane) {
    return !line.is_edge() && (line.planes()[0] == plane || line.planes()[1] == plane);
}

}  // namespace

HeightName LocalArrangement::height_name(PlaneId plane, PointId id) const {
    if (is_vertex(id)) {
        const SpaceId s = shared_.plane(plane).above(vertex(id));
        return s != kNone ? HeightName(s, s) : HeightName(plane);
    }
    const Point& p = point(id);
    const std::array<const Line*, 2> lines{&line(p.first), &line(p.second)};
    if (const auto edge = standing_edge(shared_, plane, lines); edge.is_edge()) return edge;
    for (std::size_t i = 0; i < 2; ++i) {
        const Line &trace = *lines[i], &other = *lines[1 - i];
        if (!is_trace_of(trace, plane)) continue;
        // along the trace another plane is equally high
        const auto [first, second] = trace.planes();
        const PlaneId partner = first == plane ? second : first;
        if (const auto edge = standing_edge(shared_, partner, lines); edge.is_edge()) return edge;
        const bool shared = is_trace_of(other, first) != is_trace_of(other, second);
        return HeightName(shared && is_trace_of(other, second) ? second : first);
    }
    return HeightName(plane);
}

void LocalArrangement::locate(Point& p) {
    const Line& l = line(p.first);
    const Line& m = line(p.second);
    const NearPoint close = approximate(p);
    const Point& from = shared_.point(close.origin);
    std::optional<double> x = nearest_sum(from.x, close.x), y = nearest_sum(from.y, close.y);
    if (!x || !y) {
        const VertexId origin = anchor(shared_, l);
        const Point& o = shared_.point(origin);
        const DoubleDoubleArithmetic in{shared_};
        const auto h = cross(line_coefficients<DoubleDoubleInterval>(in, shared_, l, origin),
                             line_coefficients<DoubleDoubleInterval>(in, shared_, m, origin));
        x = (h.x / h.w + DoubleDoubleInterval(o.x)).rounded();
        y = (h.y / h.w + DoubleDoubleInterval(o.y)).rounded();
        if (!x || !y) {
            ++exact_;
            const auto whole = exactly(
                shared_,
                [&](const auto& exact, auto number) -> std::optional<std::array<double, 2>> {
                    using Number = decltype(number);
                    const auto e = cross(line_coefficients<Number>(exact, shared_, l, origin),
                                         line_coefficients<Number>(exact, shared_, m, origin));
                    const Number to_x = e.x + exact.plan(o.x) * e.w;
                    const Number to_y = e.y + exact.plan(o.y) * e.w;
                    if (!is_known(to_x) || !is_known(to_y)) return std::nullopt;
                    const int unit = shared_.plan_exponent();
                    return std::array{nearest_double(to_x, e.w, unit),
                                      nearest_double(to_y, e.w, unit)};
                });
            x = whole[0];
            y = whole[1];
        }
    }
    p.x = *x;
    p.y = *y;
}

std::array<double, 2> LocalArrangement::rounded(PointId id) {
    return {point(id).x, point(id).y};
}

double LocalArrangement::rounded_height(PlaneId plane, PointId id) {
    return rounded_height(plane, height_name(plane, id), id, approximate(id));
}

double LocalArrangement::rounded_height(PlaneId plane_id, const HeightName& name, PointId id,
                                        const NearPoint& close) {
    const SpaceVertex& corner = shared_.space(shared_.plane(plane_id).corner[0]);
    if (name.is_edge() && name.from() == name.to()) return shared_.space(name.from()).z;
    if (const auto z = name.is_edge() ? near_edge_height(shared_, name.from(), name.to(), close)
                                      : near_height(shared_, plane_id, close))
        return *z;
    {
        const DoubleDoubleArithmetic in{shared_};
        const auto n = plane_normal<DoubleDoubleInterval>(in, shared_, plane_id);
        const auto h = position_of<DoubleDoubleInterval>(in, *this, id, corner.plan);
        const auto z =
            (DoubleDoubleInterval(corner.z) - (n.a * h.x + n.b * h.y) / (n.c * h.w)).rounded();
        if (z) return *z;
    }
    ++exact_;
    return exactly(shared_, [&](const auto& in, auto number) -> std::optional<double> {
        using Number = decltype(number);
        const auto n = plane_normal<Number>(in, shared_, plane_id);
        const auto h = position_of<Number>(in, *this, id, corner.plan);
        const Number w = n.c * h.w;
        const Number z = in.height(corner.z) * w - n.a * h.x - n.b * h.y;
        if (!is_known(z)) return std::nullopt;
        return nearest_double(z, w, shared_.height_exponent());
    });
}

std::array<double, 3> LocalArrangement::line_key(LineId id) {
    const Line& l = line(id);
    constexpr VertexId kOrigin{0};  // any vertex does, as long as it is the same for all lines
    if (const auto key = near_line_key(near_line(shared_, l, kOrigin))) return *key;
    {
        const auto c = line_coefficients<DoubleDoubleInterval>(DoubleDoubleArithmetic{shared_},
                                                               shared_, l, kOrigin);
        const auto a = c.a.sign(), b = c.b.sign();
        if (a && b) {
            const auto steep = ((*a < 0 ? -c.a : c.a) - (*b < 0 ? -c.b : c.b)).sign();
            if (steep) {
                const DoubleDoubleInterval& divisor = *steep > 0 ? c.a : c.b;
                const auto slope = ((*steep > 0 ? c.b : c.a) / divisor).rounded();
                const auto offset = (c.c / divisor).rounded();
                if (slope && offset) return {*steep > 0 ? 1.0 : 0.0, *slope, *offset};
            }
        }
    }
    ++exact_;
    return exactly(
        shared_, [&](const auto& in, auto number) -> std::optional<std::array<double, 3>> {
            using Number = decltype(number);
            const auto e = line_coefficients<Number>(in, shared_, l, kOrigin);
            const Number longer =
                (sign_of(e.a) < 0 ? Number(-e.a) : e.a) - (sign_of(e.b) < 0 ? Number(-e.b) : e.b);
            if (!is_known(longer) || !is_known(e.c)) return std::nullopt;
            const bool steep = sign_of(longer) > 0;
            const Number& divisor = steep ? e.a : e.b;
            // a and b are lengths over lengths; c is a length in units of 2^plan_exponent
            return std::array{steep ? 1.0 : 0.0, nearest_double(steep ? e.b : e.a, divisor, 0),
                              nearest_double(e.c, divisor, shared_.plan_exponent())};
        });
}

}  // namespace realmodel::exact
