// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/plan_arrangement.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/algorithms.hpp"
#include "exact/arithmetic.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::exact {

void check_ids(std::size_t count, const char* what, std::size_t most) {
    if (count <= most) return;
    throw InputError("too_large", "the model needs more than " + std::to_string(most / 1000000) +
                                      " million " + what +
                                      "; build it in parts or with a coarser mesh");
}

void PlanArrangement::expect_vertices(std::size_t count) {
    points_.reserve(count);
    space_.reserve(count);
    vertex_table_.reserve(count);
    space_table_.reserve(count);
}

void PlanArrangement::expect_planes(std::size_t count) {
    planes_.reserve(count);
    plane_filters_.reserve(count);
}

void PlanArrangement::expect_lines(std::size_t count) {
    lines_.reserve(count);
}

void PlanArrangement::make_room(std::size_t lines, std::size_t points) {
    reserve_more(lines_, lines);
    reserve_more(points_, points);
}

VertexId PlanArrangement::add_vertex(double x, double y) {
    assert(vertex_count_ == 0 && std::isfinite(x) && std::isfinite(y));
    const auto entry = vertex_table_.insert(position_key(x, y), [&](std::int32_t number) {
        const Point& vertex = points_[static_cast<std::size_t>(number)];
        return position_key(vertex.x, vertex.y);
    });
    if (entry.is_new) {
        check_ids(points_.size() + 1, "positions");
        Point vertex;
        vertex.x = x == 0.0 ? 0.0 : x;
        vertex.y = y == 0.0 ? 0.0 : y;
        points_.push_back(vertex);
    }
    return VertexId(entry.number);
}

SpaceId PlanArrangement::add_space_vertex(VertexId plan, double z) {
    assert(vertex_count_ == 0 && std::isfinite(z));
    const auto entry = space_table_.insert(height_key(plan, z), [&](std::int32_t number) {
        const SpaceVertex& vertex = space_[static_cast<std::size_t>(number)];
        return height_key(vertex.plan, vertex.z);
    });
    if (entry.is_new) {
        check_ids(space_.size() + 1, "vertices");
        space_.push_back({plan, z == 0.0 ? 0.0 : z});
    }
    return SpaceId(entry.number);
}

PlaneId PlanArrangement::add_plane(const std::array<SpaceId, 3>& corner) {
    const PlaneId plane = make_planes(1);
    set_plane(plane, corner);
    return plane;
}

PlaneId PlanArrangement::make_planes(std::size_t count) {
    assert(plane_filters_.size() == planes_.size());
    check_ids(planes_.size() + count, "triangles");
    const PlaneId first(planes_.size());
    planes_.resize(planes_.size() + count);
    plane_filters_.resize(planes_.size());
    return first;
}

PlaneFilter PlanArrangement::filter_of(const std::array<SpaceId, 3>& corner) const {
    const auto position = [&](int i) {
        const Point& p = point(space(corner[i]).plan);
        return std::array{p.x, p.y};
    };
    const auto [x0, y0] = position(0);
    const auto [x1, y1] = position(1);
    const auto [x2, y2] = position(2);
    const double z0 = space(corner[0]).z;
    const double ux = x1 - x0, uy = y1 - y0, uz = space(corner[1]).z - z0;
    const double vx = x2 - x0, vy = y2 - y0, vz = space(corner[2]).z - z0;
    const double c = ux * vy - uy * vx;
    const double error_c = kDeterminant * (std::abs(ux * vy) + std::abs(uy * vx)) + kTermUnderflow;
    const double least = std::abs(c) - error_c;
    PlaneFilter filter;
    filter.gx = -(uy * vz - uz * vy) / c;
    filter.gy = -(uz * vx - ux * vz) / c;
    const double error_a = kDeterminant * (std::abs(uy * vz) + std::abs(uz * vy)) + kTermUnderflow;
    const double error_b = kDeterminant * (std::abs(uz * vx) + std::abs(ux * vz)) + kTermUnderflow;
    const auto error_of = [&](double gradient, double error) {
        if (!(least > 0.0)) return HUGE_VAL;
        const double size = std::abs(gradient);
        return (error + size * error_c) / least * kBoundSlack + kEpsilon * size;
    };
    filter.error_x = error_of(filter.gx, error_a);
    filter.error_y = error_of(filter.gy, error_b);
    return filter;
}

void PlanArrangement::set_plane(PlaneId plane, const std::array<SpaceId, 3>& corner) {
    assert(corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0]);
    planes_[index(plane)] = {corner,
                             {space(corner[0]).plan, space(corner[1]).plan, space(corner[2]).plan}};
    plane_filters_[index(plane)] = filter_of(corner);
}

void PlanArrangement::freeze_vertices() {
    assert(vertex_count_ == 0);
    vertex_count_ = points_.size();
    vertex_table_ = {};  // no more of them will be asked for
    space_table_ = {};
    constexpr int kNone = 100000;
    plan_exponent_ = height_exponent_ = kNone;
    PlanReach& r = reach_;
    for (const Point& p : points_) {
        plan_exponent_ = finest_exponent(p.y, finest_exponent(p.x, plan_exponent_));
        r.low_x = std::min(r.low_x, p.x);
        r.low_y = std::min(r.low_y, p.y);
        r.high_x = std::max(r.high_x, p.x);
        r.high_y = std::max(r.high_y, p.y);
    }
    if (!points_.empty()) {
        r.width = (r.high_x - r.low_x) * (1 + kEpsilon);
        r.height = (r.high_y - r.low_y) * (1 + kEpsilon);
        const double largest = std::max(
            {std::abs(r.low_x), std::abs(r.high_x), std::abs(r.low_y), std::abs(r.high_y)});
        r.point_error = rounding_error(largest);
        const auto edge_error = [&](double way) {
            return ((1 + kEpsilon) * (r.point_error + kEpsilon * way) +
                    (kEpsilon + kLineValue) * way) *
                   kBoundSlack;
        };
        r.edge_x = edge_error(r.width);
        r.edge_y = edge_error(r.height);
    }
    for (const SpaceVertex& s : space_)
        height_exponent_ = finest_exponent(s.z, height_exponent_);
    if (plan_exponent_ == kNone) plan_exponent_ = 0;
    if (height_exponent_ == kNone) height_exponent_ = 0;
}

void PlanArrangement::forget_names() {
    edges_of_vertex_ = {};
    line_table_ = point_table_ = {};
    plane_filters_ = {};
}

void PlanArrangement::forget_all() {
    forget_names();
    points_ = {};
    space_ = {};
    planes_ = {};
    lines_ = {};
}

/// The line with this name, `next` where it is new.
LineId PlanArrangement::find_or_add_line(const Line& wanted, LineId next) {
    if (wanted.is_edge()) {
        const auto [first, second] = wanted.ends();
        const std::int32_t known = edges_of_vertex_.find_or_add(
            first.number(), next.number(),
            [&, to = second](std::int32_t number) { return line(LineId(number)).ends()[1] == to; });
        if (known != OwnedNames::kElsewhere) return LineId(known);
    }
    const auto entry = line_table_.insert(wanted.key(), next.number(), [&](std::int32_t number) {
        return line(LineId(number)).key();
    });
    return LineId(entry.number);
}

DirectedLine PlanArrangement::add_edge(VertexId from, VertexId to) {
    assert(from != to);
    const bool reversed = from > to;
    const LineId id = add_line(reversed ? Line(to, from) : Line(from, to));
    return DirectedLine(id, reversed);
}

LineId PlanArrangement::add_line(const Line& line) {
    const LineId next(lines_.size());
    const LineId id = find_or_add_line(line, next);
    if (id == next) set_line(append(1, 0).line, line);
    return id;
}

PointId PlanArrangement::add_point(const Point& wanted) {
    const PointId next(points_.size());
    const auto key = [&](const Point& p) {
        return NamedPoint(p, piercing(line(p.first), line(p.second))).key();
    };
    const auto entry = point_table_.insert(key(wanted), next.number(), [&](std::int32_t number) {
        return key(point(PointId(number)));
    });
    if (entry.is_new) set_point(append(0, 1).point, wanted);
    return PointId(entry.number);
}

Piercing PlanArrangement::piercing(const Line& first, const Line& second) const {
    if (first.is_edge() == second.is_edge()) return {};
    const Line &edge = first.is_edge() ? first : second, &trace = first.is_edge() ? second : first;
    const auto standing = [&](PlaneId id) {
        const EdgeOrPlane above = plane(id).above(edge);
        return above.is_edge() ? above : EdgeOrPlane(id);
    };
    const auto [lower, upper] = trace.planes();
    EdgeOrPlane one = standing(lower), other = standing(upper);
    if (!one.is_edge() || (other.is_edge() && other < one)) std::swap(one, other);
    return one.is_edge() ? Piercing{one, other} : Piercing{};
}

PlanArrangement::Appended PlanArrangement::append(std::size_t lines, std::size_t points) {
    check_ids(lines_.size() + lines, "lines");
    check_ids(points_.size() + points, "points");
    const Appended first{LineId(lines_.size()), PointId(points_.size())};
    lines_.resize(lines_.size() + lines);
    points_.resize(points_.size() + points);
    return first;
}

LineFilter PlanArrangement::edge_filter(VertexId from, VertexId to) const {
    const Point& p = point(from);
    const Point& q = point(to);
    LineFilter f;
    f.a = p.y - q.y;
    f.b = q.x - p.x;
    f.error_a = kEpsilon * std::abs(f.a);
    f.error_b = kEpsilon * std::abs(f.b);
    f.x0 = p.x;
    f.y0 = p.y;
    return f;
}

LineFilter PlanArrangement::trace_filter(PlaneId first, PlaneId second) const {
    const PlaneFilter& p = plane_filter(first);
    const PlaneFilter& q = plane_filter(second);
    const SpaceVertex& sp = space(plane(first).corner[0]);
    const SpaceVertex& sq = space(plane(second).corner[0]);
    const Point& vp = point(sp.plan);
    const Point& vq = point(sq.plan);
    LineFilter f;
    f.a = p.gx - q.gx;
    f.b = p.gy - q.gy;
    f.error_a = p.error_x + q.error_x + kEpsilon * (std::abs(p.gx) + std::abs(q.gx));
    f.error_b = p.error_y + q.error_y + kEpsilon * (std::abs(p.gy) + std::abs(q.gy));
    f.x0 = vp.x;
    f.y0 = vp.y;
    const double dx = vp.x - vq.x, dy = vp.y - vq.y;
    const double rise_x = q.gx * dx, rise_y = q.gy * dy;
    f.c = (sp.z - sq.z) - (rise_x + rise_y);
    f.error_c =
        (q.error_x * std::abs(dx) + q.error_y * std::abs(dy)) * kBoundSlack +
        kPlaneHeight * (std::abs(sp.z) + std::abs(sq.z) + std::abs(rise_x) + std::abs(rise_y)) +
        kTermUnderflow;
    return f;
}

}  // namespace realmodel::exact
