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

/// From the plan into a frame's own coordinates and back.
struct FrameMap {
    LatticeFrame frame;

    PlanPoint into(const PlanPoint& p) const {
        const double x = p[0] - frame.origin[0], y = p[1] - frame.origin[1];
        return {x * frame.axis[0] + y * frame.axis[1], y * frame.axis[0] - x * frame.axis[1]};
    }
    PlanPoint out(double x, double y) const {
        return {frame.origin[0] + x * frame.axis[0] - y * frame.axis[1],
                frame.origin[1] + x * frame.axis[1] + y * frame.axis[0]};
    }
};

/// The points of one row, by their columns.
struct Row {
    std::int64_t number = std::numeric_limits<std::int64_t>::min();
    std::int32_t first = 0;  ///< number of its first point
    std::vector<std::int64_t> columns;
};

/// Puts triangles between the rows of a lattice as they come.
class Weaver {
public:
    /// `kept_off`: squares that get no triangles, sorted, by the row and column of their lower
    /// left.
    Weaver(FlatMesh& mesh, bool is_square, std::vector<std::array<std::int64_t, 2>>&& kept_off)
        : mesh_(mesh), is_square_(is_square), kept_off_(std::move(kept_off)) {}

    void add(Row&& upper) {
        std::vector<std::int32_t> under(upper.columns.size(), -1);
        if (upper.number == lower_.number + 1) {
            if (is_square_) {
                weave_squares(upper, under);
            } else {
                weave(upper, under);
            }
        }
        lower_ = std::move(upper);
        under_ = std::move(under);
    }

private:
    void weave(const Row& upper, std::vector<std::int32_t>& under) {
        // Column k of the lower row lies below columns k + lean - 1 and k + lean of the upper one.
        const std::int64_t lean = lower_.number & 1;
        const auto has = [](const Row& row, std::size_t i, std::int64_t column) {
            return i < row.columns.size() && row.columns[i] == column;
        };
        std::size_t j = 0;
        std::int32_t standing = -1;  // the triangle that ends at the present column
        for (std::size_t i = 0; i < lower_.columns.size(); ++i) {
            const std::int64_t k = lower_.columns[i];
            if (i > 0 && lower_.columns[i - 1] != k - 1) standing = -1;
            while (j < upper.columns.size() && upper.columns[j] < k + lean - 1)
                ++j;
            const std::int32_t here = lower_.first + static_cast<std::int32_t>(i);
            const bool has_left = has(upper, j, k + lean - 1);
            const std::size_t r = j + (has_left ? 1 : 0);
            const bool has_right = has(upper, r, k + lean);
            const std::int32_t right = upper.first + static_cast<std::int32_t>(r);
            std::int32_t hanging = -1;  // from the upper row, its tip here
            if (has_left && has_right) {
                hanging = mesh_.add_triangle({here, right, right - 1});
                under[j] = hanging;
                if (standing >= 0) mesh_.join({hanging, 2}, {standing, 1});
            }
            standing = -1;
            if (has_right && has(lower_, i + 1, k + 1)) {
                standing = mesh_.add_triangle({here, here + 1, right});
                if (hanging >= 0) mesh_.join({standing, 2}, {hanging, 0});
                if (under_[i] >= 0) mesh_.join({standing, 0}, {under_[i], 1});
            }
        }
    }

    void weave_squares(const Row& upper, std::vector<std::int32_t>& under) {
        std::size_t j = 0;
        std::int32_t last = -1;  // the lower right triangle of the square before
        for (std::size_t i = 0; i + 1 < lower_.columns.size(); ++i) {
            const std::int64_t k = lower_.columns[i];
            while (j < upper.columns.size() && upper.columns[j] < k)
                ++j;
            const bool is_whole = lower_.columns[i + 1] == k + 1 && j + 1 < upper.columns.size() &&
                                  upper.columns[j] == k && upper.columns[j + 1] == k + 1;
            if (!is_whole || std::binary_search(kept_off_.begin(), kept_off_.end(),
                                                std::array{lower_.number, k})) {
                last = -1;
                continue;
            }
            const std::int32_t a = lower_.first + static_cast<std::int32_t>(i),
                               d = upper.first + static_cast<std::int32_t>(j);
            const std::int32_t right = mesh_.add_triangle({a, a + 1, d + 1});
            const std::int32_t left = mesh_.add_triangle({a, d + 1, d});
            mesh_.join({right, 2}, {left, 0});
            if (last >= 0) mesh_.join({left, 2}, {last, 1});
            if (under_[i] >= 0) mesh_.join({right, 0}, {under_[i], 1});
            under[j] = left;
            last = right;
        }
    }

    FlatMesh& mesh_;
    bool is_square_;
    std::vector<std::array<std::int64_t, 2>> kept_off_;
    Row lower_;
    std::vector<std::int32_t> under_;  ///< the triangle under the edge to the next column
};

/// An edge as seen in the direction that a frame may take.
struct LongEdge {
    PlanPoint a, b;
    double length;
    double turn;  ///< its direction modulo 60 degrees, 0 .. 1
};

std::vector<LongEdge> long_edges(const RegionGraph& graph, double edge_length) {
    std::vector<LongEdge> edges;
    for (const auto* list : {&graph.border, &graph.inner}) {
        for (const auto& [from, to] : *list) {
            const PlanPoint &a = graph.points[from], &b = graph.points[to];
            const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
            if (length < 4 * edge_length) continue;
            const double turn = std::atan2(b[1] - a[1], b[0] - a[0]) / (std::numbers::pi / 3);
            edges.push_back({a, b, length, turn - std::floor(turn)});
        }
    }
    return edges;
}

/// How far two directions are apart, of 60 degrees.
double apart(double s, double t) {
    const double d = std::abs(s - t);
    return std::min(d, 1 - d);
}

/// A length cut into whole parts of about the one given, if that stretches them by little; else
/// the one given.
double fitted(double length, double part) {
    constexpr double kMostStretch = 0.015;
    const double count = std::round(length / part);
    if (count < 1) return part;
    const double fits = length / count;
    return std::abs(fits - part) <= kMostStretch * part ? fits : part;
}

}  // namespace

LatticeFrame fitting_frame(const RegionGraph& graph, double edge_length) {
    constexpr double kSameDirection = 0.01;  // of 60 degrees
    LatticeFrame frame{
        graph.points.front(), {1, 0}, edge_length, edge_length * std::numbers::sqrt3 / 2};
    const std::vector<LongEdge> edges = long_edges(graph, edge_length);
    if (edges.empty()) return frame;
    constexpr int kBins = 120;
    std::array<double, kBins> lengths{};
    for (const LongEdge& edge : edges)
        lengths[std::min(kBins - 1, static_cast<int>(edge.turn * kBins))] += edge.length;
    int best = 0;
    const auto around = [&](int bin) {
        return lengths[(bin + kBins - 1) % kBins] + 2 * lengths[bin] + lengths[(bin + 1) % kBins];
    };
    for (int bin = 1; bin < kBins; ++bin)
        if (around(bin) > around(best)) best = bin;
    const LongEdge* longest = nullptr;
    for (const LongEdge& edge : edges) {
        if (apart(edge.turn, (best + 0.5) / kBins) > 1.5 / kBins) continue;
        if (longest == nullptr || edge.length > longest->length) longest = &edge;
    }
    if (longest == nullptr) return frame;
    frame.origin = longest->a;
    frame.axis = {(longest->b[0] - longest->a[0]) / longest->length,
                  (longest->b[1] - longest->a[1]) / longest->length};
    frame.spacing = fitted(longest->length, edge_length);

    // The border opposite: the parallel edge, not much shorter, that is farthest from this one.
    const FrameMap map{frame};
    double farthest = 0;
    for (const LongEdge& edge : edges) {
        if (apart(edge.turn, longest->turn) > kSameDirection || edge.length < longest->length / 3) {
            continue;
        }
        const PlanPoint a = map.into(edge.a), b = map.into(edge.b);
        if (std::abs(b[1] - a[1]) > 0.1 * edge_length) continue;
        farthest = std::max(farthest, std::abs(a[1]));
    }
    if (farthest > 0) frame.row_height = fitted(farthest, frame.row_height);
    return frame;
}

Lattice lattice_inside(const BorderPieces& border, std::span<const std::int32_t> loners,
                       const LatticeFrame& frame, const SizeField& size, double edge_length,
                       double clearance, const Check& check) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const FrameMap map{frame};
    const double room = clearance * edge_length;
    const auto row_above = [&](double y) {
        return static_cast<std::int64_t>(std::ceil(y / frame.row_height));
    };
    const auto row_y = [&](std::int64_t row) {
        return static_cast<double>(row) * frame.row_height;
    };

    std::vector<Stretch> crossings;  // from: x where the border crosses the row; to: not used
    std::vector<Stretch> too_near;
    std::vector<std::array<std::int64_t, 2>> kept_off;
    std::size_t seen = 0;
    const auto keep_off = [&](const PlanPoint& a, const PlanPoint& b) {
        if (++seen % 4096 == 0) check(0);
        const auto [bottom, top] = std::minmax(a[1], b[1]);
        if (frame.is_square) {
            const auto cell = [](double at, double width) {
                return static_cast<std::int64_t>(std::floor(at / width));
            };
            const double reserve = 1e-6 * edge_length;
            const auto [left, right] = std::minmax(a[0], b[0]);
            for (auto r = cell(bottom - reserve, frame.row_height);
                 r <= cell(top + reserve, frame.row_height); ++r) {
                for (auto k = cell(left - reserve, frame.spacing);
                     k <= cell(right + reserve, frame.spacing); ++k)
                    kept_off.push_back({r, k});
            }
        }
        const std::int64_t last = row_above(top + room);
        for (std::int64_t row = row_above(bottom - room); row < last; ++row) {
            double near_low = kInfinity, near_high = -kInfinity;
            near_segment(near_low, near_high, a, b, room, row_y(row));
            if (near_low <= near_high) too_near.push_back({row, near_low, near_high});
        }
    };
    for (const auto& [from, to] : border.border) {
        const PlanPoint a = map.into(border.points[from]), b = map.into(border.points[to]);
        const auto [bottom, top] = std::minmax(a[1], b[1]);
        // A piece owns its lower end but not its upper one, so a row through a corner counts once.
        for (std::int64_t row = row_above(bottom); row < row_above(top); ++row) {
            const double x = a[0] + (row_y(row) - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            crossings.push_back({row, x, x});
        }
        keep_off(a, b);
    }
    for (const auto& [from, to] : border.inner)
        keep_off(map.into(border.points[from]), map.into(border.points[to]));
    for (const std::int32_t loner : loners) {
        const PlanPoint p = map.into(border.points[loner]);
        keep_off(p, p);
    }
    std::sort(crossings.begin(), crossings.end());
    std::sort(too_near.begin(), too_near.end());

    std::sort(kept_off.begin(), kept_off.end());
    Lattice lattice;
    Weaver weaver(lattice.mesh, frame.is_square, std::move(kept_off));
    Row row_points;
    const auto finish_row = [&] {
        if (!row_points.columns.empty()) weaver.add(std::move(row_points));
        row_points = {};
    };
    auto blocked = too_near.begin();
    double blocked_to = -kInfinity;  // of the row, up to what is reached so far
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
        const std::int64_t row = crossings[i].row;
        check(static_cast<double>(i) / static_cast<double>(crossings.size()));
        if (row != row_points.number) {
            finish_row();
            row_points.number = row;
            row_points.first = static_cast<std::int32_t>(lattice.points.size());
            blocked_to = -kInfinity;
            while (blocked != too_near.end() && blocked->row < row)
                ++blocked;
        }
        const double shift = (row & 1) == 0 || frame.is_square ? 0 : 0.5;
        const auto column = [&](double x) { return x / frame.spacing - shift; };
        const auto last = static_cast<std::int64_t>(std::floor(column(crossings[i + 1].from)));
        for (auto k = static_cast<std::int64_t>(std::ceil(column(crossings[i].from))); k <= last;
             ++k) {
            const double x = (static_cast<double>(k) + shift) * frame.spacing;
            while (blocked != too_near.end() && blocked->row == row && blocked->from <= x) {
                blocked_to = std::max(blocked_to, blocked->to);
                ++blocked;
            }
            if (x <= blocked_to) continue;
            const PlanPoint p = map.out(x, row_y(row));
            if (!size.is_uniform() && std::abs(size.at(p) - edge_length) > 0.002 * edge_length) {
                continue;
            }
            if (!row_points.columns.empty() && row_points.columns.back() >= k) continue;
            row_points.columns.push_back(k);
            lattice.points.push_back(p);
        }
    }
    finish_row();

    const auto triangles = static_cast<std::int32_t>(lattice.mesh.corners.size());
    std::vector<bool> used(lattice.points.size(), false);
    lattice.on_rim.assign(lattice.points.size(), false);
    for (std::int32_t t = 0; t < triangles; ++t) {
        for (int i = 0; i < 3; ++i) {
            const HalfEdge side(t, i);
            used[lattice.mesh.from(side)] = true;
            if (!lattice.mesh.is_border(side)) continue;
            lattice.rim.push_back(side);
            lattice.on_rim[lattice.mesh.from(side)] = lattice.on_rim[lattice.mesh.to(side)] = true;
        }
    }
    for (std::size_t i = 0; i < used.size(); ++i)
        if (!used[i]) lattice.loners.push_back(static_cast<std::int32_t>(i));
    return lattice;
}

}  // namespace realmodel::meshing
