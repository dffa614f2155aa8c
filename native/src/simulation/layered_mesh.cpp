// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/layered_mesh.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "simulation/column_heights.hpp"
#include "simulation/columns.hpp"
#include "simulation/element_quality.hpp"
#include "simulation/pillar_levels.hpp"
#include "simulation/plan_topology.hpp"

namespace realmodel::simulation {

namespace {

constexpr int kWeakRounds = 30;
constexpr int kJudgedRound = 6;        ///< from then on no block may lose more than in the first
constexpr double kMostOfAll = 0.0005;  ///< that and less of all volumes every block may change by
constexpr int kRelaxations = 40;
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

/// Elements are never edited. A step asks ElementQuality what is wrong, changes PillarLevels (a
/// height is removed, or moves), and fills all columns anew. run() is the list of the steps.
class ColumnRepair {
public:
    ColumnRepair(const ColumnInput& input, const Layering& layering, Progress* progress)
        : input_(input),
          plan_(input.plan),
          layering_(layering),
          progress_(progress),
          levels_(input, layering),
          pillars_(bucketize<std::size_t>(plan_.nodes(),
                                          [&](const auto& put) {
                                              for (std::size_t p = 0; p < plan_.pillar_count(); ++p)
                                                  put(index(plan_.pillar_node(p)), p);
                                          })),
          has_flat_base_(plan_.nodes(), 0) {
        for (std::size_t p = 0; p < plan_.pillar_count(); ++p) {
            if (input.heights.rock(p) >= 0 && input.heights.surfaces(p)[0] == kBase)
                has_flat_base_[index(plan_.pillar_node(p))] = 1;
        }
        refill();
        volumes_ = filling_->columns.mesh.volumes;
        least_change_ = kMostOfAll * std::accumulate(volumes_.begin(), volumes_.end(), 0.0);
        is_whole_.assign(volumes_.size(), 0);
        is_narrow_ = narrow_strips(plan_, filling_->columns.fronts);
    }

    /// Each step may spoil what later ones repair, but not what earlier ones did: removals come
    /// first, because they make faces steep; then heights move, which changes no block; then both,
    /// for what checkMesh still fails with all its options; at last what it fails without any.
    void run() {
        // Thin ends of layers, whose elements have inner faces in two directions only or lean, end
        // one element earlier.
        remove_all([&] { return filling_->quality.weak(is_narrow_); }, false, kWeakRounds,
                   kMostOfBlock);
        relax_steep_faces(1);
        repair_failing();
        // Elements that are too thin for how steep they are become one with the next in their
        // columns, in all blocks again; what no removal repairs is reported.
        const auto was_whole = std::exchange(is_whole_, std::vector<std::uint8_t>(volumes_.size()));
        ElementQuality::SkewedFaces skewed;
        remove_all(
            [&] {
                skewed = filling_->quality.skewed(layering_.divided);
                return std::move(skewed.removals);
            },
            true, INT_MAX, kMostIfSkewed);
        LayeredMesh& made = filling_->columns.mesh;
        made.skewed = {skewed.faces, skewed.most, skewed.place, std::move(skewed.tall)};
        for (std::size_t b = 0; b < is_whole_.size(); ++b) {
            if (was_whole[b] != 0 || is_whole_[b] != 0)
                made.unrepaired_blocks.push_back(static_cast<std::int32_t>(b));
        }
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

    /// Removes heights, in rounds, until no more are found. Where the end of a layer is given up
    /// because of its shape, the next one may be no better: in a layer of even thickness a hole of
    /// a few nodes would grow ring by ring until nothing is left. Where layers taper, fewer heights
    /// follow from round to round. So a block that loses more in a late round than in the first,
    /// or more than a share of itself in all, is left as it was, and all begins again.
    /// @param several  of one node in one round  @param most  the share
    template <class Find>
    void remove_all(const Find& find, bool several, int rounds, double most) {
        const PillarLevels start = levels_;
        std::vector<std::size_t> first;
        for (int round = 1; round <= rounds; ++round) {
            auto removals = find();
            leave_whole(removals);
            std::vector<std::size_t> count(volumes_.size(), 0);
            for (const PillarLevels::Removal& removal : removals)
                for_blocks(removal, [&](std::int32_t block) { ++count[index(block)]; });
            if (round == 1) first = count;
            if (levels_.remove(plan_, removals, several) == 0) return;
            refill();
            bool any = false;
            for (std::size_t b = 0; b < count.size(); ++b) {
                const bool grows = round >= kJudgedRound && count[b] > first[b];
                if (is_whole_[b] != 0 || (!grows && !changes_much(b, most))) continue;
                is_whole_[b] = 1;
                any = true;
            }
            if (!any) continue;
            levels_ = start;
            refill();
            round = 0;
        }
    }

    /// Leaves out removals that would change a block that stays as it is.
    void leave_whole(std::vector<PillarLevels::Removal>& removals) const {
        std::erase_if(removals, [&](const PillarLevels::Removal& removal) {
            bool is_whole = false;
            for_blocks(removal, [&](std::int32_t b) { is_whole |= is_whole_[index(b)] != 0; });
            return is_whole;
        });
    }

    /// Calls visit(block) for the blocks that a removal takes volume from, or gives it to.
    template <class Visit>
    void for_blocks(const PillarLevels::Removal& removal, const Visit& visit) const {
        for (const std::size_t p : pillars_[index(removal.node)]) {
            const std::int32_t rock = input_.heights.rock(p);
            if (rock < 0) continue;
            const auto [below, above] = levels_.blocks_at(p, rock, removal.height);
            if (below == above) continue;
            for (const std::int32_t block : {below, above}) {
                if (block >= 0) visit(block);
            }
        }
    }

    /// Whether a block has changed by more than repairs may cost: a share of itself, and a little
    /// of all volumes.
    bool changes_much(std::size_t block, double most) const {
        return std::abs(filling_->columns.mesh.volumes[block] - volumes_[block]) >
               std::max(most * volumes_[block], least_change_);
    }

    /// Faces that are steep, so that the centers of neighbors lie far from the direction across
    /// them, are made less steep: at first all heights of a node move, so that elements stay
    /// upright, then each for itself. Else more of thin blocks has to be given up.
    /// @param reach  minimum thicknesses: how far heights move at most
    void relax_steep_faces(double reach) {
        const double thickness = layering_.minimum_thickness;
        bool any = false;
        for (const bool alone : {false, true}) {
            std::vector<std::uint8_t> is_moved(plan_.nodes(), 1);
            for (int round = 0; round < kRelaxations; ++round) {
                const auto moves = filling_->quality.steep(is_moved);
                is_moved.assign(plan_.nodes(), 0);
                if (!levels_.relax_heights(moves, reach * thickness, thickness, alone,
                                           has_flat_base_, is_moved))
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
        PillarLevels best = levels_;
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
                leave_whole(failing);
                levels_.remove(plan_, failing);
            }
            if (!is_first) refill();
            if (idle < kIdleMoves) relax_steep_faces(kFarthest);
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
            if (changes_much(b, kMostOfBlock)) return true;
        }
        return changed > kMostRepaired * total;
    }

    const ColumnInput& input_;
    const PlanTopology& plan_;
    const Layering& layering_;
    Progress* progress_;
    PillarLevels levels_;
    std::optional<Filling> filling_;
    std::vector<double> volumes_;              ///< of each block, before the first repair
    double least_change_ = 0;                  ///< what every block may lose or gain
    std::vector<std::uint8_t> is_whole_;       ///< of each block: it stays as it is
    const Buckets<std::size_t> pillars_;       ///< of each node
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

namespace {

constexpr std::int32_t kMostFreeLayers = 16;  ///< where no layers are asked for

}  // namespace

LayeredMesh layered_mesh(const ComplexView& model, std::span<const std::int32_t> block_rock,
                         const PlanLines& lines, meshing::PlanarMesh mesh, Layering layering,
                         const Execution& execution) {
    const RockBlocks blocks(block_rock);
    PlanTopology plan(lines, std::move(mesh));
    const ColumnHeights heights = pillar_columns(model, blocks, lines, plan, execution);
    const VerticalFaults faults(model, lines.steps);
    std::vector<std::uint8_t> is_free(layering.layers.size(), 0);
    for (std::size_t b = 0; b < is_free.size(); ++b) {
        if (layering.layers[b] != 0 || layering.layer_thickness > 0) continue;
        layering.layers[b] = 1;
        is_free[b] = 1;
    }
    for (;;) {
        LayeredMesh made =
            repaired_columns({lines, blocks, plan, heights}, faults, layering, execution.progress);
        // blocks that are too thick for their top or base get twice as many layers
        bool again = false;
        for (const std::int32_t block : made.skewed.tall) {
            if (is_free[index(block)] == 0 || layering.layers[index(block)] >= kMostFreeLayers)
                continue;
            layering.layers[index(block)] *= 2;
            again = true;
        }
        if (again) continue;
        made.block_layers = std::move(layering.layers);
        made.plan = plan.take_mesh();
        return made;
    }
}

}  // namespace realmodel::simulation
