// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace realmodel::meshing {

namespace {

/// Where something meets a row of the lattice.
struct Stretch {
    std::int64_t row;
    double from, to;
    bool operator<(const Stretch& other) const {
        if (row != other.row) return row < other.row;
        return from != other.from ? from < other.from : to < other.to;
    }
};

/// Takes in the part of the segment ab that lies on the line y.
void widen_by_segment(double& low, double& high, const PlanPoint& a, const PlanPoint& b, double y) {
    if ((a[1] < y && b[1] < y) || (a[1] > y && b[1] > y)) return;
    const double rise = b[1] - a[1];
    const double t = rise == 0 ? 0 : std::clamp((y - a[1]) / rise, 0.0, 1.0);
    for (const double x : {a[0] + t * (b[0] - a[0]), rise == 0 ? b[0] : a[0] + t * (b[0] - a[0])}) {
        low = std::min(low, x);
        high = std::max(high, x);
    }
}

/// The stretch of the line y within `distance` of the segment ab: a convex set, hence an interval.
/// Empty (low > high) where there is none.
void near_segment(double& low, double& high, const PlanPoint& a, const PlanPoint& b,
                  double distance, double y) {
    for (const PlanPoint& end : {a, b}) {
        const double rest = distance * distance - (y - end[1]) * (y - end[1]);
        if (rest < 0) continue;
        low = std::min(low, end[0] - std::sqrt(rest));
        high = std::max(high, end[0] + std::sqrt(rest));
    }
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    if (length == 0) return;
    const double nx = -(b[1] - a[1]) / length * distance, ny = (b[0] - a[0]) / length * distance;
    const PlanPoint corners[] = {{a[0] + nx, a[1] + ny},
                                 {b[0] + nx, b[1] + ny},
                                 {b[0] - nx, b[1] - ny},
                                 {a[0] - nx, a[1] - ny}};
    for (int i = 0; i < 4; ++i)
        widen_by_segment(low, high, corners[i], corners[(i + 1) % 4], y);
}

}  // namespace

std::vector<PlanPoint> lattice_inside(const BorderPieces& border, double edge_length,
                                      double clearance, const Check& check) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    PlanPoint low{infinity, infinity};
    for (const PlanPoint& p : border.points) {
        low = {std::min(low[0], p[0]), std::min(low[1], p[1])};
    }
    const double row_height = edge_length * std::numbers::sqrt3 / 2;
    const auto row_above = [&](double y) {
        return static_cast<std::int64_t>(std::ceil((y - low[1]) / row_height));
    };
    const auto row_y = [&](std::int64_t row) {
        return low[1] + static_cast<double>(row) * row_height;
    };

    std::vector<Stretch> crossings;  // from: x where the border crosses the row; to: not used
    std::vector<Stretch> too_near;
    std::size_t seen = 0;
    for (const auto& [from, to] : border.pieces) {
        if (++seen % 4096 == 0) check(0);
        const PlanPoint &a = border.points[from], &b = border.points[to];
        const auto [bottom, top] = std::minmax(a[1], b[1]);
        // A piece owns its lower end but not its upper one, so a row through a corner counts once.
        for (std::int64_t row = row_above(bottom); row < row_above(top); ++row) {
            const double x = a[0] + (row_y(row) - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            crossings.push_back({row, x, x});
        }
        const std::int64_t last = row_above(top + clearance);
        for (std::int64_t row = row_above(bottom - clearance); row < last; ++row) {
            double near_low = infinity, near_high = -infinity;
            near_segment(near_low, near_high, a, b, clearance, row_y(row));
            if (near_low <= near_high) too_near.push_back({row, near_low, near_high});
        }
    }
    std::sort(crossings.begin(), crossings.end());
    std::sort(too_near.begin(), too_near.end());

    std::vector<PlanPoint> points;
    auto blocked = too_near.begin();
    double blocked_to = -infinity;  // of the row, up to what is reached so far
    std::int64_t blocked_row = -1;
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
        const std::int64_t row = crossings[i].row;
        check(static_cast<double>(i) / static_cast<double>(crossings.size()));
        if (row != blocked_row) {
            blocked_row = row;
            blocked_to = -infinity;
            while (blocked != too_near.end() && blocked->row < row)
                ++blocked;
        }
        const double shift = row % 2 == 0 ? 0 : 0.5;
        const auto column = [&](double x) { return (x - low[0]) / edge_length - shift; };
        const auto last = static_cast<std::int64_t>(std::floor(column(crossings[i + 1].from)));
        for (auto k = static_cast<std::int64_t>(std::ceil(column(crossings[i].from))); k <= last;
             ++k) {
            const double x = low[0] + (static_cast<double>(k) + shift) * edge_length;
            while (blocked != too_near.end() && blocked->row == row && blocked->from <= x) {
                blocked_to = std::max(blocked_to, blocked->to);
                ++blocked;
            }
            if (x > blocked_to) points.push_back({x, row_y(row)});
        }
    }
    return points;
}

}  // namespace realmodel::meshing
