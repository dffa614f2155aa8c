// SPDX-License-Identifier: GPL-3.0-or-later
// Where constructed points and heights become doubles, always the nearest ones: equal however they
// are computed and whichever way a position, a height or a line is named. So the quickest way that
// is sure of its answer may give it: extended precision, then twice that of doubles, then GMP.

#include "exact/arithmetic.hpp"
#include "exact/extended_interval.hpp"
#include "exact/formulas.hpp"
#include "exact/local_arrangement.hpp"

namespace realmodel::exact {

void LocalArrangement::locate(Point& p) {
    const Line& l = line(p.first);
    const Line& m = line(p.second);
    std::optional<double> x, y;
    if (l.is_edge() && m.is_edge()) {
        const auto known = nearest_crossing(shared_, l, m);
        x = known[0];
        y = known[1];
    } else {
        const NearPoint close = near(p);
        const Point& from = shared_.point(close.origin);
        x = nearest_sum(from.x, close.x);
        y = nearest_sum(from.y, close.y);
    }
    if (!x || !y) {
        const VertexId origin = anchor(shared_, l);
        const Point& o = shared_.point(origin);
        const BallArithmetic in{shared_};
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
    return rounded_height(plane, id, near(id));
}

std::optional<double> LocalArrangement::rounded_height_of_crossing(const HeightName& name,
                                                                   PointId id) const {
    if (!name.is_edge() || is_vertex(id)) return std::nullopt;
    const Point& p = point(id);
    return near_height_of_crossing(shared_, name.from(), name.to(), line(p.first), line(p.second));
}

double LocalArrangement::rounded_height(PlaneId plane, const HeightName& name, PointId id,
                                        const NearPoint& close) {
    if (name.is_edge()) {
        if (name.from() == name.to()) return shared_.space(name.from()).z;
        if (const auto z = near_edge_height(shared_, name.from(), name.to(), close)) return *z;
    }
    return rounded_height(plane, id, close);
}

double LocalArrangement::rounded_height(PlaneId plane_id, PointId id, const NearPoint& close) {
    const SpaceVertex& corner = shared_.space(shared_.plane(plane_id).corner[0]);
    if (is_vertex(id)) {
        const SpaceId s = shared_.plane(plane_id).above(vertex(id));
        if (s != kNone) return shared_.space(s).z;
    }
    if (const auto z = near_height(shared_, plane_id, close)) return *z;
    {
        const BallArithmetic in{shared_};
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
        const auto c =
            line_coefficients<DoubleDoubleInterval>(BallArithmetic{shared_}, shared_, l, kOrigin);
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
