// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/index.hpp"

namespace realmodel::spatial {

/// x and y in plan.
using PlanPosition = std::array<double, 2>;

/// An axis-parallel box in plan.
struct PlanBox {
    double low_x = 0, low_y = 0, high_x = 0, high_y = 0;
    double width() const { return high_x - low_x; }
    double height() const { return high_y - low_y; }
    /// The box around both.
    PlanBox united(const PlanBox& other) const {
        return {std::min(low_x, other.low_x), std::min(low_y, other.low_y),
                std::max(high_x, other.high_x), std::max(high_y, other.high_y)};
    }
    PlanBox widened(double by) const { return {low_x - by, low_y - by, high_x + by, high_y + by}; }
    bool contains(const PlanPosition& p) const {
        return p[0] >= low_x && p[0] <= high_x && p[1] >= low_y && p[1] <= high_y;
    }
    /// Whether the boxes share at least a point. Coordinates are rounded monotonically, so boxes of
    /// polygons that share an area always meet.
    bool meets(const PlanBox& other) const {
        return low_x <= other.high_x && other.low_x <= high_x && low_y <= other.high_y &&
               other.low_y <= high_y;
    }
};

/// A box around nothing.
inline constexpr PlanBox kNoBox{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

/// The box around some positions.
inline PlanBox box_around(std::span<const PlanPosition> positions) {
    PlanBox box = kNoBox;
    for (const auto& [x, y] : positions)
        box = box.united({x, y, x, y});
    return box;
}

/// Tiles from column `left` to `right` and row `low` to `high`, both included.
struct TileSpan {
    std::int32_t left, right, low, high;
};

/// A uniform grid of tiles over a frame; what lies beside the frame belongs to the nearest tile. A
/// point lies in the tiles of every box around it: columns and rows are monotone in x and y,
/// whatever is rounded.
class PlanTiles {
public:
    PlanTiles() = default;
    /// About `count` tiles, as square as the frame allows.
    PlanTiles(const PlanBox& frame, std::size_t count);

    std::size_t size() const { return static_cast<std::size_t>(columns_) * rows(); }
    std::size_t columns() const { return static_cast<std::size_t>(columns_); }
    std::size_t rows() const { return static_cast<std::size_t>(rows_); }
    const PlanBox& frame() const { return frame_; }
    double step_x() const { return step_x_; }
    double step_y() const { return step_y_; }
    TileSpan span(const PlanBox& box) const {
        return {column(box.low_x), column(box.high_x), row(box.low_y), row(box.high_y)};
    }
    /// The tile that a position lies in.
    std::size_t tile_at(const PlanPosition& p) const { return tile(column(p[0]), row(p[1])); }
    std::size_t tile(std::int32_t column, std::int32_t row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(column);
    }
    TileSpan span_of(std::size_t tile) const {
        const auto column = static_cast<std::int32_t>(tile % columns()),
                   row = static_cast<std::int32_t>(tile / columns());
        return {column, column, row, row};
    }
    template <class Visit>
    void for_each(const TileSpan& span, const Visit& visit) const {
        for (std::int32_t r = span.low; r <= span.high; ++r) {
            for (std::int32_t c = span.left; c <= span.right; ++c)
                visit(tile(c, r));
        }
    }
    /// Whether `holds` is true of any tile.
    template <class Holds>
    bool any(const TileSpan& span, const Holds& holds) const {
        for (std::int32_t r = span.low; r <= span.high; ++r) {
            for (std::int32_t c = span.left; c <= span.right; ++c) {
                if (holds(tile(c, r))) return true;
            }
        }
        return false;
    }
    /// Calls visit(tile) for every tile whose center lies in a triangle, or as good as on its edge.
    template <class Visit>
    void for_each_center_in(const std::array<PlanPosition, 3>& triangle, const Visit& visit) const;

    std::int32_t column(double x) const { return nearest((x - frame_.low_x) / step_x_, columns_); }
    std::int32_t row(double y) const { return nearest((y - frame_.low_y) / step_y_, rows_); }

private:
    static std::int32_t nearest(double at, std::int32_t count) {
        if (!(at > 0.0)) return 0;
        return at >= static_cast<double>(count) ? count - 1 : static_cast<std::int32_t>(at);
    }

    PlanBox frame_;
    double step_x_ = 1, step_y_ = 1;
    std::int32_t columns_ = 0, rows_ = 0;
};

template <class Visit>
void PlanTiles::for_each_center_in(const std::array<PlanPosition, 3>& triangle,
                                   const Visit& visit) const {
    const PlanBox box = box_around(triangle);
    if (!box.meets(frame_)) return;
    const TileSpan rows = span(box);
    const double slack = 1e-3 * step_x_;
    for (std::int32_t r = rows.low; r <= rows.high; ++r) {
        const double y = frame_.low_y + (r + 0.5) * step_y_;
        double from = HUGE_VAL, to = -HUGE_VAL;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto &p = triangle[i], &q = triangle[(i + 1) % 3];
            if (std::min(p[1], q[1]) > y || std::max(p[1], q[1]) < y) continue;
            const double share = p[1] == q[1] ? 0.0 : (y - p[1]) / (q[1] - p[1]);
            for (const double x : {p[0] + share * (q[0] - p[0]),
                                   p[1] == q[1] ? q[0] : p[0] + share * (q[0] - p[0])}) {
                from = std::min(from, x);
                to = std::max(to, x);
            }
        }
        if (from > to || to < frame_.low_x - step_x_ || from > frame_.high_x + step_x_) continue;
        const std::int32_t last = column(to + slack);
        for (std::int32_t c = column(from - slack); c <= last; ++c) {
            const double x = frame_.low_x + (c + 0.5) * step_x_;
            if (x >= from - slack && x <= to + slack) visit(tile(c, r));
        }
    }
}

/// The numbers of positions, in their order along a Hilbert curve through their extent (Hilbert
/// 1891; the turns by table as in Warren, "Hacker's Delight", section 16-1): those near each other
/// in plan mostly follow each other. Positions too near each other to be told apart stay in the
/// order in which they came.
std::vector<std::uint32_t> along_hilbert_curve(std::span<const PlanPosition> positions);

/// Points in plan, in tiles about as many as there are points: finds the few within a box.
class PointBins {
public:
    explicit PointBins(const std::vector<PlanPosition>& points)
        : tiles_(box_around(points), points.size()) {
        bins_ = bucketize<BinnedPoint>(tiles_.size(), [&](const auto& put) {
            for (std::size_t i = 0; i < points.size(); ++i)
                put(tiles_.tile_at(points[i]), BinnedPoint{points[i], i});
        });
    }

    /// Calls visit(number, position) for every point within the box, borders included.
    template <class Visit>
    void within(const PlanBox& box, const Visit& visit) const {
        if (!box.meets(tiles_.frame())) return;
        tiles_.for_each(tiles_.span(box), [&](std::size_t tile) {
            for (const auto& [p, number] : bins_[tile]) {
                if (box.contains(p)) visit(number, p);
            }
        });
    }

private:
    struct BinnedPoint {
        PlanPosition position;
        std::size_t number;
    };

    PlanTiles tiles_;
    Buckets<BinnedPoint> bins_;
};

/// Numbers of things, to be found by the tiles that their boxes meet.
class TileBins {
public:
    /// span_of(number) is where each of `count` things is, or null where it does not count; of the
    /// tiles only those that are wanted are searched.
    template <class SpanOf>
    TileBins(const PlanTiles& tiles, const std::vector<std::uint8_t>& is_wanted, std::size_t count,
             const SpanOf& span_of, const Execution& execution)
        : tiles_(tiles) {
        const auto produce = [&](std::size_t chunk, const auto& put) {
            for (std::size_t i = chunk * kRange, end = std::min(count, i + kRange); i < end; ++i) {
                const TileSpan* span = span_of(i);
                if (span == nullptr) continue;
                tiles.for_each(*span, [&](std::size_t tile) {
                    if (is_wanted[tile] != 0)
                        put(tile, BinnedBox{static_cast<std::int32_t>(i), span->left, span->low});
                });
            }
        };
        items_ = bucketize_in_any_order<BinnedBox>(tiles.size(), (count + kRange - 1) / kRange,
                                                   produce, execution);
    }

    /// Calls test(number) once for each thing in these tiles, which are wanted, in no order that
    /// may matter, until it is false; whether it never was.
    template <class Test>
    bool all(const TileSpan& span, const Test& test) const {
        for (std::int32_t row = span.low; row <= span.high; ++row) {
            for (std::int32_t column = span.left; column <= span.right; ++column) {
                for (const BinnedBox& item : items_[tiles_.tile(column, row)]) {
                    // in the first tile that both have
                    if (column == std::max(span.left, item.left) &&
                        row == std::max(span.low, item.low) && !test(item.number))
                        return false;
                }
            }
        }
        return true;
    }

private:
    static constexpr std::size_t kRange = 512;
    struct BinnedBox {
        std::int32_t number, left, low;  ///< its first column and row
    };

    const PlanTiles& tiles_;
    Buckets<BinnedBox> items_;  ///< of each tile
};

}  // namespace realmodel::spatial
