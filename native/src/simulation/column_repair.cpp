// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/column_repair.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/parallel_counts.hpp"
#include "realmodel/base/errors.hpp"
#include "simulation/narrow_strips.hpp"

namespace realmodel::simulation {

namespace {

constexpr int kWeakRounds = 30;
constexpr int kEasings = 40;
// Rounds that leave no fewer failing elements than the best one.
constexpr int kIdleMoves = 10;           ///< with moves of heights
constexpr int kIdleRepairs = 40;         ///< and with those that only remove heights
constexpr double kMostFailing = 0.01;    ///< a share of elements: with more nothing is removed
constexpr double kMostRepaired = 0.002;  ///< how much blocks may change for it, of all volumes
constexpr double kFarthest = 8;  ///< minimum thicknesses: how far heights move at what still fails

/// Calls visit(corner) for the corners of all elements and faces.
template <class Visit>
void for_corners(LayeredMesh& mesh, const Visit& visit) {
    const auto all = [&](auto& rows) {
        for (auto& row : rows) {
            for (std::int32_t& corner : row)
                visit(corner);
        }
    };
    all(mesh.tetrahedra.corners);
    all(mesh.pyramids.corners);
    all(mesh.prisms.corners);
    all(mesh.triangles.corners);
    all(mesh.quadrilaterals.corners);
}

}  // namespace

ColumnRepair::Filling::Filling(LayeredMesh&& empty, const ColumnRepair& of)
    : mesh(std::move(empty)),
      filler(of.plan_, of.blocks_, of.heights_, of.levels_, mesh, of.progress_),
      quality(of.plan_, of.levels_, filler.fronts(), of.layering_.minimum_thickness, of.progress_) {
}

ColumnRepair::ColumnRepair(const PlanTopology& plan, const PlanLines& lines,
                           const RockBlocks& blocks, const ColumnHeights& heights,
                           const Layering& layering, Progress* progress)
    : plan_(plan),
      blocks_(blocks),
      heights_(heights),
      layering_(layering),
      progress_(progress),
      levels_(plan, lines, blocks, heights, layering),
      has_flat_base_(plan.nodes(), 0) {
    for (std::size_t p = 0; p < plan.post_count(); ++p) {
        if (heights.rock(p) >= 0 && heights.surfaces(p)[0] == kBase)
            has_flat_base_[index(plan.post_node(p))] = 1;
    }
    refill();
    is_narrow_ = narrow_strips(plan, filling_->filler.fronts());
}

void ColumnRepair::refill() {
    check_total(levels_.height_count(), INT32_MAX);
    LayeredMesh empty;
    empty.volumes.assign(blocks_.rock.size(), 0);
    for (std::size_t r = 0; r < blocks_.count(); ++r) {
        const auto own = levels_.layer_blocks(static_cast<std::int32_t>(r)).size();
        empty.layers = std::max(empty.layers, static_cast<std::int32_t>(own));
    }
    filling_.emplace(std::move(empty), *this);
}

/// Each step may spoil what later ones repair, but not what earlier ones did: removals come first,
/// because they make faces steep; then heights move, which changes no block; then both, for what
/// checkMesh still fails with all its options; at last what it fails without any, at any price.
void ColumnRepair::run() {
    remove_weak_ends();
    ease_steep_faces(1);
    repair_failing();
    join_skewed();
}

/// Thin ends of layers, whose elements have inner faces in two directions only or lean, end one
/// element earlier.
void ColumnRepair::remove_weak_ends() {
    for (int round = 0; round < kWeakRounds; ++round) {
        auto weak = filling_->quality.weak(is_narrow_);
        if (levels_.remove(plan_, weak) == 0) return;
        refill();
    }
}

/// Faces that are steep, so that the centers of neighbors lie far from the direction across them,
/// are made less steep: at first all heights of a node move, then each for itself.
/// @param reach  minimum thicknesses: how far heights move at most
void ColumnRepair::ease_steep_faces(double reach) {
    const double thickness = layering_.minimum_thickness;
    std::vector<std::uint8_t> is_moved;
    bool any = false;
    for (const bool alone : {false, true}) {
        is_moved.assign(plan_.nodes(), 1);
        for (int round = 0; round < kEasings; ++round) {
            const auto moves = filling_->quality.steep(is_moved);
            is_moved.assign(plan_.nodes(), 0);
            if (!levels_.ease(moves, reach * thickness, thickness, alone, has_flat_base_, is_moved))
                break;
            any = true;
        }
    }
    if (any) refill();
}

/// Heights at elements that checkMesh fails move farther, and of what that does not repair heights
/// are removed, in turns. Where moves bring nothing any more, only removals go on, from the best
/// round. That round stands in the end, unless nothing fails any more.
void ColumnRepair::repair_failing() {
    auto failing = filling_->quality.failing(is_narrow_);
    if (failing.empty() || failing.size() > kMostFailing * filling_->quality.elements()) return;
    const std::vector<double> volumes = filling_->mesh.volumes;
    PostLevels best = levels_;
    std::size_t least = SIZE_MAX;
    for (int idle = 0; !failing.empty() && idle < kIdleRepairs;) {
        const bool is_first = least == SIZE_MAX;
        if (failing.size() < least) {
            least = failing.size();
            best = levels_;
            idle = 0;
        } else {
            ++idle;
        }
        if (idle == kIdleMoves) {
            levels_ = best;
        } else if (!is_first) {
            levels_.remove(plan_, failing);
        }
        if (!is_first) refill();
        if (idle < kIdleMoves) ease_steep_faces(kFarthest);
        failing = filling_->quality.failing(is_narrow_);
        if (changes_much(volumes)) break;
    }
    if (failing.empty() && !changes_much(volumes)) return;
    levels_ = best;
    refill();
}

/// Whether blocks have changed by more than repairs may cost.
bool ColumnRepair::changes_much(const std::vector<double>& volumes) const {
    double changed = 0, total = 0;
    for (std::size_t b = 0; b < volumes.size(); ++b) {
        changed += std::abs(filling_->mesh.volumes[b] - volumes[b]);
        total += volumes[b];
    }
    return changed > kMostRepaired * total;
}

/// Elements that are too thin for how steep they are become one with the next in their columns,
/// until there are none; what no removal repairs is reported.
void ColumnRepair::join_skewed() {
    for (;;) {
        auto skewed = filling_->quality.skewed(layering_.divided);
        if (levels_.remove(plan_, skewed.removals, true) == 0) {
            filling_->mesh.skewed = {skewed.faces, skewed.most, skewed.place,
                                     std::move(skewed.tall)};
            return;
        }
        refill();
    }
}

LayeredMesh ColumnRepair::finish(const VerticalFaults& faults) {
    filling_->filler.finish_steps(faults);
    LayeredMesh& made = filling_->mesh;
    std::vector<std::int32_t> number(levels_.height_count(), -1);
    for_corners(made, [&](std::int32_t& corner) { number[index(corner)] = 0; });
    for (std::size_t n = 0, at = 0; n < plan_.nodes(); ++n) {
        const auto node = static_cast<std::int32_t>(n);
        const PlanPoint& p = plan_.point(node);
        for (const double z : levels_.heights(node)) {
            if (number[at] == 0) {
                number[at] = static_cast<std::int32_t>(made.points.size());
                made.points.push_back({p[0], p[1], z});
            }
            ++at;
        }
    }
    for_corners(made, [&](std::int32_t& corner) { corner = number[index(corner)]; });
    return std::move(made);
}

}  // namespace realmodel::simulation
