// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/column_repair.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "simulation/column_filler.hpp"
#include "simulation/element_quality.hpp"
#include "simulation/narrow_strips.hpp"
#include "simulation/repair_limits.hpp"

namespace realmodel::simulation {

namespace {

constexpr int kWeakRounds = 30;
constexpr int kEasings = 40;
// Rounds that leave no fewer failing elements than the best one.
constexpr int kIdleMoves = 10;           ///< with moves of heights
constexpr int kIdleRepairs = 40;         ///< and with those that only remove heights
constexpr double kMostFailing = 0.01;    ///< a share of elements: with more nothing is removed
constexpr double kMostRepaired = 0.002;  ///< how much blocks may change for it, of all volumes
constexpr double kMostOfBlock = 0.25;    ///< how much one block may change, of itself,
constexpr double kMostIfSkewed = 0.5;    ///< and for what checkMesh fails without any options
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

/// Elements are never edited. A step asks ElementQuality what is wrong, changes PostLevels (a
/// height is removed, or moves), and fills all columns anew. run() is the list of the steps.
class ColumnRepair {
public:
    ColumnRepair(const ColumnInput& input, const Layering& layering, Progress* progress)
        : input_(input),
          plan_(input.plan),
          layering_(layering),
          progress_(progress),
          levels_(input, layering),
          has_flat_base_(plan_.nodes(), 0) {
        for (std::size_t p = 0; p < plan_.post_count(); ++p) {
            if (input.heights.rock(p) >= 0 && input.heights.surfaces(p)[0] == kBase)
                has_flat_base_[index(plan_.post_node(p))] = 1;
        }
        refill();
        limits_.emplace(input_, filling_->columns.mesh.volumes);
        is_narrow_ = narrow_strips(plan_, filling_->columns.fronts);
    }

    /// Each step may spoil what later ones repair, but not what earlier ones did: removals come
    /// first, because they make faces steep; then heights move, which changes no block; then both,
    /// for what checkMesh still fails with all its options; at last what it fails without any.
    void run() {
        remove_weak_ends();
        ease_steep_faces(1);
        repair_failing();
        join_skewed();
        filling_->columns.mesh.kept = limits_->kept_blocks();
    }

    /// Faces on steps, and points of those heights that elements have.
    LayeredMesh finish(const VerticalFaults& faults) {
        add_step_faces(filling_->columns, faults);
        LayeredMesh& made = filling_->columns.mesh;
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

private:
    /// Columns between the levels as they are now.
    struct Filling {
        FilledColumns columns;
        ElementQuality quality;
        explicit Filling(const ColumnRepair& of)
            : columns(fill_columns(of.input_, of.levels_, of.progress_)),
              quality(of.plan_, of.levels_, columns.fronts, of.layering_.minimum_thickness,
                      of.progress_) {}
    };
    void refill() { filling_.emplace(*this); }

    /// Thin ends of layers, whose elements have inner faces in two directions only or lean, end one
    /// element earlier.
    void remove_weak_ends() {
        const PostLevels start = levels_;
        do {
            for (int round = 0; round < kWeakRounds; ++round) {
                auto weak = filling_->quality.weak(is_narrow_);
                if (!remove(weak)) break;
            }
        } while (takes_back(start, kMostOfBlock));
    }

    bool remove(ElementQuality::Removals& removals, bool several = false) {
        limits_->limit(levels_, removals);
        limits_->note(levels_, removals);
        if (levels_.remove(plan_, removals, several) == 0) return false;
        refill();
        return true;
    }

    /// Whether a step took too much, so that it begins again where it did.
    bool takes_back(const PostLevels& start, double most) {
        if (!limits_->take_back(filling_->columns.mesh.volumes, most)) return false;
        levels_ = start;
        refill();
        return true;
    }

    /// Faces that are steep, so that the centers of neighbors lie far from the direction across
    /// them, are made less steep: at first all heights of a node move, then each for itself.
    /// @param reach  minimum thicknesses: how far heights move at most
    void ease_steep_faces(double reach) {
        const double thickness = layering_.minimum_thickness;
        std::vector<std::uint8_t> is_moved;
        bool any = false;
        for (const bool alone : {false, true}) {
            is_moved.assign(plan_.nodes(), 1);
            for (int round = 0; round < kEasings; ++round) {
                const auto moves = filling_->quality.steep(is_moved);
                is_moved.assign(plan_.nodes(), 0);
                if (!levels_.ease(moves, reach * thickness, thickness, alone, has_flat_base_,
                                  is_moved))
                    break;
                any = true;
            }
        }
        if (any) refill();
    }

    /// Heights at elements that checkMesh fails move farther, and of what that does not repair
    /// heights are removed, in turns. Where moves bring nothing any more, only removals go on, from
    /// the best round. That round stands in the end, unless nothing fails any more.
    void repair_failing() {
        auto failing = filling_->quality.failing(is_narrow_);
        if (failing.empty() || failing.size() > kMostFailing * filling_->quality.elements()) return;
        const std::vector<double> volumes = filling_->columns.mesh.volumes;
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
                limits_->limit(levels_, failing);
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
    bool changes_much(const std::vector<double>& volumes) const {
        double changed = 0, total = 0;
        for (std::size_t b = 0; b < volumes.size(); ++b) {
            changed += std::abs(filling_->columns.mesh.volumes[b] - volumes[b]);
            total += volumes[b];
            if (limits_->changes_much(b, filling_->columns.mesh.volumes, kMostOfBlock)) return true;
        }
        return changed > kMostRepaired * total;
    }

    /// Elements that are too thin for how steep they are become one with the next in their columns,
    /// until there are none; what no removal repairs is reported.
    void join_skewed() {
        const PostLevels start = levels_;
        do {
            for (;;) {
                auto skewed = filling_->quality.skewed(layering_.divided);
                if (remove(skewed.removals, true)) continue;
                filling_->columns.mesh.skewed = {skewed.faces, skewed.most, skewed.place,
                                                 std::move(skewed.tall)};
                break;
            }
        } while (takes_back(start, kMostIfSkewed));
    }

    const ColumnInput& input_;
    const PlanTopology& plan_;
    const Layering& layering_;
    Progress* progress_;
    PostLevels levels_;
    std::optional<Filling> filling_;
    std::optional<RepairLimits> limits_;
    std::vector<std::uint8_t> is_narrow_;      ///< of each triangle, before the first repair
    std::vector<std::uint8_t> has_flat_base_;  ///< of each node
};

}  // namespace

LayeredMesh repaired_columns(const ColumnInput& input, const VerticalFaults& faults,
                             const Layering& layering, Progress* progress) {
    ColumnRepair columns(input, layering, progress);
    columns.run();
    return columns.finish(faults);
}

}  // namespace realmodel::simulation
