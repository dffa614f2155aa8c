// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/layered_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

constexpr std::int32_t kJudgedRing = 6;  ///< a front that has more places there than at first grows
constexpr double kMostOfAll = 0.0005;    ///< that and less of all volumes every block may change by

/// What repairs may take of each block. Where the end of a layer is given up because of its shape,
/// the next one may be no better: in a layer of even thickness a hole of a few nodes would grow
/// ring by ring until nothing is left. Where layers taper, fewer places follow from ring to ring.
class RepairLimits {
public:
    /// @param volumes  of each block, before the first repair
    RepairLimits(const ColumnInput& input, std::span<const double> volumes)
        : input_(input),
          volumes_(volumes.begin(), volumes.end()),
          pillars_(bucketize<std::size_t>(input.plan.nodes(),
                                          [&](const auto& put) {
                                              for (std::size_t p = 0; p < input.plan.pillar_count();
                                                   ++p)
                                                  put(index(input.plan.pillar_node(p)), p);
                                          })),
          triangles_(input.plan.triangles_at_nodes()),
          is_whole_(volumes.size(), 0) {
        for (const double volume : volumes_)
            least_ += kMostOfAll * volume;
    }

    /// Leaves out removals that would change a block where it stays as it is.
    void limit(const PillarLevels& levels, std::vector<PillarLevels::Removal>& removals) const {
        std::erase_if(removals, [&](const PillarLevels::Removal& removal) {
            bool is_kept = false;
            for_blocks(levels, removal, [&](std::int32_t block) {
                is_kept =
                    is_kept || is_whole_[index(block)] != 0 ||
                    std::binary_search(kept_.begin(), kept_.end(), BlockNode{block, removal.node});
            });
            return is_kept;
        });
    }

    /// Notes what removals that are about to be made change.
    void note(const PillarLevels& levels, std::span<const PillarLevels::Removal> removals) {
        std::vector<Taken> more;
        for (const PillarLevels::Removal& removal : removals) {
            for_blocks(levels, removal, [&](std::int32_t block) {
                const BlockNode place{block, removal.node};
                if (found(place) < taken_.size()) return;
                std::int32_t inner = 0;
                for_taken_around(
                    place, [&](std::size_t other) { inner = std::max(inner, taken_[other].ring); });
                more.push_back({place, inner + 1});
            });
        }
        taken_.insert(taken_.end(), more.begin(), more.end());
        sort_unique(taken_);
    }

    /// Whether a block has changed by more than repairs may cost: a share of itself, and a little
    /// of all volumes.
    bool changes_much(std::size_t block, std::span<const double> volumes, double most) const {
        return std::abs(volumes[block] - volumes_[block]) >
               std::max(most * volumes_[block], least_);
    }

    /// Judges what was noted and notes anew. @return whether blocks stay as they are at more places
    /// from now on, because there a front grew, or their repair cost too much: then the step that
    /// made the removals has to begin again
    bool take_back(std::span<const double> volumes, double most) {
        std::vector<std::uint8_t> is_much(volumes.size(), 0);
        for (std::size_t b = 0; b < volumes.size(); ++b)
            is_much[b] = is_whole_[b] == 0 && changes_much(b, volumes, most) ? 1 : 0;
        std::vector<std::uint8_t> is_answered(volumes.size(), 0);
        bool any = false;
        for (const std::vector<std::size_t>& front : fronts()) {
            const auto in_ring = [&](std::int32_t ring) {
                return std::count_if(front.begin(), front.end(),
                                     [&](std::size_t at) { return taken_[at].ring == ring; });
            };
            const std::size_t block = index(taken_[front[0]].place.block);
            if (in_ring(kJudgedRing) <= in_ring(1) && (is_much[block] == 0 || in_ring(2) == 0))
                continue;
            for (const std::size_t at : front)
                kept_.push_back(taken_[at].place);
            any = true;
            is_answered[block] = 1;
        }
        sort_unique(kept_);
        for (std::size_t b = 0; b < volumes.size(); ++b) {
            if (is_much[b] == 0 || is_answered[b] != 0) continue;
            is_whole_[b] = 1;
            any = true;
        }
        taken_.clear();
        return any;
    }

    /// The blocks that stay as they are somewhere.
    std::vector<std::int32_t> kept_blocks() const {
        std::vector<std::int32_t> made;
        for (const BlockNode& place : kept_)
            made.push_back(place.block);
        for (std::size_t b = 0; b < is_whole_.size(); ++b) {
            if (is_whole_[b] != 0) made.push_back(static_cast<std::int32_t>(b));
        }
        sort_unique(made);
        return made;
    }

private:
    /// A block at a node.
    struct BlockNode {
        std::int32_t block, node;
        auto operator<=>(const BlockNode&) const = default;
    };
    /// Where a block was given up, and in which ring: 1 if it was so nowhere beside it before.
    struct Taken {
        BlockNode place;
        std::int32_t ring;
        auto operator<=>(const Taken&) const = default;
    };

    /// Calls visit(block) for the blocks that a removal takes volume from, or gives it to.
    template <class Visit>
    void for_blocks(const PillarLevels& levels, const PillarLevels::Removal& removal,
                    const Visit& visit) const {
        for (const std::size_t p : pillars_[index(removal.node)]) {
            const std::int32_t rock = input_.heights.rock(p);
            if (rock < 0) continue;
            const auto [below, above] = levels.blocks_at(p, rock, removal.height);
            if (below == above) continue;
            for (const std::int32_t block : {below, above}) {
                if (block >= 0) visit(block);
            }
        }
    }

    /// Where a place stands among those that were taken; their number if it is none.
    std::size_t found(const BlockNode& place) const {
        const auto at = std::lower_bound(taken_.begin(), taken_.end(), Taken{place, 0});
        return at != taken_.end() && at->place == place
                   ? static_cast<std::size_t>(at - taken_.begin())
                   : taken_.size();
    }

    /// Calls visit(which of the taken) for those beside a place.
    template <class Visit>
    void for_taken_around(const BlockNode& place, const Visit& visit) const {
        for (const std::int32_t t : triangles_[index(place.node)]) {
            for (const std::int32_t node : input_.plan.corners(index(t))) {
                const std::size_t other = found({place.block, node});
                if (other < taken_.size()) visit(other);
            }
        }
    }

    /// The places that were taken in one piece.
    std::vector<std::vector<std::size_t>> fronts() const {
        std::vector<std::vector<std::size_t>> made;
        std::vector<std::uint8_t> is_seen(taken_.size(), 0);
        for (std::size_t start = 0; start < taken_.size(); ++start) {
            if (is_seen[start] != 0) continue;
            is_seen[start] = 1;
            std::vector<std::size_t> front{start};
            for (std::size_t k = 0; k < front.size(); ++k) {
                for_taken_around(taken_[front[k]].place, [&](std::size_t other) {
                    if (is_seen[other] != 0) return;
                    is_seen[other] = 1;
                    front.push_back(other);
                });
            }
            made.push_back(std::move(front));
        }
        return made;
    }

    const ColumnInput& input_;
    std::vector<double> volumes_;
    double least_ = 0;                    ///< what every block may lose or gain
    Buckets<std::size_t> pillars_;        ///< of each node
    Buckets<std::int32_t> triangles_;     ///< around each node
    std::vector<Taken> taken_;            ///< sorted
    std::vector<BlockNode> kept_;         ///< sorted
    std::vector<std::uint8_t> is_whole_;  ///< of each block: it is kept everywhere
};

constexpr int kWeakRounds = 30;
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
          has_flat_base_(plan_.nodes(), 0) {
        for (std::size_t p = 0; p < plan_.pillar_count(); ++p) {
            if (input.heights.rock(p) >= 0 && input.heights.surfaces(p)[0] == kBase)
                has_flat_base_[index(plan_.pillar_node(p))] = 1;
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
        relax_steep_faces(1);
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
        const PillarLevels start = levels_;
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
    bool takes_back(const PillarLevels& start, double most) {
        if (!limits_->take_back(filling_->columns.mesh.volumes, most)) return false;
        levels_ = start;
        refill();
        return true;
    }

    /// Faces that are steep, so that the centers of neighbors lie far from the direction across
    /// them, are made less steep: at first all heights of a node move, then each for itself.
    /// @param reach  minimum thicknesses: how far heights move at most
    void relax_steep_faces(double reach) {
        const double thickness = layering_.minimum_thickness;
        std::vector<std::uint8_t> is_moved;
        bool any = false;
        for (const bool alone : {false, true}) {
            is_moved.assign(plan_.nodes(), 1);
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
                limits_->limit(levels_, failing);
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
            if (limits_->changes_much(b, filling_->columns.mesh.volumes, kMostOfBlock)) return true;
        }
        return changed > kMostRepaired * total;
    }

    /// Elements that are too thin for how steep they are become one with the next in their columns,
    /// until there are none; what no removal repairs is reported.
    void join_skewed() {
        const PillarLevels start = levels_;
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
    PillarLevels levels_;
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
