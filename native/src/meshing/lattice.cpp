// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/vectors.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::meshing {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Where something meets a row of the lattice.
struct RowInterval {
    std::int64_t row;
    double from, to;
    auto operator<=>(const RowInterval&) const = default;
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

/// The interval of the line y within `distance` of the segment ab: a convex set, hence an interval.
/// Empty (low > high) where there is none.
void near_segment(double& low, double& high, const PlanPoint& a, const PlanPoint& b,
                  double distance, double y) {
    for (const PlanPoint& end : {a, b}) {
        const double rest = distance * distance - (y - end[1]) * (y - end[1]);
        if (rest < 0) continue;
        low = std::min(low, end[0] - std::sqrt(rest));
        high = std::max(high, end[0] + std::sqrt(rest));
    }
    const double length = realmodel::distance(a, b);
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
    /// `excluded`: squares that get no triangles, sorted, by the row and column of their lower
    /// left.
    Weaver(FlatMesh& mesh, bool is_square, std::vector<std::array<std::int64_t, 2>>&& excluded)
        : mesh_(mesh), is_square_(is_square), excluded_(std::move(excluded)) {}

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
            if (!is_whole || std::binary_search(excluded_.begin(), excluded_.end(),
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
    std::vector<std::array<std::int64_t, 2>> excluded_;
    Row lower_;
    std::vector<std::int32_t> under_;  ///< the triangle under the edge to the next column
};

/// Fills the rows of a lattice between the crossings of the border with them.
class RowFiller {
public:
    RowFiller(const LatticeFrame& frame, SizeField& size, double edge_length, double room,
              const Check& check)
        : map_{frame},
          frame_(frame),
          size_(size),
          edge_length_(edge_length),
          room_(room),
          check_(check) {}

    void keep_off_border(const BorderPieces& border, std::span<const std::int32_t> loners) {
        for (const auto& [from, to] : border.border) {
            const PlanPoint a = map_.into(border.points[from]), b = map_.into(border.points[to]);
            const auto [bottom, top] = std::minmax(a[1], b[1]);
            // A piece owns its lower end but not its upper one, so a row through a corner counts
            // once.
            for (std::int64_t row = row_above(bottom); row < row_above(top); ++row) {
                const double x = a[0] + (row_y(row) - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                crossings_.push_back({row, x, x});
            }
            keep_off(a, b);
        }
        for (const auto& [from, to] : border.inner)
            keep_off(map_.into(border.points[from]), map_.into(border.points[to]));
        for (const std::int32_t loner : loners) {
            const PlanPoint p = map_.into(border.points[loner]);
            keep_off(p, p);
        }
        std::sort(crossings_.begin(), crossings_.end());
        std::sort(too_near_.begin(), too_near_.end());
        std::sort(excluded_.begin(), excluded_.end());
        blocked_ = too_near_.begin();
    }

    TriangleLattice fill() {
        Weaver weaver(lattice_.mesh, frame_.is_square, std::move(excluded_));
        const auto finish_row = [&] {
            if (!row_.columns.empty()) weaver.add(std::move(row_));
            row_ = {};
        };
        for (std::size_t i = 0; i + 1 < crossings_.size(); i += 2) {
            check_(static_cast<double>(i) / static_cast<double>(crossings_.size()));
            if (crossings_[i].row != row_.number) {
                finish_row();
                begin_row(crossings_[i].row);
            }
            fill_between(crossings_[i].from, crossings_[i + 1].from);
        }
        finish_row();
        find_rim();
        return std::move(lattice_);
    }

private:
    std::int64_t row_above(double y) const {
        return static_cast<std::int64_t>(std::ceil(y / frame_.row_height));
    }
    double row_y(std::int64_t row) const { return static_cast<double>(row) * frame_.row_height; }

    void keep_off(const PlanPoint& a, const PlanPoint& b) {
        if (++seen_ % 4096 == 0) check_(0);
        const auto [bottom, top] = std::minmax(a[1], b[1]);
        if (frame_.is_square) {
            const auto cell = [](double at, double width) {
                return static_cast<std::int64_t>(std::floor(at / width));
            };
            const double reserve = 1e-6 * edge_length_;
            const auto [left, right] = std::minmax(a[0], b[0]);
            for (auto r = cell(bottom - reserve, frame_.row_height);
                 r <= cell(top + reserve, frame_.row_height); ++r) {
                for (auto k = cell(left - reserve, frame_.spacing);
                     k <= cell(right + reserve, frame_.spacing); ++k)
                    excluded_.push_back({r, k});
            }
        }
        const std::int64_t last = row_above(top + room_);
        for (std::int64_t row = row_above(bottom - room_); row < last; ++row) {
            double low = kInfinity, high = -kInfinity;
            near_segment(low, high, a, b, room_, row_y(row));
            if (low <= high) too_near_.push_back({row, low, high});
        }
    }

    void begin_row(std::int64_t row) {
        row_.number = row;
        row_.first = static_cast<std::int32_t>(lattice_.points.size());
        blocked_to_ = -kInfinity;
        while (blocked_ != too_near_.end() && blocked_->row < row)
            ++blocked_;
    }

    void fill_between(double from, double to) {
        const double shift = (row_.number & 1) == 0 || frame_.is_square ? 0 : 0.5;
        const auto column = [&](double x) { return x / frame_.spacing - shift; };
        const auto last = static_cast<std::int64_t>(std::floor(column(to)));
        for (auto k = static_cast<std::int64_t>(std::ceil(column(from))); k <= last; ++k) {
            const double x = (static_cast<double>(k) + shift) * frame_.spacing;
            while (blocked_ != too_near_.end() && blocked_->row == row_.number &&
                   blocked_->from <= x) {
                blocked_to_ = std::max(blocked_to_, blocked_->to);
                ++blocked_;
            }
            if (x <= blocked_to_) continue;
            const PlanPoint p = map_.out(x, row_y(row_.number));
            if (!size_.is_uniform() &&
                std::abs(size_.at(p) - edge_length_) > 0.002 * edge_length_) {
                continue;
            }
            if (!row_.columns.empty() && row_.columns.back() >= k) continue;
            row_.columns.push_back(k);
            lattice_.points.push_back(p);
        }
    }

    void find_rim() {
        const FlatMesh& mesh = lattice_.mesh;
        std::vector<bool> is_used(lattice_.points.size(), false);
        mesh.for_each_edge([&](HalfEdge edge) {
            is_used[mesh.from(edge)] = true;
            if (mesh.is_border(edge)) lattice_.rim.push_back(edge);
        });
        for (std::size_t i = 0; i < is_used.size(); ++i)
            if (!is_used[i]) lattice_.loners.push_back(static_cast<std::int32_t>(i));
    }

    FrameMap map_;
    const LatticeFrame& frame_;
    SizeField& size_;
    double edge_length_, room_;
    const Check& check_;
    std::size_t seen_ = 0;
    std::vector<RowInterval> crossings_;  // from: x where the border crosses the row; to: not used
    std::vector<RowInterval> too_near_;
    std::vector<std::array<std::int64_t, 2>> excluded_;
    TriangleLattice lattice_;
    Row row_;
    std::vector<RowInterval>::const_iterator blocked_;
    double blocked_to_ = -kInfinity;  // in the row, up to what is reached so far
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
            const double length = distance(a, b);
            if (length < 4 * edge_length) continue;
            const double turn =
                elementary::atan2(b[1] - a[1], b[0] - a[0]) / (std::numbers::pi / 3);
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
double fitted(double length, double step) {
    constexpr double kMostStretch = 0.015;
    const double count = std::round(length / step);
    if (count < 1) return step;
    const double fits = length / count;
    return std::abs(fits - step) <= kMostStretch * step ? fits : step;
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

TriangleLattice lattice_inside(const BorderPieces& border, std::span<const std::int32_t> loners,
                               const LatticeFrame& frame, SizeField& size, double edge_length,
                               double clearance, const Check& check) {
    RowFiller filler(frame, size, edge_length, clearance * edge_length, check);
    filler.keep_off_border(border, loners);
    return filler.fill();
}

}  // namespace realmodel::meshing
