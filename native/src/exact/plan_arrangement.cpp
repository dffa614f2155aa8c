// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/plan_arrangement.hpp"

#include <algorithm>
#include <cmath>

#include "exact/arithmetic.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::exact {

namespace {

constexpr double kEpsilon = 0x1p-52;  // twice the unit roundoff, so that products of bounds fit in

void check_room(std::size_t count, const char* what) {
    if (count >= static_cast<std::size_t>(kLocal)) {
        throw InputError("too_large", std::string("the model needs more than 500 million ") + what +
                                          "; build it in parts or with a coarser mesh");
    }
}

}  // namespace

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
    const auto make = [](auto& array, std::size_t more) {
        if (array.capacity() - array.size() < more)
            array.reserve(std::max(array.size() + more, 2 * array.capacity()));
    };
    make(lines_, lines);
    make(points_, points);
}

VertexId PlanArrangement::add_vertex(double x, double y) {
    const auto found = vertex_table_.insert(position_key(x, y), [&](std::int32_t number) {
        const Point& vertex = points_[static_cast<std::size_t>(number)];
        return position_key(vertex.x, vertex.y);
    });
    if (found.is_new) {
        check_room(points_.size(), "positions");
        Point vertex;
        vertex.x = x == 0.0 ? 0.0 : x;
        vertex.y = y == 0.0 ? 0.0 : y;
        points_.push_back(vertex);
    }
    return found.number;
}

SpaceId PlanArrangement::add_space_vertex(VertexId plan, double z) {
    const auto found = space_table_.insert(height_key(plan, z), [&](std::int32_t number) {
        const SpaceVertex& vertex = space_[static_cast<std::size_t>(number)];
        return height_key(vertex.plan, vertex.z);
    });
    if (found.is_new) space_.push_back({plan, z == 0.0 ? 0.0 : z});
    return found.number;
}

PlaneId PlanArrangement::add_plane(const std::array<SpaceId, 3>& corner) {
    const PlaneId plane = make_planes(1);
    set_plane(plane, corner);
    return plane;
}

PlaneId PlanArrangement::make_planes(std::size_t count) {
    const auto first = static_cast<PlaneId>(planes_.size());
    planes_.resize(planes_.size() + count);
    plane_filters_.resize(planes_.size());
    return first;
}

void PlanArrangement::set_plane(PlaneId plane, const std::array<SpaceId, 3>& corner) {
    const auto position = [&](int i) {
        const Point& p = points_[static_cast<std::size_t>(space(corner[i]).plan)];
        return std::array{p.x, p.y};
    };
    const auto [x0, y0] = position(0);
    const auto [x1, y1] = position(1);
    const auto [x2, y2] = position(2);
    const double z0 = space(corner[0]).z;
    const double ux = x1 - x0, uy = y1 - y0, uz = space(corner[1]).z - z0;
    const double vx = x2 - x0, vy = y2 - y0, vz = space(corner[2]).z - z0;
    const double c = ux * vy - uy * vx;
    const double error_c = 4 * kEpsilon * (std::abs(ux * vy) + std::abs(uy * vx)) + 1e-290;
    const double least = std::abs(c) - error_c;
    PlaneFilter filter;
    filter.gx = -(uy * vz - uz * vy) / c;
    filter.gy = -(uz * vx - ux * vz) / c;
    const double error_a = 4 * kEpsilon * (std::abs(uy * vz) + std::abs(uz * vy)) + 1e-290;
    const double error_b = 4 * kEpsilon * (std::abs(uz * vx) + std::abs(ux * vz)) + 1e-290;
    const bool safe = least > 0.0;
    filter.error_x = safe ? (error_a + std::abs(filter.gx) * error_c) / least * (1 + 0x1p-40) +
                                kEpsilon * std::abs(filter.gx)
                          : HUGE_VAL;
    filter.error_y = safe ? (error_b + std::abs(filter.gy) * error_c) / least * (1 + 0x1p-40) +
                                kEpsilon * std::abs(filter.gy)
                          : HUGE_VAL;
    planes_[static_cast<std::size_t>(plane)] = {
        corner, {space(corner[0]).plan, space(corner[1]).plan, space(corner[2]).plan}};
    plane_filters_[static_cast<std::size_t>(plane)] = filter;
}

void PlanArrangement::freeze_vertices() {
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
        r.point_error = largest * 0x1p-53 + 1e-300;
        const auto edge_error = [&](double way) {
            return ((1 + kEpsilon) * (r.point_error + kEpsilon * way) + 5 * kEpsilon * way) *
                   (1 + 0x1p-40);
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
    edges_of_vertex_ = crossings_of_line_ = {};
    line_table_ = point_table_ = {};
    names_forgotten_ = true;
}

void PlanArrangement::forget_all() {
    forget_names();
    points_ = {};
    space_ = {};
    planes_ = {};
    plane_filters_ = {};
    lines_ = {};
}

void PlanArrangement::remember_names() {
    names_forgotten_ = false;
    for (std::size_t l = 0; l < lines_.size(); ++l)
        find_or_add_line(lines_[l], static_cast<std::int32_t>(l));
    for (std::size_t p = vertex_count_; p < points_.size(); ++p)
        find_or_add_crossing(points_[p], static_cast<std::int32_t>(p - vertex_count_));
}

/// The number of a line with this name, `next` where it is new.
std::int32_t PlanArrangement::find_or_add_line(const Line& line, std::int32_t next) {
    const auto line_at = [&](std::int32_t number) -> const Line& {
        return lines_[static_cast<std::size_t>(number)];
    };
    if (line.kind == Line::Kind::kEdge) {
        const std::int32_t number = edges_of_vertex_.find_or_add(
            line.first, next, [&](std::int32_t n) { return line_at(n).second == line.second; });
        if (number != OwnedNames::kElsewhere) return number;
    }
    return line_table_
        .insert(line_key_of(line), next, [&](std::int32_t n) { return line_key_of(line_at(n)); })
        .number;
}

/// The number of a crossing with this name, counted from the first, `next` where it is new.
std::int32_t PlanArrangement::find_or_add_crossing(const Point& point, std::int32_t next) {
    const auto point_at = [&](std::int32_t number) -> const Point& {
        return points_[vertex_count_ + static_cast<std::size_t>(number)];
    };
    if (point.edge_from < 0) {
        const LineId older = std::min(point.first, point.second);
        const std::int32_t number = crossings_of_line_.find_or_add(
            std::max(point.first, point.second), next, [&](std::int32_t n) {
                return std::min(point_at(n).first, point_at(n).second) == older;
            });
        if (number != OwnedNames::kElsewhere) return number;
    }
    return point_table_
        .insert(point_key_of(point), next,
                [&](std::int32_t n) { return point_key_of(point_at(n)); })
        .number;
}

DirectedLine PlanArrangement::add_edge(VertexId from, VertexId to) {
    const bool reversed = from > to;
    const LineId id = add_line({Line::Kind::kEdge, reversed ? to : from, reversed ? from : to});
    return directed(id, reversed);
}

LineId PlanArrangement::add_line(const Line& line) {
    if (names_forgotten_) remember_names();
    const auto next = static_cast<LineId>(lines_.size());
    const LineId id = find_or_add_line(line, next);
    if (id == next) {
        check_room(lines_.size(), "lines");
        lines_.push_back(line);
    }
    return id;
}

PointId PlanArrangement::add_point(const Point& point) {
    if (names_forgotten_) remember_names();
    const auto next = static_cast<std::int32_t>(points_.size() - vertex_count_);
    const std::int32_t number = find_or_add_crossing(point, next);
    if (number == next) {
        check_room(points_.size(), "points");
        points_.push_back(point);
    }
    return number + static_cast<PointId>(vertex_count_);
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
        q.error_x * std::abs(dx) * (1 + 0x1p-40) + q.error_y * std::abs(dy) * (1 + 0x1p-40) +
        4 * kEpsilon * (std::abs(sp.z) + std::abs(sq.z) + std::abs(rise_x) + std::abs(rise_y)) +
        1e-290;
    return f;
}

}  // namespace realmodel::exact
