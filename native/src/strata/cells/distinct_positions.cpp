// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/distinct_positions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "base/keep_single.hpp"
#include "base/parallel_counts.hpp"
#include "base/ulp.hpp"

namespace realmodel::strata {

namespace {

/// Moves plan vertices to free positions beside them.
class Spreader {
public:
    Spreader(const exact::PlanArrangement& geometry, const PlanVertices& plan_vertices,
             const TileBorder* border)
        : geometry_(geometry), plan_vertices_(plan_vertices), border_(border) {}

    bool movable(std::size_t vertex) const {
        return !geometry_.is_vertex(plan_vertices_.representative[vertex]);
    }
    const PlanPosition& at(std::size_t vertex) const {
        if (!moved_.empty()) {
            const auto moved = moved_.find(vertex);
            if (moved != moved_.end()) return moved->second;
        }
        return plan_vertices_.position[vertex];
    }
    /// The plan vertices that were moved, and where to.
    const std::map<std::size_t, PlanPosition>& moved() const { return moved_; }

    /// Gives plan vertices in equal positions positions of their own.
    void separate() {
        // input vertices come first among equals, so these are crossings
        for (const PlanVertexId vertex : plan_vertices_.coincident)
            move(static_cast<std::size_t>(vertex), [](int, int) { return true; });
        if (border_ == nullptr) return;
        for (const auto& [number, is_on] : border_->plan_vertices) {
            const auto vertex = static_cast<std::size_t>(number);
            if (!border_->allows(vertex, at(vertex))) move(vertex, [](int, int) { return true; });
        }
    }

    /// Moves a plan vertex by as little as possible, but along the given axis.
    void move_along(std::size_t vertex, int axis) {
        move(vertex, [axis](int x, int y) { return (axis == 0 ? x : y) != 0; });
    }

private:
    bool take(const PlanPosition& position) {
        if (std::binary_search(plan_vertices_.position.begin(), plan_vertices_.position.end(),
                               position))
            return false;
        return taken_.insert(position).second;
    }

    template <class Allowed>
    void move(std::size_t vertex, const Allowed& allowed) {
        const PlanPosition from = at(vertex);
        for (int reach = 1;; ++reach) {
            for (int x = -reach; x <= reach; ++x) {
                for (int y = -reach; y <= reach; ++y) {
                    if (std::max(std::abs(x), std::abs(y)) != reach || !allowed(x, y)) continue;
                    const PlanPosition to{moved_by_ulps(from[0], x), moved_by_ulps(from[1], y)};
                    if (border_ != nullptr && !border_->allows(vertex, to)) continue;
                    if (!take(to)) continue;
                    moved_[vertex] = to;
                    return;
                }
            }
        }
    }

    const exact::PlanArrangement& geometry_;
    const PlanVertices& plan_vertices_;
    const TileBorder* border_;
    std::map<std::size_t, PlanPosition> moved_;
    std::set<PlanPosition> taken_;  ///< besides the plan vertices' own positions
};

struct Extent {
    PlanPosition low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
    void include(const PlanPosition& p) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
    bool is_flat(std::size_t axis) const { return low[axis] == high[axis]; }
};

/// Finds cells whose plan vertices all have one x, or one y, and spreads them.
class FlatCells {
public:
    FlatCells(const FaceList& faces, const PlanVertices& plan_vertices, Spreader& spreader,
              const Execution& execution)
        : faces_(faces),
          plan_vertices_(plan_vertices),
          spreader_(spreader),
          execution_(execution) {}

    /// Finds the cells; whether there are any.
    bool find() {
        cells_ = cells_of_flat_faces();
        if (cells_.empty()) return false;
        // Few, and all of their faces must be flat.
        find_faces();
        extents_.assign(cells_.size(), {});
        for_each_corner(
            [&](std::size_t i, std::size_t vertex) { extents_[i].include(spreader_.at(vertex)); });
        return std::any_of(extents_.begin(), extents_.end(),
                           [](const Extent& e) { return e.is_flat(0) || e.is_flat(1); });
    }
    /// Spreads those found last; false where none of their plan vertices may move.
    bool spread() {
        std::vector<std::array<std::int64_t, 2>> to_move(cells_.size(), {-1, -1});
        bool any = false;
        for_each_corner([&](std::size_t i, std::size_t vertex) {
            for (std::size_t axis = 0; axis < 2; ++axis) {
                if (!extents_[i].is_flat(axis) || !spreader_.movable(vertex)) continue;
                to_move[i][axis] = std::max(to_move[i][axis], static_cast<std::int64_t>(vertex));
                any = true;
            }
        });
        for (const auto& of_cell : to_move) {
            for (int axis = 0; axis < 2; ++axis) {
                const std::int64_t vertex = of_cell[static_cast<std::size_t>(axis)];
                if (vertex >= 0) spreader_.move_along(static_cast<std::size_t>(vertex), axis);
            }
        }
        return any;
    }
    /// Those found last.
    std::vector<FlatCell> found() const {
        std::vector<FlatCell> flat;
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            if (extents_[i].is_flat(0) || extents_[i].is_flat(1))
                flat.push_back({cells_[i], extents_[i].low});
        }
        return flat;
    }

private:
    std::size_t vertex_of(const Corner& corner) const {
        return index(plan_vertices_.of_point[index(corner.point)]);
    }

    /// Asks for what will be read of the faces after one: mostly that of two corners.
    [[gnu::always_inline]] void prefetch_face(std::size_t face) const {
        const auto first_corner = [&](std::size_t ahead) {
            const std::size_t f = std::min(face + ahead, faces_.size() - 1);
            return faces_.polygons.corners.data() + faces_.polygons.offsets[f];
        };
        prefetch(&plan_vertices_.of_point[index(first_corner(24)->point)]);
        const Corner* const near = first_corner(12);
        prefetch(&plan_vertices_.position[vertex_of(near[0])]);
        prefetch(&plan_vertices_.position[vertex_of(near[1])]);
    }

    bool is_flat(PolygonView face) const {
        const PlanPosition& first = spreader_.at(vertex_of(face[0]));
        bool same_x = true, same_y = true;
        for (std::size_t i = 1; i < face.size() && (same_x || same_y); ++i) {
            const PlanPosition& next = spreader_.at(vertex_of(face[i]));
            same_x = same_x && next[0] == first[0];
            same_y = same_y && next[1] == first[1];
        }
        return same_x || same_y;
    }

    /// Appends what collect(face, found) finds of all faces, in their order.
    template <class Found, class Collect>
    std::vector<Found> collected(const Collect& collect) const {
        constexpr std::size_t kFaces = 1 << 13;
        std::vector<std::vector<Found>> found((faces_.size() + kFaces - 1) / kFaces);
        parallel_ranges(faces_.size(), kFaces, execution_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t f = begin; f < end; ++f)
                collect(f, found[begin / kFaces]);
        });
        std::vector<Found> all;
        for (const auto& some : found)
            all.insert(all.end(), some.begin(), some.end());
        return all;
    }

    /// The cells above and below faces that are flat themselves, ascending.
    std::vector<std::int32_t> cells_of_flat_faces() const {
        auto cells = collected<std::int32_t>([&](std::size_t f, auto& found) {
            prefetch_face(f);
            if (!is_flat(faces_.polygons[f])) return;
            for (const std::int32_t cell : {faces_.above[f], faces_.below[f]}) {
                if (cell != kOutsideCell) found.push_back(cell);
            }
        });
        sort_unique(cells);
        return cells;
    }

    void find_faces() {
        of_cells_ = collected<std::pair<std::size_t, std::size_t>>([&](std::size_t f, auto& found) {
            for (const std::int32_t cell : {faces_.above[f], faces_.below[f]}) {
                const auto at = std::lower_bound(cells_.begin(), cells_.end(), cell);
                if (at != cells_.end() && *at == cell)
                    found.emplace_back(static_cast<std::size_t>(at - cells_.begin()), f);
            }
        });
    }

    /// Calls visit(i, vertex) for every corner of every face of the i-th of the cells.
    template <class Visit>
    void for_each_corner(const Visit& visit) const {
        for (const auto& [i, face] : of_cells_) {
            for (const Corner& corner : faces_.polygons[face])
                visit(i, vertex_of(corner));
        }
    }

    const FaceList& faces_;
    const PlanVertices& plan_vertices_;
    Spreader& spreader_;
    Execution execution_;
    std::vector<std::int32_t> cells_;                            ///< with a flat face, ascending
    std::vector<Extent> extents_;                                ///< of each of them
    std::vector<std::pair<std::size_t, std::size_t>> of_cells_;  ///< which of them, and a face
};

}  // namespace

std::vector<FlatCell> make_distinct(const exact::PlanArrangement& geometry, const FaceList& faces,
                                    const PlanVertices& plan_vertices, ConformedFaces& conformed,
                                    const TileBorder* border, const Execution& execution) {
    Spreader spreader(geometry, plan_vertices, border);
    spreader.separate();
    // Moving one cell's vertex may flatten its neighbor; a few rounds settle it.
    constexpr int kRounds = 16;
    FlatCells flat(faces, plan_vertices, spreader, execution);
    std::vector<FlatCell> left;
    for (int round = 0; flat.find(); ++round) {
        if (round < kRounds && flat.spread()) continue;
        left = flat.found();
        break;
    }
    for (const auto& [vertex, position] : spreader.moved()) {
        for (auto v = conformed.vertex_offsets[vertex]; v < conformed.vertex_offsets[vertex + 1];
             ++v) {
            auto& moved = conformed.positions[static_cast<std::size_t>(v)];
            moved[0] = position[0];
            moved[1] = position[1];
        }
    }
    return left;
}

}  // namespace realmodel::strata
