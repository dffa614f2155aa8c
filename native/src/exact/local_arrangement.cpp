// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/local_arrangement.hpp"

#include <algorithm>
#include <optional>

#include "exact/arithmetic.hpp"

namespace realmodel::exact {

void LocalIds::reserve_ids(PlanArrangement& receiver) {
    receiver_ = &receiver;
    appended_ = receiver.append(lines_.marked().size(), points_.marked().size());
}

/// A local point whose lines are known by their shared ids.
Point LocalIds::with_shared_lines(PointId id) {
    Point point = points_[id];
    point.first = shared_line(point.first);
    point.second = shared_line(point.second);
    return point;
}

void LocalIds::write_marked() {
    assert(receiver_ != nullptr);
    lines_.make_shared_ids();
    points_.make_shared_ids();
    LineId line = appended_.line;
    for (const LineId local : lines_.marked()) {
        receiver_->set_line(line, lines_[local]);
        lines_.shared(local) = line;
        ++line;
    }
    PointId point = appended_.point;
    for (const PointId local : points_.marked()) {
        receiver_->set_point(point, with_shared_lines(local));
        points_.shared(local) = point;
        ++point;
    }
}

LineId LocalIds::add_line_by_name(LineId id) {
    assert(receiver_ != nullptr);
    return lines_.shared(id) = receiver_->add_line(lines_[id]);
}

PointId LocalIds::add_point_by_name(PointId id) {
    assert(receiver_ != nullptr);
    return points_.shared(id) = receiver_->add_point(with_shared_lines(id));
}

namespace {

VertexId origin_of(const LocalArrangement& scope, PointId id) {
    return scope.is_vertex(id) ? scope.vertex(id)
                               : anchor(scope.shared(), scope.line(scope.point(id).first));
}

}  // namespace

// Not decided by floating point: returns 2.
int LocalArrangement::filtered_side(const LineFilter& line, const Point& point) const {
    const double dx = point.x - line.x0, dy = point.y - line.y0;
    const double value = line.a * dx + line.b * dy + line.c;
    const double error = line.error_at(dx, dy, point.error());
    if (value > error) return 1;
    if (value < -error) return -1;
    return 2;
}

bool LocalArrangement::is_right_by(const LineFilter& trace, PointId id, double difference) const {
    const Point& p = point(id);
    const double dx = p.x - trace.x0, dy = p.y - trace.y0;
    const double value = trace.a * dx + trace.b * dy + trace.c;
    return value + difference < -kFarTimes * trace.error_at(dx, dy, p.error());
}

// Whether an input vertex lies on an input edge because both products of the determinant vanish, as
// they do along borders parallel to an axis: a difference of doubles is 0 only where they are
// equal.
bool LocalArrangement::vanishes(const LineFilter& edge, const Point& vertex) const {
    return (vertex.x == edge.x0 || edge.a == 0.0) && (vertex.y == edge.y0 || edge.b == 0.0);
}

// The same of a crossing: whether it lies on an input edge parallel to an axis that runs where this
// one does, as the edges of such a border do.
bool LocalArrangement::runs_along(const LineFilter& edge, const Point& crossing) const {
    const auto runs_on = [&](LineId id) {
        if (!line(id).is_edge()) return false;
        const LineFilter other = filter(id);
        return (edge.a == 0.0 && other.a == 0.0 && edge.y0 == other.y0) ||
               (edge.b == 0.0 && other.b == 0.0 && edge.x0 == other.x0);
    };
    return (edge.a == 0.0 || edge.b == 0.0) &&
           (runs_on(crossing.first) || runs_on(crossing.second));
}

int LocalArrangement::exact_side(const Line& line, PointId point) {
    ++exact_;
    return exactly(shared_, [&](const auto& in, auto number) -> std::optional<int> {
        using Number = decltype(number);
        if (is_vertex(point)) {
            const auto c = line_coefficients<Number>(in, shared_, line, vertex(point)).c;
            return is_known(c) ? std::optional(sign_of(c)) : std::nullopt;
        }
        const VertexId origin = anchor(shared_, line);
        const auto l = line_coefficients<Number>(in, shared_, line, origin);
        const auto h = position_of<Number>(in, *this, point, origin);
        const Number value = l.a * h.x + l.b * h.y + l.c * h.w;
        return is_known(value) ? std::optional(sign_of(value) * sign_of(h.w)) : std::nullopt;
    });
}

/// compare_heights where both triangles have a corner above a plan vertex.
std::optional<int> LocalArrangement::compare_corners(PlaneId upper, PlaneId lower,
                                                     VertexId vertex) const {
    const SpaceId s = shared_.plane(upper).above(vertex);
    const SpaceId t = s == kNone ? kNone : shared_.plane(lower).above(vertex);
    if (t == kNone) return std::nullopt;
    return sign_of(shared_.space(s).z - shared_.space(t).z);
}

int LocalArrangement::side(DirectedLine directed_line, PointId id) {
    const LineId line_id = directed_line.id();
    const Line& l = line(line_id);
    const Point& p = point(id);
    int result = 2;
    if (is_vertex(id)) {
        const VertexId v = vertex(id);
        if (l.is_edge()) {
            if (v == l.ends()[0] || v == l.ends()[1]) return 0;
        } else if (const auto known = compare_corners(l.planes()[0], l.planes()[1], v)) {
            result = *known;
        }
    } else {
        if (p.first == line_id || p.second == line_id) return 0;
        if (!l.is_edge() && on_trace_by_name(l.planes()[0], l.planes()[1], p)) return 0;
    }
    ++decisions_;
    if (result == 2) {
        const LineFilter f = filter(line_id);
        result = filtered_side(f, p);
        if (result == 2 && l.is_edge()) {
            if (is_vertex(id) ? vanishes(f, p) : runs_along(f, p)) return 0;
        }
    }
    if (result == 2) result = exact_side(l, id);
    return directed_line.is_reversed() ? -result : result;
}

// Both triangles stand on an input edge that meets the point, or one on the edge and the other
// pierced by it.
bool LocalArrangement::on_trace_by_name(PlaneId a, PlaneId b, const Point& p) const {
    const auto has = [&](PlaneId plane, const EdgeOrPlane& name) {
        if (!name.is_edge()) return plane == name.plane();
        const auto& c = shared_.plane(plane).corner;
        const SpaceId from = name.from(), to = name.to();
        return (c[0] == from || c[1] == from || c[2] == from) &&
               (c[0] == to || c[1] == to || c[2] == to);
    };
    const Piercing by = shared_.piercing(line(p.first), line(p.second));
    if (by.edge.is_edge()) {
        const auto meets = [&](PlaneId plane) {
            return has(plane, by.edge) || has(plane, by.pierced);
        };
        if (meets(a) && meets(b)) return true;
    }
    for (const LineId id : {p.first, p.second}) {
        const Line& l = line(id);
        if (l.is_edge()) {
            const EdgeOrPlane edge = shared_.plane(a).above(l);
            if (edge.is_edge() && edge == shared_.plane(b).above(l)) return true;
        } else if (l == Line(std::min(a, b), std::max(a, b))) {
            return true;
        }
    }
    return false;
}

int LocalArrangement::compare_heights(PlaneId upper, PlaneId lower, PointId id) {
    if (upper == lower) return 0;
    return compare_heights(upper, lower, shared_.trace_filter(upper, lower), id);
}

int LocalArrangement::compare_heights(PlaneId upper, PlaneId lower, const LineFilter& trace,
                                      PointId id) {
    if (upper == lower) return 0;
    const Point& p = point(id);
    ++decisions_;
    if (is_vertex(id)) {
        if (const auto known = compare_corners(upper, lower, vertex(id))) return *known;
    } else if (on_trace_by_name(upper, lower, p)) {
        return 0;
    }
    const int result = filtered_side(trace, p);
    return result != 2 ? result : exact_side(Line(upper, lower), id);
}

bool LocalArrangement::same_place(PointId a, PointId b) {
    if (a == b) return true;
    if (point(a).x != point(b).x || point(a).y != point(b).y) return false;
    if (is_vertex(a) && is_vertex(b)) return false;
    if (is_vertex(a)) std::swap(a, b);
    const Point p = point(a);
    return side(DirectedLine(p.first), b) == 0 && side(DirectedLine(p.second), b) == 0;
}

bool LocalArrangement::same_line(LineId a, LineId b) {
    if (a == b) return true;
    if (!line(a).is_edge()) std::swap(a, b);
    const Line l = line(a), m = line(b);
    if (l == m) return true;
    if (l.is_edge()) {
        const DirectedLine other(b);
        return side(other, l.ends()[0]) == 0 && side(other, l.ends()[1]) == 0;
    }
    ++exact_;
    return exactly(shared_, [&](const auto& in, auto number) -> std::optional<bool> {
        using Number = decltype(number);
        const VertexId origin = anchor(shared_, l);
        const auto p = line_coefficients<Number>(in, shared_, l, origin);
        const auto q = line_coefficients<Number>(in, shared_, m, origin);
        const Number ab = p.a * q.b - p.b * q.a, ac = p.a * q.c - p.c * q.a,
                     bc = p.b * q.c - p.c * q.b;
        if (!is_known(ab) || !is_known(ac) || !is_known(bc)) return std::nullopt;
        return sign_of(ab) == 0 && sign_of(ac) == 0 && sign_of(bc) == 0;
    });
}

std::array<int, 2> LocalArrangement::direction_signs(LineId id) {
    const Line& l = line(id);
    if (l.is_edge()) {
        const Point& p = shared_.point(l.ends()[0]);
        const Point& q = shared_.point(l.ends()[1]);
        return {sign_of(q.x - p.x), sign_of(q.y - p.y)};
    }
    const VertexId origin = anchor(shared_, l);
    const auto c = line_coefficients<DoubleDoubleInterval>(DoubleDoubleArithmetic{shared_}, shared_,
                                                           l, origin);
    const auto a = c.a.sign(), b = c.b.sign();
    if (a && b) return {*b, -*a};
    ++exact_;
    return exactly(shared_, [&](const auto& in, auto number) -> std::optional<std::array<int, 2>> {
        const auto e = line_coefficients<decltype(number)>(in, shared_, l, origin);
        if (!is_known(e.a) || !is_known(e.b)) return std::nullopt;
        return std::array{sign_of(e.b), -sign_of(e.a)};
    });
}

int LocalArrangement::compare(int axis, PointId a, PointId b) {
    assert(axis == 0 || axis == 1);
    const auto rounded_one = [&](PointId id) { return axis == 0 ? point(id).x : point(id).y; };
    if (rounded_one(a) != rounded_one(b)) return rounded_one(a) < rounded_one(b) ? 1 : -1;
    if (a == b || (is_vertex(a) && is_vertex(b))) return 0;
    ++exact_;
    return exactly(shared_, [&](const auto& in, auto number) -> std::optional<int> {
        using Number = decltype(number);
        const VertexId origin = origin_of(*this, a);
        const auto p = position_of<Number>(in, *this, a, origin);
        const auto q = position_of<Number>(in, *this, b, origin);
        const Number &from = axis == 0 ? p.x : p.y, &to = axis == 0 ? q.x : q.y;
        const Number difference = to * p.w - from * q.w;
        if (!is_known(difference)) return std::nullopt;
        return sign_of(difference) * sign_of(p.w) * sign_of(q.w);
    });
}

DirectedLine LocalArrangement::trace(PlaneId upper, PlaneId lower) {
    assert(upper != lower);
    const LineId id = find_or_add_trace(std::min(upper, lower), std::max(upper, lower));
    return DirectedLine(id, upper > lower);
}

PointId LocalArrangement::crossing(LineId a, LineId b) {
    const Line la = line(a), lb = line(b);
    // Where an end of one edge lies on the other line, the crossing is that input vertex.
    if (la.is_edge()) {
        for (const VertexId v : la.ends()) {
            if (side(DirectedLine(b), v) == 0) return v;
        }
    }
    if (lb.is_edge()) {
        for (const VertexId v : lb.ends()) {
            if (side(DirectedLine(a), v) == 0) return v;
        }
    }
    return crossing_between_ends(a, b);
}

PointId LocalArrangement::crossing_between_ends(LineId a, LineId b) {
    assert(a != b);
    NamedPoint p({a, b}, shared_.piercing(line(a), line(b)));
    return points_.find_or_add(p, [&](Point& at) { locate(at); });
}

}  // namespace realmodel::exact
