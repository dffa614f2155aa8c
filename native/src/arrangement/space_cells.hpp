// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "arrangement/edge_fan.hpp"
#include "base/counting_sort.hpp"
#include "base/disjoint_sets.hpp"
#include "exact/space_points.hpp"
#include "realmodel/base/array.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::arrangement {

/// Around a ray from a point in the direction of an axis. A point and its rounded position have no
/// double between them, so the ray crosses nothing in a box that this one does not meet.
inline spatial::Box ray_box(const exact::SpacePoints& points, exact::SpacePointId from,
                            std::size_t axis) {
    spatial::Box ray;
    ray.include(points.rounded(from));
    ray.high[axis] = HUGE_VAL;
    return ray;
}

/// Finds the boxes that rays meet. A tree is made of them once it is worth its while.
class RayBoxes {
public:
    explicit RayBoxes(Array<spatial::Box> boxes) : boxes_(std::move(boxes)) {}

    /// The numbers of the boxes that a ray may meet, in order.
    /// @throws Cancelled
    std::vector<std::int32_t> find(const spatial::Box& ray, Progress* progress) {
        std::vector<std::int32_t> numbers;
        if (!tree_ && ++rays_ > kFewRays) {
            tree_.emplace(std::vector(boxes_.begin(), boxes_.end()), Execution{1, progress});
            boxes_ = {};
        }
        if (tree_) {
            tree_->find(ray, [&numbers](std::int32_t box) { numbers.push_back(box); });
            std::sort(numbers.begin(), numbers.end());
            return numbers;
        }
        for (std::size_t i = 0; i < boxes_.size(); ++i) {
            if (boxes_[i].meets(ray)) numbers.push_back(static_cast<std::int32_t>(i));
        }
        return numbers;
    }

private:
    static constexpr int kFewRays = 16;
    Array<spatial::Box> boxes_;  ///< until there is a tree
    std::optional<spatial::BoxTree> tree_;
    int rays_ = 0;
};

/// The cells of space between facets, and what is known of each.
///
/// Notation:
///   facet    a polygon that meets others in whole edges only: a triangle of two surfaces that were
///            divided along one another (P and Q in booleans), a region of a surface or of a face
///            of a model (cutting, structures)
///   side     a facet has side 0, below it, where it is seen clockwise from, and side 1, above it.
///            Sides have numbers, which the caller gives. What does not divide space has both sides
///            under one number
///   use      a facet at one of its edges (EdgeUse). For one who goes round the edge, seen along it
///            counter-clockwise, one side of the facet is ahead of it and the other one behind
///   half-plane  the uses that lie in one that begins at the edge (EdgeFan)
///   sector   what is between a half-plane and the next one: the sides ahead of the first and
///            behind the second are in one cell. So each cell is a set of sides, joined around all
///            edges; components of its boundary that do not touch one another are joined along rays
///   way      from a cell through a facet into another one, in direction 1 from side 0 to side 1,
///            in direction -1 back
///   label    one or several numbers of each cell, with a known change at each facet: how often P
///            and Q go round the cell (winding; a surface goes once round what is below it), or on
///            which side of each fault it is. Around an edge all changes add up to nothing
///            where no surface ends there; where one does, two ways may lead to different labels
class SpaceCells {
public:
    struct Way {
        std::int32_t to, facet;
        std::int8_t direction;
    };

    /// @throws InputError kind too_large
    explicit SpaceCells(std::size_t sides)
        : joined_((checked_number(sides, "sides of faces and their parts"), sides)) {}

    /// Notes that two sides are in one cell. Several threads may do so at once, until number().
    void join(std::int32_t side, std::int32_t other) { joined_.join(side, other); }
    /// The same of all that bounds a sector of a fan: that after one of its half-planes.
    /// @param side_of  the number of a side of an item: side_of(item, 0 or 1); -1 leaves it out
    template <class Fan, class SideOf>
    void join_sector(std::span<const EdgeUse> uses, const Fan& fan, std::size_t half_plane,
                     const SideOf& side_of) {
        std::int32_t first = -1;
        const auto join_all = [&](std::size_t of, bool is_ahead) {
            for (const std::size_t i : fan.half_plane(of)) {
                const EdgeUse& use = uses[i];
                const std::int32_t side =
                    side_of(index(use.item), is_ahead ? use.ahead() : use.behind());
                if (side < 0) continue;
                if (first < 0) first = side;
                join(first, side);
            }
        };
        join_all(half_plane, true);
        join_all((half_plane + 1) % fan.half_planes(), false);
    }

    /// Numbers the cells in the order of their first sides.
    /// @param counts  whether a side does
    template <class Counts>
    void number(const Counts& counts, const Execution& execution) {
        const std::size_t sides = joined_.size();
        cell_.resize(sides);
        parallel_for_each(sides, execution, [&](std::size_t i) {
            cell_[i] = counts(i) ? joined_.find(static_cast<std::int32_t>(i)) : -1;
        });
        std::vector<std::int32_t> of_set(sides, -1);
        for (std::size_t i = 0; i < sides; ++i) {
            if (cell_[i] < 0) continue;
            std::int32_t& known = of_set[index(cell_[i])];
            if (known < 0) {
                known = static_cast<std::int32_t>(first_.size());
                first_.push_back(static_cast<std::int32_t>(i));
            }
            cell_[i] = known;
        }
    }
    std::size_t size() const { return first_.size(); }
    /// The cell of a side, -1 of one that does not count.
    std::int32_t of(std::size_t side) const { return cell_[side]; }
    std::size_t first_side(std::size_t cell) const { return index(first_[cell]); }

    /// Takes facets as ways.
    /// @param visit_facets  visit_facets(visit) calls visit(facet, cell at side 0, cell at side 1)
    ///                    for all facets between two cells; it is called twice
    template <class VisitFacets>
    void connect(const VisitFacets& visit_facets) {
        ways_ = bucketize<Way>(size(), [&](const auto& put) {
            visit_facets([&](std::size_t facet, std::int32_t low, std::int32_t high) {
                assert(low >= 0 && high >= 0 && index(low) < size() && index(high) < size());
                put(index(low), Way{high, static_cast<std::int32_t>(facet), 1});
                put(index(high), Way{low, static_cast<std::int32_t>(facet), -1});
            });
        });
    }
    /// Takes the label of a cell to all that can be reached from it.
    /// @param beyond   beyond(way, label): the label where the way leads to, none where it ends
    /// @param differs  differs(way) is called where the label there is known to be another one
    template <class Label, class Beyond, class Differs>
    void spread(std::size_t start, std::vector<std::optional<Label>>& labels, const Beyond& beyond,
                const Differs& differs) const {
        assert(labels.size() == size() && labels[start]);
        std::vector<std::size_t> open{start};
        while (!open.empty()) {
            const std::size_t cell = open.back();
            open.pop_back();
            for (const Way& way : ways_[cell]) {
                const std::optional<Label> label = beyond(way, *labels[cell]);
                if (!label) continue;
                auto& known = labels[index(way.to)];
                if (!known) {
                    known = label;
                    open.push_back(index(way.to));
                } else if (*known != *label) {
                    differs(way);
                }
            }
        }
    }

private:
    DisjointSets joined_;              ///< sides
    std::vector<std::int32_t> cell_;   ///< of sides
    std::vector<std::int32_t> first_;  ///< of cells: their first side
    Buckets<Way> ways_;                ///< from each cell
};

}  // namespace realmodel::arrangement
