// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/triangulation/part_check.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::interpolation {

namespace {

constexpr double kSlack = 1e-6;  // of the size of a circle, for rounding
constexpr double kFlat = 1e-7;   // of the squared side: of flatter triangles circles are rounding
constexpr double kOfOrigin = 4e-16;  // what coordinates relative to the origin may be off by

std::vector<Position> local_positions(const DataPoints& data,
                                      std::span<const std::array<double, 3>> points) {
    std::vector<Position> out;
    for (const auto& [x, y, z] : points)
        out.push_back(data.to_local({x, y}));
    return out;
}

}  // namespace

PartCheck::PartCheck(const DataPoints& data, const PointsAround& around)
    : hull_(local_positions(data, around.border)), is_whole_(around.is_whole) {
    const std::vector<Position> places = local_positions(data, around.border);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const std::size_t next = (i + 1) % places.size();
        border_.add(places[i], around.border[i][2], places[next], around.border[next][2]);
        place_on_border_.emplace_back(places[i], i);
    }
    std::sort(place_on_border_.begin(), place_on_border_.end());
    const double x = data.origin[0], y = data.origin[1];
    const double off = kOfOrigin * std::max(std::abs(x), std::abs(y));
    const auto local_box = [&](const std::array<double, 4>& box) {
        return spatial::PlanBox{box[0] - x, box[1] - y, box[2] - x, box[3] - y};
    };
    all_ = local_box(around.all).widened(2 * off);
    window_ = local_box(around.window).widened(-2 * off);
}

bool PartCheck::is_hull_edge(const Position& a, const Position& b) const {
    const auto place = [&](const Position& p) {
        const auto found = std::lower_bound(place_on_border_.begin(), place_on_border_.end(),
                                            std::pair(p, std::size_t{0}));
        const bool is_there = found != place_on_border_.end() && found->first == p;
        return is_there ? found->second : place_on_border_.size();
    };
    const std::size_t count = place_on_border_.size(), i = place(a), j = place(b);
    if (i == count || j == count) return false;
    return (i + 1) % count == j || (j + 1) % count == i;
}

bool PartCheck::has_all_in(const spatial::PlanBox& box) const {
    return std::max(box.low_x, all_.low_x) >= window_.low_x &&
           std::max(box.low_y, all_.low_y) >= window_.low_y &&
           std::min(box.high_x, all_.high_x) <= window_.high_x &&
           std::min(box.high_y, all_.high_y) <= window_.high_y;
}

bool PartCheck::has_all_in_circle(const Position& p, const Position& a, const Position& b) const {
    if (is_whole_) return true;
    const double ax = a[0] - p[0], ay = a[1] - p[1], bx = b[0] - p[0], by = b[1] - p[1];
    const double cross = ax * by - ay * bx, dot = ax * bx + ay * by;
    const double aa = ax * ax + ay * ay, bb = bx * bx + by * by;
    const double ux = bx - ax, uy = by - ay, side = std::sqrt(ux * ux + uy * uy);
    if (dot <= 0 && is_hull_edge(a, b)) {
        // Less than half a circle: it reaches from the edge as high as the tangent of half the arc
        // tells, and is nowhere wider.
        const double high =
            0.5 * std::abs(cross) / (std::sqrt(aa) * std::sqrt(bb) - dot) * (1 + kSlack);
        const double off_x = std::abs(uy) * high, off_y = std::abs(ux) * high;
        const spatial::PlanBox box{std::min(a[0], b[0]) - off_x, std::min(a[1], b[1]) - off_y,
                                   std::max(a[0], b[0]) + off_x, std::max(a[1], b[1]) + off_y};
        return has_all_in(box.widened(kSlack * side));
    }
    if (!(std::abs(cross) > kFlat * std::max({aa, bb, side * side}))) return false;
    const double x = (by * aa - ay * bb) / (2 * cross), y = (ax * bb - bx * aa) / (2 * cross);
    const double radius = std::sqrt(x * x + y * y) * (1 + kSlack);
    const double middle_x = p[0] + x, middle_y = p[1] + y;
    // What of the circle is in the box of all points.
    const auto beyond = [](double at, double low, double high) {
        return std::max({low - at, at - high, 0.0});
    };
    const auto half = [&](double off) {
        return std::sqrt(std::max(radius * radius - off * off, 0.0));
    };
    const double half_x = half(beyond(middle_y, all_.low_y, all_.high_y)) + kSlack * radius;
    const double half_y = half(beyond(middle_x, all_.low_x, all_.high_x)) + kSlack * radius;
    return has_all_in({middle_x - half_x, middle_y - half_y, middle_x + half_x, middle_y + half_y});
}

}  // namespace realmodel::interpolation
