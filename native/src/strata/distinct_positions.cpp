// SPDX-License-Identifier: GPL-3.0-or-later
#include "distinct_positions.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "parallel_chunks.hpp"

namespace realmodel::strata {

namespace {

using PlanPosition = std::array<double, 2>;

double moved(double value, int units) {
    for (; units > 0; --units)
        value = std::nextafter(value, HUGE_VAL);
    for (; units < 0; ++units)
        value = std::nextafter(value, -HUGE_VAL);
    return value;
}

/// Moves places to free positions beside them.
class Spreader {
public:
    Spreader(const exact::PlanGeometry& geometry, const Places& places)
        : geometry_(geometry), places_(places), position_(places.representative.size()) {
        for (std::size_t p = 0; p < position_.size(); ++p) {
            const auto& point = geometry.point(places.representative[p]);
            position_[p] = {point.x, point.y};
        }
    }

    bool movable(std::size_t place) const {
        return places_.representative[place] >= geometry_.vertex_count();
    }
    const PlanPosition& at(std::size_t place) const { return position_[place]; }
    bool any_moved() const { return any_moved_; }

    /// Gives places in equal positions positions of their own. Places are in order of position.
    void separate() {
        for (std::size_t p = 1; p < position_.size(); ++p) {
            if (original(p) != original(p - 1)) continue;
            index();
            // input vertices come first among equals, so p is a crossing
            move(p, [](int, int) { return true; });
        }
    }

    /// Moves a place by as little as possible, but along the given axis.
    void move_along(std::size_t place, int axis) {
        index();
        move(place, [axis](int x, int y) { return (axis == 0 ? x : y) != 0; });
    }

private:
    PlanPosition original(std::size_t place) const {
        const auto& point = geometry_.point(places_.representative[place]);
        return {point.x, point.y};
    }
    void index() {
        if (!taken_.empty()) return;
        taken_.insert(position_.begin(), position_.end());
        any_moved_ = true;
    }
    template <class Allowed>
    void move(std::size_t place, const Allowed& allowed) {
        const PlanPosition from = position_[place];
        for (int reach = 1;; ++reach) {
            for (int x = -reach; x <= reach; ++x) {
                for (int y = -reach; y <= reach; ++y) {
                    if (std::max(std::abs(x), std::abs(y)) != reach || !allowed(x, y)) continue;
                    const PlanPosition to{moved(from[0], x), moved(from[1], y)};
                    if (!taken_.insert(to).second) continue;
                    position_[place] = to;
                    return;
                }
            }
        }
    }

    const exact::PlanGeometry& geometry_;
    const Places& places_;
    std::vector<PlanPosition> position_;
    std::set<PlanPosition> taken_;
    bool any_moved_ = false;
};

struct Extent {
    PlanPosition low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
    void include(const PlanPosition& p) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
};

template <class Visit>
void for_each_corner_of_cells(const FaceList& faces, const Progress* progress, const Visit& visit) {
    for (std::size_t f = 0; f < faces.size(); ++f) {
        poll(progress, f);
        for (const std::int32_t cell : {faces.above[f], faces.below[f]}) {
            if (cell == kOutsideCell) continue;
            for (const Corner& corner : faces.polygons[f])
                visit(static_cast<std::size_t>(cell), corner.point);
        }
    }
}

/// Spreads the cells whose places all have one x, or one y; true where there were any.
bool spread_flat_cells(const FaceList& faces, const Places& places, Spreader& spreader,
                       const Progress* progress) {
    std::int32_t cells = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        cells = std::max({cells, faces.above[f] + 1, faces.below[f] + 1});
    }
    std::vector<Extent> extent(static_cast<std::size_t>(cells));
    const auto place_of = [&](PointId point) {
        return static_cast<std::size_t>(places.of_point[static_cast<std::size_t>(point)]);
    };
    for_each_corner_of_cells(faces, progress, [&](std::size_t cell, PointId point) {
        extent[cell].include(spreader.at(place_of(point)));
    });
    std::vector<std::array<std::int64_t, 2>> to_move(extent.size(), {-1, -1});
    bool any = false;
    for_each_corner_of_cells(faces, progress, [&](std::size_t cell, PointId point) {
        const std::size_t place = place_of(point);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            if (extent[cell].low[axis] == extent[cell].high[axis] && spreader.movable(place)) {
                to_move[cell][axis] =
                    std::max(to_move[cell][axis], static_cast<std::int64_t>(place));
                any = true;
            }
        }
    });
    if (!any) return false;
    for (const auto& places_to_move : to_move) {
        for (int axis = 0; axis < 2; ++axis) {
            const std::int64_t place = places_to_move[static_cast<std::size_t>(axis)];
            if (place >= 0) spreader.move_along(static_cast<std::size_t>(place), axis);
        }
    }
    return true;
}

}  // namespace

void make_distinct(const exact::PlanGeometry& geometry, const FaceList& faces, const Places& places,
                   Loops& loops, const Progress* progress) {
    Spreader spreader(geometry, places);
    spreader.separate();
    // Moving one cell's place may flatten its neighbour; a few rounds settle it.
    for (int round = 0; round < 16 && spread_flat_cells(faces, places, spreader, progress);
         ++round) {
    }
    for (std::size_t p = 0; p < places.representative.size(); ++p) {
        poll(progress, p);
        const auto begin = static_cast<std::size_t>(loops.place_offsets[p]);
        const auto end = static_cast<std::size_t>(loops.place_offsets[p + 1]);
        for (std::size_t v = begin; v < end; ++v) {
            auto& position = loops.positions[v];
            position[0] = spreader.at(p)[0];
            position[1] = spreader.at(p)[1];
            if (v > begin && position[2] <= loops.positions[v - 1][2]) {
                position[2] = std::nextafter(loops.positions[v - 1][2], HUGE_VAL);
            }
        }
    }
}

}  // namespace realmodel::strata
