// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/distinct_positions.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "base/algorithms.hpp"
#include "base/floating_point.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

namespace {

/// Moves plan vertices to free positions beside them.
class Spreader {
public:
    Spreader(const exact::PlanArrangement& geometry, const PlanVertices& plan_vertices,
             ConformedFaces& conformed, const TileBorder* border)
        : geometry_(geometry),
          plan_vertices_(plan_vertices),
          conformed_(conformed),
          border_(border) {}

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
        // at each reach there is a position that may be allowed; no more of them can be taken
        const std::size_t most = plan_vertices_.size() + taken_.size() + 1;
        for (int reach = 1; std::cmp_less_equal(reach, most); ++reach) {
            for (int x = -reach; x <= reach; ++x) {
                for (int y = -reach; y <= reach; ++y) {
                    if (std::max(std::abs(x), std::abs(y)) != reach || !allowed(x, y)) continue;
                    const PlanPosition to{moved_by_ulps(from[0], x), moved_by_ulps(from[1], y)};
                    if (border_ != nullptr && !border_->allows(vertex, to)) continue;
                    if (!take(to)) continue;
                    moved_[vertex] = to;
                    for (auto v = conformed_.vertex_offsets[vertex];
                         v < conformed_.vertex_offsets[vertex + 1]; ++v)
                        std::ranges::copy(to, conformed_.positions[index(v)].begin());
                    return;
                }
            }
        }
        throw InternalError("beside a plan vertex there is a free position that it may move to",
                            std::array{from[0], from[1], 0.0});
    }

    const exact::PlanArrangement& geometry_;
    const PlanVertices& plan_vertices_;
    ConformedFaces& conformed_;
    const TileBorder* border_;
    std::map<std::size_t, PlanPosition> moved_;
    std::set<PlanPosition> taken_;  ///< besides the plan vertices' own positions
};

bool is_flat(const PlanBox& box, std::size_t axis) {
    return axis == 0 ? box.low_x == box.high_x : box.low_y == box.high_y;
}

/// Finds cells whose plan vertices all have one x, or one y, and spreads them.
class FlatCells {
public:
    FlatCells(const FaceList& faces, const ConformedFaces& conformed, Spreader& spreader,
              const Execution& execution)
        : faces_(faces), conformed_(conformed), spreader_(spreader), execution_(execution) {}

    /// Finds the cells; whether there are any.
    bool find() {
        cells_ = cells_of_flat_faces();
        if (cells_.empty()) return false;
        // Few, and all of their faces must be flat.
        find_faces();
        extents_.assign(cells_.size(), spatial::kNoBox);
        for_each_corner([&](std::size_t i, std::int32_t vertex) {
            const auto& [x, y, z] = conformed_.positions[index(vertex)];
            extents_[i] = extents_[i].united({x, y, x, y});
        });
        return std::any_of(extents_.begin(), extents_.end(),
                           [](const PlanBox& b) { return is_flat(b, 0) || is_flat(b, 1); });
    }
    /// Spreads those found last; false where none of their plan vertices may move.
    bool spread() {
        std::vector<std::array<std::int64_t, 2>> to_move(cells_.size(), {-1, -1});
        bool any = false;
        for_each_corner([&](std::size_t i, std::int32_t corner) {
            const std::size_t vertex = conformed_.plan_vertex_of(corner);
            for (std::size_t axis = 0; axis < 2; ++axis) {
                if (!is_flat(extents_[i], axis) || !spreader_.movable(vertex)) continue;
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
    std::vector<FlatCell> flat_cells() const {
        std::vector<FlatCell> flat;
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            const PlanBox& box = extents_[i];
            if (is_flat(box, 0) || is_flat(box, 1))
                flat.push_back({cells_[i], {box.low_x, box.low_y}});
        }
        return flat;
    }

private:
    /// Calls visit(vertex) for the corners of a face until one says false.
    template <class Visit>
    void visit_corners(std::size_t face, const Visit& visit) const {
        const std::uint32_t corner = faces_.polygons.offsets[face],
                            count = faces_.polygons.offsets[face + 1] - corner,
                            entry = conformed_.face_offsets[face];
        const bool passes_none = conformed_.face_offsets[face + 1] - entry == count;
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t corner_entry =
                passes_none ? entry + i : conformed_.entries.first(corner + i);
            if (!visit(conformed_.vertices[corner_entry])) return;
        }
    }

    /// Asks for the positions of a face after one.
    [[gnu::always_inline]] void prefetch_face(std::size_t face) const {
        const std::uint32_t first = conformed_.face_offsets[std::min(face + 12, faces_.size() - 1)];
        for (std::uint32_t e = first; e < first + 3; ++e)
            prefetch(&conformed_.positions[index(std::max(conformed_.vertices[e], 0))]);
    }

    bool is_flat_in_plan(std::size_t face) const {
        const std::array<double, 3>* first = nullptr;
        bool same_x = true, same_y = true;
        visit_corners(face, [&](std::int32_t vertex) {
            const auto& next = conformed_.positions[index(vertex)];
            if (first == nullptr) first = &next;
            same_x = same_x && next[0] == (*first)[0];
            same_y = same_y && next[1] == (*first)[1];
            return same_x || same_y;
        });
        return same_x || same_y;
    }

    /// The cells above and below faces that are flat themselves, ascending.
    std::vector<std::int32_t> cells_of_flat_faces() const {
        auto cells = collect_items<std::int32_t>(
            faces_.size(), execution_, [&](std::size_t f, auto& cells_of_face) {
                prefetch_face(f);
                if (!is_flat_in_plan(f)) return;
                for (const std::int32_t cell : {faces_.above[f], faces_.below[f]}) {
                    if (cell != kOutsideCell) cells_of_face.push_back(cell);
                }
            });
        sort_unique(cells);
        return cells;
    }

    void find_faces() {
        of_cells_ = collect_items<std::pair<std::size_t, std::size_t>>(
            faces_.size(), execution_, [&](std::size_t f, auto& pairs) {
                for (const std::int32_t cell : {faces_.above[f], faces_.below[f]}) {
                    const auto at = std::lower_bound(cells_.begin(), cells_.end(), cell);
                    if (at != cells_.end() && *at == cell)
                        pairs.emplace_back(static_cast<std::size_t>(at - cells_.begin()), f);
                }
            });
    }

    /// Calls visit(i, vertex) for every corner of every face of the i-th of the cells.
    template <class Visit>
    void for_each_corner(const Visit& visit) const {
        for (const auto& [i, face] : of_cells_) {
            visit_corners(face, [&, cell = i](std::int32_t vertex) {
                visit(cell, vertex);
                return true;
            });
        }
    }

    const FaceList& faces_;
    const ConformedFaces& conformed_;
    Spreader& spreader_;
    Execution execution_;
    std::vector<std::int32_t> cells_;                            ///< with a flat face, ascending
    std::vector<PlanBox> extents_;                               ///< of each of them
    std::vector<std::pair<std::size_t, std::size_t>> of_cells_;  ///< which of them, and a face
};

}  // namespace

std::vector<FlatCell> make_distinct(const exact::PlanArrangement& geometry, const FaceList& faces,
                                    const PlanVertices& plan_vertices, ConformedFaces& conformed,
                                    const TileBorder* border, const Execution& execution) {
    Spreader spreader(geometry, plan_vertices, conformed, border);
    spreader.separate();
    // Moving one cell's vertex may flatten its neighbor; a few rounds settle it.
    constexpr int kRounds = 16;
    FlatCells flat(faces, conformed, spreader, execution);
    std::vector<FlatCell> left;
    for (int round = 0; flat.find(); ++round) {
        if (round < kRounds && flat.spread()) continue;
        left = flat.flat_cells();
        break;
    }
    return left;
}

}  // namespace realmodel::strata
