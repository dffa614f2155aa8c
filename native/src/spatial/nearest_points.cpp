// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/nearest_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <numeric>

#include "base/index.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::spatial {

namespace {

/// What nanoflann asks of a set of points.
struct PlanPoints {
    std::span<const PlanPosition> points;

    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t point, std::size_t axis) const { return points[point][axis]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

/// Keeps the nearest so far, in order. nanoflann's own set keeps of equal distances whichever it
/// met first, which depends on the shape of the tree.
class NearestSoFar {
public:
    NearestSoFar(std::vector<Neighbor>& near, std::size_t count) : near_(near), count_(count) {
        near_.clear();
    }
    std::size_t size() const { return near_.size(); }
    bool empty() const { return near_.empty(); }
    bool full() const { return near_.size() == count_; }
    void sort() const {}

    /// nanoflann drops points and branches that are not nearer than this: a little more than the
    /// last one kept, so that ties, and branches bounded with rounding, are still looked at.
    double worstDist() const {
        if (!full()) return std::numeric_limits<double>::max();
        const double last = near_.back().squared_distance;
        return last + 1e-9 * last + std::numeric_limits<double>::min();
    }

    bool addPoint(double squared_distance, std::int32_t point) {
        const Neighbor added{squared_distance, point};
        if (full()) {
            if (!(added < near_.back())) return true;
            near_.pop_back();
        }
        near_.push_back(added);
        for (std::size_t i = near_.size() - 1; i > 0 && near_[i] < near_[i - 1]; --i) {
            std::swap(near_[i], near_[i - 1]);
        }
        return true;
    }

private:
    std::vector<Neighbor>& near_;
    std::size_t count_;
};

/// The same of points that count.
class NearestThatCount : public NearestSoFar {
public:
    NearestThatCount(std::vector<Neighbor>& near, std::size_t count,
                     std::span<const std::int32_t> counts)
        : NearestSoFar(near, count), counts_(counts) {}
    bool addPoint(double squared_distance, std::int32_t point) {
        return counts_[index(point)] == 0 || NearestSoFar::addPoint(squared_distance, point);
    }

private:
    std::span<const std::int32_t> counts_;
};

/// Keeps all that are near enough.
class NearEnough {
public:
    NearEnough(std::vector<Neighbor>& near, double squared_distance, std::size_t most)
        : near_(near), squared_distance_(squared_distance), most_(most) {
        near_.clear();
    }
    std::size_t size() const { return near_.size(); }
    bool empty() const { return near_.empty(); }
    bool full() const { return true; }
    void sort() const {}
    double worstDist() const { return squared_distance_; }
    bool addPoint(double squared_distance, std::int32_t point) {
        near_.push_back({squared_distance, point});
        return near_.size() <= most_;
    }

private:
    std::vector<Neighbor>& near_;
    double squared_distance_;
    std::size_t most_;
};

using KdTree = nanoflann::KDTreeSingleIndexAdaptor<
    nanoflann::L2_Simple_Adaptor<double, PlanPoints, double, std::int32_t>, PlanPoints, 2,
    std::int32_t>;

#if NANOFLANN_VERSION >= 0x150
using SearchParameters = nanoflann::SearchParameters;
#else
using SearchParameters = nanoflann::SearchParams;
#endif

}  // namespace

struct NearestPoints::Tree {
    explicit Tree(std::span<const PlanPosition> of) : points{of}, index(2, points) {}
    PlanPoints points;
    KdTree index;
};

NearestPoints::NearestPoints(std::span<const PlanPosition> points)
    : tree_(std::make_unique<Tree>(points)) {}

NearestPoints::~NearestPoints() = default;
NearestPoints::NearestPoints(NearestPoints&&) noexcept = default;
NearestPoints& NearestPoints::operator=(NearestPoints&&) noexcept = default;

std::size_t NearestPoints::size() const {
    return tree_->points.points.size();
}

const PlanPosition& NearestPoints::point(std::int32_t number) const {
    return tree_->points.points[index(number)];
}

void NearestPoints::find(const PlanPosition& position, std::size_t count,
                         std::vector<Neighbor>& near) const {
    NearestSoFar nearest(near, std::min(count, size()));
    if (count == 0 || size() == 0) return;
    tree_->index.findNeighbors(nearest, position.data(), SearchParameters());
}

void NearestPoints::find_among(const PlanPosition& position, std::size_t count,
                               std::span<const std::int32_t> counts,
                               std::vector<Neighbor>& near) const {
    NearestThatCount nearest(near, count, counts);
    if (count == 0 || size() == 0) return;
    tree_->index.findNeighbors(nearest, position.data(), SearchParameters());
}

bool NearestPoints::within(const PlanPosition& position, double distance, std::size_t most,
                           std::vector<Neighbor>& near) const {
    // nanoflann wants what is nearer than this, and bounds branches with rounding.
    const double squared = distance * distance;
    NearEnough set(near, squared + 1e-9 * squared + std::numeric_limits<double>::min(), most);
    if (size() > 0) tree_->index.findNeighbors(set, position.data(), SearchParameters());
    return near.size() <= most;
}

namespace {

constexpr double kWidest = 0.3;  // radius of a block, in distances to the last point wanted
constexpr std::size_t kCandidatesOfPoint = 4;  // candidates for each point wanted

}  // namespace

bool BlockNeighbors::prepare(std::span<const PlanPosition> nodes) {
    const PlanBox box = box_around(nodes);
    const PlanPosition center{0.5 * (box.low_x + box.high_x), 0.5 * (box.low_y + box.high_y)};
    tree_.find(center, count_, neighbors_);
    if (nodes.size() > 1) {
        const double wanted = std::sqrt(neighbors_.back().squared_distance);
        const double radius = elementary::hypot(box.high_x - center[0], box.high_y - center[1]);
        if (radius > kWidest * wanted) return false;
        // The nearest of a node lie within wanted + radius of it.
        const double reach = (wanted + 2 * radius) * (1 + 1e-9);
        if (!tree_.within(center, reach, kCandidatesOfPoint * count_, neighbors_)) return false;
    }
    candidates_.clear();
    for (const Neighbor& neighbor : neighbors_)
        candidates_.push_back(neighbor.point);
    std::sort(candidates_.begin(), candidates_.end());
    x_.clear();
    y_.clear();
    for (const std::int32_t point : candidates_) {
        const auto [x, y] = tree_.point(point);
        x_.push_back(x);
        y_.push_back(y);
    }
    squared_.resize(candidates_.size());
    keys_.resize(count_);
    order_.resize(candidates_.size());
    std::iota(order_.begin(), order_.end(), 0);
    return true;
}

std::span<const std::int32_t> BlockNeighbors::nearest(const PlanPosition& node) {
    const std::size_t count = candidates_.size();
#pragma omp simd
    for (std::size_t i = 0; i < count; ++i) {
        const double dx = node[0] - x_[i], dy = node[1] - y_[i];
        squared_[i] = dx * dx + dy * dy;
    }
    // Insertion into the order of the node before, which is nearly that of this one. Only the first
    // count_ are in order.
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t candidate = order_[i];
        const double key = squared_[static_cast<std::size_t>(candidate)];
        const auto after = [&](std::size_t k) {
            return keys_[k] > key || (keys_[k] == key && order_[k] > candidate);
        };
        std::size_t at = i;
        if (i >= count_) {
            if (!after(count_ - 1)) continue;
            at = count_ - 1;
            order_[i] = order_[at];
        }
        for (; at > 0 && after(at - 1); --at) {
            keys_[at] = keys_[at - 1];
            order_[at] = order_[at - 1];
        }
        keys_[at] = key;
        order_[at] = candidate;
    }
    return {order_.data(), count_};
}

namespace {

constexpr std::size_t kPointsInTile = 2;

std::size_t octant(double dx, double dy) {
    return (dx < 0 ? 4U : 0U) + (dy < 0 ? 2U : 0U) + (std::abs(dx) < std::abs(dy) ? 1U : 0U);
}

}  // namespace

OctantSearch::OctantSearch(std::span<const PlanPosition> points, const Wanted& wanted)
    : points_(points),
      wanted_(wanted),
      tiles_(box_around(points), points.size() / kPointsInTile),
      points_at_(bucketize<std::int32_t>(tiles_.size(), [&](const auto& put) {
          for (std::size_t i = 0; i < points.size(); ++i)
              put(tiles_.tile_at(points[i]), static_cast<std::int32_t>(i));
      })) {}

void OctantSearch::visit(std::size_t tile, const PlanPosition& position, std::int32_t left_out) {
    for (const std::int32_t point : points_at_[tile]) {
        const PlanPosition& at = points_[index(point)];
        const double dx = at[0] - position[0], dy = at[1] - position[1];
        const Neighbor here{dx * dx + dy * dy, point};
        seen_.push_back(here);
        if (here.point == left_out || here.squared_distance > wanted_.squared_radius) continue;
        auto& taken = taken_[octant(dx, dy)];
        if (taken.size() == wanted_.in_octant && taken.back() < here) continue;
        if (taken.size() == wanted_.in_octant) taken.pop_back();
        taken.insert(std::upper_bound(taken.begin(), taken.end(), here), here);
    }
}

bool OctantSearch::complete(double squared_distance) const {
    if (squared_distance > wanted_.squared_radius) return true;
    const auto within = [&](const Neighbor& n) { return n.squared_distance <= squared_distance; };
    std::size_t taken = 0;
    for (const auto& octant : taken_)
        taken += static_cast<std::size_t>(std::count_if(octant.begin(), octant.end(), within));
    if (taken >= wanted_.in_all) return true;
    return seen_.size() >= wanted_.looked_at &&
           static_cast<std::size_t>(std::count_if(seen_.begin(), seen_.end(), within)) >=
               wanted_.looked_at;
}

void OctantSearch::find(const PlanPosition& position, std::int32_t left_out,
                        std::vector<Neighbor>& nearest) {
    seen_.clear();
    for (auto& octant : taken_)
        octant.clear();
    const PlanBox& frame = tiles_.frame();
    const auto columns = static_cast<std::int32_t>(tiles_.columns());
    const auto rows = static_cast<std::int32_t>(tiles_.rows());
    const std::int32_t column = tiles_.column(position[0]), row = tiles_.row(position[1]);
    for (std::int32_t ring = 0;; ++ring) {
        const TileSpan span{column - ring, column + ring, row - ring, row + ring};
        for (std::int32_t r = std::max(span.low, 0); r <= std::min(span.high, rows - 1); ++r) {
            const bool is_whole = r == span.low || r == span.high;
            const std::int32_t stride = is_whole ? 1 : 2 * ring;
            for (std::int32_t c = span.left; c <= span.right; c += stride) {
                if (c >= 0 && c < columns) visit(tiles_.tile(c, r), position, left_out);
            }
        }
        // What was not looked at lies beyond a side that is not the frame's; a little less for
        // rounding.
        double reach = std::numeric_limits<double>::infinity();
        const auto find_span = [&](double at, double low, double step, std::int32_t from,
                                   std::int32_t to, std::int32_t count) {
            if (from > 0) reach = std::min(reach, at - (low + from * step) - 1e-9 * step);
            if (to < count - 1) reach = std::min(reach, low + (to + 1) * step - at - 1e-9 * step);
        };
        find_span(position[0], frame.low_x, tiles_.step_x(), span.left, span.right, columns);
        find_span(position[1], frame.low_y, tiles_.step_y(), span.low, span.high, rows);
        if (std::isinf(reach)) break;
        reach = std::max(0.0, reach);
        if (complete(reach * reach)) break;
    }
    nearest.clear();
    for (const auto& octant : taken_)
        nearest.insert(nearest.end(), octant.begin(), octant.end());
    std::sort(nearest.begin(), nearest.end());
    if (seen_.size() > wanted_.looked_at) {
        const auto last_one = seen_.begin() + static_cast<std::ptrdiff_t>(wanted_.looked_at - 1);
        std::nth_element(seen_.begin(), last_one, seen_.end());
        nearest.erase(std::upper_bound(nearest.begin(), nearest.end(), *last_one), nearest.end());
    }
    if (nearest.size() > wanted_.in_all) nearest.resize(wanted_.in_all);
}

}  // namespace realmodel::spatial
