// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/nearest_points.hpp"

#include <algorithm>
#include <limits>
#include <nanoflann.hpp>

#include "base/index.hpp"

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
    NearestSoFar(std::vector<Neighbor>& found, std::size_t count) : found_(found), count_(count) {
        found_.clear();
    }
    std::size_t size() const { return found_.size(); }
    bool empty() const { return found_.empty(); }
    bool full() const { return found_.size() == count_; }
    void sort() const {}

    /// nanoflann drops points and branches that are not nearer than this: a little more than the
    /// last one kept, so that ties, and branches bounded with rounding, are still looked at.
    double worstDist() const {
        if (!full()) return std::numeric_limits<double>::max();
        const double last = found_.back().squared_distance;
        return last + 1e-9 * last + std::numeric_limits<double>::min();
    }

    bool addPoint(double squared_distance, std::int32_t point) {
        const Neighbor added{squared_distance, point};
        if (full()) {
            if (!(added < found_.back())) return true;
            found_.pop_back();
        }
        found_.push_back(added);
        for (std::size_t i = found_.size() - 1; i > 0 && found_[i] < found_[i - 1]; --i) {
            std::swap(found_[i], found_[i - 1]);
        }
        return true;
    }

private:
    std::vector<Neighbor>& found_;
    std::size_t count_;
};

/// Keeps all that are near enough.
class NearEnough {
public:
    NearEnough(std::vector<Neighbor>& found, double squared_distance, std::size_t most)
        : found_(found), squared_distance_(squared_distance), most_(most) {
        found_.clear();
    }
    std::size_t size() const { return found_.size(); }
    bool empty() const { return found_.empty(); }
    bool full() const { return true; }
    void sort() const {}
    double worstDist() const { return squared_distance_; }
    bool addPoint(double squared_distance, std::int32_t point) {
        found_.push_back({squared_distance, point});
        return found_.size() <= most_;
    }

private:
    std::vector<Neighbor>& found_;
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
                         std::vector<Neighbor>& found) const {
    NearestSoFar nearest(found, std::min(count, size()));
    if (count == 0 || size() == 0) return;
    tree_->index.findNeighbors(nearest, position.data(), SearchParameters());
}

bool NearestPoints::within(const PlanPosition& position, double distance, std::size_t most,
                           std::vector<Neighbor>& found) const {
    // nanoflann wants what is nearer than this, and bounds branches with rounding.
    const double squared = distance * distance;
    NearEnough near(found, squared + 1e-9 * squared + std::numeric_limits<double>::min(), most);
    if (size() > 0) tree_->index.findNeighbors(near, position.data(), SearchParameters());
    return found.size() <= most;
}

}  // namespace realmodel::spatial
